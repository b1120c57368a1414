"""Exact trigonometric polynomials, the lecture form, and straight-line programs."""
