"""The zeros of a factor of det J: q2 = 0 or pi where they can be read off, and what the posture is called."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factors import Factor
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial
from derive.lecture.to_sympy import expression_to_sympy

Expr = Any
Write = Callable[[Polynomial], Expr]


class Posture(StrEnum):
    """What a singular posture is called (Siciliano et al., Robotics, sec. 3.3.2 and 3.3.3).

    Attributes:
        WRIST: Axes 4 and 6 are aligned.
        ELBOW: The arm is stretched out or folded: the wrist centre lies in the plane of axes 2 and 3.
        SHOULDER: The wrist centre lies on axis 1, or in the plane through it that is parallel to axis 2.
    """

    WRIST = "wrist"
    ELBOW = "elbow"
    SHOULDER = "shoulder"


@dataclass(frozen=True)
class Condition:
    """Where one factor is zero.

    Attributes:
        expression: The factor.
        variable: The joint variable, or the sum of angles, that can be solved for; None if none can.
        values: What it is there, angles in (-pi, pi]; empty if nothing can be solved.
        posture: What the arm looks like, where that is certain.
        joints: The joints (from 1) whose variables it holds.
    """

    expression: Expr
    variable: Expr | None
    values: tuple[Expr, ...]
    posture: Posture | None
    joints: tuple[int, ...]


@dataclass(frozen=True)
class Solver:
    """Solves the factors of one domain.

    Args:
        domain: The domain.
    """

    domain: PolynomialDomain

    def moving(self, p: Polynomial) -> tuple[int, ...]:
        """The joints (from 0) whose variables change the value."""
        return tuple(i for i in range(self.domain.robot.n) if self.domain.derivative(p, i))

    def condition(self, factor: Factor, expression: Expr, write: Write, has_wrist: bool) -> Condition | None:
        """Where the factor is zero; None if it does not move.

        Args:
            factor: The factor.
            expression: The same as it is printed.
            write: Writes a polynomial.
            has_wrist: Whether the determinant is that of an arm with a spherical wrist.
        """
        joints = self.moving(factor.value)
        if not joints:
            return None
        variable, values = self._solved(factor, joints, write)
        posture = self._posture(joints, has_wrist)
        return Condition(expression, variable, values, posture, tuple(j + 1 for j in joints))

    def _solved(self, factor: Factor, joints: tuple[int, ...], write: Write) -> tuple[Expr | None, tuple[Expr, ...]]:
        pi = sympy.pi
        if factor.kind is not None:
            values = (sympy.S.Zero, pi) if factor.kind is Kind.SINE else (-pi / 2, pi / 2)
            return expression_to_sympy(self.domain.angle_sum(factor.joints)), values
        if len(joints) != 1:
            return None, ()
        symbol = sympy.Symbol(self.domain.robot.joints[joints[0]].variable)
        revolute = self.domain.robot.joints[joints[0]].is_revolute
        values = (self._angle if revolute else self._offset)(factor.value, joints[0], write)
        return (symbol, values) if values else (None, ())

    def _offset(self, p: Polynomial, joint: int, write: Write) -> tuple[Expr, ...]:
        """q of k*q + rest = 0 where k is a number."""
        by_q = self.domain.derivative(p, joint)
        if not by_q.is_constant:
            return ()
        rest = p - by_q * self.domain.ring.generator(self.domain.robot.joints[joint].variable)
        return (write(rest * (-1 / by_q.constant_term)),)

    def _angle(self, p: Polynomial, joint: int, write: Write) -> tuple[Expr, ...]:
        """Both angles of a*c + b*s = 0, the arc tangents of -a/b."""
        c, s = self.domain.cosine_sine_of(joint)
        slope = self.domain.derivative(p, joint)
        a, b = p * c - slope * s, p * s + slope * c
        if self.moving(a) or self.moving(b):
            return ()
        return (sympy.atan2(write(-a), write(b)), sympy.atan2(write(a), write(-b)))

    def _posture(self, joints: tuple[int, ...], has_wrist: bool) -> Posture | None:
        robot = self.domain.robot
        if has_wrist and joints == (4,):
            return Posture.WRIST
        articulated = all(joint.is_revolute for joint in robot.joints[:3]) and (has_wrist or robot.n == 3)
        elbow = any({1, 2} <= set(group) and 0 not in group for group in self.domain.groups)
        if not (articulated and elbow):
            return None
        return {(2,): Posture.ELBOW, (1, 2): Posture.SHOULDER}.get(joints)
