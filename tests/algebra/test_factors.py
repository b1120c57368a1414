"""Factors modulo s^2 + c^2 = 1: their product is the polynomial, and products fall apart."""

from __future__ import annotations

import random

import pytest

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factors import Factoring
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial
from derive.robot.robot import Robot

DOMAIN = PolynomialDomain(Robot.load("puma560-corke"), rates=False)
RING = DOMAIN.ring


def product(p: Polynomial) -> Polynomial:
    result = RING.one
    for factor in Factoring(DOMAIN).factors(p):
        result = result * factor.value**factor.exponent
    return result


def some(rng: random.Random) -> Polynomial:
    """A linear form in sines, cosines and lengths."""
    c, s = DOMAIN.cosine_sine_of(rng.randrange(1, 5))
    a, b, d = (RING.generator(name) for name in rng.sample(["a2", "a3", "d3", "d4"], 3))
    return a * c + rng.choice([b, -b, RING.zero]) * s + rng.randint(-1, 1) * d


@pytest.mark.parametrize("seed", range(40))
def test_the_factors_multiply_to_the_polynomial(seed: int) -> None:
    rng = random.Random(seed)
    p = some(rng) * some(rng) * some(rng)
    assert product(p) == p
    other = p + some(rng)
    assert product(other) == other


@pytest.mark.parametrize("seed", range(20))
def test_products_of_linear_forms_fall_apart(seed: int) -> None:
    rng = random.Random(seed)
    forms = [some(rng) for _ in range(3)]
    found = Factoring(DOMAIN).factors(forms[0] * forms[1] * forms[2])
    assert sum(factor.exponent for factor in found if not factor.value.is_constant) >= 3


def test_a_squared_sine_is_a_sine_twice() -> None:
    c, s = DOMAIN.cosine_sine_of(2)
    found = Factoring(DOMAIN).factors(1 - c * c)
    assert [(f.value, f.exponent, f.kind, f.joints) for f in found] == [(s, 2, Kind.SINE, (2,))]


def test_sines_of_single_angles_are_found_among_sums() -> None:
    c2, s2 = DOMAIN.cosine_sine_of(1)
    c3, s3 = DOMAIN.cosine_sine_of(2)
    sum_sine = s2 * c3 + c2 * s3
    found = {(f.kind, f.joints) for f in Factoring(DOMAIN).factors(s3 * sum_sine * c2)}
    assert found == {(Kind.SINE, (2,)), (Kind.SINE, (1, 2)), (Kind.COSINE, (1,))}


def test_zero_is_its_own_factor() -> None:
    assert [f.value for f in Factoring(DOMAIN).factors(RING.zero)] == [RING.zero]
