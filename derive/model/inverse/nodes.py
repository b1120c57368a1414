"""The elementary equations of inverse kinematics: what each takes, how many values it has, how it is solved.

Each is solved over any numbers (`Field`) by + - * / and square roots alone, without angles. With c and s the cosine and
sine of the unknown,

    A c + B s = C:  h = sqrt(A^2 + B^2 - C^2),  c = (A C - e B h)/(A^2 + B^2),  s = (B C + e A h)/(A^2 + B^2),  e = +-1,

which is theta = atan2(B, A) + e atan2(h, C) (type 2 of Khalil and Dombre, Modeling, Identification and Control of
Robots, 2002, chapter 4); two such equations determine c and s by Cramer's rule (type 3).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from functools import cached_property
from typing import Any, Generic, Protocol, Self, TypeVar

from derive.algebra.ring import Polynomial
from derive.mechanics.vectors import Scalar
from derive.robot.expression import Expression


class Mask(Protocol):
    """Where something holds: a truth value, or an array of them."""

    def __and__(self, other: Any, /) -> Self: ...
    def __or__(self, other: Any, /) -> Self: ...
    def __invert__(self) -> Self: ...


N = TypeVar("N", bound=Scalar)
"""A number, with + - * between numbers and ints."""

M = TypeVar("M", bound=Mask)
"""Where something holds."""


class Kind(StrEnum):
    """How a node is solved; the types are those of Khalil and Dombre, 2002, chapter 4."""

    GIVEN = "given"
    """The joint is an argument."""
    SUM = "sum"
    """A sum or difference of angles that are known."""
    TYPE_1 = "type 1"
    """X r = Y."""
    TYPE_2 = "type 2"
    """Y c + X s = Z."""
    TYPE_3 = "type 3"
    """Two equations Y c + X s = Z."""
    QUADRATIC = "quadratic"
    """X r^2 + Y r = Z."""
    CONIC = "conic"
    """One equation of the second degree in c and s: a quartic."""
    GENERAL = "general"
    """Several unknowns at once: elimination and an eigenvalue problem."""


BRANCHES = {
    Kind.GIVEN: 1,
    Kind.SUM: 1,
    Kind.TYPE_1: 1,
    Kind.TYPE_2: 2,
    Kind.TYPE_3: 1,
    Kind.QUADRATIC: 2,
    Kind.CONIC: 4,
}
"""How many values an unknown has for given coefficients."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """What a node solves for: a slide, a joint angle, or the sum of the angles of neighbouring parallel joints.

    Attributes:
        joints: Indices of the joints, from 0.
        signs: The factor of each joint's variable in the sum; the first is +1.
        generators: Names of the generators in the ring: cosine and sine, or the length.
    """

    joints: tuple[int, ...]
    signs: tuple[int, ...]
    generators: tuple[str, ...]

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle, and not a length."""
        return len(self.generators) == 2


Exponents = tuple[int, ...]
"""Of cosine and sine, or of the length, of the unknown."""


@dataclass(frozen=True, slots=True)
class Source:
    """Where an equation comes from: M = A_first ... A_last between joint frames, and the rest of the chain around T.

    With the pose W without base and tool, M = (Z_1 ... )^-1 W (... Z_n)^-1. The entries are named as `pool` names them.

    Attributes:
        first: First joint of M, from 1.
        last: Last joint of M.
        entry: Which entry or invariant of both sides.
        outer_left: Whether M begins behind the offset of its first joint.
        outer_right: Whether M ends before the offset of its last joint.
        also: Another equation, with which an unknown was eliminated from this one (`derive.model.inverse.pairs`).
    """

    first: int
    last: int
    entry: str
    outer_left: bool = False
    outer_right: bool = False
    also: Source | None = None


