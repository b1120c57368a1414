"""How the elementary equations of inverse kinematics are solved.

Each is solved over any numbers (`Field`) by + - * / and square roots alone, without angles. With c and s the cosine and
sine of the unknown,

    A c + B s = C:  h = sqrt(A^2 + B^2 - C^2),  c = (A C - e B h)/(A^2 + B^2),  s = (B C + e A h)/(A^2 + B^2),  e = +-1,

which is theta = atan2(B, A) + e atan2(h, C) (type 2 of Khalil and Dombre, Modeling, Identification and Control of
Robots, 2002, chapter 4); two such equations determine c and s by Cramer's rule (type 3).

A conic meets the circle in four points, on two straight lines. With S the symmetric matrix of the conic A c^2 + B c s +
C s^2 + D c + E s + F and G that of the circle, c^2 + s^2 - 1, the conic S + x G passes through the same points for
every x, and where det(S + x G) = 0 it is a pair of lines. This cubic in x has the leading coefficient -1 whatever the
conic is. Its roots are the three ways to join four points by two lines. Of them the one is taken that is farthest from
the others: where two points merge it joins these by a tangent, and two other roots coincide; so the lines are as exact
as the coefficients are, double points included (J. Richter-Gebert, Perspectives on Projective Geometry, 2011, chapter
11, has how a conic is split into lines).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from math import prod
from operator import add
from typing import Any, Generic, Protocol, Self, TypeVar

from derive.algebra.ring import Polynomial
from derive.inverse.closed.nodes import Exponents, NodeEquation, NodeFormula, NodeKind
from derive.mechanics.vectors import Scalar
from derive.robot.expression import Expression

# By this factor a coefficient may be larger than one that is zero: what is divided by it has lost three digits.
ILL = 1e9
# By these factors a radicand may be above that of a double root, or below zero, so that rounding decides about it.
DOUBLE, MISSING = 1e5, 1e2
# Where two equations are one, turned, their determinant is a square: it is zero below this part of what others are.
TURNED = 1e-12
# Where all coefficients are small their radicand counts as if it was this part of its usual size: they are rounded.
SHORT = Fraction(1, 10**10)
# Where a radicand keeps all its digits its two roots are one below this part of what it usually is.
FOLDED = Fraction(1, 10**12)
# Exponents of cosine and sine in the order in which `Field.conic` takes the coefficients.
CONIC_TERMS: tuple[Exponents, ...] = ((2, 0), (1, 1), (0, 2), (1, 0), (0, 1), (0, 0))


class Mask(Protocol):
    """Where something holds: a truth value, or an array of them."""

    def __and__(self, other: Any, /) -> Self: ...
    def __or__(self, other: Any, /) -> Self: ...
    def __invert__(self) -> Self: ...


N = TypeVar("N", bound=Scalar)  # a number, with + - * between numbers and ints
M = TypeVar("M", bound=Mask)  # where something holds


class Field(Protocol[N, M]):
    """Numbers that a graph is run over, with + - * between them and with ints, and masks with & | ~."""

    def number(self, value: Any) -> N:
        """A rational number."""

    def constant(self, expression: Expression) -> N:
        """A parameter, a root, the sine of a constant angle: what a generator stands for that is no unknown."""

    def divide(self, a: N, b: N) -> N:
        """The quotient; any number where the divisor is zero."""

    def sqrt(self, a: N) -> N:
        """The square root; any number where there is none."""

    def is_zero(self, a: N, scale: N) -> M:
        """Whether a coefficient is zero, within rounding."""

    def has_root(self, a: N, scale: N) -> M:
        """Whether a number has a square root: it is not below zero, but for rounding."""

    def merges(self, a: N, scale: N) -> M:
        """Whether the two square roots of a number cannot be told apart."""

    def select(self, mask: M, a: N, b: N) -> N:
        """The one number where a mask holds, and the other elsewhere."""

    def never(self, mask: M) -> bool:
        """Whether a mask is known to hold nowhere, so that what depends on it need not be computed."""

    def truth(self, value: bool) -> M:
        """A mask that holds everywhere or nowhere."""

    def cosine_sine(self, angle: N) -> tuple[N, N]:
        """Cosine and sine of a given joint angle."""

    def angle(self, cosine: N, sine: N) -> N:
        """The angle of a cosine and a sine, in (-pi, pi]."""

    def unit(self, cosine: N, sine: N) -> tuple[N, N]:
        """A point that lies on the unit circle but for rounding, which a small determinant makes large, moved there."""

    def conic(self, coefficients: Sequence[N]) -> Sequence[tuple[N, N, M, M, M]]:
        """The four common points of the unit circle and a conic."""

    def general(self, formula: NodeFormula, values: Mapping[str, N]) -> Sequence[tuple[tuple[tuple[N, ...], ...], M]]:
        """The values of a general node."""


@dataclass(frozen=True)
class Branch(Generic[N, M]):
    """One value of an unknown."""

    numbers: tuple[N, ...]  # cosine and sine, or the length
    exists: M  # whether it is real (over floats), or a number at all
    boundary: M  # whether another branch coincides with it
    doubt: M  # whether rounding decides about that: its radicand is all but zero


@dataclass(frozen=True)
class Solver(Generic[N, M]):
    """Solves elementary equations over one kind of numbers."""

    field: Field[N, M]  # the numbers
    evaluate: Callable[[Polynomial], N]  # the number of a coefficient
    reach: N  # the size of the arm, which the size of every coefficient is a power of

    def degenerate(self, formula: NodeFormula, factor: float = 1.0) -> M:
        """Whether a formula does not determine its unknown here."""
        first, second = formula.equations[0], formula.equations[-1]
        # Cosine and sine from an equation each: lost where either divisor is zero.
        if formula.kind is NodeKind.TYPE_3 and len(formula.degenerate) == 2:
            one, other = formula.degenerate
            return self._is_zero(one, factor, first) | self._is_zero(other, factor, second)
        # Where the second equation has the coefficients of the first, turned by a right angle, the determinant is
        # A^2 + B^2: a square, so compared with the square of the usual threshold.
        if formula.kind is NodeKind.TYPE_3 and len(formula.degenerate) == 1 and not formula.degenerate[0].is_constant:
            (p, q, _), (r, s, _) = first.linear, second.linear
            if (r == -q and s == p) or (r == q and s == -p):
                a, b, d, e = map(self.evaluate, (p, q, r, s))
                return self.field.is_zero(a * e - b * d, self._scale(first, second, factor=factor * factor * TURNED))
        # Else the unknown is lost where all leading coefficients vanish together.
        mask = self.field.truth(bool(formula.degenerate))
        for leading in formula.degenerate:
            mask = mask & self._is_zero(leading, factor, *((first,) if second is first else (first, second)))
        return mask

    def solve(self, formula: NodeFormula) -> list[Branch[N, M]]:
        """The values of the unknown, where the formula is not degenerate; any numbers elsewhere."""
        match formula.kind:
            case NodeKind.TYPE_1:
                a, b = (self.evaluate(formula.equations[0].coefficient(k)) for k in (1, 0))
                no = self.field.truth(False)
                return [Branch((self.field.divide(-b, a),), self.field.truth(True), no, no)]
            case NodeKind.QUADRATIC:
                # r = (-B +- sqrt(B^2 - 4 A C))/(2 A), without B where there is none.
                f, size = self.field, self.reach * self.reach
                a, b, c = (self.evaluate(formula.equations[0].coefficient(k)) for k in (2, 1, 0))
                if not formula.equations[0].coefficient(1):
                    return self._both(f.divide(-c, a), size, lambda e, root: (e * root,))
                return self._both(b * b - 4 * (a * c), a * a * size, lambda e, root: (f.divide(e * root - b, 2 * a),))
            case NodeKind.TYPE_2:
                return self._angles(formula.equations[0])
            case NodeKind.TYPE_3:
                f, (one, two) = self.field, formula.equations
                (a, b, c), (d, e, g) = (map(self.evaluate, equation.linear) for equation in formula.equations)
                if not one.linear[1] and not two.linear[0]:
                    cosine, sine = f.divide(c, a), f.divide(g, e)
                elif not one.linear[0] and not two.linear[1]:
                    cosine, sine = f.divide(g, d), f.divide(c, b)
                else:  # Cramer's rule
                    determinant = a * e - b * d
                    cosine, sine = f.divide(c * e - b * g, determinant), f.divide(a * g - c * d, determinant)
                no = f.truth(False)
                return [Branch(f.unit(cosine, sine), f.truth(True), no, no)]
            case NodeKind.CONIC:
                coefficients = [formula.equations[0].coefficient(*exponents) for exponents in CONIC_TERMS]
                found = self.field.conic([self.evaluate(p) for p in coefficients])
                return [Branch((c, s), exists, double, doubt) for c, s, exists, double, doubt in found]
        raise ValueError(f"no elementary type: {formula.kind}")

    def _is_zero(self, p: Polynomial, factor: float, *equations: NodeEquation) -> M:
        if p.is_constant:
            return self.field.truth(not p)
        return self.field.is_zero(self.evaluate(p), self._scale(*equations, factor=factor))

    def _scale(self, *equations: NodeEquation, factor: float = 1.0) -> N:
        """The size of the coefficients of an equation, or of the products of those of two, times a factor."""
        scale = self.field.number(prod((equation.size for equation in equations), start=Fraction(factor)))
        for _ in range(sum(equation.dimension for equation in equations)):
            scale = scale * self.reach
        return scale

    def _both(self, radicand: N, size: N, value: Callable[[int, N], tuple[N, ...]]) -> list[Branch[N, M]]:
        """The branches of a square root, the second one only where it can be told from the first."""
        f = self.field
        # Negative by rounding alone counts as zero: the pose is on the boundary, where both roots are one.
        exists, double = f.has_root(radicand, size), f.merges(radicand, size)
        root = f.select(double, f.number(0), f.sqrt(radicand))
        boundary = exists & double
        above, below = (size * f.number(Fraction(factor)) for factor in (DOUBLE, MISSING))
        # Near enough to zero for rounding to decide, from either side.
        small = f.merges(radicand, above)
        doubt = small if f.never(small) else small & f.has_root(radicand, below)
        second = exists & ~double
        return [Branch(value(1, root), exists, boundary, doubt), Branch(value(-1, root), second, boundary, doubt)]

    def _angles(self, equation: NodeEquation) -> list[Branch[N, M]]:
        f = self.field
        (has_a, has_b, has_c), (a, b, c) = map(bool, equation.linear), map(self.evaluate, equation.linear)
        if not has_c:
            square = a * a + b * b
            root = f.sqrt(square)
            # A c + B s = 0: theta = atan2(-A, B) and its opposite, without a radicand that could vanish.
            cosine, sine = f.divide(-b, root), f.divide(a, root)
            exists, no = f.has_root(square, square), f.truth(False)
            return [Branch(pair, exists, no, no) for pair in ((cosine, sine), (-cosine, -sine))]
        if not has_a or not has_b:
            # One of cosine and sine is known, the other is a root of 1 - x^2.
            known = f.divide(c, b if has_b else a)
            radicand, size = self._square_of_other(equation.linear[1 if has_b else 0], equation.linear[2], known)
            return self._both(radicand, size, lambda e, r: (e * r, known) if has_b else (known, e * r))
        square = a * a + b * b
        # Along the vector (A, B) by C, across it by +-sqrt(A^2 + B^2 - C^2).
        along = f.divide(c, square)

        def _turned(e: int, root: N) -> tuple[N, ...]:
            across = f.divide(e * root, square)
            return a * along - b * across, b * along + a * across

        usual = self._scale(equation)
        return self._both(square - c * c, square + usual * usual * f.number(SHORT), _turned)

    def _square_of_other(self, factor: Polynomial, right: Polynomial, known: N) -> tuple[N, N]:
        """1 - x^2 of x = C/B, and its size: by B - C and B + C where one of these is known to all its digits."""
        # So it is beside a folded elbow of two equal lengths, whose B + C is the square of a distance.
        f, one = self.field, self.field.number(1)
        for sign in (1, -1):
            # 1 - x^2 = (1 - x)(1 + x), and B (1 +- x) = B +- C without cancellation.
            exact = factor + sign * right
            # No digits are lost in a sum of squares, p.p included: even powers whose factors have one sign.
            terms, names = list(exact.terms()), exact.ring.names
            even = all(e % 2 == 0 or names[i] == "p.p" for exponents, _ in terms for i, e in enumerate(exponents))
            if not right.is_constant and even and len({coefficient > 0 for _, coefficient in terms}) == 1:
                near = f.divide(self.evaluate(exact), self.evaluate(factor))
                return near * (one - sign * known), near * f.number(Fraction(1, 2)) + f.number(FOLDED)
        return one - known * known, one


# -- where a conic meets the unit circle: two straight lines

Vector = tuple[N, N, N]

CUBIC_STEPS = 5  # halley's steps from at most 1.5 times the root: the error is cubed in each
POLISH_STEPS = 2  # Newton steps of a point along the circle
# Slopes of the conic along the circle below this part of its size are those of double points, which stay.
FLAT = Fraction(1, 10**7)
DOUBTFUL = (10**8, 10**5)
"""By these factors a radicand may be above that of a double point, or below zero, so that rounding may decide about it:
where four points are one it is known to a third of its digits."""

# A point whose error is more than this part of the conic's size is none: its lines are not real.
ON_CONIC = Fraction(1, 10**9)


def line_points(f: Field[N, M], coefficients: Sequence[N]) -> list[tuple[N, N, M, M, M]]:
    """The four common points of the unit circle and a conic."""
    size = f.divide(f.number(1), f.sqrt(reduce(add, [k * k for k in coefficients])))
    unit = [k * size for k in coefficients]
    points: list[tuple[N, N, M, M, M]] = []
    for a, b, d in _lines(f, unit):
        # The foot of the line from the centre, -d (a, b)/square, and half the chord to either side.
        square = a * a + b * b
        radicand = square - d * d
        exists, double = f.has_root(radicand, square), f.merges(radicand, square)
        root = f.select(double, f.number(0), f.sqrt(radicand))
        doubt = f.merges(radicand, square * f.number(DOUBTFUL[0]))
        doubt = doubt & f.has_root(radicand, square * f.number(DOUBTFUL[1]))
        for sign, real in ((1, exists), (-1, exists & ~double)):
            c, s = f.divide(-(a * d) - sign * (b * root), square), f.divide(sign * (a * root) - b * d, square)
            c, s, value = _polished(f, c, s, unit)
            near = f.number(ON_CONIC)
            points.append((c, s, real & f.merges(value * value - near * near, f.number(0)), exists & double, doubt))
    return points


def _lines(f: Field[N, M], unit: Sequence[N]) -> tuple[Vector[N], Vector[N]]:
    """The two lines a c + b s + d = 0 of the pair in the pencil that is farthest from the others."""
    # S = [[a, b, d], [b, c, e], [d, e, g]], less x times the circle's diag(1, 1, -1).
    half = f.number(Fraction(1, 2))
    a, c, g = unit[0], unit[2], unit[5]
    b, d, e = half * unit[1], half * unit[3], half * unit[4]
    third = f.number(Fraction(1, 3)) * (a + c - g)  # without a square term in the cubic
    a, c, g = a - third, c - third, g + third
    # det(S + x G) = -x^3 - linear x + determinant: second and third invariant of S about G.
    linear = a * c - b * b - a * g + d * d - c * g + e * e
    determinant = a * (c * g - e * e) - b * (b * g - d * e) + d * (b * e - c * d)
    # S + x G has rank 2: a pair of lines.
    x = _far_root(f, linear, determinant)
    a, c, g = a + x, c + x, g - x
    # the adjugate of a pair of lines is minus the square of their common point
    first = (c * g - e * e, d * e - b * g, b * e - c * d)
    second, cross, third = a * g - d * d, b * d - a * e, a * c - b * b
    adjugate: tuple[Vector[N], ...] = (first, (first[1], second, cross), (first[2], cross, third))
    # The longest column of the adjugate, divided by its root: the lines' common point (u, v, w).
    place, row = -adjugate[0][0], adjugate[0]
    for i in (1, 2):
        less = f.merges(place + adjugate[i][i], f.number(0))
        place = f.select(less, -adjugate[i][i], place)
        row = tuple(f.select(less, new, old) for new, old in zip(adjugate[i], row, strict=True))  # type: ignore[assignment]
    root = f.sqrt(place)
    known = f.merges(place, f.number(0))
    u, v, w = (f.select(known, f.number(0), f.divide(-k, root)) for k in row)
    # S + x G plus the cross matrix of that point has rank 1: rows and columns are the two lines (Richter-Gebert, 11).
    product = ((a, b - w, d + v), (b + w, c, e - u), (d - v, e + u, g))
    return _largest(f, product), _largest(f, tuple(zip(*product, strict=True)))


def _largest(f: Field[N, M], rows: Sequence[Vector[N]]) -> Vector[N]:
    """Of multiples of one vector the longest."""
    best, size = rows[0], reduce(add, [k * k for k in rows[0]])
    for row in rows[1:]:
        own = reduce(add, [k * k for k in row])
        longer = f.merges(size - own, f.number(0))
        best = tuple(f.select(longer, new, old) for new, old in zip(row, best, strict=True))  # type: ignore[assignment]
        size = f.select(longer, own, size)
    return best


def _far_root(f: Field[N, M], linear: N, constant: N) -> N:
    """The real root of x^3 + linear x = constant farthest from the others, which has the sign of the constant."""
    # Halley's method from above, where the cubic is convex. The start is sqrt(-linear) + constant^(1/3), and the
    # exponent 1/3 is nearly 1/4 + 1/16 + 1/64 + 1/256.
    negative = f.merges(constant, f.number(0))
    size = f.select(negative, -constant, constant)
    # size^(1/4 + 1/16 + 1/64 + 1/256) by square roots, nearly the cubic root.
    x, power = f.number(1), size
    for _ in range(4):
        power = f.sqrt(f.sqrt(power))
        x = x * power
    x = x + f.sqrt(-linear)
    for _ in range(CUBIC_STEPS):
        square = x * x
        # Halley: x - f f'/(f'^2 - f f''/2) with f'' = 6 x.
        value, slope = x * (square + linear) - size, 3 * square + linear
        bottom = slope * slope - 3 * (x * value)
        still = f.merges(bottom, f.number(0))
        x = x - f.select(still, f.number(0), f.divide(value * slope, bottom))
    return f.select(negative, -x, x)


def _polished(f: Field[N, M], cosine: N, sine: N, unit: Sequence[N]) -> tuple[N, N, N]:
    """A point after Newton steps along the circle, and the conic's value there."""
    flat = f.number(FLAT * FLAT)
    for _ in range(POLISH_STEPS):
        value = _value(cosine, sine, unit)
        cc, cs, ss, c, s, _ = unit
        by_cosine, by_sine = 2 * (cc * cosine) + cs * sine + c, cs * cosine + 2 * (ss * sine) + s
        # Derivative along the circle; damped, so that double points, where it vanishes, stay.
        slope = by_sine * cosine - by_cosine * sine
        step = f.divide(value * slope, slope * slope + flat)
        cosine, sine = f.unit(cosine + step * sine, sine - step * cosine)
    return cosine, sine, _value(cosine, sine, unit)


def _value(cosine: N, sine: N, unit: Sequence[N]) -> N:
    cc, cs, ss, c, s, one = unit
    return cosine * (cc * cosine + cs * sine + c) + sine * (ss * sine + s) + one
