"""The end effector on a spline: via points of the hand (document 001, slide 31)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from sympy import Integer

from derive.errors import DeriveError
from derive.handouts.assemble import context_of
from derive.motion.hand_curve import HandCurve
from derive.motion.motion import Motion
from derive.motion.output.page import plan_part
from derive.motion.paths.hand_spline import angular_motion, spline_way
from derive.motion.paths.poses import rotation_of
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle

VIA = """\
robot: {name: arm, convention: standard, inverse: {task: [x, y]}, joints: [
  {type: revolute, q: b, theta: -b, a: 0.4}, {type: revolute, q: a, theta: -a, a: 0.3}]}
profile: spline
spline: hand
points:
  A: {pose: {p: [0.5, -0.1, 0]}}
  B: {pose: {p: [0.4, -0.3, 0]}}
  C: {pose: {p: [0.1, -0.5, 0]}}
  D: {pose: {p: [-0.2, -0.4, 0]}}
path: [A, {to: B, time: 1}, {to: C, time: 3/2}, {to: D, time: 1}]
"""
"""The arm of the skeleton, its root at rest."""

PLACES = np.array([[0.5, -0.1], [0.4, -0.3], [0.1, -0.5], [-0.2, -0.4]])

TURNING = """\
robot: puma560-corke
profile: spline
spline: hand
points:
  a: {pose: {p: [0.4, -0.3, 0.3], rpy: [6, 115, 17]}}
  b: {pose: {p: [0.5, -0.1, 0.2], rpy: [26, 126, 17]}}
  c: {pose: {p: [0.45, -0.2, 0.35], rpy: [0, 115, 40]}}
