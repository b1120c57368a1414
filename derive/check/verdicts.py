"""What is said about a printed formula: same form, equal, or wrong with the change that repairs it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from functools import lru_cache
from typing import Any

import sympy

from derive.algebra.from_sympy import expression_from_sympy
from derive.check.comparison import Finding
from derive.check.diagnosis import Question, Repair, diagnose
from derive.check.differences import difference_terms
from derive.check.same_form import same_form
from derive.errors import DeriveError
from derive.robot.arithmetic import substitute
from derive.robot.expression import Expression

Expr = Any


class Outcome(StrEnum):
    """The verdict on one formula.

    Attributes:
        SAME_FORM: Right, and written as the lecture form writes it.
        EQUAL: Right, written in another way.
        WRONG: Not equal.
        UNDECIDABLE: A name that the robot does not know; nothing can be said.
    """

    SAME_FORM = "same form"
    EQUAL = "equal"
    WRONG = "wrong"
    UNDECIDABLE = "undecidable name"


@dataclass(frozen=True, slots=True)
class Judgement:
    """The verdict on one formula and the reasons.

    Attributes:
        outcome: The verdict.
        difference: Terms of printed minus right, where it is wrong and both are polynomials.
        repair: The smallest change that makes it right, if one was found.
    """

    outcome: Outcome
    difference: tuple[Expr, ...] = ()
    repair: Repair | None = None


@lru_cache(maxsize=10_000)
def judge(finding: Finding) -> Judgement:
    """The verdict on a comparison.

    Args:
        finding: What was compared.
    """
    question = finding.question
    if finding.unknown is not None:
        return Judgement(Outcome.UNDECIDABLE)
    if finding.verdict.equal:
        same = question is not None and same_form(question.printed, question.right)
        return Judgement(Outcome.SAME_FORM if same else Outcome.EQUAL)
    if question is None:
        return Judgement(Outcome.WRONG, repair=finding.repair)
    whole = _whole(question)
    terms = difference_terms(question.robot, whole, question.right) if whole is not None else ()
    return Judgement(Outcome.WRONG, terms, diagnose(replace(question, extra_terms=_lacking(terms))))


def _whole(question: Question) -> Expression | None:
    """The printed formula without further names; None where not it, but something of it is compared."""
    if question.is_plain:
        return substitute(question.printed, dict(question.definitions))
    return None


def _lacking(terms: tuple[Expr, ...]) -> tuple[Expression, ...]:
    """A difference of one term is a term too many or too few."""
    if len(terms) != 1:
        return ()
    try:
        return (expression_from_sympy(sympy.Mul(-1, terms[0])),)
    except DeriveError:
        return ()
