"""Generators, constants and roots."""

import itertools
import math
import pickle
from fractions import Fraction
from functools import reduce

import pytest
from hypothesis import given
from hypothesis import strategies as st

from derive.algebra import constants
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind, canonical, collect, split_pi, square_free
from derive.algebra.ring import Polynomial
from derive.errors import ExpressionError, Location, QuantityError
from derive.robot.expression import Call, Name
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from tests.rows import robot_of_rows

rationals = st.builds(Fraction, st.integers(-(10**9), 10**9), st.integers(1, 10**6))


@given(a=rationals, b=rationals)
def test_rationals_stay_exact(a: Fraction, b: Fraction) -> None:
    assert constants.add(a, b) == a + b
    assert constants.multiply(a, b) == a * b
    assert constants.to_float(a) == float(a)


@given(a=rationals)
def test_functions_round_to_the_nearest_double(a: Fraction) -> None:
    x = a / 10**7
    assert constants.to_float(constants.sine(x)) == pytest.approx(math.sin(float(x)), rel=1e-12, abs=1e-12)
    assert constants.to_float(constants.square_root(abs(a))) == math.sqrt(abs(a)) or a.denominator != 1


@pytest.mark.parametrize(
    ("degrees", "square"),
    [(30, Fraction(3, 4)), (45, Fraction(1, 2)), (60, Fraction(1, 4)), (90, Fraction(0)), (180, 1)],
)
def test_cosines_of_special_angles_square_to_rationals(degrees: int, square: Fraction) -> None:
    cosine = constants.cosine(constants.multiply(constants.pi(), Fraction(degrees, 180)))
    found = constants.multiply(cosine, cosine)
    assert isinstance(found, Fraction)
    assert found == square


def test_what_cancels_is_zero_and_tiny_numbers_are_not_taken_for_it() -> None:
    root = constants.square_root(Fraction(2))
    eight = constants.square_root(Fraction(8))
    assert constants.add(constants.add(root, root), constants.multiply(eight, Fraction(-1))) == 0
    assert constants.sine(constants.multiply(constants.pi(), Fraction(7))) == 0
    assert constants.multiply(root, Fraction(1, 10**80)) != 0
    assert constants.sine(Fraction(1, 10**60)) != 0


def test_pi_is_known_to_its_last_bit_and_equal_constants_have_equal_keys() -> None:
    assert constants.to_float(constants.pi()) == math.pi
    rest = constants.to_float(constants.add(constants.pi(), Fraction(-314159265358979, 10**14)))
    assert rest == pytest.approx(3.23846264338327950288e-15, rel=1e-15)
    sixty = constants.sine(constants.multiply(constants.pi(), Fraction(1, 3)))
    half_root = constants.multiply(constants.square_root(Fraction(3)), Fraction(1, 2))
    assert constants.key_of(sixty) == constants.key_of(half_root)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: constants.reciprocal(Fraction(0)), "division by zero"),
        (lambda: constants.square_root(Fraction(-1)), "negative"),
        (lambda: constants.to_float(Fraction(10) ** 400), "too large"),
    ],
)
def test_numbers_that_are_none_are_refused(make: object, message: str) -> None:
    with pytest.raises(QuantityError, match=message):
        make()  # type: ignore[operator]


def test_constants_reach_another_process_with_every_bit() -> None:
    for value in (constants.pi(), constants.multiply(constants.cosine(Fraction(1)), Fraction(-1)), Fraction(2, 3)):
        found = pickle.loads(pickle.dumps(value))
        assert (type(found), constants.key_of(found)) == (type(value), constants.key_of(value))
        assert constants.add(found, constants.multiply(value, Fraction(-1))) == 0
        assert found == value


HERE = Location("<test>")
ARM = robot_of_rows("R a: a1, alpha: be | R a: sqrt(8)")


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


@pytest.mark.parametrize("value", [Fraction(8), Fraction(1, 2), Fraction(18, 50), Fraction(49), Fraction(10007**2 * 6)])
def test_a_square_root_is_a_rational_times_roots_of_different_primes(value: Fraction) -> None:
    factor, primes = square_free(value)
    assert factor**2 * math.prod(primes) == value
    assert len(set(primes)) == len(primes)


def test_what_expressions_need_is_collected_innermost_first_in_any_order() -> None:
    atoms = collect(
        [parse_expression("sqrt(1 + sqrt(a))/(b + 1/a) + pi*sqrt(12)", HERE)], [parse_expression("pi/5", HERE)]
    )
    assert next(iter(atoms.roots)) == Name("a")
    assert next(iter(atoms.inverses)) == Name("a")
    assert (len(atoms.roots), len(atoms.inverses), atoms.has_pi) == (2, 2, True)
    assert list(atoms.primes) == [3]
    assert list(atoms.pi_rests) == [Fraction(1, 5)]
    first, second = (parse_expression(text, HERE) for text in ("a*(b + c)*d", "d*a*(c + b)"))
    assert canonical(first) == canonical(second)


def test_squares_of_a_small_constant_angle_stay_squares_of_its_sine() -> None:
    domain = PolynomialDomain(robot_of_rows("R alpha: pi/100"), rates=False)
    cosine, sine = domain.cosine_sine(domain.robot.joints[0].alpha)
    assert cosine * cosine - 1 == -(sine * sine)
    assert len(sine * sine) == 1


ROBOT = Robot.load("dh-classical-deluca")


def polynomials(*texts: str) -> list[Polynomial]:
    cells = [parse_expression(text, Location("cell")) for text in texts]
    domain = PolynomialDomain(ROBOT, cells)
    return [domain.constant(cell) for cell in cells]


@pytest.mark.parametrize(
    "factors",
    [
        ("sqrt(sin(alpha1))", "sin(alpha1)", "sqrt(sin(alpha1))", "sin(alpha1)"),
        ("sqrt(a1 + sqrt(2)*d1)", "sqrt(2)", "sqrt(a1 + sqrt(2)*d1)", "d1"),
        ("sqrt(1 + sqrt(sin(alpha1)))", "sqrt(sin(alpha1))", "sqrt(1 + sqrt(sin(alpha1)))", "sin(alpha1)"),
    ],
)
def test_a_product_has_one_normal_form(factors: tuple[str, ...]) -> None:
    values = polynomials(*factors)
    products = [reduce(lambda a, b: a * b, order) for order in itertools.permutations(values)]
    assert all(product == products[0] for product in products)


def test_the_square_of_a_root_of_a_sine_is_the_sine_and_other_functions_are_refused() -> None:
    root, sine, cosine = polynomials("sqrt(sin(alpha1))", "sin(alpha1)", "cos(alpha1)")
    assert root * root == sine
    assert root * sine * root == 1 - cosine * cosine
    sign = Call("sign", (Name("a1"),))
    with pytest.raises(ExpressionError, match="sign in an algebraic expression"):
        PolynomialDomain(ROBOT, [sign]).constant(sign)
