"""Incremental inverse kinematics: document 001, slide 32."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from derive.cli.main import main
from derive.errors import QuantityError
from derive.motion.incremental import Walker, increments_of, printed_increments
from derive.motion.motion import Motion
from derive.robot.evaluate import parameter_values
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from tests.motion.plans import PICK_AND_PLACE
from tests.motion.skeleton import REACH

VALUES = {"l0": 0.4, "l1": 0.3, "Tx": 0.1, "Ty": 0.2}
START = np.array([0.3, 0.9])


@pytest.fixture(scope="module")
def walker() -> Walker:
    return Walker(Robot.load("skeleton"), VALUES)


def test_the_error_before_correction_falls_with_the_step_and_the_hand_closes_on_its_target(walker: Walker) -> None:
    target = walker.place(np.array([0.8, 1.4]))
    coarse, fine = walker.walk(START, target, 200), walker.walk(START, target, 400)
    assert coarse.error / fine.error == pytest.approx(2, abs=0.05)
    assert coarse.error > 1e-5
    for found in (coarse, fine):
        assert found.closed <= 1e-9
        assert np.linalg.norm(walker.place(found.q[-1]) - target) <= 1e-9
        assert (found.damped, found.factor) == (0, "")
        assert 0 < found.corrections < 6


def test_the_hand_follows_the_line(walker: Walker) -> None:
    target = walker.place(np.array([0.8, 1.4]))
    found = walker.walk(START, target, 1000)
    places = np.array([walker.place(q) for q in found.q])
    line = walker.place(START) + np.linspace(0, 1, 1001)[:, None] * (target - walker.place(START))
    assert np.abs(places - line).max() < 1e-3
    assert found.q.shape == (1001, 2)


def test_near_the_straight_arm_steps_are_damped_and_the_vanishing_factor_is_named(walker: Walker) -> None:
    beyond = np.array([0.1 + 0.75, 0.2, 0])
    found = walker.walk(np.array([0.3, -0.6]), beyond, 100)
    assert found.damped > 0
    assert found.factor == "sin(q2)"
    assert 0.05 <= found.closed < 0.1
    assert np.abs(np.diff(found.q, axis=0)).max() < 1


@pytest.mark.parametrize("bend", [0.02, 0.0])
def test_a_target_near_or_on_a_singular_configuration_is_closed_on(walker: Walker, bend: float) -> None:
    found = walker.walk(np.array([0.3, 0.9]), walker.place(np.array([0.5, bend])), 100)
    assert found.damped > 0
    assert found.closed <= 1e-9


@pytest.mark.parametrize("start", [[0.0, 0.0], [0.5, 0.0], [0.5, np.pi], [0.3, 1.0], [0.3, 1e-8]])
@pytest.mark.parametrize("share", [0.3, -0.3, 0.6, -0.9])
@pytest.mark.parametrize("steps", [50, 400])
def test_a_target_across_or_along_the_axis_of_a_joint_is_closed_on(
    walker: Walker, start: list[float], share: float, steps: int
) -> None:
    """J^+ of a straight arm leads along it and never aside."""
    pivot, q = np.array([0.1, 0.2, 0]), np.array(start)
    way = walker.place(q) - pivot
    target = pivot + share * 0.7 * way / np.linalg.norm(way)
    found = walker.walk(q, target, steps)
    assert found.is_closed
    assert walker.place(found.q[-1]) == pytest.approx(target, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "turns"), [("puma560-corke", True), ("scara-matlab", True), ("skeleton", False), ("planar-3r", True)]
)
def test_a_hand_that_is_free_to_turn_is_brought_to_the_orientation_too(name: str, turns: bool) -> None:
    robot, random = Robot.load(name), np.random.default_rng(2)
    free = Walker(robot, {**VALUES, **{symbol: 0.4 for symbol in free_symbols(robot)}, **parameter_values(robot)})
    for case in range(4):
        start, end = random.uniform(-2, 2, (2, robot.n)) * [[case > 0], [1]]
        coarse, fine = (free.walk(start, free.pose(end), steps) for steps in (100, 200))
        assert fine.is_closed
        assert (fine.turn is not None) is turns
        wanted = free.pose(end) if turns else free.pose(end)[:3, 3]
        reached = free.pose(fine.q[-1]) if turns else free.place(fine.q[-1])
        assert reached == pytest.approx(wanted, abs=3e-9)
        if turns and not (coarse.damped or fine.damped or case == 0):
            assert fine.turn == pytest.approx((coarse.turn or 0) / 2, rel=0.2, abs=1e-9)


def test_targets_that_stay_open_are_told_with_status_1(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = tmp_path / "plan.yaml"
    plan.write_text(
        "robot: {name: arm, convention: standard, joints: [{type: revolute, a: 1}, {type: revolute, a: 1}]}\n"
        "points: {a: [0, 0], b: [pi/3, -2*pi/3]}\npath: [a, {to: b, time: 1}]\n"
    )
    assert main(["move", str(plan), "--increments", "20"]) == 0
    assert "in attempt 2, aside of where J^+ stops" in capsys.readouterr().out
    monkeypatch.setattr("derive.motion.incremental.ANEW", 0)
    assert main(["move", str(plan), "--increments", "20"]) == 1
    printed = capsys.readouterr()
    assert "a -> b: 1 m after 20 steps, 1 m after 40; not closed: 1 m left by 50 corrections" in printed.out
    assert "increments do not close on the target of a -> b; go through a point aside" in printed.err


def test_a_path_is_walked_segment_by_segment() -> None:
    motion = Motion.from_text(PICK_AND_PLACE)
    found = increments_of(motion, 50)
    assert len(found) == 5
    assert found[1].error < 1e-12
    assert found[0].factor == "sin(q2)"
    lines = list(printed_increments(motion, 50))
    assert lines[1].startswith("A -> B: ")
    assert "near sin(q2) = 0" in lines[0]


def test_what_has_no_path_or_a_base_that_moves_is_refused() -> None:
    with pytest.raises(QuantityError, match="base moves"):
        increments_of(Motion.from_text(REACH), 10)
    curves = "robot: planar-3r\ncurves: {q1: t, q2: t**2, q3: t}\ntime: 1\n"
    with pytest.raises(QuantityError, match="from point to point"):
        increments_of(Motion.from_text(curves), 10)


def test_a_hand_that_no_joint_moves_stays_where_it_is(recwarn: pytest.WarningsRecorder) -> None:
    robot = Robot.from_text("name: arm\nconvention: standard\njoints: [{type: revolute}]\n")
    found = Walker(robot, {}).walk(np.zeros(1), np.zeros(3), 3)
    assert found.error == 0
    assert not found.damped
    assert not recwarn.list


def test_near_a_singular_configuration_other_directions_are_exact_and_an_end_there_is_named() -> None:
    """C to D goes down where sin(q2) = 0, and A to C ends there (document 004)."""
    found = increments_of(Motion.from_text(PICK_AND_PLACE), 20)
    to_c, down = found[3], found[4]
    assert down.error < 1e-12
    assert (down.damped, down.factor) == (20, "sin(q2)")
    assert to_c.damped == 0
    assert to_c.factor == "sin(q2)"
    assert to_c.closed <= 1e-9
    lines = list(printed_increments(Motion.from_text(PICK_AND_PLACE), 20))
    assert lines[3].endswith("; ends near sin(q2) = 0")
