"""Numeric verification of generated code: every function of every target against the independent recursion of `oracle`.

`verify` draws `samples`, loads or compiles what was `generated`, calls every function in all its ways (`trials`) and
compares with what the oracle answers, within the `tolerance` of 1e-9.
"""
