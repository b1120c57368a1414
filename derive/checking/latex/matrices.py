"""Matrices of printed formulas: sums, products, transposes and determinants of tables of expression trees."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain

from derive.errors import CheckError
from derive.robot.expression import ZERO, Expression, add, multiply, negate

LARGEST_DETERMINANT = 4  # rows of a determinant that is expanded; larger ones nobody prints


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry."""

    formula: Expression  # what it says; zero where a name is unknown
    text: str = ""  # as it is printed; empty where it is computed from what is printed
    offset: int = 0  # where it stands in the whole text
    is_open: bool = False  # whether it is left out, such as the stars of a matrix of which one entry matters
    unknown: CheckError | None = None  # why it cannot be read, such as a name that the robot does not know


@dataclass(frozen=True, slots=True)
class Table:
    """A matrix."""

    rows: tuple[tuple[Entry, ...], ...]  # its entries, in rows of equal length

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.rows), len(self.rows[0])

    @property
    def entries(self) -> tuple[Entry, ...]:
        """Its entries row by row."""
        return tuple(chain(*self.rows))

    @property
    def transposed(self) -> Table:
        """Rows as columns."""
        return Table(tuple(zip(*self.rows, strict=True)))

    def changed(self, change: Callable[[Expression], Expression]) -> Table:
        """The same function of every entry."""
        return Table(tuple(tuple(_computed(change(e.formula), e) for e in row) for row in self.rows))

    def plus(self, other: Table) -> Table:
        """The sum."""
        if self.shape != other.shape:
            found = f"sum of matrices {_size(self)} and {_size(other)}"
            raise CheckError(found, allowed="allowed: matrices of one shape")
        pairs = (zip(a, b, strict=True) for a, b in zip(self.rows, other.rows, strict=True))
        return Table(tuple(tuple(_computed(add(a.formula, b.formula), a, b) for a, b in row) for row in pairs))

    def times(self, other: Table) -> Table:
        """The product; of two columns with three entries the cross product, with two the inner one."""
        if self.shape == other.shape == (3, 1):
            (a1, a2, a3), (b1, b2, b3) = ([entry.formula for entry in table.entries] for table in (self, other))
            pairs = (((a2, b3), (a3, b2)), ((a3, b1), (a1, b3)), ((a1, b2), (a2, b1)))
            differences = (add(multiply(*first), negate(multiply(*second))) for first, second in pairs)
            return Table(tuple((_computed(e, *self.entries, *other.entries),) for e in differences))
        if self.shape == other.shape == (2, 1):
            return Table((tuple(entry for (entry,) in self.rows),)).times(other)
        if self.shape[1] != other.shape[0]:
            found = f"product of matrices {_size(self)} and {_size(other)}"
            raise CheckError(found, allowed="allowed: shapes that fit")

        def product(row: tuple[Entry, ...], column: tuple[Entry, ...]) -> Entry:
            terms = (multiply(a.formula, b.formula) for a, b in zip(row, column, strict=True))
            return _computed(add(*terms), *row, *column)

        return Table(tuple(tuple(product(row, column) for column in other.transposed.rows) for row in self.rows))

    @property
    def determinant(self) -> Entry:
        """Its determinant, expanded along the first row."""
        if self.shape[0] != self.shape[1] or self.shape[0] > LARGEST_DETERMINANT:
            allowed = f"allowed: square matrices of up to {LARGEST_DETERMINANT} rows"
            raise CheckError(f"determinant of a matrix {_size(self)}", allowed=allowed)
        return _computed(_expanded(tuple(tuple(entry.formula for entry in row) for row in self.rows)), *self.entries)


def joined_blocks(rows: Sequence[Sequence[Expression | Table]]) -> Table:
    """A matrix of matrices; a zero among them is a block of zeros."""
    blocks = [[block if isinstance(block, Table) else Table(((Entry(block),),)) for block in row] for row in rows]
    heights = [max(block.shape[0] for block in row) for row in blocks]
    widths = [max(block.shape[1] for block in column) for column in zip(*blocks, strict=True)]
    whole: list[tuple[Entry, ...]] = []
    for row, height in zip(blocks, heights, strict=True):
        parts = []
        for block, width in zip(row, widths, strict=True):
            if block.shape == (1, 1) and block.rows[0][0].formula == ZERO:
                block = Table(((block.rows[0][0],) * width,) * height)
            if block.shape != (height, width):
                raise CheckError(f"block {_size(block)} of a matrix", allowed=f"allowed: {height}x{width} here")
            parts.append(block.rows)
        whole += [tuple(chain(*line)) for line in zip(*parts, strict=True)]
    return Table(tuple(whole))


def _computed(formula: Expression, *parts: Entry) -> Entry:
    unknown = next((part.unknown for part in parts if part.unknown), None)
    return Entry(formula, "", parts[0].offset, any(part.is_open for part in parts), unknown)


def _expanded(rows: tuple[tuple[Expression, ...], ...]) -> Expression:
    if len(rows) == 1:
        return rows[0][0]
    # Laplace along the first row: at most 4 rows, so that nothing is computed twice often
    minors = (_expanded(tuple((*row[:j], *row[j + 1 :]) for row in rows[1:])) for j in range(len(rows)))
    products = (multiply(entry, minor) for entry, minor in zip(rows[0], minors, strict=True))
    return add(*(negate(term) if j % 2 else term for j, term in enumerate(products)))


def _size(table: Table) -> str:
    return "x".join(map(str, table.shape))