@dataclass(frozen=True)
class Equation:
    """``sum of coefficient * c^i s^j = 0`` (or ``coefficient * r^i``) with coefficients of what is known.

    Attributes:
        terms: Exponents of the unknown -> coefficient, none of them the zero polynomial.
        dimension: The power of length that it has: 0 for entries of rotations, 1 for positions, 2 for squares.
        source: Where it comes from.
        size: What it is multiplied by, against the entries that it comes from: the size of its coefficients, with
            lengths counted by the reach of the arm.
    """

    terms: Mapping[Exponents, Polynomial]
    dimension: int
    source: Source
    size: Fraction = Fraction(1)

    def coefficient(self, *exponents: int) -> Polynomial:
        """The coefficient of a power of the unknown, zero where it does not occur.

        Args:
            exponents: Of cosine and sine, or of the length.
        """
        known = self.terms.get(exponents)
        return next(iter(self.terms.values())).ring.zero if known is None else known

    @property
    def linear(self) -> tuple[Polynomial, Polynomial, Polynomial]:
        """(A, B, C) of an equation A c + B s = C of an angle."""
        return self.coefficient(1, 0), self.coefficient(0, 1), -self.coefficient(0, 0)


@dataclass(frozen=True)
class Formula:
    """One way to solve a node.

    Attributes:
        kind: The elementary type.
        equations: One, or two for type 3; none for sums and given joints.
        parts: The angles whose sum is taken, each with its sign (`Kind.SUM` alone).
        payload: What a general node needs besides; see `derive.model.inverse.general`.
    """

    kind: Kind
    equations: tuple[Equation, ...] = ()
    parts: tuple[tuple[Unknown, int], ...] = ()
    payload: Any = None

    @property
    def branches(self) -> int:
        """How many values it gives."""
        return int(self.payload.branches) if self.kind is Kind.GENERAL else BRANCHES[self.kind]

    @cached_property
    def existence(self) -> Polynomial | None:
        """The polynomial that a real solution needs to be at least 0; None where there is always one."""
        match self.kind:
            case Kind.TYPE_2:
                a, b, c = self.equations[0].linear
                return a * a + b * b - c * c if c else None
            case Kind.QUADRATIC:
                a, b, c = (self.equations[0].coefficient(k) for k in (2, 1, 0))
                return b * b - 4 * (a * c)
        return None

    @cached_property
    def degenerate(self) -> tuple[Polynomial, ...]:
        """The polynomials at whose common zeros the formula does not determine its unknown; none: it always does."""
        match self.kind:
            case Kind.TYPE_1:
                found: tuple[Polynomial, ...] = (self.equations[0].coefficient(1),)
            case Kind.QUADRATIC:
                found = (self.equations[0].coefficient(2),)
            case Kind.TYPE_2:
                found = self.equations[0].linear[:2]
            case Kind.TYPE_3:
                (a, b, _), (d, e, _) = (equation.linear for equation in self.equations)
                found = (a, e) if not b and not d else (b, d) if not a and not e else (a * e - b * d,)
            case Kind.CONIC:
                found = tuple(p for exponents, p in self.equations[0].terms.items() if any(exponents))
            case _:
                return ()
        kept = tuple(p for p in found if p)
        return () if self.kind is not Kind.TYPE_3 and any(p.is_constant for p in kept) else kept


