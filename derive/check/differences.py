"""What a wrong formula has too much or too little, term by term."""

from __future__ import annotations

from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.lecture_form import LectureForm
from derive.algebra.ring import TooManyTerms
from derive.errors import DeriveError
from derive.robot.expression import Expression
from derive.robot.robot import Robot
from derive.robot.style import Style

Expr = Any

MAX_TERMS = 20_000
"""Budget of the polynomial difference; beyond it none is shown."""


def difference_terms(robot: Robot, printed: Expression, right: Expression) -> tuple[Expr, ...]:
    """The terms of printed minus right, angle sums contracted and squares reduced.

    Args:
        robot: Its joints tell angles from lengths.
        printed: The printed formula.
        right: The derived one.

    Returns:
        SymPy terms; none where the formulas are no polynomials, or are equal.
    """
    try:
        domain = PolynomialDomain(robot, [printed, right], max_terms=MAX_TERMS)
        polynomial = domain.constant(printed) - domain.constant(right)
        difference = LectureForm(domain, style=Style.EXPANDED).kinematic(polynomial)
    except (DeriveError, TooManyTerms):
        return ()
    return tuple(term for term in sympy.Add.make_args(difference) if term != 0)
