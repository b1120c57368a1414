"""Where the Jacobian of an arm loses rank: the determinant of a square block, its factors and their zeros.

Everything is exact: the factors multiply to the determinant as polynomials modulo s^2 + c^2 = 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.lecture_form import LectureForm
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.algebra.trigonometric_factors import Factor, Factoring
from derive.mechanics.factor_scale import Lengths
from derive.mechanics.kinematics import Kinematics
from derive.mechanics.reference import Reference
from derive.mechanics.singular_block import SquareBlock, square_blocks
from derive.mechanics.singular_conditions import Condition, Solver
from derive.robot.robot import Robot
from derive.robot.style import Contraction, Style

Expr = Any
Matrix = Any

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
class Block:
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
    blocks: tuple[Block, ...] = ()
    determinant: Expr | None = None
    factors: tuple[SingularFactor, ...] = ()

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """Where the rank drops: where any of these holds."""
        return tuple(f.condition for f in self.factors if f.condition is not None)


def find_singularities(
    robot: Robot, style: Style = Style.COMPACT, contraction: Contraction = Contraction.ALIGNED
) -> Singularities:
    """Where the Jacobian of a robot loses rank.

    Args:
        robot: The robot.
        style: How expressions are grouped.
        contraction: Which sums of angles are contracted.
    """
    if robot.n == 1:
        return Singularities(Outcome.NEVER)
    if robot.n > MAX_JOINTS:
        return Singularities(Outcome.REDUNDANT)
    try:
        return _Search(robot, style, contraction).result()
    except TooManyTerms:
        return Singularities(Outcome.TOO_LONG)


@dataclass(frozen=True)
class _Search:
    robot: Robot
    style: Style
    contraction: Contraction

    @cached_property
    def domain(self) -> PolynomialDomain:
        return PolynomialDomain(self.robot, contraction=self.contraction, rates=False, max_terms=MAX_TERMS)

    @cached_property
    def form(self) -> LectureForm:
        return LectureForm(self.domain, style=self.style)

    def result(self) -> Singularities:
        blocks = square_blocks(Kinematics(self.robot, self.domain))
        determinants = [block.determinant() for block in blocks]
        written = tuple(self._written(block) for block in blocks)
        if not blocks or not all(determinants):
            return Singularities(Outcome.EVERYWHERE, written, sympy.S.Zero)
        factors = self._factors(determinants)
        found = tuple(self._factor(f, len(blocks) == 2) for f in factors)
        determinant = sympy.Mul(*(f.expression**f.exponent for f in found))
        moving = any(f.condition is not None for f in found)
        return Singularities(Outcome.FOUND if moving else Outcome.NEVER, written, determinant, found)

    def _factors(self, determinants: list[Polynomial]) -> list[Factor]:
        """The factors of all blocks: one number, what does not move, then what does."""
        factoring, lengths = Factoring(self.domain), Lengths(self.robot, self.domain)
        number, powers = self.domain.ring.one, dict[Polynomial, Factor]()
        for p in determinants:
            for factor in factoring.factors(p):
                scale, scaled = lengths.scaled(factor)
                number = number * scale
                known = powers.get(scaled.value)
                exponent = scaled.exponent + (known.exponent if known else 0)
                powers[scaled.value] = Factor(scaled.value, exponent, scaled.kind, scaled.joints)
        rest = [f for f in powers.values() if f.value != 1]
        return [Factor(number, 1)] * (number != 1) + sorted(rest, key=self._rank)

    def _rank(self, factor: Factor) -> tuple[int, ...]:
        """What does not move first, then from the base outwards."""
        return Solver(self.domain).moving(factor.value)

    def _factor(self, factor: Factor, has_wrist: bool) -> SingularFactor:
        expression = self.form.kinematic(factor.value)
        condition = Solver(self.domain).condition(factor, expression, self.form.kinematic, has_wrist)
        return SingularFactor(expression, factor.exponent, condition)

    def _written(self, block: SquareBlock) -> Block:
        rows = [[self.form.kinematic(entry) for entry in row] for row in block.entries]
        matrix = sympy.ImmutableMatrix(rows)
        return Block(block.name, block.rows, block.columns, block.reference, block.others_are_zero, matrix)
