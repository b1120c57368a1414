"""What generators stand for: partners, multiples of pi, square roots of rationals."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind, canonical, collect, split_pi, square_free
from derive.errors import Location
from derive.robot.expression import Name
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot

HERE = Location("<test>")
ARM = Robot.from_text(
    "name: arm\nconvention: standard\njoints: [{type: revolute, a: a1, alpha: be}, {type: revolute, a: sqrt(8)}]\n"
)


def test_every_sine_knows_its_cosine_and_comes_before_it() -> None:
    generators = {g.name: g for g in PolynomialDomain(ARM).generators}
    order = list(generators)
    sines = [g for g in generators.values() if g.kind in (Kind.SINE, Kind.CONSTANT_SINE)]
    assert len(sines) == 3
    for sine in sines:
        cosine = generators[sine.partner]
        assert (cosine.partner, cosine.argument, cosine.joint) == (sine.name, sine.argument, sine.joint)
        assert order.index(sine.name) < order.index(cosine.name)


@pytest.mark.parametrize("multiple", [Fraction(k, d) for d in (1, 4, 6, 7, 12) for k in range(-30, 31)])
def test_a_multiple_of_pi_is_right_angles_and_a_rest_of_half_of_one(multiple: Fraction) -> None:
    quarter, rest = split_pi(multiple)
    assert 0 <= quarter < 4
    assert Fraction(-1, 4) < rest <= Fraction(1, 4)
    assert (multiple - Fraction(quarter, 2) - rest) % 2 == 0


@pytest.mark.parametrize(
    "value", [Fraction(8), Fraction(1, 2), Fraction(18, 50), Fraction(49), Fraction(10_007**2 * 6)]
)
def test_a_square_root_is_a_rational_times_roots_of_different_primes(value: Fraction) -> None:
    factor, primes = square_free(value)
    assert factor**2 * math.prod(primes) == value
    assert len(set(primes)) == len(primes)


def test_order_does_not_tell_expressions_apart() -> None:
    first, second = (parse_expression(text, HERE) for text in ("a*(b + c)*d", "d*a*(c + b)"))
    assert canonical(first) == canonical(second)


def test_what_expressions_need_is_collected_innermost_first() -> None:
    atoms = collect(
        [parse_expression("sqrt(1 + sqrt(a))/(b + 1/a) + pi*sqrt(12)", HERE)], [parse_expression("pi/5", HERE)]
    )
    assert next(iter(atoms.roots)) == Name("a")
    assert next(iter(atoms.inverses)) == Name("a")
    assert (len(atoms.roots), len(atoms.inverses), atoms.has_pi) == (2, 2, True)
    assert list(atoms.primes) == [3]
    assert list(atoms.pi_rests) == [Fraction(1, 5)]


def test_squares_of_a_small_constant_angle_stay_squares_of_its_sine() -> None:
    text = "name: arm\ntitle: Arm\nconvention: standard\njoints:\n  - {type: revolute, alpha: pi/100}\n"
    domain = PolynomialDomain(Robot.from_text(text), rates=False)
    cosine, sine = domain.cosine_sine(domain.robot.joints[0].alpha)
    assert cosine * cosine - 1 == -(sine * sine)
    assert len(sine * sine) == 1
