"""What is said about a printed formula: same form, equal, or wrong with the change that repairs it.

Two expressions have the same form when their trees agree after flattening sums and products, ignoring order and
moving signs and rational factors out of products and sums, and nothing else: ``c1*(a2*c2 + a3*c23)`` is not
``a2*c1*c2 + a3*c1*c23``. Of a wrong formula it is found what it has too much or too little, term by term.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from functools import lru_cache
from math import gcd, lcm
from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.from_sympy import expression_from_sympy
from derive.algebra.quotients import opaque
from derive.checking.diagnosis import Question, Repair, diagnose
from derive.checking.findings import Finding
from derive.errors import DeriveError
from derive.lecture.form import LectureForm
from derive.lecture.to_sympy import Expr, expression_to_sympy
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, substitute
from derive.robot.style import Style

MAX_TERMS = 20_000
"""Budget of the polynomial difference; beyond it none is shown, since nobody would find the slip in it."""

Shape = tuple[Any, ...]
"""The form of an expression up to a rational factor; ordered, so that equal forms are equal values."""

ONE: Shape = ("*",)


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

    Returns:
        The verdict; the search for the slip is made once for each finding.
    """
    question = finding.question
    if finding.unknown is not None:
        return Judgement(Outcome.UNDECIDABLE)
    if finding.verdict.equal:
        same = question is not None and same_form(question.printed, question.right)
        return Judgement(Outcome.SAME_FORM if same else Outcome.EQUAL)
    if question is None:
        return Judgement(Outcome.WRONG, repair=finding.repair)
    terms = _difference_terms(question) if question.is_plain else ()
    lacking: tuple[Expression, ...] = ()
    if len(terms) == 1:  # a difference of one term is a term too many or too few
        with suppress(DeriveError):
            lacking = (expression_from_sympy(sympy.Mul(-1, terms[0])),)
    return Judgement(Outcome.WRONG, terms, diagnose(replace(question, extra_terms=lacking)))


def _difference_terms(question: Question) -> tuple[Expr, ...]:
    """SymPy terms of printed minus right, angle sums contracted and squares reduced; none of no polynomials.

    sign(qd1), as in Coulomb friction, counts as a symbol.
    """
    meanings: dict[str, Expression] = {}
    whole = substitute(question.printed, question.definitions)
    printed, right = opaque(whole, meanings), opaque(question.right, meanings)
    try:
        domain = PolynomialDomain(question.robot, [printed, right], max_terms=MAX_TERMS)
        polynomial = domain.constant(printed) - domain.constant(right)
        difference = LectureForm(domain, style=Style.EXPANDED).kinematic(polynomial)
    except DeriveError:
        return ()
    difference = difference.xreplace({sympy.Symbol(name): expression_to_sympy(e) for name, e in meanings.items()})
    return tuple(term for term in sympy.Add.make_args(difference) if term != 0)


def same_form(a: Expression, b: Expression) -> bool:
    """Whether two expressions have the same form and the same rational factor in front.

    Args:
        a: A tree.
        b: Another.
    """
    return _form(a) == _form(b)


def _form(e: Expression) -> tuple[Fraction, Shape]:
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
            return Fraction(1), ("call", function, *(_form(a) for a in arguments))


def _product(e: Product | Power) -> tuple[Fraction, Shape]:
    factor = Fraction(1)
    factors: dict[Shape, int] = {}
    for base, exponent in _flat_factors(e, 1):
        k, shape = _form(base)
        factor *= k**exponent if k else Fraction(0)
        inner = shape[1:] if shape[0] == "*" else ((shape, 1),)
        for part, power in inner:
            factors[part] = factors.get(part, 0) + power * exponent
    kept = sorted(((s, p) for s, p in factors.items() if p), key=repr)
    if len(kept) == 1 and kept[0][1] == 1:
        return factor, kept[0][0]
    return factor, ("*", *kept)


def _flat_factors(e: Expression, exponent: int) -> list[tuple[Expression, int]]:
    """Bases and exponents of the flattened product."""
    if isinstance(e, Product):
        return [pair for f in e.factors for pair in _flat_factors(f, exponent)]
    if isinstance(e, Power):
        return _flat_factors(e.base, exponent * e.exponent)
    return [(e, exponent)]


def _sum(e: Sum) -> tuple[Fraction, Shape]:
    terms: list[tuple[Fraction, Shape]] = []
    for term in e.terms:
        k, shape = _form(term)
        if shape[0] == "+":
            terms.extend((k * inner, s) for inner, s in shape[1:])
        elif k:
            terms.append((k, shape))
    if len(terms) < 2:
        return terms[0] if terms else (Fraction(0), ONE)
    terms.sort(key=lambda pair: (repr(pair[1]), pair[0]))
    # the rational that leaves whole numbers without a common factor, the first of them positive
    content = Fraction(gcd(*(k.numerator for k, _ in terms)), lcm(*(k.denominator for k, _ in terms)))
    if terms[0][0] < 0:
        content = -content
    return content, ("+", *((k / content, s) for k, s in terms))
