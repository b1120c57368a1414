"""Exact trigonometric polynomials over angles, variables and parameters. Knows no robot mechanics."""
