"""Segments between points, poses among them, singular places, and paths q(s) with motions along them."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from sympy import Float, Integer, Rational, pi, sqrt

from derive.errors import RobotFileError
from derive.motion.curves.trajectory import Trajectory
from derive.motion.motion import Motion
from derive.motion.paths.fastest import INTERVALS, Nodes, grid_of, smooth_path
from derive.motion.paths.hand import Hand
from derive.motion.paths.poses import Way, rotation_of, rotation_vector, usual_rank, vanishing_factor
from derive.motion.paths.segments import trajectory_of
from derive.motion.torques.functions import Functions
from derive.robot.robot import Robot
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


def test_trapezoids_keep_to_the_limits_where_they_are_short_or_their_cruise_is_chosen() -> None:
    found = motion("profile: trapezoidal\nspeed: [10, 10]\nacceleration: [2, 8]\npath: [a, b]\n")
    assert (found.trajectory.duration - 2 * sqrt(pi / 2)).equals(0)
    assert len(found.trajectory.segments[0].joints[0]) == 2
    assert largest(found)[1] == pytest.approx([2, 2 / np.pi], rel=1e-9)
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


def test_the_speed_of_the_robot_file_is_the_default_and_no_move_takes_a_second() -> None:
    assert motion("profile: cubic\npath: [a, b]\n", ", speed: 2").trajectory.duration == 3 * pi / 4
    text = "profile: cubic\nspeed: [1, 9]\npath: [a, b]\n"
    assert motion(text, ", speed: 2").trajectory.duration == 3 * pi / 2
    found = motion("speed: [1, 1]\npath: [a, a, b]\n")
    assert found.trajectory.segments[0].duration == 1


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


def test_segments_follow_one_another_through_their_points() -> None:
    made = motion("path: [a, {to: b, time: 1}, {to: c, time: 2}]\n")
    segments = trajectory_of(made.plan, Hand(made.plan, made.values, made._exact, made._loaded)).segments
    spans = [(segment.name, segment.start, segment.duration) for segment in segments]
    assert spans == [("a -> b", 0, 1), ("b -> c", 1, 2)]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("path: [a, b]\n", r"<text>:3:\d+: no time from here to b; write \{to: ..., time: 3\}, or speed: and acc"),
        ("profile: trapezoidal\npath: [a, {to: b, time: 2, cruise: 3}]\n", r":4:\d+: cruise 3 .* 1.5708 < V <= 3.1"),
        ("profile: trapezoidal\npath: [a, {to: b, time: 2, cruise: 1}]\n", r"cruise 1 of the trapezoid"),
        ("profile: trapezoidal\nspeed: [1, 1]\npath: [a, {to: b, cruise: 0.5}]\n", r"allowed: above 1, and 2 at most$"),
        ("profile: trapezoidal\nvia: pass\npath: [a, {to: b, time: 1}, {to: c, time: 1}]\n", r":5:\d+: .* b is passed"),
        ("profile: spline\nspeed: [1, 1]\npath: [a, {to: b, time: 1}, c]\n", r"to c; write a time for each"),
        ("path: [a, {to: b, time: 1, line: yes, profile: spline}]\n", r"a line to b is no spline"),
    ],
)
def test_what_has_no_time_is_refused_with_its_place(text: str, message: str) -> None:
    with pytest.raises(RobotFileError, match=message):
        _ = motion(text).trajectory


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


def pose(seed: int) -> np.ndarray:
    random, found = np.random.default_rng(seed), np.eye(4)
    found[:3, :3], found[:3, 3] = rotation_of(random.normal(size=3)), random.normal(size=3)
    return found


@pytest.mark.parametrize("angle", [0, 1e-12, 1e-7, 1e-3, 1, 3, np.pi - 1e-7, np.pi])
def test_a_rotation_is_that_of_its_vector(angle: float) -> None:
    for seed in range(5):
        axis = np.random.default_rng(seed).normal(size=3)
        rotation = rotation_of(angle * axis / np.linalg.norm(axis))
        assert rotation @ rotation.T == pytest.approx(np.eye(3), abs=1e-14)
        assert np.linalg.norm(rotation_vector(rotation)) == pytest.approx(angle, abs=1e-7)
        assert rotation_of(rotation_vector(rotation)) == pytest.approx(rotation, abs=2e-7 if angle > 3.1 else 1e-14)


def test_an_arc_goes_through_three_positions_on_a_circle_and_none_through_a_line() -> None:
    a, middle, b = pose(3), pose(4), pose(5)
    way = Way.arc(a, middle, b)
    assert way.pose(0) == pytest.approx(a, abs=1e-13)
    assert way.pose(1) == pytest.approx(b, abs=1e-13)
    places = np.array([way.place(s)[0] for s in np.linspace(0, 1, 20001)])
    assert np.linalg.norm(places - middle[:3, 3], axis=1).min() < 1e-3
    lengths = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert lengths.max() == pytest.approx(lengths.min(), rel=1e-8)
    way, h = Way.arc(pose(3), pose(4), pose(5)), 1e-4
    for s in (0.1, 0.6):
        before, here, after = (way.place(s + d)[0] for d in (-h, 0, h))
        _, tangent, bend = way.place(s)
        assert tangent == pytest.approx((after - before) / (2 * h), rel=1e-5, abs=1e-6)
        assert bend == pytest.approx((after - 2 * here + before) / h**2, rel=1e-4, abs=1e-4)
    a, b, middle = pose(1), pose(2), pose(1)
    middle[:3, 3] = (a[:3, 3] + b[:3, 3]) / 2
    with pytest.raises(ValueError, match="on one line"):
        Way.arc(a, middle, b)


LINE = """
robot: {robot}
points:
  a: {start}
  b: {{pose: {{p: {place}, rpy: [pi, 0, 0]}}}}
