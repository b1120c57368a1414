"""The kinematics on the sheet: the rows' transforms, T and the Jacobian."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from derive.emit.handout.tables import DataPrinter
from derive.emit.latex.layout import EQUALS, Equation, displays, equation_lines, fits, matrix, pack
from derive.emit.latex.metrics import Box, concatenate, italic, script
from derive.emit.latex.pieces import Break, Piece, joined
from derive.emit.latex.quantity import Block, Layouter, places
from derive.emit.latex.symbols import EntryNamer, Symbols, bold
from derive.emit.quantity import Quantities, Quantity
from derive.robot.robot import IDENTITY, Matrix, Robot

FIRST_FRAME_GROUP = 8
"""Groups of intermediate terms from here on belong to transforms, by the frame that they start from."""


@dataclass(frozen=True)
class KinematicsLayout:
    """Lays out the kinematics of one robot.

    Attributes:
        robot: The robot.
        quantities: Its derived quantities.
        layouter: How a quantity is laid out.
        symbols: Names of entries.
    """

    robot: Robot
    quantities: Quantities
    layouter: Layouter
    symbols: Symbols

    def transforms(self) -> tuple[Block, ...]:
        """A_1 ... A_n; those that fit share lines."""
        blocks: list[Block] = []
        row: list[Box] = []
        for i in range(1, self.robot.n + 1):
            box = self._whole(self._frame_symbol("A", i, i - 1), self.quantities[f"A[{i}]"])
            if box is not None:
                row.append(box)
                continue
            blocks += [*_packed(row), self._block("A", i, i - 1, f"A[{i}]")]
            row = []
        return (*blocks, *_packed(row))

    def _whole(self, symbol: Box, quantity: Quantity) -> Box | None:
        printer = self.layouter.printer
        rows, columns = (range(1, size + 1) for size in quantity.shape)
        cells = [[joined(printer.pieces(quantity.entry(i, j))) for j in columns] for i in rows]
        box = concatenate(symbol, EQUALS, matrix(cells))
        return box if fits(box, len(rows)) else None

    def end_effector(self) -> Block:
        """T."""
        return self.layouter.block(self.end_symbol, self._entry("t"), self.quantities["T"], group=0)

    @property
    def end_symbol(self) -> Box:
        """The symbol of T."""
        return bold("T")

    def product(self) -> str:
        """T as a product: base, A_1 ... A_n, tool."""
        factors = [self._frame_symbol("A", i, i - 1) for i in range(1, self.robot.n + 1)]
        if len(factors) > 8:
            factors = [*factors[:3], Box("\\cdots", 13.0), factors[-1]]
        if self.robot.base != IDENTITY:
            factors.insert(0, Box("\\mathbf{T}_{\\mathrm{base}}", 30.0))
        if self.robot.tool != IDENTITY:
            factors.append(Box("\\mathbf{T}_{\\mathrm{tool}}", 30.0))
        return concatenate(self.end_symbol, EQUALS, *factors).tex

    def partial_products(self) -> tuple[tuple[Block, ...], tuple[str, ...]]:
        """The arm as a product of a few transforms that can be printed, and the display of that product.

        Both are empty where the arm is too short to be taken apart.
        """
        blocks, factors, start = [], [], 0
        while start < self.robot.n:
            end = self._last_short(start)
            blocks.append(self._block("T", end, start, f"T[{start},{end}]"))
            factors.append(Piece(self._frame_symbol("T", end, start), Break.COMMA))
            start = end
        if len(blocks) == 1:
            return (), ()
        whole = Equation(self._frame_symbol("T", self.robot.n, 0), tuple(factors))
        return tuple(blocks), tuple(displays(equation_lines([whole])))

    def _last_short(self, start: int) -> int:
        end = start + 1
        while end < self.robot.n and self._is_short(start, end + 1):
            end += 1
        return end

    def _is_short(self, start: int, end: int) -> bool:
        quantity = self.quantities[f"T[{start},{end}]"]
        longest = max(quantity.terms(*place) for place in places(quantity.shape))
        return longest <= self.layouter.policy.factor_terms

    def jacobian(self) -> Block:
        """J."""
        return self.layouter.block(bold("J"), self._entry("J"), self.quantities["J"], group=1)

    def _block(self, letter: str, upper: int, lower: int, key: str) -> Block:
        symbol = self._frame_symbol(letter, upper, lower)

        def entry(row: int, column: int) -> Box:
            return script(concatenate(Box("(", 5.0), symbol, Box(")", 5.0)), italic(f"{row}{column}"))

        return self.layouter.block(symbol, entry, self.quantities[key], group=FIRST_FRAME_GROUP + lower)

    def _entry(self, letter: str) -> EntryNamer:
        return EntryNamer(self.symbols, letter)

    @staticmethod
    def _frame_symbol(letter: str, frame: int, reference: int) -> Box:
        return script(bold(letter), italic(str(frame)), italic(str(reference)))


def _packed(boxes: list[Box]) -> Iterator[Block]:
    if boxes:
        yield Block(tuple(displays(pack(boxes))))


def constant_frames(data: DataPrinter) -> list[str]:
    """Base and tool, where they are not the identity."""
    frames = (("base", data.robot.base), ("tool", data.robot.tool))
    return [line for name, frame in frames if frame != IDENTITY for line in _constant_frame(data, name, frame)]


def _constant_frame(data: DataPrinter, name: str, frame: Matrix) -> list[str]:
    symbol = Box(f"\\mathbf{{T}}_{{\\mathrm{{{name}}}}}", 30.0)
    cells = [[data.value(cell) for cell in row] for row in frame]
    box = concatenate(symbol, EQUALS, matrix([[joined(cell) for cell in row] for row in cells]))
    if fits(box, 4):
        return displays([box.tex])
    named = [
        Equation(script(concatenate(Box("(", 5.0), symbol, Box(")", 5.0)), italic(f"{i}{j}")), cell)
        for i, row in enumerate(cells, 1)
        for j, cell in enumerate(row, 1)
    ]
    return displays(equation_lines(named))
