"""Motions as the web page gets them: the same pieces, payloads by columns, formulas as trees."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from sympy import Abs, atan2, cos, pi, sign, sin, sqrt, tan

from derive.motion.motion import Motion
from derive.motion.output.playback import OPERATIONS, playback, tree
from derive.plans.hermite import TIME
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


SPRUNG = """robot: {name: arm, convention: standard, joints: [{type: revolute, a: 1, speed: 1}], gravity: [0, -9.81, 0],
  links: [{mass: 1}]}
points: {a: [0], b: [1]}
path: [a, {to: b, time: 1}]
control: {law: pd, kp: 400, kd: 40}
"""


def test_of_a_simulation_the_rows_are_played_and_its_excess_is_told() -> None:
    motion = Motion.from_text(SPRUNG)
    run = motion.simulate()
    made = playback(motion, run)
    assert made.run is not None
    assert made.run.times == tuple(run.t.tolist())
    assert np.array(made.run.q) == pytest.approx(run.q, rel=1e-11)
    assert made.bounds == {"speed": ((None, 1.0),)}
    (found,) = made.exceeded
    assert (found.quantity, found.joint, found.value) == ("speed", 0, pytest.approx(np.abs(run.qd).max()))
    assert made.ranges[0][0] == pytest.approx(run.q.min())


def test_motions_of_too_many_pieces_are_told_by_places(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("derive.motion.output.playback.MOST_NUMBERS", 32)
    motion = Motion.from_text(PICK_AND_PLACE)
    made = playback(motion)
    assert made.places == 4
    times = [piece.start for piece in made.tracks[0]]
    assert times == [0, 5, 10]
    assert (
        pytest.approx(np.array(motion(np.array(times)))[:2, :, 1], abs=1e-14)
        == np.array([piece.values[:2] for piece in made.tracks[1]]).T
    )


def test_long_simulations_have_fewer_rows_on_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("derive.motion.output.playback.MOST_NUMBERS", 200)
    motion = Motion.from_text(SPRUNG)
    made = playback(motion, motion.simulate()).run
    assert made is not None
    assert 4 * len(made.times) <= 104
    assert made.times[-1] == 1


def test_a_simulation_that_fails_at_once_has_a_picture() -> None:
    motion = Motion.from_text(SPRUNG)
    run = motion.simulate()
    only = replace(run, **{name: getattr(run, name)[:1] for name in ("t", "q", "qd", "tau", "energy", "work", "lost")})
    made = playback(motion, only)
    assert made.duration == motion.sample
    assert made.run is not None
    assert made.run.times == (0, motion.sample)
    assert made.run.q == ((0.0,), (0.0,))


def test_an_arm_without_links_has_no_torques() -> None:
    arm = "{name: arm, convention: standard, joints: [{type: revolute, a: 1}]}"
    made = playback(Motion.from_text(f"robot: {arm}\ncurves: {{q1: t**2}}\ntime: 2\n"))
    assert made.functions == ()
    assert made.tracks[0][0].formulas[1] == ["multiply", 2.0, "t"]


def test_a_base_that_moves_brings_a_program_for_each_load() -> None:
    text = PICK_AND_PLACE.replace("{to: D, time: 3}", "{to: D, time: 3, payload: 0.5}") + "base: {x: t/2}\n"
    found = playback(Motion.from_text(text))
    assert [segment.load for segment in found.segments] == [0, 0, 0, 0, 1]
    assert len(found.base_torques) == 2
    assert all(len(each.results) == 4 for each in found.base_torques)
    assert [len(rows) for rows in found.base_rates] == [3, 3]
    assert playback(Motion.from_text(PICK_AND_PLACE)).base_torques == ()
