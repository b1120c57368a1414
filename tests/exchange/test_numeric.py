"""Numbers in the place of symbols."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from derive.errors import DeriveError, Location
from derive.exchange.certificate import ball
from derive.exchange.numeric import angle_text, text, with_numbers, with_positive_axes
from derive.mechanics.space import exactly
from derive.robot.expression import number
from derive.robot.names import robot_symbols
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import dressed

ARM = """
name: arm
convention: standard
joints:
  - {type: revolute, d: h, a: 2*h, alpha: pi/2, limits: [-w, w]}
  - {type: prismatic, a: b/c}
parameters: {h: 0.3, c: 0.5}
"""


def test_numbers_of_the_file_and_of_the_user_take_the_place_of_all_symbols() -> None:
    robot = with_numbers(Robot.from_text(ARM), {"b": number("0.25"), "w": number(2), "c": number("0.125")})
    assert not robot_symbols(robot)
    assert [robot.joints[0].d, robot.joints[0].a, robot.joints[1].a] == [number("0.3"), number("0.6"), number(2)]
    assert robot.joints[0].limits == (number(-2), number(2))


def test_one_message_names_every_symbol_without_a_number() -> None:
    with pytest.raises(DeriveError, match=r"arm: no number for b, w; .*; .*--values b=0\.5,w=0\.5"):
        with_numbers(Robot.from_text(ARM))


def test_a_cell_without_a_finite_value_is_refused() -> None:
    with pytest.raises(DeriveError, match="b/c has no finite value"):
        with_numbers(Robot.from_text(ARM), {"b": number(1), "w": number(1), "c": number(0)})


@pytest.mark.parametrize(
    ("cell", "digits", "angle"),
    [
        ("0.4318", "0.4318", "0.4318"),
        ("-pi/2", "-1.5707963267948966", "-pi/2"),
        ("sqrt(2)/2", "0.70710678118654752", "0.70710678118654752"),
        ("pi + 1", "4.1415926535897932", "4.1415926535897932"),
        ("1/3", "0.33333333333333333", "0.33333333333333333"),
    ],
)
def test_numbers_are_written_with_seventeen_digits(cell: str, digits: str, angle: str) -> None:
    with exactly():
        expression = parse_expression(cell, Location("<test>"))
        assert (text(ball(expression)), angle_text(expression)) == (digits, angle)


@pytest.mark.parametrize("name", ["stanford-deluca", "skeleton-modified", "skeleton-root"])
def test_axes_turned_around_move_the_same_arm(name: str) -> None:
    robot = dressed(name, rotors=True)
    random = np.random.default_rng(2)
    for signs in random.choice([-1, 1], (4, robot.n)):
        cells = {"theta": number("0.4"), "d": number("0.3")}
        joints = (replace(joint, sign=int(sign), **cells) for joint, sign in zip(robot.joints, signs, strict=True))
        arm = replace(robot, joints=tuple(joints))
        made = with_positive_axes(arm)
        assert all(joint.sign == 1 for joint in made.joints)
        q, qd, qdd = random.uniform(-1, 1, (3, robot.n))
        ours, theirs = Oracle.of(arm), Oracle.of(made)
        for function, given in (("forward_kinematics", (q,)), ("inverse_dynamics", (q, qd, qdd))):
            expected = ours.evaluate(function, *given)
            assert np.abs(theirs.evaluate(function, *given) - expected).max() < 1e-13 * max(1, np.abs(expected).max())
