"""Constants: exact where they are rational, recognised where they meet, rounded once."""

from __future__ import annotations

import math
import pickle
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from derive.algebra import constants
from derive.errors import QuantityError

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


def test_what_cancels_is_zero() -> None:
    root = constants.square_root(Fraction(2))
    eight = constants.square_root(Fraction(8))
    assert constants.add(constants.add(root, root), constants.multiply(eight, Fraction(-1))) == 0
    assert constants.sine(constants.multiply(constants.pi(), Fraction(7))) == 0


def test_tiny_numbers_are_not_taken_for_zero() -> None:
    root = constants.square_root(Fraction(2))
    assert constants.multiply(root, Fraction(1, 10**80)) != 0
    assert constants.sine(Fraction(1, 10**60)) != 0


def test_equal_constants_have_equal_keys_whatever_their_way() -> None:
    sixty = constants.sine(constants.multiply(constants.pi(), Fraction(1, 3)))
    half_root = constants.multiply(constants.square_root(Fraction(3)), Fraction(1, 2))
    assert constants.key_of(sixty) == constants.key_of(half_root)


def test_pi_is_known_to_its_last_bit() -> None:
    assert constants.to_float(constants.pi()) == math.pi
    assert constants.to_float(constants.add(constants.pi(), Fraction(-314159265358979, 10**14))) == pytest.approx(
        3.23846264338327950288e-15, rel=1e-15
    )


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
