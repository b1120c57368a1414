"""Fastest motions: closed forms, toppra's own constraints, and that no limit is exceeded anywhere."""

from __future__ import annotations

import re
import sys

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.motion.motion import Motion
from derive.motion.paths.fastest import FastestMotion
from derive.robot.evaluate import evaluate
from tests.motion.random_arms import arm as arm_of
from tests.motion.random_arms import points
from tests.random_robots import seeds

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


def test_friction_is_in_the_torque_and_helps_to_brake() -> None:
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
    for coulomb in ("2", "[2, 0.5]", "[2, 4]"):  # it never moves backwards
        motion = wheel("torque: [5]\n", f"{{coulomb: {coulomb}}}")
        assert motion.duration == pytest.approx(np.sqrt(2 * 2 * (1 / 3 + 1 / 7)), rel=3e-3)


@pytest.mark.first(1)
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


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[FastestMotion]:
    """Whatever is solved, as it was asked for."""
    found: list[FastestMotion] = []
    solve = FastestMotion.solve
    monkeypatch.setattr(FastestMotion, "solve", lambda self: (found.append(self), solve(self))[1])
    return found


def test_its_time_is_toppras(solved: list[FastestMotion]) -> None:
    duration = arm("path: [a, {to: b, via: pass}, c]\n").duration
    assert duration == pytest.approx(sum(map(toppras_time, solved)), rel=0.01)


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


def test_where_joints_stand_they_stand_and_a_line_without_length_for_a_second() -> None:
    motion = arm("path: [a, a, {to: b}]\n")
    assert motion.trajectory.segments[0].duration == 1
    text = ARM.replace("FIRST", "{}").replace("SECOND", "{}").replace("b: [0.4, 1.5]", "b: [0.4, 0.3]")
    joints = Motion.from_text(text + "path: [a, b]\n").trajectory.segments[0].joints
    assert len(joints[0]) > 100
    assert len(joints[1]) == 1
    text = ARM.replace("FIRST", "{}").replace("SECOND", "{}").replace("gravity:", "inverse: {task: [x, y]}, gravity:")
    for profile in ("fastest", "quintic"):
        path = f"profile: {profile}\npath: [b, {{to: b, line: yes}}]\n"
        segment = Motion.from_text(text.replace("profile: fastest\n", "") + path).trajectory.segments[0]
        assert segment.duration == 1
        assert [float(q) for q, *_ in (pieces[0].values[1] for pieces in segment.joints)] == [0.4, 1.5]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (WHEEL, r"<text>:5:\d+: nothing limits the acceleration of the fastest motion; write acceleration: or"),
        (WHEEL + "speed: [1]\n", r"nothing limits the acceleration"),
        (WHEEL + "torque: [0]\n", r"torque.*not above zero"),
        (WHEEL.replace("a, b]", "a, {to: b, time: 2}]") + "torque: [1]\n", r"takes the time that the lim"),
        (WHEEL.replace("[a, b]", "[a, {to: b, via: pass}, b]") + "torque: [1]\n", r"the arm does not move to b"),
        (ARM.replace("[60, 20]", "[20, 20]") + "path: [a, b]\n", r"needs 1\.\d+ times the largest torque 20 of joint"),
        (WHEEL.replace(",\n  links: [{mass: 1, friction: FRICTION}]", "") + "torque: [1]\n", r":5:\d+: .* no dynamics"),
    ],
)
def test_what_has_no_fastest_motion_is_refused_with_its_place(text: str, message: str) -> None:
    with pytest.raises(DeriveError, match=message):
        _ = Motion.from_text(text.replace("FRICTION", "{}").replace("FIRST", "{}").replace("SECOND", "{}")).trajectory


def test_without_toppra_one_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "toppra.algorithm", None)
    with pytest.raises(DeriveError, match=r"needs toppra, which is not installed; .*-m pip install .*'toppra>="):
        _ = wheel("torque: [8]\n").trajectory


PLANAR = """\
robot: {name: arm, convention: standard, gravity: [0, -9.81, 0], inverse: {task: [x, y]},
  joints: [{type: revolute, a: FIRST}, {type: revolute, a: SECOND}],
  links: [{mass: 2, com: [-0.3, 0, 0], inertia: {zz: 0.2}, friction: FRICTION}, {mass: 1, friction: FRICTION}]}
points: {a: [0.3, 1.2], b: [1.0, 0.9], c: [0.6, 1.4]}
"""
WAYS = [
    "[a, b]",
    "[a, {to: b, via: pass}, c]",
    "[a, {to: b, via: pass, payload: 0.8}, {to: c, via: pass}, a]",
    "[a, b, c]",
]
IN_SPACE = ["[a, {to: b, line: yes}]", "[a, {to: b, through: c}]", "[a, {to: b, through: c, payload: 1.5}]"]


