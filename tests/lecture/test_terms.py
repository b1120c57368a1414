"""Terms in printed factors: contracted polynomials, and arithmetic of monomials."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.lecture.terms import FactorTable, Monomial, common_factor, divide, partition, project
from derive.robot.robot import Robot

ARM = Robot.from_text("name: arm\nconvention: standard\njoints: [{type: revolute, a: a1}, {type: revolute, a: a2}]\n")


def test_a_difference_of_angles_is_one_factor() -> None:
    domain = PolynomialDomain(ARM, sums=lambda group: False)
    (c1, s1), (c2, s2) = domain.cosine_sine_of(0), domain.cosine_sine_of(1)
    table = FactorTable(domain)
    ((monomial, coefficient),) = table.terms(c1 * (c1 * c2 - s1 * s2) + s1 * (s1 * c2 + c1 * s2)).items()
    ((factor, exponent),) = monomial
    assert (coefficient, exponent) == (1, 1)
    assert (table.factors[factor].kind, table.factors[factor].joints) == (Kind.COSINE, (1,))


def test_the_numbers_of_the_factors_do_not_depend_on_what_is_asked_for() -> None:
    asked, fresh = FactorTable(PolynomialDomain(ARM)), FactorTable(PolynomialDomain(ARM))
    asked.terms(asked.domain.cosine_sine_of(1)[0] ** 2)
    assert asked.factors == fresh.factors


def monomial(rng: random.Random) -> Monomial:
    return tuple((f, rng.randint(1, 3)) for f in sorted(rng.sample(range(6), rng.randint(0, 4))))


def product(a: Monomial, b: Monomial) -> Monomial:
    total = dict(a)
    for f, e in b:
        total[f] = total.get(f, 0) + e
    return tuple(sorted(total.items()))


@pytest.mark.parametrize("seed", range(20))
def test_monomials_divide_and_are_put_together_again(seed: int) -> None:
    rng = random.Random(seed)
    terms = {monomial(rng): Fraction(rng.randint(1, 9)) for _ in range(8)}
    common = common_factor(terms)
    assert all(product(common, divide(m, common)) == m for m in terms)
    level = frozenset({0, 2, 4})
    parts = partition(terms, level)
    assert {product(outer, inner): c for outer, part in parts.items() for inner, c in part.items()} == terms
    assert all(project(inner, level) == () for part in parts.values() for inner in part)
