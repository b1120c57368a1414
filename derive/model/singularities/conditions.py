"""The zeros of a factor of det J: q2 = 0 or pi where they can be read off, and what the posture is called."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factors import Factor
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial
from derive.lecture.to_sympy import Expr, expression_to_sympy

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


def moving_joints(domain: PolynomialDomain, p: Polynomial) -> tuple[int, ...]:
    """The joints whose variables change a polynomial.

    Args:
        domain: Its domain.
        p: The polynomial.

    Returns:
        Their numbers, from 0.
    """
    return tuple(i for i in range(domain.robot.n) if domain.derivative(p, i))


def zero_condition(
    domain: PolynomialDomain, factor: Factor, expression: Expr, write: Write, has_wrist: bool
) -> Condition | None:
    """Where a factor of the determinant is zero.

    Args:
        domain: Its domain.
        factor: The factor.
        expression: The same as it is printed.
        write: Writes a polynomial.
        has_wrist: Whether the determinant is that of an arm with a spherical wrist.

    Returns:
        The condition; None if the factor does not move.
    """
    joints = moving_joints(domain, factor.value)
    if not joints:
        return None
    variable: Expr | None = None
    values: tuple[Expr, ...] = ()
    if factor.kind is not None:  # a sine or cosine alone
        variable = expression_to_sympy(domain.angle_sum(factor.joints))
        values = (sympy.S.Zero, sympy.pi) if factor.kind is Kind.SINE else (-sympy.pi / 2, sympy.pi / 2)
    elif len(joints) == 1:
        joint = domain.robot.joints[joints[0]]
        values = (_angles if joint.is_revolute else _offset)(domain, factor.value, joints[0], write)
        variable = sympy.Symbol(joint.variable) if values else None
    return Condition(expression, variable, values, _posture(domain, joints, has_wrist), tuple(j + 1 for j in joints))


def _offset(domain: PolynomialDomain, p: Polynomial, joint: int, write: Write) -> tuple[Expr, ...]:
    """q of k*q + rest = 0 where k is a number."""
    by_q = domain.derivative(p, joint)
    if not by_q.is_constant:
        return ()
    rest = p - by_q * domain.ring.generator(domain.robot.joints[joint].variable)
    return (write(rest * (-1 / by_q.constant_term)),)


def _angles(domain: PolynomialDomain, p: Polynomial, joint: int, write: Write) -> tuple[Expr, ...]:
    """Both angles of a*c + b*s = 0, the arc tangents of -a/b."""
    c, s = domain.cosine_sine_of(joint)
    slope = domain.derivative(p, joint)
    a, b = p * c - slope * s, p * s + slope * c
    if moving_joints(domain, a) or moving_joints(domain, b):
        return ()
    return (sympy.atan2(write(-a), write(b)), sympy.atan2(write(a), write(-b)))


def _posture(domain: PolynomialDomain, joints: tuple[int, ...], has_wrist: bool) -> Posture | None:
    robot = domain.robot
    if has_wrist and joints == (4,):
        return Posture.WRIST
    articulated = all(joint.is_revolute for joint in robot.joints[:3]) and (has_wrist or robot.n == 3)
    elbow = any({1, 2} <= set(group) and 0 not in group for group in domain.groups)
    if not (articulated and elbow):
        return None
    return {(2,): Posture.ELBOW, (1, 2): Posture.SHOULDER}.get(joints)
