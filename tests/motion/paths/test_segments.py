"""From steps to segments: times by limits, what is passed, and what is refused."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np
import pytest
from sympy import Expr, Integer, Rational, pi, sqrt

from derive.errors import RobotFileError
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.motion.curves.limits import Limits
from derive.motion.curves.trajectory import Corner
from derive.motion.motion import Motion
from derive.motion.paths.segments import trajectory_of
from derive.robot.expression import Expression
from tests.motion.random_arms import cells, points
from tests.random_robots import seeds

ARM = "robot: {name: arm, convention: standard, joints: [{type: revolute, a: 1SPEED}, {type: revolute, a: 1}]}\n"
POINTS = "points: {a: [0, 0], b: [pi, 1], c: [2, -1], d: [1, 1/2]}\n"
PLAN = ARM + POINTS


def motion(text: str, speed: str = "") -> Motion:
    return Motion.from_text(PLAN.replace("SPEED", speed) + text)


def largest(found: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Largest speeds and accelerations of the whole motion, at many times."""
    _, qd, qdd = found(np.linspace(0, found.duration, 20011))
    return np.abs(qd).max(axis=0), np.abs(qdd).max(axis=0)


def test_the_slowest_joint_sets_the_time_of_a_trapezoid_and_the_others_follow() -> None:
    found = motion("profile: trapezoidal\nspeed: [1, 2]\nacceleration: [2, 1]\npath: [a, b]\n")
    assert found.trajectory.duration == pi + Rational(1, 2)  # D/V + V/A of joint 1
    speeds, accelerations = largest(found)
    assert (speeds[0], accelerations[0]) == pytest.approx((1, 2), rel=1e-12)
    assert speeds[1] < 2
    assert accelerations[1] < 1
    assert found(found.duration)[0] == pytest.approx([np.pi, 1], abs=1e-15)


def test_a_short_trapezoid_has_no_constant_speed() -> None:
    found = motion("profile: trapezoidal\nspeed: [10, 10]\nacceleration: [2, 8]\npath: [a, b]\n")
    assert (found.trajectory.duration - 2 * sqrt(pi / 2)).equals(0)
    assert len(found.trajectory.segments[0].joints[0]) == 2
    assert largest(found)[1] == pytest.approx([2, 2 / np.pi], rel=1e-9)


def test_a_trapezoid_with_a_chosen_cruise_keeps_to_the_limits() -> None:
    text = "profile: trapezoidal\nspeed: [1, 9]\nacceleration: [9, 9]\npath: [a, {to: b, cruise: 1.2}]\n"
    found = motion(text)
    assert (found.trajectory.duration - 6 * pi / 5).equals(0)
    assert largest(found)[0][0] == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("profile", ["cubic", "quintic", "septic", "harmonic"])
def test_profiles_reach_one_limit_and_exceed_none(profile: str) -> None:
    found = motion(f"profile: {profile}\nspeed: [2, 2]\nacceleration: [3, 3]\npath: [a, b, c, d]\n")
    for segment in found.trajectory.segments:
        _, qd, qdd = found(float(segment.start) + np.linspace(1e-9, float(segment.duration) - 1e-9, 5001))
        assert max(np.abs(qd).max() / 2, np.abs(qdd).max() / 3) == pytest.approx(1, abs=1e-6)


def test_the_speed_of_the_robot_file_is_the_default() -> None:
    assert motion("profile: cubic\npath: [a, b]\n", ", speed: 2").trajectory.duration == 3 * pi / 4
    text = "profile: cubic\nspeed: [1, 9]\npath: [a, b]\n"
    assert motion(text, ", speed: 2").trajectory.duration == 3 * pi / 2


@pytest.mark.parametrize("way", ["profile: spline", "profile: cubic\nvia: pass", "profile: quintic\nvia: pass"])
def test_what_is_passed_keeps_to_its_limits_and_stays_exact(way: str) -> None:
    found = motion(f"{way}\nspeed: [2, 2]\nacceleration: [3, 3]\npath: [a, b, c, d]\n")
    speeds, accelerations = largest(found)
    assert max(*speeds / 2, *accelerations / 3) == pytest.approx(1, abs=1e-4)
    assert max(*speeds / 2, *accelerations / 3) <= 1
    assert all(segment.duration.is_Rational for segment in found.trajectory.segments)
    for segment, point in zip(found.trajectory.segments, ([np.pi, 1], [2, -1], [1, 0.5]), strict=True):
        assert found(float(segment.start + segment.duration))[0] == pytest.approx(point, abs=1e-12)


def test_a_line_takes_the_time_that_its_joints_need() -> None:
    text = """robot: {name: arm, convention: standard, joints: [{type: revolute, a: 1}, {type: revolute, a: 1}],
      inverse: {task: [x, y]}}
points: {a: [0.3, 1], b: [1, 0.9]}
path: [a, {to: b, line: yes}]
speed: [0.7, 5]
acceleration: [20, 20]
"""
    found = Motion.from_text(text)
    assert largest(found)[0][0] == pytest.approx(0.7, rel=1e-5)
    assert largest(found)[0][0] <= 0.7
    slower = Motion.from_text(text.replace("line: yes", f"line: yes, time: {found.duration:.6f}"))
    t = np.linspace(0, found.duration, 50)
    assert slower(t)[0] == pytest.approx(found(t)[0], abs=1e-9)


