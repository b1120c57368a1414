"""Fastest motions: closed forms, toppra's own constraints, and that no limit is exceeded anywhere."""

from __future__ import annotations

import re
import sys

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.motion.fastest import FastestMotion
from derive.motion.motion import Motion
from derive.motion.paths import grid_of, smooth_path

WHEEL = """\
robot: {name: wheel, convention: standard, gravity: [0, 0, 0], joints: [{type: revolute, a: 1}],
  links: [{mass: 1, friction: FRICTION}]}
profile: fastest
points: {a: [0], b: [2]}
path: [a, b]
"""
"""One joint that turns 1 kg m^2."""

ARM = """\
robot: {name: arm, convention: standard, gravity: [0, -9.81, 0],
  joints: [{type: revolute, a: 1}, {type: revolute, a: 1}],
  links: [{mass: 3, com: [-0.5, 0, 0], inertia: {zz: 0.25}, friction: FIRST},
    {mass: 2, com: [-0.5, 0, 0], inertia: {zz: 0.2}, friction: SECOND}]}
profile: fastest
points: {a: [-pi/2, 0.3], b: [0.4, 1.5], c: [-0.5, -0.8]}
torque: [60, 20]
"""

toppra = pytest.importorskip("toppra")


def wheel(extra: str, friction: str = "{}") -> Motion:
    return Motion.from_text(WHEEL.replace("FRICTION", friction) + extra)


def arm(extra: str, first: str = "{}", second: str = "{}") -> Motion:
    return Motion.from_text(ARM.replace("FIRST", first).replace("SECOND", second) + extra)


def excess(motion: Motion, torque: np.ndarray, speed: float = np.inf) -> float:
    """By how much limits are exceeded at 10 times denser samples than it was made of, and at random ones."""
    pieces = sum(len(max(segment.joints, key=len)) for segment in motion.trajectory.segments)
    random = np.random.default_rng(5).uniform(0, motion.duration, 20_000)
    t = np.append(np.linspace(0, motion.duration, 100 * pieces + 1), random)
    qd = motion(t)[1]
    return float(max((np.abs(motion.torques(t)) - torque).max(), np.abs(qd).max() - speed))


def test_torque_alone_makes_it_speed_up_half_the_time_and_slow_down() -> None:
    """T = 2 sqrt(D I/tau)."""
    motion = wheel("torque: [8]\n")
    assert motion.duration == pytest.approx(2 * np.sqrt(2 * 1 / 8), rel=1e-5)
    assert motion(motion.duration / 2)[0] == pytest.approx(1, rel=1e-3)
    assert motion(motion.duration)[0] == pytest.approx([2], abs=1e-14)
    assert excess(motion, np.array([8])) <= 0


def test_speed_and_acceleration_make_a_trapezoid() -> None:
    """T = D/V + V/A."""
    motion = wheel("speed: [0.8]\nacceleration: [1.6]\n")
    assert motion.duration == pytest.approx(2 / 0.8 + 0.8 / 1.6, rel=2e-4)
    assert np.abs(motion(np.linspace(0, motion.duration, 30_001))[1]).max() <= 0.8


def test_viscous_friction_is_in_the_torque() -> None:
    """With friction d the joint speeds up by (tau/d)(1 - e^{-d t}) and slows down by its mirror image in time."""
    torque, viscous, way = 2.0, 1.5, 2.0

    def times(speed: float) -> tuple[float, float]:
        return -np.log(1 - viscous * speed / torque) / viscous, np.log(1 + viscous * speed / torque) / viscous

    def gone(speed: float) -> float:
        up, down = times(speed)
        first = (torque / viscous) * up - speed / viscous
        return first - (torque / viscous) * down + speed / viscous

    low, high = 0.0, torque / viscous * (1 - 1e-12)
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if gone(middle) < way else (low, middle)
    motion = wheel(f"torque: [{torque}]\n", f"{{viscous: {viscous}}}")
    assert sum(times(low)) <= motion.duration <= 1.005 * sum(times(low))
    assert excess(motion, np.array([torque])) <= 0


def test_dry_friction_helps_to_brake() -> None:
    """Up at tau - f, down at tau + f: T = sqrt(2 D I (1/(tau - f) + 1/(tau + f)))."""
    motion = wheel("torque: [5]\n", "{coulomb: 2}")
    assert motion.duration == pytest.approx(np.sqrt(2 * 2 * (1 / 3 + 1 / 7)), rel=3e-3)


@pytest.mark.parametrize(
    "path", ["[a, b]", "[a, {to: b, via: pass}, {to: c, payload: 0.8}]", "[a, {to: c, payload: 0.5}, b]"]
)
def test_no_limit_is_exceeded_and_one_is_always_reached(path: str) -> None:
    torque = np.array([60, 20])
    motion = arm(f"speed: [5, 7]\npath: {path}\n", "{viscous: 3, coulomb: 1}", "{viscous: 1, coulomb: 0.5}")
    assert excess(motion, torque) <= 1e-9
    t = np.linspace(0, motion.duration, 2002)[1:-1]
    used = np.maximum(np.abs(motion.torques(t)) / torque, np.abs(motion(t)[1]) / [5, 7]).max(axis=1)
    assert np.mean(used > 0.95) > 0.95
    for segment, point in zip(motion.trajectory.segments, motion.plan.steps, strict=True):
        end = float(segment.start + segment.duration)
        corner = {"a": [-np.pi / 2, 0.3], "b": [0.4, 1.5], "c": [-0.5, -0.8]}[point.to]
        assert motion(end)[0] == pytest.approx(corner, abs=1e-12)
    assert not motion.violations


