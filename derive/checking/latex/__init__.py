"""Formulas in LaTeX documents: pieces, equations, left sides, grammar, names."""
