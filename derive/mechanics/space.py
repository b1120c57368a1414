"""Points, lines and frames in balls of 256 bits, which enclose the truth and tell zero from almost zero.

Whoever computes with them does so inside `exactly`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from math import floor, log10
from typing import Any

from flint import arb, ctx, fmpq

from derive.mechanics.vectors import cross, dot

BITS = 256  # of a number
Real = Any  # a ball: a number and a bound of its error (flint.arb)
Point = tuple[Real, Real, Real]  # a point or a vector in space
DIGITS = 17  # of a number that is none of a few digits
NOTHING = 1e-40  # what is smaller is zero: so many digits are lost nowhere


@contextmanager
def exactly(steps: int = 0) -> Iterator[None]:
    """Balls of `BITS` bits, and of one more for each frame in another: a turn makes balls up to sqrt(3) times wider."""
    before, ctx.prec = ctx.prec, BITS + steps
    try:
        yield
    finally:
        ctx.prec = before


def real(value: Fraction | int) -> Real:
    """A rational number."""
    return arb(fmpq(value.numerator, value.denominator))


def decimal(value: Real, digits: int = DIGITS) -> Fraction:
    """The nearest number of some digits; zero where there is nothing."""
    if not abs(value) > NOTHING:
        return Fraction(0)
    mantissa, exponent = value.mid().man_exp()
    exact = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    places = digits - 1 - floor(log10(abs(exact)))
    return Fraction(round(exact * 10**places), 1) / Fraction(10) ** places


def cosine_sine(angle: Real) -> tuple[Real, Real]:
    """Cosine and sine, exact at multiples of pi/2."""
    quarters = angle * 2 / arb.pi()
    whole = round(float(quarters))
    if abs(quarters - whole) < NOTHING:
        zero, one = arb(0), arb(1)
        return ((one, zero), (zero, one), (-one, zero), (zero, -one))[whole % 4]
    return angle.cos(), angle.sin()


def vector(values: Sequence[Fraction | int]) -> Point:
    """Three rational numbers."""
    x, y, z = map(real, values)
    return (x, y, z)


def plus(a: Point, b: Point, scale: Real = 1) -> Point:
    """Sum a + scale b."""
    return (a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2])


def times(a: Point, scale: Real) -> Point:
    """Multiple scale a."""
    return (a[0] * scale, a[1] * scale, a[2] * scale)


def length(a: Point) -> Real:
    """Length |a|."""
    square = dot(a, a)
    return square.sqrt() if square > 0 else arb(0, square.abs_upper().sqrt())


def unit(a: Point) -> Point:
    """Direction a/|a|."""
    return times(a, 1 / length(a))


@dataclass(frozen=True, slots=True)
class Frame:
    """A right-handed frame, in the world's coordinates."""

    origin: Point  # where it is
    x: Point  # its first axis
    y: Point  # its second axis
    z: Point  # its third axis

    @classmethod
    def of(cls, origin: Point, x: Point, z: Point) -> Frame:
        """A frame by its first and third axis, which are perpendicular."""
        return cls(origin, x, cross(z, x), z)

    def point(self, local: Point) -> Point:
        """A point of this frame in the world."""
        return plus(self.origin, self.direction(local))

    def direction(self, local: Point) -> Point:
        """A vector of this frame in the world."""
        return plus(plus(times(self.x, local[0]), self.y, local[1]), self.z, local[2])

    def inside(self, point: Point) -> Point:
        """A point of the world in this frame."""
        return self.turned(plus(point, self.origin, -1))

    def turned(self, direction: Point) -> Point:
        """A vector of the world in this frame."""
        return (dot(self.x, direction), dot(self.y, direction), dot(self.z, direction))

    def then(self, other: Frame) -> Frame:
        """The world coordinates of a frame that is given in this one."""
        return Frame(self.point(other.origin), *(self.direction(axis) for axis in (other.x, other.y, other.z)))

    def seen_from(self, other: Frame) -> Frame:
        """This frame in another one."""
        return Frame(other.inside(self.origin), *(other.turned(axis) for axis in (self.x, self.y, self.z)))


WORLD = Frame(vector((0, 0, 0)), vector((1, 0, 0)), vector((0, 1, 0)), vector((0, 0, 1)))


@dataclass(frozen=True, slots=True)
class Line:
    """A line in space."""

    point: Point  # one of its points
    direction: Point  # unit vector

    def foot(self, point: Point) -> Point:
        """The point of the line that is nearest to a point."""
        return plus(self.point, self.direction, dot(plus(point, self.point, -1), self.direction))

    def distance(self, point: Point) -> Real:
        """Of a point from the line."""
        return length(plus(point, self.foot(point), -1))

    def nearest(self, other: Line) -> Point:
        """The point of this line that is nearest to a line that is not parallel."""
        across = cross(other.direction, cross(self.direction, other.direction))
        away = plus(other.point, self.point, -1)
        return plus(self.point, self.direction, dot(away, across) / dot(self.direction, across))
