"""The numbers over which a graph of solutions is run: floats, complex numbers, integers modulo a prime."""

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from derive.algebra.residues import Residue, ResidueDomain, power
from derive.inverse.closed.elementary_solver import line_points
from derive.inverse.closed.nodes import NodeFormula
from derive.robot.evaluate import to_float
from derive.robot.expression import Expression, substitute

Floats = Any  # an array of floats (or complex numbers), one entry per pose, or one number
Masks = Any  # an array of truth values, one entry per pose, or one
ZERO = 1e-12  # a coefficient below this part of its usual size does not determine an angle: its digits are rounding
BEYOND = 1e-11  # a radicand may be below zero by this part of its size: the pose is on the boundary of what is reached
MERGED = 1e-14  # below this part of its size the two roots of a radicand are one


class _ArrayMasks:
    """What fields of arrays have in common: masks of one truth value per pose."""

    truth: Callable[[bool], Masks] = np.bool_

    def never(self, mask: Masks) -> bool:
        return not np.any(mask)


class FloatField(_ArrayMasks):
    """Real numbers: arrays of floats, one entry per pose."""

    def __init__(self, values: Mapping[str, Fraction | float]) -> None:
        self.values = values

    number: Callable[[int | Fraction], Floats] = np.float64
    select = staticmethod(np.where)

    def constant(self, expression: Expression) -> Floats:
        """The number of a parameter or constant."""
        return np.float64(to_float(expression, self.values))

    def divide(self, a: Floats, b: Floats) -> Floats:
        """The quotient; the dividend where the divisor is zero."""
        return a / np.where(b == 0, 1.0, b)

    def sqrt(self, a: Floats) -> Floats:
        """The square root; 0 of negative numbers."""
        return np.sqrt(np.maximum(a, 0.0))

    def is_zero(self, a: Floats, scale: Floats) -> Masks:
        """Whether a coefficient is zero within rounding."""
        return np.abs(a) <= ZERO * np.abs(scale)

    def has_root(self, a: Floats, scale: Floats) -> Masks:
        """Whether a number is not below zero, but for rounding."""
        return a >= -BEYOND * np.abs(scale)

    def merges(self, a: Floats, scale: Floats) -> Masks:
        """Whether the two roots of a number are one within rounding."""
        return a <= MERGED * np.abs(scale)

    def cosine_sine(self, angle: Floats) -> tuple[Floats, Floats]:
        """Cosine and sine of a given joint angle."""
        return np.cos(angle), np.sin(angle)

    def angle(self, cosine: Floats, sine: Floats) -> Floats:
        """The angle of a cosine and a sine."""
        return np.arctan2(sine, cosine)

    def unit(self, cosine: Floats, sine: Floats) -> tuple[Floats, Floats]:
        """A point that lies on the unit circle but for rounding, moved there by a Newton step for 1/sqrt(c^2 + s^2)."""
        scale = 1.5 - 0.5 * (cosine * cosine + sine * sine)
        return cosine * scale, sine * scale

    def conic(self, coefficients: Sequence[Floats]) -> Sequence[tuple[Floats, Floats, Masks, Masks, Masks]]:
        """The common points of the unit circle and a conic."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return line_points(self, coefficients)

    def general(self, formula: NodeFormula, values: Mapping[str, Floats]) -> Sequence[Any]:
        """The values of a general node: its payload solves it."""
        found: Sequence[Any] = formula.payload.solve(self, values)
        return found


class ComplexField(FloatField):
    """Complex numbers, in which every branch exists; for counting solutions."""

    number = np.complex128

    def sqrt(self, a: Floats) -> Floats:
        """One of the two square roots."""
        return np.sqrt(np.asarray(a, dtype=np.complex128))

    def has_root(self, a: Floats, scale: Floats) -> Masks:
        """Every number has one."""
        return np.ones_like(a, dtype=bool)

    def merges(self, a: Floats, scale: Floats) -> Masks:
        """At generic poses the two roots differ."""
        return np.zeros_like(a, dtype=bool)

    def conic(self, coefficients: Sequence[Floats]) -> Sequence[tuple[Floats, Floats, Masks, Masks, Masks]]:
        """The common points of the circle c^2 + s^2 = 1 and a conic: a quartic in z = c + i s."""
        cc, cs, ss, c, s, one = np.broadcast_arrays(*coefficients)
        # c = (z + 1/z)/2, s = (z - 1/z)/(2 i), times 4 z^2: coefficients of z^4 to z^0.
        quartic = [cc - ss - 1j * cs, 2 * (c - 1j * s), 2 * (cc + ss) + 4 * one, 2 * (c + 1j * s), cc - ss + 1j * cs]
        rows, no = np.stack(quartic, axis=-1).reshape(-1, 5), np.bool_(False)
        roots = np.zeros((len(rows), 4), dtype=np.complex128)  # fewer where the first coefficients vanish
        for k, own in enumerate(map(np.roots, rows)):
            roots[k, : len(own)] = own
        points = [(z != 0, np.where(z == 0, 1, z)) for z in roots.reshape(*cc.shape, 4).T]
        return [((z + 1 / z) / 2, (z - 1 / z) / 2j, exists, no, no) for exists, z in points]


class PrimeField(_ArrayMasks):
    """Integers modulo a prime, arrays with one entry per pose; a branch exists where its square root does."""

    def __init__(self, residues: ResidueDomain, numbers: Mapping[str, Expression]) -> None:
        self.residues, self.numbers = residues, numbers
        self.prime, self.number = residues.prime, residues.number  # a rational modulo the prime

    def constant(self, expression: Expression) -> Residue:
        """The residue of a parameter or constant."""
        return self.residues.constant(substitute(expression, self.numbers))

    def divide(self, a: Residue, b: Residue) -> Residue:
        """The quotient; 0 where the divisor is zero."""
        return a * self._power(b, self.prime - 2)

    def sqrt(self, a: Residue) -> Residue:
        """The square root modulo a prime 4k + 3; any number where there is none."""
        return self._power(a, (self.prime + 1) // 4)

    def is_zero(self, a: Residue, scale: Residue) -> Masks:
        """Whether a number is zero."""
        return a.values == 0

    def has_root(self, a: Residue, scale: Residue) -> Masks:
        """Whether a number is a square."""
        root = self.sqrt(a)
        return (root * root).values == a.values

    merges = is_zero  # whether the two roots are one

    def select(self, mask: Masks, a: Residue, b: Residue) -> Residue:
        """The one number where a mask holds, the other elsewhere."""
        return Residue(self.prime, np.where(mask, a.values, b.values))

    def cosine_sine(self, angle: Residue) -> tuple[Residue, Residue]:
        """A point of the unit circle, with the number as tangent of half the angle."""
        # Modulo a prime angles have no sine: (1 - t^2, 2 t)/(1 + t^2) runs through the circle's points instead.
        square = angle * angle
        scale = self._power(1 + square, self.prime - 2)
        return (1 - square) * scale, 2 * angle * scale

    def angle(self, cosine: Residue, sine: Residue) -> Residue:
        """The tangent of half the angle, which stands for it."""
        return self.divide(sine, 1 + cosine)

    def unit(self, cosine: Residue, sine: Residue) -> tuple[Residue, Residue]:
        """Cosine and sine as they are: nothing is rounded."""
        return cosine, sine

    def conic(self, *_: Any, **__: Any) -> Sequence[Any]:
        """Not needed: graphs with quartics are counted over the complex numbers, general nodes by themselves."""
        raise NotImplementedError

    general = conic

    def _power(self, base: Residue, exponent: int) -> Residue:
        return Residue(self.prime, power(base.values, exponent, self.prime))
