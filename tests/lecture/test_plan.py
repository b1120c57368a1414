"""Plans: how many operations they take, and that no rule changes what they stand for."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest

from derive.lecture.plan import (
    LARGE_FACTOR,
    Plan,
    Plus,
    Term,
    Times,
    cheapest,
    factored,
    flat,
    grouped,
    nested,
    product_form,
    with_plain_numbers,
)
from derive.lecture.terms import Terms

NUMBERS = [Fraction(n) for n in (2, 3, 5, 7, 11)]


def value(plan: Plan) -> Fraction:
    match plan:
        case Term(coefficient, monomial):
            total = coefficient
        case Times(coefficient, monomial, inner):
            total = coefficient
            for part, exponent in inner:
                total *= value(part) ** exponent
        case Plus(parts):
            return sum((value(part) for part in parts), Fraction(0))
    for factor, exponent in monomial:
        total *= NUMBERS[factor] ** exponent
    return total


def some_terms(seed: int, signs: tuple[int, ...] = (-1, 1)) -> Terms:
    rng = random.Random(seed)
    monomials = {tuple((f, rng.randint(1, 2)) for f in sorted(rng.sample(range(5), 3))) for _ in range(7)}
    return {m: Fraction(rng.choice(signs) * rng.randint(1, 4)) for m in sorted(monomials)}


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("signs", [(-1, 1), (-1,)])
def test_every_rule_keeps_the_value(seed: int, signs: tuple[int, ...]) -> None:
    terms = some_terms(seed, signs)
    levels = [frozenset({0}), frozenset({1, 2})]
    plans = [
        flat(terms),
        factored(terms, flat),
        factored(terms, flat, frozenset({0, 1})),
        grouped(terms, levels[1], flat),
        nested(terms, levels),
    ]
    assert {value(plan) for plan in plans} == {value(plans[0])}
    assert cheapest(plans).operations == min(plan.operations for plan in plans)


def test_a_common_factor_saves_its_multiplications_and_a_sum_of_negatives_has_its_sign_outside() -> None:
    """x*y + x*z takes three operations, x*(y + z) two."""
    one = Fraction(1)
    terms = {((0, 1), (1, 1)): one, ((0, 1), (2, 1)): one}
    assert (flat(terms).operations, factored(terms, flat).operations) == (3, 2)
    terms = {((0, 1), (1, 1)): Fraction(-1), ((0, 1), (2, 1)): Fraction(-2)}
    found = factored(terms, flat)
    assert isinstance(found, Times)
    assert found.coefficient == -1


def test_squares_of_sums_are_found_and_sums_that_are_no_products_left() -> None:
    square = {((0, 2),): Fraction(1), ((0, 1), (1, 1)): Fraction(2), ((1, 2),): Fraction(1)}
    found = product_form(square)
    assert isinstance(found, Times)
    assert [exponent for _, exponent in found.inner] == [2]
    assert value(found) == value(flat(square))
    assert product_form({((0, 2),): Fraction(1), ((1, 2),): Fraction(1)}) is None
    single = {((0, 1), (1, 1)): Fraction(1), ((0, 1), (2, 1)): Fraction(1)}
    assert product_form(single) is None
    assert product_form(single, monomials=True) is not None


def _sum(*numbers: str) -> Plan:
    """Number of factor 0, number of factor 1, ...; the first term is plain."""
    return Plus(tuple(Term(Fraction(n), ((k, 1),) if k else ()) for k, n in enumerate(numbers)))


def _numbers(plan: Plan) -> list[Fraction]:
    match plan:
        case Term(coefficient, _):
            return [coefficient]
        case Times(coefficient, _, inner):
            return [coefficient, *(n for part, _ in inner for n in _numbers(part))]
        case Plus(parts):
            return [n for part in parts for n in _numbers(part)]


@pytest.mark.parametrize(
    ("coefficient", "sums", "expected"),
    [
        ("-4.8e-8", [(("141", "10000"), 1)], ["-6.768e-6", "-4.8e-4"]),
        ("-4.8e-8", [(("141", "10000"), 2)], ["-4.8", "0.0141", "1"]),
        ("-1.7e-8", [(("31", "10000"), 1), (("-500", "0", "3441"), 1)], ["-0.17", "0.0031", "1", "-0.5", "0", "3.441"]),
        ("10", [(("0.1", "0.1"), 1), (("1", "1"), 1)], ["1", "1", "1", "1", "1"]),
        ("0.5", [(("1", "2"), 1), (("1", "1"), 1)], ["0.5", "1", "2", "1", "1"]),
        ("1", [(("0.05", "0.2"), 1), (("1", "1"), 1)], ["1", "0.05", "0.2", "1", "1"]),
    ],
)
def test_products_of_decimals_have_numbers_of_usual_size(
    coefficient: str, sums: list[tuple[tuple[str, ...], int]], expected: list[str]
) -> None:
    plan = Times(Fraction(coefficient), (), tuple((_sum(*numbers), exponent) for numbers, exponent in sums))
    plain = with_plain_numbers(plan)
    assert value(plain) == value(plan)
    assert _numbers(plain) == [Fraction(n) for n in expected]
    assert plain.operations <= plan.operations


@pytest.mark.parametrize("seed", range(20))
def test_plain_numbers_keep_the_value(seed: int) -> None:
    rng = random.Random(seed)

    def drawn() -> str:
        return str(rng.choice([-1, 1]) * Fraction(rng.randint(1, 10 ** rng.randint(1, 5)), rng.choice([1, 100])))

    sums = tuple((_sum(drawn(), drawn(), drawn()), rng.randint(1, 2)) for _ in range(rng.randint(1, 2)))
    plan = Times(Fraction(rng.randint(1, 999), 10**6), ((3, 1),), sums)
    plain = with_plain_numbers(plan)
    assert value(plain) == value(plan)
    assert all(abs(n) < LARGE_FACTOR for part, _ in getattr(plain, "inner", ()) for n in _numbers(part))
