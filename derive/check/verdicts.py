"""What is said about a printed formula: same form, equal, or wrong with the change that repairs it.

What a wrong formula has too much or too little, term by term.

Whether two expressions are written alike.

Two expressions have the same form when their trees agree after flattening sums and products, ignoring order and
moving signs and rational factors out of products and sums, and nothing else: ``c1*(a2*c2 + a3*c23)`` is not
``a2*c1*c2 + a3*c1*c23``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from functools import lru_cache
from math import gcd, lcm
from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.from_sympy import expression_from_sympy
from derive.algebra.ring import TooManyTerms
from derive.check.diagnosis import Question, Repair, diagnose
from derive.check.findings import Finding
from derive.errors import DeriveError
from derive.lecture.form import LectureForm
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, substitute
from derive.robot.robot import Robot
from derive.robot.style import Style

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


Shape = tuple[Any, ...]
"""The form of an expression up to a rational factor; ordered, so that equal forms are equal values."""

ONE: Shape = ("*",)


def same_form(a: Expression, b: Expression) -> bool:
    """Whether two expressions have the same form (and the same rational factor in front)."""
    return form(a) == form(b)


def form(e: Expression) -> tuple[Fraction, Shape]:
    """The rational factor of an expression and the shape of the rest."""
    match e:
        case Number(value):
            return value, ONE
        case Pi():
            return Fraction(1), ("pi",)
        case Name(name):
            return Fraction(1), ("name", name)
        case Sum():
            return _sum(e)
        case Product() | Power():
            return _product(e)
        case Call(function, arguments):
            return Fraction(1), ("call", function, *(form(a) for a in arguments))


def _product(e: Product | Power) -> tuple[Fraction, Shape]:
    factor = Fraction(1)
    factors: dict[Shape, int] = {}
    for base, exponent in _factors(e, 1):
        k, shape = form(base)
        factor *= k**exponent if k else Fraction(0)
        inner = shape[1:] if shape[0] == "*" else ((shape, 1),)
        for part, power in inner:
            factors[part] = factors.get(part, 0) + power * exponent
    kept = sorted(((s, p) for s, p in factors.items() if p), key=repr)
    if len(kept) == 1 and kept[0][1] == 1:
        return factor, kept[0][0]
    return factor, ("*", *kept)


def _factors(e: Expression, exponent: int) -> list[tuple[Expression, int]]:
    """Bases and exponents of the flattened product."""
    if isinstance(e, Product):
        return [pair for f in e.factors for pair in _factors(f, exponent)]
    if isinstance(e, Power):
        return _factors(e.base, exponent * e.exponent)
    return [(e, exponent)]


def _sum(e: Sum) -> tuple[Fraction, Shape]:
    terms: list[tuple[Fraction, Shape]] = []
    for term in e.terms:
        k, shape = form(term)
        if shape[0] == "+":
            terms.extend((k * inner, s) for inner, s in shape[1:])
        elif k:
            terms.append((k, shape))
    if len(terms) < 2:
        return terms[0] if terms else (Fraction(0), ONE)
    terms.sort(key=lambda pair: (repr(pair[1]), pair[0]))
    content = _content([k for k, _ in terms])
    if terms[0][0] < 0:
        content = -content
    return content, ("+", *((k / content, s) for k, s in terms))


def _content(numbers: list[Fraction]) -> Fraction:
    """The positive rational that leaves whole numbers without a common factor."""
    return Fraction(gcd(*(k.numerator for k in numbers)), lcm(*(k.denominator for k in numbers)))


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