path: [a, {to: b, time: 1}, {to: c, time: 2}]
"""


@pytest.fixture(scope="module")
def via() -> Motion:
    return Motion.from_text(VIA)


def test_slide_31_the_hand_goes_through_its_points_on_the_spline_of_scipy(via: Motion) -> None:
    knots = [0, 1, 2.5, 3.5]
    p, v = HandCurve(via)(np.array(knots))
    assert p[:, :2] == pytest.approx(PLACES, abs=1e-11)
    assert np.abs(v[[0, -1]]).max() < 1e-12
    t = np.linspace(0, 3.5, 500)
    expected = CubicSpline(knots, PLACES, bc_type="clamped")
    p, v = HandCurve(via)(t)
    assert p[:, :2] == pytest.approx(expected(t), abs=1e-9)
    assert v[:, :2] == pytest.approx(expected(t, 1), abs=1e-7)


def test_the_plan_in_print_says_that_the_hand_is_on_the_spline(via: Motion) -> None:
    motion, context = via, context_of(via.plan.robot)
    assert "rotation vector" in repr(plan_part(motion, context))
    joints = Motion.from_text(VIA.replace("spline: hand\n", ""))
    assert "rotation vector" not in repr(plan_part(joints, context))


def test_joints_are_continuous_with_their_accelerations_at_the_points(via: Motion) -> None:
    for joint in range(2):
        before, after = (segment.joints[joint] for segment in via.trajectory.segments[:2])
        assert before[-1].values[1] == after[0].values[0]
        assert len(before[-1].values[1]) == 3


def test_a_hand_that_turns_is_where_its_points_are_and_moves_smoothly() -> None:
    motion, oracle = Motion.from_text(TURNING), Oracle.of(Robot.load("puma560-corke"))
    there = oracle.evaluate("forward_kinematics", motion(np.array([0.0, 1.0, 3.0]))[0])
    assert there[:, :3, 3] == pytest.approx(
        np.array([[0.4, -0.3, 0.3], [0.5, -0.1, 0.2], [0.45, -0.2, 0.35]]), abs=1e-10
    )
    for pose, (roll, pitch, yaw) in zip(there, np.deg2rad([[6, 115, 17], [26, 126, 17], [0, 115, 40]]), strict=True):
        turns = [angle * np.eye(3)[axis] for axis, angle in ((2, yaw), (1, pitch), (0, roll))]
        assert pose[:3, :3] == pytest.approx(np.linalg.multi_dot([rotation_of(turn) for turn in turns]), abs=1e-10)
    t, h = np.linspace(0.01, 2.99, 40), 1e-5
    q, qd, qdd = (np.array(part) for part in zip(*(motion(t + d) for d in (-h, 0, h)), strict=True))
    assert (q[2] - q[0]) / (2 * h) == pytest.approx(qd[1], abs=1e-6)
    assert (qd[2] - qd[0]) / (2 * h) == pytest.approx(qdd[1], abs=1e-4)


@pytest.mark.parametrize("angle", [0.0, 1e-5, 0.3, 2.0, 5.0])
def test_angular_velocity_and_acceleration_are_those_of_the_rotation(angle: float) -> None:
    random = np.random.default_rng(7)
    axis, rate, bend = random.normal(size=(3, 3))
    w, h = angle * axis / np.linalg.norm(axis), 1e-4

    def at(t: float) -> np.ndarray:
        return rotation_of(w + rate * t + bend * t * t / 2)

    omega, alpha = angular_motion(w, rate, bend)
    spin = (at(h) - at(-h)) / (2 * h) @ at(0).T
    assert omega == pytest.approx([spin[2, 1], spin[0, 2], spin[1, 0]], abs=1e-6)
    tensor = (at(h) - 2 * at(0) + at(-h)) / h**2 @ at(0).T
    skew = (tensor - tensor.T) / 2
    assert alpha == pytest.approx([skew[2, 1], skew[0, 2], skew[1, 0]], abs=1e-5)


def test_orientations_more_than_half_a_turn_from_the_first_go_on_turning() -> None:
    poses = [np.eye(4) for _ in range(4)]
    for k, pose in enumerate(poses):
        pose[:3, :3] = rotation_of(np.array([0, 0, 1.5 * k]))
    way = spline_way([Integer(k) for k in range(4)], poses)
    _, omega, _ = way.turned(2.5)
    assert omega[2] > 0
    assert way.turned(3.0)[0] == pytest.approx(poses[3][:3, :3], abs=1e-12)


def test_limits_set_the_times_in_the_proportion_of_the_ways_of_the_hand() -> None:
    text = (
        VIA.replace(", time: 1}", "}")
        .replace(", time: 3/2}", "}")
        .replace("spline: hand", "spline: hand\nspeed: [1, 2]")
    )
    motion = Motion.from_text(text)
    qd = motion(np.linspace(0, motion.duration, 4001))[1]
    assert max(np.abs(qd[:, 0]).max(), np.abs(qd[:, 1]).max() / 2) == pytest.approx(1, abs=1e-4)
    first, second, _ = (float(segment.duration) for segment in motion.trajectory.segments)
    ways = np.linalg.norm(np.diff(PLACES, axis=0), axis=1)
    assert first / second == pytest.approx(ways[0] / ways[1], rel=0.01)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("profile: spline", "profile: cubic", r"<text>:4:9: spline: hand, and no profile is spline; write"),
        ("spline: hand", "spline: foot", r"<text>:4:9: .*'foot'.*joints"),
        ("{to: C, time: 3/2}", "{to: C}", r"<text>:10:\d+: no time from here to C"),
        ("[0.1, -0.5, 0]", "[0.1, -0.9, 0]", r"<text>:10:\d+: the arm (does not reach|cannot follow) the way"),
        ("[0.1, -0.5, 0]", "[-0.4, 0.1, 0]", r"<text>:10:\d+: .*(singular|does not reach the way|cannot follow)"),
    ],
)
def test_what_cannot_be_is_refused_with_its_place(old: str, new: str, message: str) -> None:
    with pytest.raises(DeriveError, match=message) as caught:
        _ = Motion.from_text(VIA.replace(old, new)).trajectory
    assert caught.value.exit_status == 2