def random_plan(seed: int) -> tuple[str, dict[str, np.ndarray]]:
    """A robot, its way, and limits of which some are close to what gravity asks for."""
    random = np.random.default_rng(seed)
    rough = seed % 3 == 0
    if in_space := seed % 5 == 4:
        first, second = random.uniform(0.5, 1, 2).tolist()
        text = PLANAR.replace("FIRST", repr(first)).replace("SECOND", repr(second))
        text, n = text.replace("FRICTION", "{viscous: 1, coulomb: 0.7}" if rough else "{}"), 2
    else:
        n = int(random.integers(2, 8))
        text = arm_of(random, n, rough=rough) + points(random, n, "abc")
    way = str(random.choice(IN_SPACE if in_space else WAYS))
    timed = re.sub(r"\{to: (\w)", r"{to: \1, time: 1", re.sub(r", (\w)(?=[,\]])", r", {to: \1}", way))
    slow = Motion.from_text(text + f"path: {timed}\n")
    q, qd, _ = slow(t := np.linspace(0, slow.duration, 300))
    index = np.full(len(t), len(slow.plan.steps) - 1)
    standing = np.maximum(*(np.abs(slow._loaded(i, q, 0 * q, 0 * q)).max(axis=0) for i in (index, 0 * index)))
    moving = np.abs(slow.torques(t)).max(axis=0)
    most = {
        "torque": standing * random.uniform(1.1, 3, n) + 0.5 * moving + 2 * rough,
        "acceleration": random.uniform(2, 20, n),
        "speed": np.maximum(np.abs(qd).max(axis=0) * random.uniform(0.5, 3, n), 0.1),
    }
    chosen = [key for key in most if random.random() < 0.6] or ["torque"]
    if chosen == ["speed"]:
        chosen.append("acceleration")
    most = {key: np.round(most[key], 6) for key in chosen}
    lines = [f"{key}: [{', '.join(repr(float(value)) for value in most[key])}]\n" for key in chosen]
    return text + "profile: fastest\n" + "".join(lines) + f"path: {way}\n", most


def toppras_time(motion: FastestMotion) -> float:
    """By toppra's own constraints on a uniform grid."""
    from toppra import algorithm, constraint
    from toppra.interpolator import AbstractGeometricPath

    class Geometric(AbstractGeometricPath):  # type: ignore[misc]
        dof = motion.path(0.0)[0].size
        path_interval = np.array([0.0, 1.0])

        def __call__(self, s: np.ndarray, order: int = 0) -> np.ndarray:
            return motion.path(np.clip(s, 0, 1))[order]

    speed, acceleration, torque = (np.minimum(most, 1e8) for most in motion.bounds)

    def inverse(q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
        return motion.torques(motion.steps[:1], q[None], qd[None], qdd[None])[0]

    rows = [
        constraint.JointVelocityConstraint(np.stack([-speed, speed], axis=1)),
        constraint.JointAccelerationConstraint(np.stack([-acceleration, acceleration], axis=1)),
    ]
    if (torque < 1e8).any():
        zero = np.zeros(len(torque))
        rows.append(constraint.JointTorqueConstraint(inverse, np.stack([-torque, torque], axis=1), zero))
    grid = np.linspace(0, 1, 1501)
    rates = algorithm.TOPPRA(rows, Geometric(), gridpoints=grid).compute_parameterization(0, 0)[1]
    return float(np.sum(2 * np.diff(grid) / (rates[1:] + rates[:-1])))


@pytest.mark.parametrize("seed", seeds(60, usual=0))
def test_random_motions_keep_to_their_limits_and_take_toppras_time(seed: int, solved: list[FastestMotion]) -> None:
    text, most = random_plan(seed)
    motion = Motion.from_text(text)
    starts = [float(p.start) for s in motion.trajectory.segments for p in max(s.joints, key=len)]
    edges = np.unique([*starts, motion.duration])
    t = (edges[:-1, None] + np.diff(edges)[:, None] * np.linspace(0, 1, 241)).ravel()
    _, qd, qdd = motion(t)
    values = {"speed": qd, "acceleration": qdd, "torque": motion.torques(t)}
    for key, limit in most.items():
        assert (np.abs(values[key]) - limit).max() <= 1e-9, key
    frictionless = not any(evaluate(link.coulomb, {}) for link in motion.plan.robot.links)
    if frictionless and "payload" not in text:
        expected = sum(map(toppras_time, solved))
        assert motion.duration == pytest.approx(expected, rel=0.01)
