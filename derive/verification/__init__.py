"""Verification of generated code in numbers: every function of every target against the recursion of `oracle`."""
