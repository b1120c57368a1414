"""One unknown out of two: two equations squared and added, as Pieper does, or one divided by the other.

Of two equations in which an angle with cosine c and sine s occurs to the first degree,

    A c + B s = C,   D c + E s = F,

the angle drops out: Cramer's rule gives c and s, whose squares add to 1,

    (C E - B F)^2 + (A F - C D)^2 = (A E - B D)^2.

Where D and E are -B and A but for constants, D = -k B, E = k A, this is k^2 C^2 + F^2 = k^2 (A^2 + B^2): the equations
are squared and added. With A, B, C, F of the first degree in the cosine and sine of another angle that is a quartic for
it (Pieper, The Kinematics of Manipulators under Computer Control, 1968). A slide drops out of two equations of the
first degree in it.
"""

from __future__ import annotations

from derive.algebra.ring import Polynomial, Ring


def without_angle(ring: Ring, generators: tuple[str, ...], p: Polynomial, q: Polynomial) -> Polynomial | None:
    """What follows from two equations when an angle is eliminated; None where one is not of the first degree in it."""
    places = [ring.index[name] for name in generators]
    first, second = (ring.coefficients(each, places) for each in (p, q))
    if not {*first, *second} <= {(1, 0), (0, 1), (0, 0)}:
        return None
    a, b, c = (first.get(e, ring.zero) for e in ((1, 0), (0, 1), (0, 0)))
    d, e, f = (second.get(x, ring.zero) for x in ((1, 0), (0, 1), (0, 0)))
    ratio = _common_ratio(ring, (a, e), (b, -d))
    if ratio is not None:
        m, n = ratio  # m * (d, e) = n * (-b, a): squared and added
        return n * n * (c * c) + m * m * (f * f) - n * n * (a * a + b * b)
    determinant, across, along = a * e - b * d, b * f - c * e, c * d - a * f
    return across * across + along * along - determinant * determinant


def without_length(ring: Ring, generator: str, p: Polynomial, q: Polynomial) -> Polynomial | None:
    """What follows from two equations when a slide is eliminated; None where one is not of the first degree in it."""
    place = [ring.index[generator]]
    first, second = (ring.coefficients(each, place) for each in (p, q))
    if not {*first, *second} <= {(1,), (0,)}:
        return None
    (a, b), (c, d) = ((each.get((1,), ring.zero), each.get((0,), ring.zero)) for each in (first, second))
    if not a or not c:
        return None
    common = ring.wrap(a.raw.gcd(c.raw))
    return _quotient(c, common) * b - _quotient(a, common) * d


def _common_ratio(
    ring: Ring, one: tuple[Polynomial, Polynomial], other: tuple[Polynomial, Polynomial]
) -> tuple[Polynomial, Polynomial] | None:
    """(m, n) with m*y = n*x for both pairs (x, y); None where they are not proportional."""
    x, y = next((pair for pair in (one, other) if pair[0] and pair[1]), (ring.zero, ring.zero))
    if not x:
        return None
    common = ring.wrap(x.raw.gcd(y.raw))
    m, n = _quotient(x, common), _quotient(y, common)
    return (m, n) if all(m * v == n * u for u, v in (one, other)) else None


def _quotient(p: Polynomial, divisor: Polynomial) -> Polynomial:
    return p.ring.wrap(divmod(p.raw, divisor.raw)[0])
