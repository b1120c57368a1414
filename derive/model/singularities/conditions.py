"""Where a factor is zero: an equation, its solutions where they can be read off, and the name of the posture."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factors import Factor
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial
from derive.lecture.sympy_conversion import Expr, expression_to_sympy
from derive.model.singularities.real_zeros import RealZeros

Write = Callable[[Polynomial], Expr]


class Posture(StrEnum):
    """What a singular posture is called (Siciliano et al., Robotics, sec. 3.3.2 and 3.3.3)."""

    WRIST = "wrist"  # axes 4 and 6 are aligned
    ELBOW = "elbow"  # the arm is stretched out or folded: the wrist centre lies in the plane of axes 2 and 3
    SHOULDER = "shoulder"  # the wrist centre lies on axis 1, or in the plane through it that is parallel to axis 2


@dataclass(frozen=True)
class Condition:
    """Where one factor is zero."""

    expression: Expr  # the factor
    variable: Expr | None  # the joint variable, or the sum of angles, that can be solved for; None if none can
    values: tuple[Expr, ...]  # what it is there, angles in (-pi, pi]; empty if nothing can be solved
    posture: Posture | None  # what the arm looks like, where that is certain
    joints: tuple[int, ...]  # the joints (from 1) whose variables it holds
    is_certain: bool = True  # whether it is known that it can be zero, whatever the parameters are

    @property
    def is_solution(self) -> bool:
        """Whether it is the variable less its one value, printed ``q2 = pi``; not ``q3``, which is zero itself."""
        return len(self.values) == 1 and bool(self.expression == self.variable - self.values[0] != self.variable)


def zero_condition(
    zeros: RealZeros, factor: Factor, expression: Expr, write: Write, *, is_position: bool, has_wrist: bool
) -> Condition | None:
    """Where a factor of the determinant is zero; None if it does not move, or is never zero."""
    joints, domain = zeros.moving(factor.value), zeros.domain
    exists = bool(joints) and zeros.exist([factor.value])
    if exists is False:
        return None
    variable: Expr | None = None
    values: tuple[Expr, ...] = ()
    if factor.kind is not None:  # a sine or cosine alone
        variable = expression_to_sympy(domain.angle_sum(factor.joints))
        angles = (sympy.S.Zero, sympy.pi) if factor.kind is Kind.SINE else (-sympy.pi / 2, sympy.pi / 2)
        offset = expression_to_sympy(domain.offset_sum(factor.joints))
        values = tuple(_in_one_turn(angle - offset) for angle in angles)
    elif len(joints) == 1:
        values = _solved(domain, factor.value, joints[0], write)
        variable = sympy.Symbol(domain.robot.joints[joints[0]].variable) if values else None
    robot, posture = domain.robot, None
    articulated = all(joint.is_revolute for joint in robot.joints[:3]) and (has_wrist or is_position)
    elbow = any({1, 2} <= set(group) and 0 not in group for group in domain.groups)
    if has_wrist and joints == (4,):
        posture = Posture.WRIST
    elif articulated and elbow:
        posture = {(2,): Posture.ELBOW, (1, 2): Posture.SHOULDER}.get(joints)
    certain = exists is True or bool(values)
    return Condition(expression, variable, values, posture, tuple(j + 1 for j in joints), certain)


def _in_one_turn(angle: Expr) -> Expr:
    """An angle with its multiple of pi in (-1, 1]."""
    turns = sympy.ceiling((angle.coeff(sympy.pi) - 1) / 2)
    return angle - 2 * turns * sympy.pi


def _solved(domain: PolynomialDomain, p: Polynomial, joint: int, write: Write) -> tuple[Expr, ...]:
    """q of k*q + rest = 0 where k is a number; both angles of a*c + b*s = 0, the arc tangents of -a/b."""
    slope = domain.derivative(p, joint)
    if not domain.robot.joints[joint].is_revolute:
        if not slope.is_constant:
            return ()
        rest = p - slope * domain.ring.generator(domain.robot.joints[joint].variable)
        return (write(rest * (-1 / slope.constant_term)),)
    # p = a c + b s + rest and dp/dq = b c - a s give a and b; both must be free of joint variables.
    c, s = domain.cosine_sine_of(joint, offset=True)
    offset = expression_to_sympy(domain.offsets[joint])
    a, b = p * c - slope * s, p * s + slope * c
    if any(domain.derivative(p, j) for p in (a, b) for j in range(domain.robot.n)):
        return ()
    ways = (sympy.atan2(write(-a), write(b)), sympy.atan2(write(a), write(-b)))
    return tuple(_in_one_turn(way - offset) for way in ways)
