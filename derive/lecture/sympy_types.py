"""Names for SymPy's objects, which come without types."""

from typing import Any

Expr = Any
"""A SymPy expression."""

Matrix = Any
"""A SymPy matrix; those of a model are immutable."""
