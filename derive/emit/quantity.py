"""What a target may ask about a derived quantity: its shape, how long an entry is, and the entry itself.

The size is known before an entry is converted, so that an entry too long to print costs nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol


class Quantity(Protocol):
    """A matrix in the lecture form; vectors are columns and scalars are 1x1."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""

    def terms(self, row: int, column: int) -> int:
        """Number of terms of an entry when multiplied out; 0 if it is zero. Indices count from 1."""

    def entry(self, row: int, column: int) -> Any:
        """The SymPy expression of an entry."""


Quantities = Mapping[str, Quantity]
"""By name, as in ``derive show``: ``A[1]``, ``T``, ``T[0,3]``, ``J``, ``B``, ``christoffel[1,2,3]``, ``C``, ``tau``."""
