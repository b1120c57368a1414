"""Bases that move by formulas of time."""

from __future__ import annotations

import re

import numpy as np
import pytest
from sympy import Rational, cos, pi, sin

from derive.errors import DeriveError
from derive.motion.motion import Motion
from derive.plans.hermite import TIME
from derive.plans.moving_base import BaseCurve
from tests.motion.skeleton import REACH


def test_a_base_is_a_rigid_motion_and_its_rate_its_derivative() -> None:
    base = BaseCurve.of((TIME, TIME**2, sin(TIME)), (TIME / 3, cos(TIME), Rational(1, 5) * TIME))
    t, h = np.linspace(0, 3, 7), 1e-6
    there = base(t, 0)
    assert there[:, :3, :3] @ there[:, :3, :3].transpose(0, 2, 1) == pytest.approx(np.tile(np.eye(3), (7, 1, 1)))
    assert base(t, 1) == pytest.approx((base(t + h, 0) - base(t - h, 0)) / (2 * h), abs=1e-8)
    assert there[:, 3].tolist() == [[0, 0, 0, 1]] * 7


def test_yaw_is_the_last_turn() -> None:
    base = BaseCurve.of((TIME, TIME, TIME), (pi / 2, pi * 0, pi / 2))
    assert base(np.zeros(1), 0)[0, :3, 1].round(15).tolist() == [0, 0, 1]
    assert base(np.zeros(1), 0)[0, :3, 0].round(15).tolist() == [0, 1, 0]


def test_second_derivatives_are_exact_too() -> None:
    base = BaseCurve.of((TIME**2, sin(TIME), TIME), (TIME / 3, cos(TIME), Rational(1, 5) * TIME))
    t, h = np.linspace(0, 3, 7), 1e-6
    assert base(t, 2) == pytest.approx((base(t + h, 1) - base(t - h, 1)) / (2 * h), abs=1e-8)


def test_an_arm_whose_base_moves_has_torques() -> None:
    text = REACH.replace("skeleton", "scara-matlab").partition("values:")[0]
    motion = Motion.from_text(text)
    assert motion.has_torques
    assert all(len(found.loads) == 4 for found in motion.peaks)


def test_the_fastest_motion_under_torques_does_not_know_a_base_that_moves() -> None:
    points = "points: {a: [0, 0, 0, 0], b: [1, 1, 1, 1]}\npath: [a, {to: b}]\n"
    limits = "profile: fastest\nspeed: [1, 1, 1, 1]\nacceleration: [1, 1, 1, 1]\ntorque: [9, 9, 9, 9]\n"
    with pytest.raises(DeriveError, match=r"torques of a fastest motion.*base that moves") as caught:
        _ = Motion.from_text(f"robot: scara-matlab\n{points}{limits}base: {{x: t}}\n").trajectory
    assert caught.value.exit_status == 2


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("x: 3*t/10", "x: 3*w/10", r"<text>:3:11: base, x: the symbol 'w' has no number; write values: \{w: ...\}"),
        ("y: t**2/10", "yy: t", r"<text>:3:\d+: .*unknown key 'yy'; allowed: x, y, z, rpy"),
        ("[0, 0, t/7]", "[0, 0]", r"rpy"),
    ],
)
def test_wrong_ones_are_refused_with_their_place(old: str, new: str, message: str) -> None:
    with pytest.raises(DeriveError) as caught:
        Motion.from_text(REACH.replace(old, new))
    assert caught.value.exit_status == 2
    assert re.search(message, str(caught.value)), str(caught.value)
