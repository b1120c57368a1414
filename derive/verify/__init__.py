"""Numeric verification of generated code: every function of every target against the independent recursion."""
