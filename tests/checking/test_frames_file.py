"""Elementary frames: what a rotation and a translation do, and how they compose."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
import sympy

from derive.checking.frames_file import compose, point, rotation, translation
from derive.errors import ExpressionError
from derive.model.model import Model
from derive.robot.robot import Robot

ALPHA, BETA, X, Y, Z = sympy.symbols("alpha beta x y z")


@pytest.mark.parametrize(("axis", "start", "end"), [("x", "y", "z"), ("y", "z", "x"), ("z", "x", "y")])
def test_a_quarter_turn_takes_one_axis_to_the_next(axis: str, start: str, end: str) -> None:
    unit = {name: point(*(int(other == name) for other in "xyz")) for name in "xyz"}
    quarter = rotation(axis, sympy.pi / 2)
    assert compose(quarter, unit[start]) == unit[end]
    assert compose(quarter, unit[axis]) == unit[axis]


@pytest.mark.parametrize("axis", "xyz")
def test_a_turn_and_its_opposite_cancel(axis: str) -> None:
    assert compose(rotation(axis, ALPHA), rotation(axis, -ALPHA)) == sympy.eye(4)
    assert compose(rotation(axis, 0.3), rotation(axis, Fraction(-3, 10))) == sympy.eye(4)


@pytest.mark.parametrize("axis", "xyz")
def test_turns_about_one_axis_add_up(axis: str) -> None:
    together = compose(rotation(axis, ALPHA), rotation(axis, BETA))
    assert together == sympy.expand_trig(rotation(axis, ALPHA + BETA))


def test_translations_add_up_and_commute() -> None:
    together = compose(translation(X, Y, Z), translation(1, 2, 3))
    assert together == translation(X + 1, Y + 2, Z + 3) == compose(translation(1, 2, 3), translation(X, Y, Z))


def test_the_product_is_that_of_matrices() -> None:
    rng = random.Random(5)
    frames = []
    for _ in range(5):
        frames.append(rotation(rng.choice("xyz"), sympy.Rational(rng.randint(-30, 30), 10)))
        frames.append(translation(*(rng.randint(-9, 9) for _ in range(3))))
    expected = sympy.eye(4)
    for frame in frames:
        expected = expected * frame
    assert sympy.Matrix(compose(*frames) - expected).evalf(30).norm() < 1e-25


def test_a_row_of_a_table_is_four_elementary_frames() -> None:
    model = Model(Robot.load("dh-classical-deluca"))
    theta, d, a, alpha = sympy.symbols("q1 d1 a1 alpha1")
    row = compose(rotation("z", theta), translation(0, 0, d), translation(a, 0, 0), rotation("x", alpha))
    assert row == model.A(1)


def test_special_angles_are_exact() -> None:
    half = sympy.Rational(1, 2)
    assert rotation("z", sympy.pi / 6)[1, 0] == half
    assert compose(rotation("z", sympy.pi / 4), rotation("z", sympy.pi / 4)) == rotation("z", sympy.pi / 2)


def test_what_is_no_frame_is_refused() -> None:
    with pytest.raises(ExpressionError, match="axis 'w'"):
        rotation("w", 0)
    for value in ("alpha", object(), None, sympy.eye(2)):
        with pytest.raises(ExpressionError):
            rotation("z", value)
    for frames in ((), (sympy.eye(3),), (point(0, 0, 0), sympy.eye(4))):
        with pytest.raises(ExpressionError, match="frames of shapes"):
            compose(*frames)
