"""Built-in plans, and new ones to start from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from derive.errors import UnknownRobotError
from derive.motion.motion import Motion
from derive.plans.catalogue import new_plan_text, plan_bytes, plan_names
from derive.plans.plan import plan_from_bytes
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle


def test_no_plan_has_the_name_of_a_robot() -> None:
    assert set(plan_names()).isdisjoint(catalogue_names())
    assert {"scara-pick-and-place", "skeleton-reach"} <= set(plan_names())


@pytest.mark.parametrize("text", ["a\0b", "x" * 5000, "\ud800.yaml"])
def test_what_no_file_can_be_called_is_no_plan(text: str) -> None:
    with pytest.raises(UnknownRobotError, match="no file and no built-in plan"):
        plan_bytes(text)


@pytest.mark.parametrize("name", plan_names())
def test_every_built_in_plan_moves(name: str) -> None:
    motion = Motion.load(name)
    q = motion(motion.times)[0]
    assert motion.plan.title
    assert (np.ptp(q, axis=0) > 0).any()


def test_hand_of_the_skeleton_goes_where_slide_29_says() -> None:
    """p = (Tx, Ty) + l0 (c_beta, -s_beta) + l1 (c_ab, -s_ab) on the curves of the plan."""
    motion = Motion.load("skeleton-reach")
    t = np.linspace(0, 4, 9)
    q = motion(t)[0]
    beta, both = q[:, 2], q[:, 2] + q[:, 3]
    assert q[:, 0] == pytest.approx(0.3 * t, abs=1e-15)
    x = 0.3 * t + 0.32 * np.cos(beta) + 0.27 * np.cos(both)
    y = 0.9 + 0.02 * np.cos(np.pi * t) - 0.32 * np.sin(beta) - 0.27 * np.sin(both)
    oracle = Oracle.of(motion.plan.robot, {"l0": 0.32, "l1": 0.27})
    hand = np.array([oracle.evaluate("forward_kinematics", row)[:2, 3] for row in q])
    assert hand == pytest.approx(np.stack([x, y], axis=1), abs=1e-12)


def test_what_is_neither_a_file_nor_a_plan_is_named_with_what_was_meant() -> None:
    with pytest.raises(UnknownRobotError, match=r"no built-in plan 'skeleton-rech'; .*did you mean 'skeleton-reach'"):
        plan_bytes("skeleton-rech")
    with pytest.raises(UnknownRobotError):
        plan_bytes("a\0b")


@pytest.mark.parametrize("name", catalogue_names())
def test_a_new_plan_of_any_robot_is_a_plan_within_its_limits(name: str) -> None:
    plan = plan_from_bytes(new_plan_text("mine", Robot.load(name), name).encode(), "mine.yaml")
    assert len(plan.steps) == 2
    assert plan.points["home"].q != plan.points["A"].q


def test_a_new_plan_counts_in_the_units_of_the_robot_file(tmp_path: Path) -> None:
    text = (
        "{name: arm, convention: standard, units: {angle: deg, length: mm}, joints: ["
        "{type: revolute, limits: [10, 60]}, {type: prismatic, limits: [0, 300]}, {type: revolute}]}"
    )
    (tmp_path / "arm.yaml").write_text(text)
    robot = Robot.load(tmp_path / "arm.yaml")
    (tmp_path / "move.yaml").write_text(new_plan_text("move", robot, "arm.yaml"))
    ends = Motion.load(tmp_path / "move.yaml")(np.array([0.0, 2.0]))[0]
    assert ends == pytest.approx(np.array([[np.radians(35), 0, 0], [np.radians(47.5), 0.15, np.pi / 4]]))
