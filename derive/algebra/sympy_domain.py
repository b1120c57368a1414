"""SymPy expressions as scalars: for kinematics that is nested instead of expanded."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.lecture_form import LectureForm
from derive.robot.expression import Expression
from derive.robot.robot import Joint

Expr = Any


class SymPyDomain:
    """A `derive.mechanics.chain.Domain` whose scalars are SymPy expressions.

    Args:
        domain: A polynomial domain in which every angle is a generator by itself; leaves are written from it.
    """

    def __init__(self, domain: PolynomialDomain) -> None:
        self.domain = domain
        self.form = LectureForm(domain)

    def number(self, value: int | Fraction) -> Expr:
        """A rational."""
        return sympy.Rational(Fraction(value).numerator, Fraction(value).denominator)

    def constant(self, expression: Expression) -> Expr:
        """A cell without joint variables."""
        return self.form.kinematic(self.domain.constant(expression))

    def cosine_sine(self, angle: Expression) -> tuple[Expr, Expr]:
        """Cosine and sine of a constant angle."""
        c, s = self.domain.cosine_sine(angle)
        return self.form.kinematic(c), self.form.kinematic(s)

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[Expr, Expr]:
        """Cosine and sine of ``sign*q + theta``."""
        c, s = self.domain.joint_cosine_sine(index, joint)
        return self.form.kinematic(c), self.form.kinematic(s)

    def joint_offset(self, index: int, joint: Joint) -> Expr:
        """``sign*q + d``."""
        return self.form.kinematic(self.domain.joint_offset(index, joint))