class Field(Protocol[N, M]):
    """Numbers that a graph is run over, with + - * between them and with ints, and masks with & | ~."""

    def number(self, value: Any) -> N:
        """A rational number.

        Args:
            value: An int or a Fraction.
        """

    def constant(self, expression: Expression) -> N:
        """A parameter, a root, the sine of a constant angle: what a generator stands for that is no unknown.

        Args:
            expression: The exact expression.
        """

    def divide(self, a: N, b: N) -> N:
        """The quotient; any number where the divisor is zero.

        Args:
            a: The dividend.
            b: The divisor.
        """

    def sqrt(self, a: N) -> N:
        """The square root; any number where there is none.

        Args:
            a: The radicand.
        """

    def is_zero(self, a: N, scale: N) -> M:
        """Whether a coefficient is zero, within rounding.

        Args:
            a: The number.
            scale: The size that it usually has.
        """

    def has_root(self, a: N, scale: N) -> M:
        """Whether a number has a square root: it is not below zero, but for rounding.

        Args:
            a: The radicand.
            scale: The size of what it is the difference of.
        """

    def merges(self, a: N, scale: N) -> M:
        """Whether the two square roots of a number cannot be told apart.

        Args:
            a: The radicand.
            scale: The size of what it is the difference of.
        """

    def select(self, mask: M, a: N, b: N) -> N:
        """The one number where a mask holds, and the other elsewhere.

        Args:
            mask: The mask.
            a: Where it holds.
            b: Elsewhere.
        """

    def never(self, mask: M) -> bool:
        """Whether a mask is known to hold nowhere, so that what depends on it need not be computed.

        Args:
            mask: The mask.
        """

    def truth(self, value: bool) -> M:
        """A mask that holds everywhere or nowhere.

        Args:
            value: Which of the two.
        """

    def cosine_sine(self, angle: N) -> tuple[N, N]:
        """Of a joint that is given.

        Args:
            angle: The angle [rad].
        """

    def angle(self, cosine: N, sine: N) -> N:
        """The angle of a cosine and a sine, in (-pi, pi].

        Args:
            cosine: Times any positive number.
            sine: Times the same number.
        """

    def unit(self, cosine: N, sine: N) -> tuple[N, N]:
        """A point that lies on the unit circle but for rounding, which a small determinant makes large, moved there.

        Args:
            cosine: Of an angle, nearly.
            sine: Of the angle, nearly.
        """

    def conic(self, coefficients: Sequence[N], scale: N) -> Sequence[tuple[N, N, M]]:
        """The four common points of the unit circle and a conic.

        Args:
            coefficients: Of c^2, c s, s^2, c, s and 1.
            scale: The size that they usually have.

        Returns:
            Cosine, sine and whether the point exists.
        """

    def general(self, formula: Formula, values: Mapping[str, N]) -> Sequence[tuple[tuple[tuple[N, ...], ...], M]]:
        """The values of a general node.

        Args:
            formula: The node's formula.
            values: Numbers of all generators that are known.

        Returns:
            For each branch the numbers of each unknown, and whether the branch exists.
        """


@dataclass(frozen=True)
class Branch(Generic[N, M]):
    """One value of an unknown.

    Attributes:
        numbers: Cosine and sine, or the length.
        exists: Whether it is real (over floats), or a number at all.
        boundary: Whether another branch coincides with it.
    """

    numbers: tuple[N, ...]
    exists: M
    boundary: M


