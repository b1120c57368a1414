"""Motions: document 004, simulation pages, and what holds of any motion."""

from __future__ import annotations

import numpy as np
import pytest
import yaml
from sympy import Rational, pi, sqrt


class TestPlansAsData:
    def test_a_mapping_is_what_its_file_is(self) -> None:
        keys = yaml.safe_load(PICK_AND_PLACE)
        keys["points"]["D"] = np.array([np.pi / 2, 0, 3, 0])
        keys["path"][-1]["line"] = False
        keys["title"] = None
        motion, read = Motion.from_dict(keys), Motion.from_text(PICK_AND_PLACE)
        t = np.linspace(0, 15, 301)
        assert np.abs(np.array(motion(t)) - np.array(read(t))).max() < 1e-14
        assert motion.trajectory.segments[0] == read.trajectory.segments[0], "texts of cells stay exact"

    def test_configurations_in_an_array_are_gone_through(self) -> None:
        rows = np.array([[0, 0, 1, 0], [0.3, 0.4, 1.2, 0], [0.5, -0.1, 1, 0.2]])
        motion = Motion.through("scara-matlab", rows, [1, 0.5], profile="septic", via="pass")
        assert motion(np.array([0, 1, 1.5]))[0] == pytest.approx(rows, abs=1e-15)
        assert repr(motion) == "Motion of scara-matlab, 1.5 s: p0 -> p1, p1 -> p2"
        assert Motion.through("scara-matlab", rows, 2).duration == 4
        assert Motion.through("scara-matlab", rows[:2], speed=[1] * 4).duration == pytest.approx(0.4 * 15 / 8)

    @pytest.mark.parametrize(("rows", "times"), [([0, 1], 1), ([[0, 0, 0, 0]], 1), ([[0] * 4] * 3, [1, 2, 3])])
    def test_rows_or_times_that_do_not_belong_together(self, rows: list[float], times: object) -> None:
        with pytest.raises(ValueError, match=r"points: two rows|times: one, or 2"):
            Motion.through("scara-matlab", rows, times)  # type: ignore[arg-type]

    def test_what_is_no_plan_is_refused_at_its_place(self) -> None:
        with pytest.raises(RobotFileError, match=r"<plan>:\d+:\d+: .*4 joints"):
            Motion.through("scara-matlab", [[0, 0], [1, 1]], 1)


def test_poses_are_those_of_the_end_effector(pick_and_place: Motion) -> None:
    times = np.array([[0.0, 3.0], [4.5, 9.9]])
    oracle = Oracle.of(Robot.load("scara-matlab"))
    expected = [[oracle.evaluate("forward_kinematics", pick_and_place(t)[0]) for t in row] for row in times]
    assert pick_and_place.poses(times) == pytest.approx(np.array(expected), abs=1e-14)
    assert pick_and_place.poses(3.0)[:3, 3] == pytest.approx([-2, 2, -1], abs=1e-14)


def test_poses_move_with_their_base() -> None:
    motion = Motion.from_text(
        "robot: {name: p, convention: standard, joints: [{type: revolute, a: 2}]}\n"
        "curves: {q1: t}\ntime: 2\nbase: {x: 3*t, rpy: [0, 0, t]}\n"
    )
    for t, pose in zip((0.5, 1.5), motion.poses(np.array([0.5, 1.5])), strict=True):
        assert pose[:2, 3] == pytest.approx([3 * t + 2 * np.cos(2 * t), 2 * np.sin(2 * t)], abs=1e-14)
    assert motion.poses(1.5) == pytest.approx(pose, abs=1e-14)