def test_its_time_is_toppras() -> None:
    """Within 1 %, against toppra's own constraint on the torques of this arm and its own grid of 501 places."""
    from toppra import SplineInterpolator, algorithm
    from toppra.constraint import JointTorqueConstraint

    motion = arm("path: [a, {to: b, via: pass}, c]\n")
    corners = np.array([[-np.pi / 2, 0.3], [0.4, 1.5], [-0.5, -0.8]])
    lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    knots = np.array([0, lengths[0] / lengths.sum(), 1])

    def inverse(q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
        return motion._functions("inverse_dynamics", q, qd, qdd)

    bound = JointTorqueConstraint(inverse, np.array([[-60, 60], [-20, 20]]), np.zeros(2))
    path = SplineInterpolator(knots, corners, bc_type="natural")
    theirs = algorithm.TOPPRA([bound], path, gridpoints=np.linspace(0, 1, 501)).compute_trajectory(0, 0)
    assert motion.duration == pytest.approx(theirs.duration, rel=0.01)


def test_a_line_in_space_is_followed_as_fast_as_the_torques_allow() -> None:
    extra = "path: [a, {to: d, line: yes}]\n"
    text = ARM.replace("FIRST", "{}").replace("SECOND", "{}").replace("c: [", "d: {pose: {p: [1.2, -0.6, 0]}}, c: [")
    motion = Motion.from_text(text.replace("gravity:", "inverse: {task: [x, y]}, gravity:") + extra)
    assert excess(motion, np.array([60, 20])) <= 1e-9
    q = motion(np.linspace(0, motion.duration, 101))[0]
    place = np.stack([np.cos(q[:, 0]) + np.cos(q.sum(axis=1)), np.sin(q[:, 0]) + np.sin(q.sum(axis=1))], axis=1)
    way = np.array([1.2, -0.6]) - place[0]
    across = (place - place[0]) @ [-way[1], way[0]] / np.linalg.norm(way)
    assert np.abs(across).max() < 1e-6


def test_where_joints_stand_they_stand() -> None:
    motion = arm("path: [a, a, {to: b}]\n")
    assert motion.trajectory.segments[0].duration == 1
    text = ARM.replace("FIRST", "{}").replace("SECOND", "{}").replace("b: [0.4, 1.5]", "b: [0.4, 0.3]")
    joints = Motion.from_text(text + "path: [a, b]\n").trajectory.segments[0].joints
    assert len(joints[0]) > 100
    assert len(joints[1]) == 1


def test_a_line_without_length_stands_for_a_second() -> None:
    text = ARM.replace("FIRST", "{}").replace("SECOND", "{}").replace("gravity:", "inverse: {task: [x, y]}, gravity:")
    for profile in ("fastest", "quintic"):
        path = f"profile: {profile}\npath: [b, {{to: b, line: yes}}]\n"
        segment = Motion.from_text(text.replace("profile: fastest\n", "") + path).trajectory.segments[0]
        assert segment.duration == 1
        assert [float(q) for q, *_ in (pieces[0].values[1] for pieces in segment.joints)] == [0.4, 1.5]


def test_bounds_by_themselves() -> None:
    """A point on a line: q = s; bounds of acceleration alone."""
    path = smooth_path(np.array([0.0, 1.0]), np.array([[0.0], [1.0]]))
    grid = grid_of(path, np.array([0.0, 1.0]))
    none = np.array([np.inf])
    steps = np.zeros(len(grid) - 1, dtype=int)
    nodes = FastestMotion(path, grid, steps, (none, np.array([4.0]), none), lambda *_: np.zeros(1)).solve()
    assert nodes.times[-1] == pytest.approx(1, rel=1e-5)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (WHEEL, r"<text>:5:\d+: nothing limits the acceleration of the fastest motion; write acceleration: or"),
        (WHEEL + "speed: [1]\n", r"nothing limits the acceleration"),
        (WHEEL + "torque: [0]\n", r"torque.*not above zero"),
        (
            WHEEL.replace("path: [a, b]", "path: [a, {to: b, time: 2}]") + "torque: [1]\n",
            r"takes the time that the lim",
        ),
        (
            WHEEL.replace("[a, b]", "[a, {to: b, via: pass}, b]") + "torque: [1]\n",
            r"the arm does not move to b; leave it out, or write via: stop",
        ),
        (
            ARM.replace("[60, 20]", "[20, 20]") + "path: [a, b]\n",
            r"no motion along this way keeps to the limits; it needs 1\.\d+ times the largest torque 20 of joint 1 to "
            r"stand at q = \(.*\); allow more torque",
        ),
        (
            WHEEL.replace(",\n  links: [{mass: 1, friction: FRICTION}]", "") + "torque: [1]\n",
            r"<text>:5:\d+: torque: wheel has no dynamics; leave it out",
        ),
    ],
)
def test_what_has_no_fastest_motion_is_refused_with_its_place(text: str, message: str) -> None:
    with pytest.raises(DeriveError) as caught:
        _ = Motion.from_text(text.replace("FRICTION", "{}").replace("FIRST", "{}").replace("SECOND", "{}")).trajectory
    assert re.search(message, str(caught.value))
    assert caught.value.exit_status == 2


def test_without_toppra_one_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "toppra.algorithm", None)
    with pytest.raises(
        DeriveError, match=r"needs toppra, which is not installed; pip install 'derive-robot\[motion\]'"
    ):
        _ = wheel("torque: [8]\n").trajectory
