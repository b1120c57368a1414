"""Where the Jacobian of an arm loses rank: the determinant of a square block, its factors and their zeros.

Everything is exact: the factors multiply to the determinant as polynomials modulo s^2 + c^2 = 1. Their rational factors
are moved where a reader expects them: 0.43*c2 + 0.41*s23, not 43*c2 + 41*s23.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from math import gcd, lcm

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factors import Factor, Factoring
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.lecture.form import LectureForm
from derive.lecture.to_sympy import Expr, Matrix
from derive.model.kinematics import Kinematics, Reference
from derive.model.matrices import aligned_latex
from derive.model.singularities.blocks import square_blocks
from derive.model.singularities.conditions import Condition, moving_joints, zero_condition
from derive.robot.expression import Number
from derive.robot.robot import Robot
from derive.robot.style import Contraction, Style

MAX_TERMS = 20_000
"""Budget of any polynomial on the way to the determinant."""

MAX_JOINTS = 6


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


def find_singularities(
    robot: Robot, style: Style = Style.COMPACT, contraction: Contraction = Contraction.ALIGNED
) -> Singularities:
    """Where the Jacobian of a robot loses rank.

    Args:
        robot: The robot.
        style: How expressions are grouped.
        contraction: Which sums of angles are contracted.

    Returns:
        The determinant in factors, and where each of them is zero.
    """
    if robot.n == 1:
        return Singularities(Outcome.NEVER)
    if robot.n > MAX_JOINTS:
        return Singularities(Outcome.REDUNDANT)
    try:
        return _singularities(robot, style, contraction)
    except TooManyTerms:
        return Singularities(Outcome.TOO_LONG)


def _singularities(robot: Robot, style: Style, contraction: Contraction) -> Singularities:
    domain = PolynomialDomain(robot, contraction=contraction, rates=False, max_terms=MAX_TERMS)
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
    without a common divisor; most of them positive.
    """
    ring, p = domain.ring, factor.value
    if factor.kind is not None:
        return ring.one, factor
    if p.is_constant:
        return p**factor.exponent, Factor(ring.one, 1)
    coefficients = [c for _, c in p.terms()]
    positive = sum(1 if c > 0 else -1 for c in coefficients) or coefficients[0]
    scale = _scale([abs(c) for c in coefficients], lengths) * (1 if positive > 0 else -1)
    return ring.number(Fraction(1) / scale) ** factor.exponent, Factor(p * scale, factor.exponent)


def _scale(coefficients: list[Fraction], lengths: list[Fraction]) -> Fraction:
    if len(coefficients) == 1:
        return 1 / coefficients[0]
    for length in lengths:
        scale = length / coefficients[0]
        if all(scale * c in lengths for c in coefficients):
            return scale
    return Fraction(lcm(*(c.denominator for c in coefficients)), gcd(*(c.numerator for c in coefficients)))