@dataclass(frozen=True)
class Solver(Generic[N, M]):
    """Solves elementary equations over one kind of numbers.

    Attributes:
        field: The numbers.
        evaluate: The number of a coefficient.
        reach: The size of the arm, which the size of every coefficient is a power of.
    """

    field: Field[N, M]
    evaluate: Callable[[Polynomial], N]
    reach: N

    def degenerate(self, formula: Formula) -> M:
        """Whether a formula does not determine its unknown here.

        Args:
            formula: Of one of the elementary types.
        """
        first = formula.equations[0]
        second = formula.equations[-1]
        if formula.kind is Kind.TYPE_3 and len(formula.degenerate) == 2:
            zeros = [self._is_zero(p, own) for p, own in zip(formula.degenerate, (first, second), strict=True)]
            return zeros[0] | zeros[1]
        mask = self.field.truth(bool(formula.degenerate))
        for p in formula.degenerate:
            mask = mask & (self._is_zero(p, first, second) if second is not first else self._is_zero(p, first))
        return mask

    def solve(self, formula: Formula) -> list[Branch[N, M]]:
        """The values of the unknown, where the formula is not degenerate; any numbers elsewhere.

        Args:
            formula: Of one of the elementary types with equations.
        """
        match formula.kind:
            case Kind.TYPE_1:
                return self._length(formula.equations[0])
            case Kind.QUADRATIC:
                return self._two_lengths(formula.equations[0])
            case Kind.TYPE_2:
                return self._angles(formula.equations[0])
            case Kind.TYPE_3:
                return self._one_angle(*formula.equations)
            case Kind.CONIC:
                equation = formula.equations[0]
                coefficients = [self.evaluate(equation.coefficient(*exponents)) for exponents in CONIC_TERMS]
                found = self.field.conic(coefficients, self._scale(equation))
                return [Branch((c, s), exists, self.field.truth(False)) for c, s, exists in found]
        raise ValueError(f"no elementary type: {formula.kind}")

    def _is_zero(self, p: Polynomial, *equations: Equation) -> M:
        if p.is_constant:
            return self.field.truth(not p)
        return self.field.is_zero(self.evaluate(p), self._scale(*equations))

    def _scale(self, *equations: Equation) -> N:
        """The size of the coefficients of an equation, or of the products of those of two."""
        total = Fraction(1)
        for equation in equations:
            total *= equation.size
        scale = self.field.number(total)
        for _ in range(sum(equation.dimension for equation in equations)):
            scale = scale * self.reach
        return scale

    def _length(self, equation: Equation) -> list[Branch[N, M]]:
        a, b = (self.evaluate(equation.coefficient(k)) for k in (1, 0))
        truth = self.field.truth
        return [Branch((self.field.divide(-b, a),), truth(True), truth(False))]

    def _two_lengths(self, equation: Equation) -> list[Branch[N, M]]:
        """r = (-B +- sqrt(B^2 - 4 A C))/(2 A), without B where there is none."""
        f = self.field
        a, b, c = (self.evaluate(equation.coefficient(k)) for k in (2, 1, 0))
        size = self.reach * self.reach
        if not equation.coefficient(1):
            return self._both(f.divide(-c, a), size, lambda e, root: (e * root,))
        radicand = b * b - 4 * (a * c)
        return self._both(radicand, a * a * size, lambda e, root: (f.divide(e * root - b, 2 * a),))

    def _both(self, radicand: N, size: N, value: Callable[[int, N], tuple[N, ...]]) -> list[Branch[N, M]]:
        """The branches of a square root, the second one only where it can be told from the first."""
        f = self.field
        exists, double = f.has_root(radicand, size), f.merges(radicand, size)
        root = f.select(double, f.number(0), f.sqrt(radicand))
        boundary = exists & double
        return [Branch(value(1, root), exists, boundary), Branch(value(-1, root), exists & ~double, boundary)]

    def _angles(self, equation: Equation) -> list[Branch[N, M]]:
        f = self.field
        (has_a, has_b, has_c), (a, b, c) = map(bool, equation.linear), map(self.evaluate, equation.linear)
        if not has_c:
            square = a * a + b * b
            root = f.sqrt(square)
            cosine, sine = f.divide(-b, root), f.divide(a, root)
            both = [(cosine, sine), (-cosine, -sine)]
            return [Branch(pair, f.has_root(square, square), f.truth(False)) for pair in both]
        one = f.number(1)
        if not has_a or not has_b:
            known = f.divide(c, b if has_b else a)
            return self._both(one - known * known, one, lambda e, r: (e * r, known) if has_b else (known, e * r))
        square = a * a + b * b
        along = f.divide(c, square)

        def _turned(e: int, root: N) -> tuple[N, ...]:
            across = f.divide(e * root, square)
            return a * along - b * across, b * along + a * across

        return self._both(square - c * c, square, _turned)

    def _one_angle(self, first: Equation, second: Equation) -> list[Branch[N, M]]:
        f = self.field
        a, b, c = map(self.evaluate, first.linear)
        d, e, g = map(self.evaluate, second.linear)
        if not first.linear[1] and not second.linear[0]:
            cosine, sine = f.divide(c, a), f.divide(g, e)
        elif not first.linear[0] and not second.linear[1]:
            cosine, sine = f.divide(g, d), f.divide(c, b)
        else:
            determinant = a * e - b * d
            cosine = f.divide(c * e - b * g, determinant)
            sine = f.divide(a * g - c * d, determinant)
        return [Branch(f.unit(cosine, sine), f.truth(True), f.truth(False))]


CONIC_TERMS: tuple[Exponents, ...] = ((2, 0), (1, 1), (0, 2), (1, 0), (0, 1), (0, 0))
"""Exponents of cosine and sine in the order in which `Field.conic` takes the coefficients."""