path: [a, {{to: b, time: 1, line: yes}}]
"""


def test_the_rank_is_that_of_places_that_are_not_singular() -> None:
    functions = Functions(Robot.load("scara-matlab"), frozenset({"jacobian"}), {})
    assert usual_rank(functions, range(6)) == 4
    assert usual_rank(functions, range(3)) == 3
    assert usual_rank(functions, (3, 4)) == 0


@pytest.mark.parametrize(
    ("q", "factor"), [((0.3, 0.2, 0.1, 0, 1e-9, 0), "sin(q5)"), ((0.3, 0.2, 1.6178, 0, 1, 0), "q3")]
)
def test_the_factor_nearest_to_zero_is_named(q: tuple[float, ...], factor: str) -> None:
    robot = Robot.load("puma560-corke")
    numbers = {name: float(value.value) for name, value in robot.parameters}
    assert factor in vanishing_factor(robot, numbers, np.array(q))


def test_a_line_that_begins_at_a_singular_configuration_is_refused_and_one_beside_it_is_followed() -> None:
    text = LINE.format(robot="scara-matlab", start="[0, 0, 1, 0]", place="[3, 0, -1]")
    with pytest.raises(RobotFileError, match=r"6:11: the way starts at a singular configuration, where sin\(q2\) = 0"):
        Motion.from_text(text)
    text = LINE.format(robot="scara-matlab", start="[0, 0.3, 1, 0]", place="[3, 0.1, -1]")
    assert Motion.from_text(text).duration == 1


def test_the_path_between_two_points_is_straight_and_through_more_it_is_scipys_natural_spline() -> None:
    path = smooth_path(np.array([0.0, 1.0]), np.array([[1.0, 2.0], [3.0, -1.0]]))
    q, slope, bend = path(np.linspace(0, 1, 11))
    assert q == pytest.approx(np.linspace([1, 2], [3, -1], 11), abs=1e-15)
    assert slope == pytest.approx(np.tile([2.0, -3.0], (11, 1)), abs=1e-14)
    assert np.abs(bend).max() < 1e-13
    knots, corners = np.array([0, 0.2, 0.7, 1]), np.array([[0.0, 1], [2, 1], [-1, 1], [3, 1]])
    path, s = smooth_path(knots, corners), np.linspace(0, 1, 101)
    theirs = CubicSpline(knots, corners, bc_type="natural")
    for order in range(3):
        assert path(s)[order] == pytest.approx(theirs(s, order), abs=1e-11)


def test_a_grid_has_the_knots_and_the_places_where_a_joint_turns_back() -> None:
    knots, corners = np.array([0, 0.5, 1]), np.array([[0.0, 0], [1, 1], [0, 2]])
    path = smooth_path(knots, corners + np.array([[0, 0], [0.2, 0], [0.1, 0]]))
    grid = grid_of(path, knots)
    assert (np.diff(grid) > 0).all()
    assert {0.0, 0.5, 1.0} <= set(grid.tolist())
    assert abs(len(grid) - 2 * INTERVALS - 1) <= 2
    turn = grid[np.abs(path(grid)[1][:, 0]).argmin()]
    assert abs(path(float(turn))[1][0]) < 1e-12
    assert turn != 0.5


@pytest.fixture
def nodes() -> Nodes:
    random = np.random.default_rng(3)
    ends = random.normal(size=(4, 2, 3, 2))
    ends[1:, 0, 0], ends[..., 1:, 1] = ends[:-1, 1, 0], 0
    ends[..., 0, 1] = 5
    return Nodes(np.array([0, 0.5, 0.7, 1.5, 2]), ends)


def test_pieces_are_what_the_nodes_say_and_slower_is_the_same_way_in_more_time(nodes: Nodes) -> None:
    first, second = nodes.pieces(1, 4, {4: (pi, Integer(5))})
    assert len(first) == 3
    assert first[-1].values[1][0] == pi  # type: ignore[union-attr]
    assert len(second) == 1
    assert second[0].values[1] == (Float(5), 0, 0)  # type: ignore[union-attr]
    whole = Trajectory.of(nodes.pieces(0, 4, {}))
    for place in (0.1, 0.8):
        times = nodes.times[:-1] + place * np.diff(nodes.times)
        for found, expected in zip(whole(times), nodes.inside(np.array([place])), strict=True):
            assert found == pytest.approx(expected[:, 0], rel=1e-9, abs=1e-9)
    u = np.linspace(0, 1, 5)
    fast, slow = nodes.inside(u), nodes.slower(3).inside(u)
    for order in range(3):
        assert slow[order] == pytest.approx(fast[order] / 3**order, abs=1e-12)
    assert nodes.slower(3).times[-1] == 6
