"""The numbers of a program that is being written, over which a graph of solutions is run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from derive.inverse.closed.elementary_solver import Solver, line_points
from derive.inverse.closed.fields import BEYOND, MERGED, ZERO
from derive.inverse.closed.graph import GraphWalk, Node
from derive.inverse.closed.graph import Value as Found
from derive.inverse.closed.nodes import NodeFormula, NodeKind
from derive.programs.tape.graph import ZERO as ZERO_VALUE
from derive.programs.tape.graph import Ref, node_of
from derive.programs.tape.tape import Layer
from derive.programs.tape.value import TapeDomain, Value
from derive.robot.expression import Pi


@dataclass(frozen=True, slots=True)
class Mask:
    """What holds or not, as a value 1 or 0 of a tape; what follows from logic alone costs nothing."""

    value: Value

    def __and__(self, other: Mask) -> Mask:
        a, b = self.value, other.value
        if a.ref == b.ref or other.never or (~self).never:
            return other
        if a.opposite().ref == b.ref:
            return Mask(a - a)
        return self if self.never or (~other).never else Mask(a * b)

    def __or__(self, other: Mask) -> Mask:
        a, b = self.value, other.value
        if a.ref == b.ref or self.never or (~other).never:
            return other
        if a.opposite().ref == b.ref:
            return ~Mask(a - a)
        return self if other.never or (~self).never else Mask(a.maximum(b))

    def __invert__(self) -> Mask:
        return Mask(self.value.opposite())

    @property
    def never(self) -> bool:
        """Whether it is known to hold nowhere."""
        return self.value.ref == ZERO_VALUE


class TapeField:
    """Values of a tape as numbers for a graph of solutions (`derive.inverse.closed.elementary_solver.Field`)."""

    def __init__(self, domain: TapeDomain) -> None:
        self.domain = domain
        self.number, self.constant = domain.number, domain.constant
        self._angles: dict[tuple[int, int], tuple[Value, Value, Value]] = {}
        self._as_found: dict[tuple[Ref, Ref], tuple[Value, Value]] = {}

    def divide(self, a: Value, b: Value) -> Value:
        """The quotient; where the divisor is zero, what floats make of it."""
        return a / b

    def sqrt(self, a: Value) -> Value:
        """The square root; 0 of negative numbers."""
        return a.maximum(0).sqrt()

    def is_zero(self, a: Value, scale: Value) -> Mask:
        """Whether a coefficient is zero within rounding."""
        if a.graph.layer[node_of(a.ref)] is not Layer.BODY:  # a length of the arm, and no matter of the pose
            return ~Mask(self.number(0).less(abs(a)))
        return ~Mask((scale * Fraction(ZERO)).less(abs(a)))

    def has_root(self, a: Value, scale: Value) -> Mask:
        """Whether a number is not below zero, but for rounding."""
        if a.graph.is_nowhere_negative(a.ref):
            return self.truth(True)
        return ~Mask(a.less(abs(scale) * -Fraction(BEYOND)))

    def merges(self, a: Value, scale: Value) -> Mask:
        """Whether the two roots of a number are one within rounding."""
        return ~Mask((abs(scale) * Fraction(MERGED)).less(a))

    def select(self, mask: Mask, a: Value, b: Value) -> Value:
        """One of two numbers."""
        return mask.value.select(a, b)

    def never(self, mask: Mask) -> bool:
        """Whether a mask is known to hold nowhere."""
        return mask.never

    def truth(self, value: bool) -> Mask:
        """A mask that holds everywhere or nowhere."""
        return Mask(self.number(int(value)))

    def cosine_sine(self, angle: Value) -> tuple[Value, Value]:
        """Of a joint that is given."""
        return angle.cos(), angle.sin()

    def angle(self, cosine: Value, sine: Value) -> Value:
        """The angle of a cosine and a sine; that of the opposite point is half a turn away."""
        cosine, sine = self._as_found.get((cosine.ref, sine.ref), (cosine, sine))
        key = node_of(sine.ref), node_of(cosine.ref)
        y, x, angle = self._angles.setdefault(key, (sine, cosine, sine.arctangent(cosine)))
        if y.ref == (-sine).ref and x.ref == (-cosine).ref and sine.ref != y.ref:
            half = self.domain.constant(Pi())
            return angle + self.number(0).less(angle).select(-half, half)
        return angle if y.ref == sine.ref and x.ref == cosine.ref else sine.arctangent(cosine)

    def unit(self, cosine: Value, sine: Value) -> tuple[Value, Value]:
        """A point that lies on the unit circle but for rounding, moved there by a Newton step for 1/sqrt(c^2 + s^2)."""
        scale = Fraction(3, 2) - (cosine * cosine + sine * sine) * Fraction(1, 2)
        moved = cosine * scale, sine * scale
        self._as_found[moved[0].ref, moved[1].ref] = cosine, sine
        return moved

    def conic(self, coefficients: Sequence[Value]) -> Sequence[tuple[Value, Value, Mask, Mask, Mask]]:
        """The common points of the unit circle and a conic."""
        return line_points(self, coefficients)

    def general(self, formula: NodeFormula, values: Mapping[str, Value]) -> Sequence[Any]:
        """Graphs with eigenvalue problems have no program (`search_function`)."""
        raise NotImplementedError


class ClosingField(TapeField):
    """Values for solutions of closed loops, which have no number where a loop does not close."""

    def sqrt(self, a: Value) -> Value:
        """The square root; no number of negative ones."""
        return a.sqrt()

    def has_root(self, a: Value, scale: Value) -> Mask:
        """Roots that are none have no number."""
        return self.truth(True)

    def merges(self, a: Value, scale: Value) -> Mask:
        """Of the two assemblies the file asks for one."""
        return self.truth(False)


class ClosingWalk(GraphWalk[Value, Mask]):
    """A walk in which an unknown with one formula has no number where that fails; else the next formula serves."""

    def _solve(self, node: Node, scope: Mapping[str, Value]) -> list[Found[Value, Mask]]:
        if len(node.formulas) > 1 or node.kind is NodeKind.GIVEN:
            return super()._solve(node, scope)
        found = Solver(self.field, lambda p: self.evaluate(p, scope), self.reach).solve(node.formulas[0])
        no = self.field.truth(False)
        return [Found((branch.numbers,), branch.exists, no, no, no, no) for branch in found]