def test_no_move_takes_a_second() -> None:
    found = motion("speed: [1, 1]\npath: [a, a, b]\n")
    assert found.trajectory.segments[0].duration == 1


class Told:
    """An arm that is told where its points are, and has no limits."""

    limits = Limits((None, None), (None, None), (None, None))

    def exact(self, value: Expression) -> Expr:
        return expression_to_sympy(value)

    def configuration(self, name: str, before: Corner | None) -> Corner:
        return {"a": (Integer(0), Integer(0)), "b": (pi, Integer(1)), "c": (Integer(2), Integer(-1))}[name]


def test_segments_follow_one_another_through_the_points_of_the_arm() -> None:
    plan = motion("path: [a, {to: b, time: 1}, {to: c, time: 2}]\n").plan
    found = trajectory_of(plan, Told())  # type: ignore[arg-type]
    assert [(segment.name, segment.start, segment.duration) for segment in found.segments] == [
        ("a -> b", 0, 1),
        ("b -> c", 1, 2),
    ]
    assert found(np.array([0.0, 1, 3]))[0].tolist() == [[0, 0], [np.pi, 1], [2, -1]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("path: [a, b]\n", r"<text>:3:\d+: no time from here to b; write \{to: ..., time: 3\}, or speed: and acc"),
        (
            "profile: trapezoidal\npath: [a, {to: b, time: 2, cruise: 3}]\n",
            r"<text>:4:\d+: cruise 3 of the trapezoid to b; allowed: above 1, and 2 at most: a speed V with "
            r"D/T < V <= 2 D/T, here 1.5708 < V <= 3.14159",
        ),
        ("profile: trapezoidal\npath: [a, {to: b, time: 2, cruise: 1}]\n", r"cruise 1 of the trapezoid"),
        ("profile: trapezoidal\nspeed: [1, 1]\npath: [a, {to: b, cruise: 0.5}]\n", r"allowed: above 1, and 2 at most$"),
        (
            "profile: trapezoidal\nvia: pass\npath: [a, {to: b, time: 1}, {to: c, time: 1}]\n",
            r"<text>:5:\d+: a trapezoidal motion stops at its points, and b is passed; write via: stop, or a profile",
        ),
        (
            "profile: spline\nspeed: [1, 1]\npath: [a, {to: b, time: 1}, c]\n",
            r"no time from here to c; write a time for each segment between two stops, or for none",
        ),
        ("path: [a, {to: b, time: 1, line: yes, profile: spline}]\n", r"a line to b is no spline"),
    ],
)
def test_what_has_no_time_is_refused_with_its_place(text: str, message: str) -> None:
    with pytest.raises(RobotFileError) as caught:
        _ = motion(text).trajectory
    assert re.search(message, str(caught.value))
    assert caught.value.exit_status == 2


def test_accelerations_jump_where_trapezoids_and_cubics_begin_and_end() -> None:
    """A trapezoid of 3 s from 1 s on speeds up and slows down for 1 s each; quintics go on without a jump."""
    path = "[a, {to: b, time: 1}, {to: c, time: 3, profile: trapezoidal}, {to: d, time: 1}, {to: a, time: 1}]"
    assert motion(f"path: {path}\n").trajectory.jumps == (1, 2, 3, 4)


@pytest.mark.parametrize("seed", seeds(200, usual=0))
def test_random_plans_reach_a_limit_exceed_none_and_pass_without_a_gap(seed: int) -> None:
    random = np.random.default_rng(seed)
    n, count = int(random.integers(1, 5)), int(random.integers(2, 6))
    profile = str(random.choice(["trapezoidal", "cubic", "quintic", "septic", "harmonic", "spline"]))
    passes = profile == "spline" or (profile in {"cubic", "quintic", "septic"} and random.random() < 0.5)
    bounds = [np.round(random.uniform(0.3, 3, n), 6), np.round(random.uniform(0.5, 20, n), 6)]
    given = [True, random.random() < 0.8] if random.random() < 0.8 else [False, True]
    joints = ", ".join(f"{{type: {random.choice(['revolute', 'prismatic'])}}}" for _ in range(n))
    lines = [
        f"{key}: [{cells(b)}]\n" for key, b, has in zip(("speed", "acceleration"), bounds, given, strict=True) if has
    ]
    text = (
        f"robot: {{name: arm, convention: standard, joints: [{joints}]}}\n"
        + points(random, n, "abcdef"[:count])
        + f"profile: {profile}\n{'via: pass' if passes and profile != 'spline' else 'sample: 0.01'}\n"
        + f"path: [{', '.join('abcdef'[:count])}]\n"
        + "".join(lines)
    )
    found = Motion.from_text(text)
    segments = found.trajectory.segments
    for run in [segments] if passes else [(segment,) for segment in segments]:
        start, end = float(run[0].start), float(run[-1].start + run[-1].duration)
        edges = np.unique([float(piece.start) for s in run for track in s.joints for piece in track])
        t = np.concatenate([np.linspace(start, end, 10001), edges + 1e-9, edges - 1e-9])
        _, qd, qdd = found(t[(t > start) & (t < end)])
        used = [np.abs(v / b).max() for v, b, has in zip((qd, qdd), bounds, given, strict=True) if has]
        assert max(used) == pytest.approx(1, abs=5e-3)
        assert max(used) <= 1 + 1e-9
    for before, after in pairwise(segments):
        for first, second in zip(before.joints, after.joints, strict=True):
            assert first[-1].values[1] == second[0].values[0]  # type: ignore[union-attr]
