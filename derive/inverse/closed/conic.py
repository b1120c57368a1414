"""Where a conic meets the unit circle: two straight lines, by square roots alone.

With S the symmetric matrix of the conic A c^2 + B c s + C s^2 + D c + E s + F and G that of the circle, c^2 + s^2 - 1,
the conic S + x G passes through the same points for every x, and where det(S + x G) = 0 it is a pair of lines. This
cubic in x has the leading coefficient -1 whatever the conic is. Its roots are the three ways to join four points by two
lines. Of them the one is taken that is farthest from the others: where two points merge it joins these by a tangent,
and two other roots coincide; so the lines are as exact as the coefficients are, double points included (J.
Richter-Gebert, Perspectives on Projective Geometry, 2011, chapter 11, has how a conic is split into lines).
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from operator import add

from derive.inverse.closed.elementary_solver import Field, M, N

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
    adjugate: tuple[Vector[N], Vector[N], Vector[N]] = (
        (c * g - e * e, d * e - b * g, b * e - c * d),
        (d * e - b * g, a * g - d * d, b * d - a * e),
        (b * e - c * d, b * d - a * e, a * c - b * b),
    )
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
    """The real root of x^3 + linear x = constant that is farthest from the others, which has the sign of the constant.

    Halley's method from above, where the cubic is convex. The start is sqrt(-linear) + constant^(1/3), and the exponent
    1/3 is nearly 1/4 + 1/16 + 1/64 + 1/256.
    """
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
