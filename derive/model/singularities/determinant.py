"""Where the Jacobian of an arm loses rank: the determinant of a square block, its factors and their zeros.

Everything is exact: the factors multiply to the determinant as polynomials modulo s^2 + c^2 = 1. Their rational factors
are moved where a reader expects them: 0.43*c2 + 0.41*s23, not 43*c2 + 41*s23. Where a zero can be read off a factor,
q2 = 0 or pi, it is, and the posture gets its name.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from math import gcd, lcm

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factors import Factor, Factoring
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.lecture.form import LectureForm
from derive.lecture.sympy_conversion import Expr, Matrix, expression_to_sympy
from derive.model.kinematics import Kinematics, Reference
from derive.model.matrices import aligned_latex
from derive.model.singularities.blocks import square_blocks
from derive.robot.expression import Number
from derive.robot.robot import Robot
from derive.robot.style import Style

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
        zeros = (sympy.S.Zero, sympy.pi) if factor.kind is Kind.SINE else (-sympy.pi / 2, sympy.pi / 2)
        offset = expression_to_sympy(domain.offset_sum(factor.joints))
        values = tuple(_in_one_turn(zero - offset) for zero in zeros)
    elif len(joints) == 1:
        values = _solved(domain, factor.value, joints[0], write)
        variable = sympy.Symbol(domain.robot.joints[joints[0]].variable) if values else None
    robot, posture = domain.robot, None
    articulated = all(joint.is_revolute for joint in robot.joints[:3]) and (has_wrist or robot.n == 3)
    elbow = any({1, 2} <= set(group) and 0 not in group for group in domain.groups)
    if has_wrist and joints == (4,):
        posture = Posture.WRIST
    elif articulated and elbow:
        posture = {(2,): Posture.ELBOW, (1, 2): Posture.SHOULDER}.get(joints)
    return Condition(expression, variable, values, posture, tuple(j + 1 for j in joints))


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
    c, s = domain.cosine_sine_of(joint, offset=True)
    offset = expression_to_sympy(domain.offsets[joint])
    a, b = p * c - slope * s, p * s + slope * c
    if moving_joints(domain, a) or moving_joints(domain, b):
        return ()
    ways = (sympy.atan2(write(-a), write(b)), sympy.atan2(write(a), write(-b)))
    return tuple(_in_one_turn(way - offset) for way in ways)


MAX_TERMS = 20_000
"""Budget of any polynomial on the way to the determinant."""

MAX_JOINTS = 6

MOST_WHOLE = 10**9
"""Whole numbers that are larger read no better than decimals."""


class Outcome(StrEnum):
    """What was found.

    Attributes:
        FOUND: The rank drops where a factor is zero.
        NEVER: The determinant is a constant, or there is but one joint.
        EVERYWHERE: Every square block of n rows is singular in every configuration.
        REDUNDANT: More than six joints; J has no square block of all its columns, and det(J J^T) is the measure.
        TOO_LONG: The determinant has more terms than the budget.
    """

    FOUND = "found"
    NEVER = "never"
    EVERYWHERE = "everywhere"
    REDUNDANT = "redundant"
    TOO_LONG = "too long"


@dataclass(frozen=True)
class JacobianBlock:
    """A square block of J.

    Attributes:
        name: ``J``, or ``J_11`` and ``J_22`` where J is block triangular about the wrist centre.
        rows: Its rows of J, from 1.
        columns: Its columns of J, from 1.
        reference: The point and the axes that J is taken about and in.
        others_are_zero: Whether the rows of J that are left out are zero everywhere.
        matrix: The block.
    """

    name: str
    rows: tuple[int, ...]
    columns: tuple[int, ...]
    reference: Reference
    others_are_zero: bool
    matrix: Matrix


@dataclass(frozen=True)
class SingularFactor:
    """A factor of the determinant.

    Attributes:
        expression: The factor.
        exponent: Its power.
        condition: Where it is zero; None if it does not move with the arm.
    """

    expression: Expr
    exponent: int
    condition: Condition | None


@dataclass(frozen=True)
class Singularities:
    """Where an arm is singular.

    Attributes:
        outcome: What was found.
        blocks: The diagonal blocks whose determinants are multiplied.
        determinant: Their product as a product of factors; 0 if singular everywhere, None where it was not
            computed.
        factors: Its factors.
    """

    outcome: Outcome
    blocks: tuple[JacobianBlock, ...] = ()
    determinant: Expr | None = None
    factors: tuple[SingularFactor, ...] = ()

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """Where the rank drops: where any of these holds."""
        return tuple(f.condition for f in self.factors if f.condition is not None)

    def _repr_latex_(self) -> str:
        if self.determinant is None:
            return aligned_latex([f"\\text{{singular: {self.outcome.value}}}"])
        lines = [f"\\det = {sympy.latex(self.determinant)}"]
        for condition in self.conditions:
            values = " \\text{ or } ".join(map(sympy.latex, condition.values))
            solved = f" \\iff {sympy.latex(condition.variable)} = {values}" if values else ""
            posture = f" \\quad \\text{{({condition.posture.value})}}" if condition.posture else ""
            lines.append(f"{sympy.latex(condition.expression)} = 0{solved}{posture}")
        return aligned_latex(lines)


def find_singularities(robot: Robot, style: Style | None = None) -> Singularities:
    """Where the Jacobian of a robot loses rank.

    Args:
        robot: The robot.
        style: How expressions are grouped; by default as the robot file says.

    Returns:
        The determinant in factors, and where each of them is zero.
    """
    if robot.n == 1:
        return Singularities(Outcome.NEVER)
    if robot.n > MAX_JOINTS:
        return Singularities(Outcome.REDUNDANT)
    try:
        return _singularities(robot, style or robot.style)
    except TooManyTerms:
        return Singularities(Outcome.TOO_LONG)


def _singularities(robot: Robot, style: Style) -> Singularities:
    domain = PolynomialDomain(robot, contraction=style.contraction, rates=False, offsets=True, max_terms=MAX_TERMS)
    write = LectureForm(domain, style=style).kinematic
    blocks = square_blocks(Kinematics(robot, domain))
    determinants = [block.determinant() for block in blocks]
    written = []
    for b in blocks:
        matrix = sympy.ImmutableMatrix([[write(entry) for entry in row] for row in b.entries])
        written.append(JacobianBlock(b.name, b.rows, b.columns, b.reference, b.others_are_zero, matrix))
    if not blocks or not all(determinants):
        return Singularities(Outcome.EVERYWHERE, tuple(written), sympy.S.Zero)
    found = []
    for factor in _factors(domain, determinants):
        expression = write(factor.value)
        condition = zero_condition(domain, factor, expression, write, has_wrist=len(blocks) == 2)
        found.append(SingularFactor(expression, factor.exponent, condition))
    determinant = sympy.Mul(*(f.expression**f.exponent for f in found))
    moving = any(f.condition is not None for f in found)
    return Singularities(Outcome.FOUND if moving else Outcome.NEVER, tuple(written), determinant, tuple(found))


def _factors(domain: PolynomialDomain, determinants: list[Polynomial]) -> list[Factor]:
    """The factors of all blocks: one number, what does not move, then what does, from the base outwards."""
    robot, factoring = domain.robot, Factoring(domain)
    cells = [cell for joint in robot.joints for cell in (joint.a, joint.d)] + [row[3] for row in robot.tool[:3]]
    lengths = sorted({abs(cell.value) for cell in cells if isinstance(cell, Number) and cell.value})
    number, powers = domain.ring.one, dict[Polynomial, Factor]()
    for p in determinants:
        for factor in factoring.factors(p):
            scale, scaled = _scaled(domain, factor, lengths)
            number = number * scale
            known = powers.get(scaled.value)
            exponent = scaled.exponent + (known.exponent if known else 0)
            powers[scaled.value] = Factor(scaled.value, exponent, scaled.kind, scaled.joints)
    rest = [f for f in powers.values() if f.value != 1]
    rest.sort(key=lambda factor: moving_joints(domain, factor.value))
    return [Factor(number, 1)] * (number != 1) + rest


def _scaled(domain: PolynomialDomain, factor: Factor, lengths: list[Fraction]) -> tuple[Polynomial, Factor]:
    """A rational power and a factor whose product is the one given.

    The coefficients of a sum become numeric lengths of the robot if one number makes all of them so, else whole numbers
    without a common divisor, or decimals up to 1 where these would be beyond `MOST_WHOLE`; most of them positive.
    """
    ring, p = domain.ring, factor.value
    if factor.kind is not None:
        return ring.one, factor
    if p.is_constant:
        return p**factor.exponent, Factor(ring.one, 1)
    coefficients = [c for _, c in p.terms()]
    positive = sum(1 if c > 0 else -1 for c in coefficients) or coefficients[0]
    sizes = [abs(c) for c in coefficients]
    common = Fraction(lcm(*(c.denominator for c in sizes)), gcd(*(c.numerator for c in sizes)))
    if max(sizes) * common > MOST_WHOLE:
        common = 1 / max(sizes)
    scales = [length / sizes[0] for length in lengths] if len(sizes) > 1 else []
    scale = next((scale for scale in scales if all(scale * c in lengths for c in sizes)), common)
    scale = scale if positive > 0 else -scale
    return ring.number(Fraction(1) / scale) ** factor.exponent, Factor(p * scale, factor.exponent)
