"""Some rows and columns of a quantity, as a quantity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from derive.emit.latex.quantity import places
from derive.emit.quantity import Quantity


@dataclass(frozen=True, slots=True)
class Submatrix:
    """Rows and columns of a quantity, counted from 1.

    Attributes:
        whole: The quantity.
        rows: Its rows.
        columns: Its columns.
    """

    whole: Quantity
    rows: tuple[int, ...]
    columns: tuple[int, ...]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.rows), len(self.columns)

    def terms(self, row: int, column: int) -> int:
        """Number of terms of an entry when multiplied out."""
        return self.whole.terms(self.rows[row - 1], self.columns[column - 1])

    def entry(self, row: int, column: int) -> Any:
        """The expression of an entry."""
        return self.whole.entry(self.rows[row - 1], self.columns[column - 1])


def column(whole: Quantity, index: int, rows: tuple[int, ...]) -> Submatrix:
    """Part of a column."""
    return Submatrix(whole, rows, (index,))


def total_terms(quantity: Quantity) -> int:
    """Number of terms of all entries."""
    return sum(quantity.terms(*place) for place in places(quantity.shape))
