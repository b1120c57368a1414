"""Rational factors of a determinant moved where a reader expects them: 0.43*c2 + 0.41*s23, not 43*c2 + 41*s23."""

from __future__ import annotations

from fractions import Fraction
from math import gcd, lcm

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial
from derive.algebra.trigonometric_factors import Factor
from derive.robot.expression import Number
from derive.robot.robot import Robot


class Lengths:
    """The numeric lengths of a robot, which the coefficients of a factor should be.

    Args:
        robot: The robot.
        domain: The domain of its polynomials.
    """

    def __init__(self, robot: Robot, domain: PolynomialDomain) -> None:
        self._domain = domain
        cells = [cell for joint in robot.joints for cell in (joint.a, joint.d)]
        cells += [row[3] for row in robot.tool[:3]]
        self._numbers = sorted({abs(cell.value) for cell in cells if isinstance(cell, Number) and cell.value})

    def scaled(self, factor: Factor) -> tuple[Polynomial, Factor]:
        """A rational power and a factor whose product is the one given.

        The coefficients of a sum become lengths of the robot if one number makes all of them so, else whole numbers
        without a common divisor; most of them positive.
        """
        ring, p = self._domain.ring, factor.value
        if factor.kind is not None:
            return ring.one, factor
        if p.is_constant:
            return p**factor.exponent, Factor(ring.one, 1)
        coefficients = [c for _, c in p.terms()]
        positive = sum(1 if c > 0 else -1 for c in coefficients) or coefficients[0]
        scale = self._scale([abs(c) for c in coefficients]) * (1 if positive > 0 else -1)
        return ring.number(Fraction(1) / scale) ** factor.exponent, Factor(p * scale, factor.exponent)

    def _scale(self, coefficients: list[Fraction]) -> Fraction:
        if len(coefficients) == 1:
            return 1 / coefficients[0]
        known = set(self._numbers)
        for length in self._numbers:
            scale = length / coefficients[0]
            if all(scale * c in known for c in coefficients):
                return scale
        return Fraction(lcm(*(c.denominator for c in coefficients)), gcd(*(c.numerator for c in coefficients)))
