"""Motions: document 004, simulation pages, and what holds of any motion."""

import numpy as np
import pytest
from sympy import Rational, pi, sqrt

from derive.errors import QuantityError
from derive.motion.motion import Motion
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.motion.plans import PICK_AND_PLACE


@pytest.fixture(scope="module")
def pick_and_place() -> Motion:
    return Motion.from_text(PICK_AND_PLACE)


class TestDocument004:
    """Figures of the segments, 3 s each, sampled at 10 ms; torques of its coupled rotors."""

    def test_peaks_are_exact(self, pick_and_place: Motion) -> None:
        speed, acceleration = 5 * pi / 16, 5 * pi / (9 * sqrt(3))
        rest_to_a, a_to_b, b_to_a, a_to_c, _ = pick_and_place.peaks
        assert [found.value for found in rest_to_a.speeds] == [speed, speed, 0, 0]
        assert all(found.value.equals(acceleration) for found in rest_to_a.accelerations[:2])
        assert a_to_b.speeds[2].value == Rational(5, 4)
        assert a_to_b.accelerations[2].value.equals(20 / (9 * sqrt(3)))
        assert b_to_a.speeds[2].value == -Rational(5, 4)
        assert a_to_c.speeds[1].value == -speed

    def test_torques_and_their_times(self, pick_and_place: Motion) -> None:
        """At the samples, as the document's figures have them; between them peaks are hardly larger."""

        def said(segment: int, joint: int) -> tuple[float, float]:
            t = 3 * segment + np.arange(300) / 100
            tau = pick_and_place.torques(t)[:, joint]
            at = np.abs(tau).argmax()
            load = pick_and_place.peaks[segment].loads[joint]
            assert abs(tau[at]) <= abs(load.peak) <= abs(tau[at]) * (1 + 1e-4)
            assert abs(load.time - t[at]) < 0.01
            return round(tau[at], 3), round(t[at] - 3 * segment, 6)

        assert said(0, 0) == (376.839, 0.62)
        assert said(0, 1) == (159.074, 0.66)
        assert said(1, 2) == (-70.943, 2.49)
        assert said(2, 2) == (-75.401, 0.78)
        assert said(3, 0) == (101.293, 2.39)
        assert said(3, 1) == (-55.791, 0.68)

    def test_work_of_each_segment(self, pick_and_place: Motion) -> None:
        expected = [17.975, -119.899, 135.062, 11.158, -119.899]
        assert [round(found.work, 3) for found in pick_and_place.peaks] == expected

    def test_at_rest_the_slide_carries_the_weight_behind_it(self, pick_and_place: Motion) -> None:
        assert pick_and_place.torques(0.0)[2] == pytest.approx(-6.5 * 9.8062, rel=1e-12)


def test_segments_join_without_a_gap_and_outside_the_motion_the_arm_stands(pick_and_place: Motion) -> None:
    for corner in (3.0, 6.0, 9.0, 12.0):
        before, after = pick_and_place(np.array([np.nextafter(corner, 0), corner]))[0]
        assert np.abs(after - before).max() < 1e-14
    _, qd, qdd = pick_and_place(np.array([0.0, 3.0, 6.0, 9.0, 12.0, 15.0]))
    assert not qd.any()
    assert not qdd.any()
    q, qd, qdd = pick_and_place(np.array([-1.0, 16.0]))
    assert q.tolist() == [[0, 0, 1, 0], [np.pi / 2, 0, 3, 0]]
    assert not qd.any()
    assert not qdd.any()


def test_one_time_and_many_give_the_same(pick_and_place: Motion) -> None:
    times = np.linspace(0, 15, 61)
    many = np.array(pick_and_place(times))
    one = np.array([pick_and_place(float(t)) for t in times]).transpose(1, 0, 2)
    assert one == pytest.approx(many, abs=1e-13)
    assert np.array(pick_and_place(times.reshape(1, 61))).shape == (3, 1, 61, 4)


