"""Pieces of a motion as tapes: position, velocity and acceleration from the time and a row of numbers.

The row of a piece begins with its start and its duration; then come the values at its ends. A polynomial is the sum of
its values by the basis of `derive.plans.hermite`, so that nothing is rounded at its ends in any language.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from math import factorial
from operator import add, mul

import sympy
from sympy import Expr

from derive.algebra import constants
from derive.algebra.constants import exact_number
from derive.errors import QuantityError
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.plans.hermite import TIME, Piece, basis
from derive.plans.profile import AnyPiece, Cosine
from derive.programs.tape.build import cut
from derive.programs.tape.derivative import derivative
from derive.programs.tape.graph import ONE, Graph
from derive.programs.tape.tape import LEAVES, Op, Tape
from derive.programs.tape.value import Value
from derive.targets.kernel import CodePiece as Text
from derive.targets.kernel import Language, temporary_names, write_statements

CLOCK, ROW = "t", "row"  # arguments of a tape: the time [s], and the numbers of a piece
NAMES = {2: "cubic", 3: "quintic", 4: "septic"}  # polynomials by the number of values at each end
HARMONIC = "harmonic"

_FUNCTIONS: dict[type[Expr], Callable[..., Value]] = {
    sympy.Add: lambda *terms: reduce(add, terms),
    sympy.Mul: lambda *factors: reduce(mul, factors),
    sympy.sin: Value.sin,
    sympy.cos: Value.cos,
    sympy.tan: lambda angle: angle.sin() / angle.cos(),
    sympy.sign: Value.sign,
    sympy.Abs: abs,
    sympy.atan2: Value.arctangent,
}


@dataclass(frozen=True, slots=True)
class Kernel:
    """How one kind of piece is computed."""

    name: str  # for instance ``quintic``, or ``curve_q1``
    tape: Tape  # its outputs are position, velocity and acceleration

    def written(self, language: Language) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Its statements and results, with ``t``, ``row[0]``, ... for the arguments."""
        texts: dict[int, Text] = {}
        for i, node in enumerate(self.tape.nodes):
            if node.op is Op.CONSTANT:
                texts[i] = language.number(node.value)
            elif node.source is not None:
                kind = node.source.kind
                texts[i] = Text(CLOCK if kind == CLOCK else f"{kind}[{node.source.index}]")
        operations = [i for i, node in enumerate(self.tape.nodes) if node.op not in LEAVES]
        statements = write_statements(self.tape, language, operations, texts, temporary_names())
        return statements, tuple(language.output(self.tape, output, texts) for output in self.tape.outputs)

    @property
    def unused(self) -> tuple[str, ...]:
        """Arguments that its tape does not ask for."""
        read = {node.source.kind for node in self.tape.nodes if node.source is not None}
        return tuple(name for name in (CLOCK, ROW) if name not in read)


def kernel_name(piece: AnyPiece, joint: str) -> str:
    """The kernel of a piece."""
    if isinstance(piece, Piece):
        return NAMES[piece.k]
    return HARMONIC if isinstance(piece, Cosine) else f"curve_{joint}"


def kernel_of(piece: AnyPiece, joint: str) -> Kernel:
    """How a piece is computed, and all others of its kind."""
    graph = Graph()
    if isinstance(piece, Piece | Cosine):
        start, duration = (Value(graph, graph.input(ROW, i)) for i in range(2))
        u = (Value(graph, graph.input(CLOCK, 0)) - start) / duration
        outputs = _hermite(graph, piece.k, u, duration) if isinstance(piece, Piece) else _harmonic(graph, u, duration)
    else:
        clock, one = Value(graph, graph.input(CLOCK, 0)), Value(graph, ONE)
        q = _value(graph, piece.formulas[0], clock)
        (qd,) = derivative([q], {clock: one})
        outputs = [q, qd, *derivative([qd], {clock: one})]
    return Kernel(kernel_name(piece, joint), cut(graph, [output.ref for output in outputs]))


def row_of(piece: AnyPiece) -> tuple[float, ...]:
    """The numbers of a piece as its kernel takes them."""
    values = piece.values if isinstance(piece, Piece | Cosine) else ()
    return tuple(map(float, (piece.start, piece.duration, *(value for end in values for value in end))))


def _end(graph: Graph, place: int) -> Value:
    """A value at an end of a piece."""
    return Value(graph, graph.input(ROW, place + 2))


def _hermite(graph: Graph, k: int, u: Value, duration: Value) -> list[Value]:
    """The polynomial with k values at each end, and its derivatives, in which positions count by their difference."""
    weights = [_end(graph, b) * duration ** (b % k) * Fraction(1, factorial(b % k)) for b in range(2 * k)]
    zero = Value(graph, graph.number(Fraction(0)))
    outputs = []
    for order in range(3):
        total = zero
        for row, weight in zip(basis(k), weights, strict=True):
            for _ in range(order):
                row = tuple(power * coefficient for power, coefficient in enumerate(row))[1:]
            total = total + reduce(lambda value, c: value * u + c, reversed(row), 0 * u) * weight  # Horner's rule
        outputs.append(total / duration**order)
        weights[0], weights[k] = zero, _end(graph, k) - _end(graph, 0)
    return outputs


def _harmonic(graph: Graph, u: Value, duration: Value) -> list[Value]:
    """A harmonic piece, symmetric about its middle as `derive.motion.curves.trajectory` has it."""
    pi = Value(graph, graph.number(constants.pi()))
    q0, q1 = _end(graph, 0), _end(graph, 1)
    way = q1 - q0
    late = Value(graph, graph.number(Fraction(1, 2))).less(u)
    angle = pi * late.select(1 - u, u)
    wave = late.select(-angle.cos(), angle.cos())
    rate = pi / duration
    q = late.select(q1 - way * (1 + wave) / 2, q0 + way * (1 - wave) / 2)
    return [q, way * rate * angle.sin() / 2, way * rate**2 * wave / 2]


def _value(graph: Graph, formula: Expr, clock: Value) -> Value:
    """A formula of the grammar of cells as a value."""
    if formula == TIME:
        return clock
    if not formula.has(TIME):
        number = Fraction(float(formula)) if formula.has(sympy.Float) else None
        exact = exact_number(expression_from_sympy(formula), {}) if number is None else number
        return Value(graph, graph.number(exact))
    if isinstance(formula, sympy.Pow) and formula.exp.is_Rational and formula.exp.q <= 2:
        base = _value(graph, formula.base, clock)
        return (base if formula.exp.q == 1 else base.sqrt()) ** int(formula.exp.p)
    if formula.func not in _FUNCTIONS:
        raise QuantityError(
            f"{formula} has no place in generated code", allowed="allowed: sin, cos, tan, sqrt, atan2, sign"
        )
    return _FUNCTIONS[formula.func](*(_value(graph, argument, clock) for argument in formula.args))


# Functions of <math.h>: one time is no batch for which branches would be too dear.
C_NAMES = {Op.ARCTANGENT: "atan2", Op.ABSOLUTE: "fabs", Op.MAXIMUM: "fmax", Op.MINIMUM: "fmin"}


def with_names(language: Language, names: dict[Op, str]) -> Language:
    """A language with other names of functions."""
    return replace(language, names={**language.names, **names})
