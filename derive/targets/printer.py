"""How a tape's operations are written down: the one interface of all languages, and Python."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from derive.algebra.constants import Constant, to_float
from derive.programs.tape.tape import FUNCTION_NAMES, Op

SUM, PRODUCT, ATOM = 1, 2, 3


@dataclass(frozen=True, slots=True)
class Piece:
    """Text of a value, and how tightly its outermost operation binds."""

    text: str
    binding: int = ATOM

    def inside(self, binding: int) -> str:
        """The text as an operand of something that binds as tightly as ``binding``."""
        return f"({self.text})" if self.binding < binding else self.text


class Printer(Protocol):
    """One language."""

    def number(self, value: Constant) -> Piece:
        """An exact constant, rounded once."""

    def add(self, a: Piece, b: Piece) -> Piece:
        """Sum."""

    def subtract(self, a: Piece, b: Piece) -> Piece:
        """Difference."""

    def multiply(self, a: Piece, b: Piece) -> Piece:
        """Product."""

    def divide(self, a: Piece, b: Piece) -> Piece:
        """Quotient."""

    def negate(self, a: Piece) -> Piece:
        """Change of sign."""

    def call(self, function: str, a: Piece) -> Piece:
        """``sin``, ``cos``, ``sqrt`` or ``sign`` of a."""

    def assign(self, name: str, value: Piece) -> str:
        """A statement."""


class InfixPrinter:
    """Operators as in Python and C; operations happen in the order of the tape, whatever the language may reorder."""

    def number(self, value: Constant) -> Piece:
        """The shortest decimal that reads back as the nearest double."""
        return Piece(repr(to_float(value)))

    def add(self, a: Piece, b: Piece) -> Piece:
        """Sum."""
        return Piece(f"{a.inside(SUM)} + {b.inside(PRODUCT)}", SUM)

    def subtract(self, a: Piece, b: Piece) -> Piece:
        """Difference."""
        return Piece(f"{a.inside(SUM)} - {b.inside(PRODUCT)}", SUM)

    def multiply(self, a: Piece, b: Piece) -> Piece:
        """Product."""
        return Piece(f"{a.inside(PRODUCT)}*{b.inside(ATOM)}", PRODUCT)

    def divide(self, a: Piece, b: Piece) -> Piece:
        """Quotient."""
        return Piece(f"{a.inside(PRODUCT)}/{b.inside(ATOM)}", PRODUCT)

    def negate(self, a: Piece) -> Piece:
        """Change of sign."""
        return Piece(f"-{a.inside(PRODUCT)}", SUM)

    def call(self, function: str, a: Piece) -> Piece:
        """A function of one argument."""
        return Piece(f"{function}({a.text})")


class PythonPrinter(InfixPrinter):
    """Python: floats, arrays and CasADi expressions alike."""

    def assign(self, name: str, value: Piece) -> str:
        """``name = value``."""
        return f"{name} = {value.text}"


class JavaScriptPrinter(InfixPrinter):
    """JavaScript: numbers, with ``sin``, ``cos``, ``sqrt`` and ``sign`` taken from ``Math``."""

    def number(self, value: Constant) -> Piece:
        """As in Python; a negative number is no atom, since ``--2`` is an error."""
        text = repr(to_float(value))
        return Piece(text, SUM if text.startswith("-") else ATOM)

    def assign(self, name: str, value: Piece) -> str:
        """``const name = value;``."""
        return f"const {name} = {value.text};"


class CPrinter(InfixPrinter):
    """C: doubles, with ``sin``, ``cos`` and ``sqrt`` of <math.h> and a ``sign`` of our own."""

    def number(self, value: Constant) -> Piece:
        """As in Python; a negative number is no atom, since ``--2`` is an error."""
        text = repr(to_float(value))
        return Piece(text, SUM if text.startswith("-") else ATOM)

    def assign(self, name: str, value: Piece) -> str:
        """``const double name = value;``."""
        return f"const double {name} = {value.text};"


def print_operation(printer: Printer, op: Op, operands: list[Piece]) -> Piece:
    """One operation of a tape."""
    if op in FUNCTION_NAMES:
        return printer.call(FUNCTION_NAMES[op], operands[0])
    methods = {
        Op.ADD: printer.add,
        Op.SUBTRACT: printer.subtract,
        Op.MULTIPLY: printer.multiply,
        Op.DIVIDE: printer.divide,
    }
    return printer.negate(operands[0]) if op is Op.NEGATE else methods[op](*operands)
