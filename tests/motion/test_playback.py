"""Motions as the web page gets them: the same pieces, payloads by columns, formulas as trees."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from sympy import Abs, atan2, cos, pi, sign, sin, sqrt, tan

from derive.motion.hermite import TIME
from derive.motion.motion import Motion
from derive.motion.playback import OPERATIONS, playback, tree
from tests.motion.plans import PICK_AND_PLACE

LAW: dict[str, Callable[..., float]] = {
    "add": lambda *terms: math.fsum(terms),
    "multiply": lambda *factors: math.prod(factors),
    "power": lambda a, b: a**b,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "sign": lambda a: math.copysign(1, a) if a else 0.0,
    "abs": abs,
    "atan2": math.atan2,
    "atan": math.atan,
}


def value(formula: Any, t: float) -> float:
    if isinstance(formula, list):
        return LAW[formula[0]](*(value(part, t) for part in formula[1:]))
    return t if formula == "t" else float(formula)


@pytest.mark.parametrize(
    "formula",
    [
        pi / 4 * sin(2 * TIME),
        TIME**2 / 10 - cos(TIME),
        sqrt(1 + TIME) / (2 + TIME),
        atan2(TIME, 3) + atan2(1, TIME - 2) + tan(TIME / 5),
        Abs(TIME - 2) * sign(TIME - 1),
        pi / 3,
    ],
)
def test_a_formula_is_a_tree_of_numbers_and_operations(formula: Any) -> None:
    made = tree(formula)
    for t in (0.1, 0.7, 1.9):
        assert value(made, t) == pytest.approx(float(formula.subs(TIME, t)), rel=1e-14)


def test_the_page_knows_every_operation() -> None:
    assert set(LAW) == set(OPERATIONS.values())


def test_pieces_of_a_joint_follow_each_other_and_end_with_the_motion() -> None:
    motion = Motion.from_text(PICK_AND_PLACE)
    made = playback(motion)
    assert made.duration == 15
    for j, track in enumerate(made.tracks):
        assert [piece.start for piece in track] == [0, 3, 6, 9, 12]
        assert all(piece.duration == 3 for piece in track)
        assert [piece.values[0] for piece in track] == motion(np.array([0.0, 3, 6, 9, 12]))[0][:, j].tolist()
    assert made.ranges[2] == (1, 3)
    assert made.basis == {3: made.basis[3]}


def test_what_the_tool_carries_is_known_by_its_segment() -> None:
    text = PICK_AND_PLACE.replace("{to: D, time: 3}", "{to: D, time: 3, payload: 0.5}")
    made = playback(Motion.from_text(text))
    assert [bool(segment.payload) for segment in made.segments] == [False, False, False, False, True]
    assert 0.5 in [number for _, number in made.segments[-1].payload]
    assert made.functions == ("inverse_dynamics", "regressor")


def test_an_arm_without_links_has_no_torques() -> None:
    arm = "{name: arm, convention: standard, joints: [{type: revolute, a: 1}]}"
    made = playback(Motion.from_text(f"robot: {arm}\ncurves: {{q1: t**2}}\ntime: 2\n"))
    assert made.functions == ()
    assert made.tracks[0][0].formulas[1] == ["multiply", 2.0, "t"]
