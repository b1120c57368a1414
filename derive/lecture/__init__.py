"""How people write it: the lecture form, and the shorthand of notes.

`terms` are polynomials in the factors that are printed, `plan` is how they are grouped, `form` chooses the cheapest
plan and makes SymPy of it; `sympy_conversion` and `shorthand` translate between expression trees, SymPy and notes.
"""