def test_a_payload_costs_what_a_heavier_last_link_costs() -> None:
    """The regressor's columns of the last link against the oracle of an arm whose last link carries the body."""
    arm = """{name: arm, convention: standard, gravity: [0, 0, -9.81],
      tool: [[1, 0, 0, 0.1], [0, 0, -1, 0], [0, 1, 0, 0.2], [0, 0, 0, 1]],
      joints: [{type: revolute, a: 0.5, alpha: pi/2}, {type: revolute, a: 0.4}],
      links: [{mass: 3, com: [-0.2, 0, 0], inertia: {xx: 0.1, yy: 0.2, zz: 0.2}}, LAST]}"""
    plain = "{mass: 2, com: [-0.1, 0, 0.05], inertia: {xx: 0.01, yy: 0.02, zz: 0.03}}"
    text = "points: {a: [0, 0.3], b: [1, -0.7]}\npath: [a, {to: b, time: 1, payload: BODY}]\n"
    body = "{mass: 1.5, com: [0.02, 0.03, 0.04], inertia: [0.002, 0.003, 0.004]}"
    motion = Motion.from_text(f"robot: {arm.replace('LAST', plain)}\n{text.replace('BODY', body)}")
    rotation, tool = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0.0]]), np.array([0.1, 0, 0.2])
    own, mass, com = np.array([-0.1, 0, 0.05]), 1.5, rotation @ [0.02, 0.03, 0.04] + tool
    centre = (2 * own + mass * com) / 3.5

    def about(inertia: np.ndarray, m: float, r: np.ndarray) -> np.ndarray:
        return inertia + m * (r @ r * np.eye(3) - np.outer(r, r))

    total = about(np.diag([0.01, 0.02, 0.03]), 2, own - centre)
    total = total + about(rotation @ np.diag([0.002, 0.003, 0.004]) @ rotation.T, mass, com - centre)
    keys = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
    inertia = ", ".join(f"{key}: {total[place]:.17f}" for key, place in keys.items())
    heavy = f"{{mass: 3.5, com: [{', '.join(f'{c:.17f}' for c in centre)}], inertia: {{{inertia}}}}}"
    oracle = Oracle.of(Robot.from_text(arm.replace("LAST", heavy)))
    for t in (0.1, 0.5, 0.83):
        expected = oracle.evaluate("inverse_dynamics", *motion(t))
        assert motion.torques(t) == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_curves_are_derived_exactly() -> None:
    motion = Motion.from_text(
        "robot: planar-2r-perugia\ncurves: {q1: pi/4*sin(2*t), q2: t**2/10 - a1}\ntime: 5\nvalues: {a1: 1/3}\n"
    )
    t = np.linspace(0, 5, 9)
    q, qd, qdd = motion(t)
    assert q == pytest.approx(np.stack([np.pi / 4 * np.sin(2 * t), t**2 / 10 - 1 / 3], axis=1), abs=1e-14)
    assert qd == pytest.approx(np.stack([np.pi / 2 * np.cos(2 * t), t / 5], axis=1), abs=1e-14)
    assert qdd == pytest.approx(np.stack([-np.pi * np.sin(2 * t), np.full(9, 0.2)], axis=1), abs=1e-14)


def test_torques_without_links_are_refused_and_samples_end_with_the_motion() -> None:
    motion = Motion.from_text("robot: stanford-deluca\ncurves: {q1: t}\ntime: 1\n")
    with pytest.raises(QuantityError, match="has no dynamics"):
        motion.torques(0.0)
    text = PICK_AND_PLACE.replace("sample: 0.01", "sample: 0.7")
    times = Motion.from_text(text).times
    assert times[-1] == 15
    assert (np.diff(times) > 0).all()
    assert times[-2] == pytest.approx(14.7)


def test_a_segment_ends_before_the_next_one_begins_whatever_its_times_round_to() -> None:
    """0.78 s + 1.54 s is beyond 2.32 s in floats, where the acceleration of cubics jumps."""
    motion = Motion.from_text(
        "robot: {name: p, convention: standard, gravity: [0, -9.81, 0], links: [{mass: 1}],\n"
        "  joints: [{type: revolute, a: 1}]}\n"
        "profile: cubic\n"
        "points: {a: [0], b: [1]}\n"
        "path: [a, {to: b, time: 0.78}, {to: b, time: 1.54}, {to: a, time: 0.42}]\n"
    )
    (load,) = motion.peaks[1].loads
    assert load.peak == pytest.approx(9.81 * np.cos(1), rel=1e-12)
    assert load.rms == pytest.approx(load.peak, rel=1e-12)
    assert load.work == 0


def test_numbers_of_the_plan_stand_for_those_of_the_robot_everywhere() -> None:
    """A pendulum of 2 kg instead of 1, 3 m long instead of 1, as it is where the robot file itself says so."""
    text = """robot: {name: pendulum, convention: standard, gravity: [0, -9.81, 0], parameters: {m: MASS, l: LENGTH},
  joints: [{type: revolute, a: l}], links: [{mass: m}]}
points: {a: [0], b: [1]}
path: [a, {to: b, time: 1}]
friction: none
"""
    given = Motion.from_text(text.replace("MASS", "2").replace("LENGTH", "3"))
    changed = Motion.from_text(text.replace("MASS", "1").replace("LENGTH", "1") + "values: {m: 2*l, l: 3}\n")
    assert changed.torques(0.0) == pytest.approx([2 * 9.81 * 3])
    t = np.linspace(0, 1, 20)
    assert changed.torques(t) == pytest.approx(given.torques(t), rel=1e-12)
    assert changed.simulate().q == pytest.approx(given.simulate().q, abs=1e-10)


def test_poses_are_those_of_the_end_effector_and_move_with_their_base(pick_and_place: Motion) -> None:
    times = np.array([[0.0, 3.0], [4.5, 9.9]])
    oracle = Oracle.of(Robot.load("scara-matlab"))
    expected = [[oracle.evaluate("forward_kinematics", pick_and_place(t)[0]) for t in row] for row in times]
    assert pick_and_place.poses(times) == pytest.approx(np.array(expected), abs=1e-14)
    assert pick_and_place.poses(3.0)[:3, 3] == pytest.approx([-2, 2, -1], abs=1e-14)
    motion = Motion.from_text(
        "robot: {name: p, convention: standard, joints: [{type: revolute, a: 2}]}\n"
        "curves: {q1: t}\ntime: 2\nbase: {x: 3*t, rpy: [0, 0, t]}\n"
    )
    for t, pose in zip((0.5, 1.5), motion.poses(np.array([0.5, 1.5])), strict=True):
        assert pose[:2, 3] == pytest.approx([3 * t + 2 * np.cos(2 * t), 2 * np.sin(2 * t)], abs=1e-14)
    assert motion.poses(1.5) == pytest.approx(pose, abs=1e-14)
