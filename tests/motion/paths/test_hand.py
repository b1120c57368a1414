"""Curves of the hand: lines, arcs and splines."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from sympy import Integer, pi

from derive.errors import DeriveError, QuantityError, RobotFileError
from derive.handouts.assemble import context_of
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.solve import solve
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.model.model import Model
from derive.motion.motion import Motion
from derive.motion.output.page import plan_part
from derive.motion.paths.hand import Hand
from derive.motion.paths.poses import angular_motion, rotation_of, spline_way
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle

LINES = """\
robot: puma560-corke
points:
  a: [17, 30, -11, 23, 34, 6]
  b: {pose: {p: [0.4, -0.3, 0.3], rpy: [6, 115, 17]}}
  c: {pose: {p: [0.5, -0.1, 0.2], rpy: [6, 126, 17]}}
  d: {pose: {p: [0.45, -0.2, 0.3], rpy: [0, 115, 0]}}
path: [a, {to: b, time: 1}, {to: c, time: 2, line: yes}, {to: b, time: 1, through: d}]
"""


@pytest.fixture(scope="module")
def lines() -> Motion:
    return Motion.from_text(LINES)


def poses(motion: Motion, times: np.ndarray) -> np.ndarray:
    oracle = Oracle.of(Robot.load("puma560-corke"))
    return np.array([oracle.evaluate("forward_kinematics", q) for q in motion(times)[0]])


def test_a_pose_is_where_the_end_effector_is(lines: Motion) -> None:
    cx, sx, cy, sy, cz, sz = (f(angle) for angle in np.deg2rad([6, 115, 17]) for f in (np.cos, np.sin))
    roll = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    pitch = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    yaw = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    found = poses(lines, np.array([1.0, 4.0]))
    for there in found:
        assert there[:3, :3] == pytest.approx(yaw @ pitch @ roll, abs=1e-10)
        assert there[:3, 3] == pytest.approx([0.4, -0.3, 0.3], abs=1e-10)


def test_the_end_effector_stays_on_the_line_with_the_profile_along_it_and_on_the_circle(lines: Motion) -> None:
    times = np.linspace(1, 3, 401)
    found, u = poses(lines, times), np.linspace(0, 1, 401)
    fraction = 10 * u**3 - 15 * u**4 + 6 * u**5
    start, way = np.array([0.4, -0.3, 0.3]), np.array([0.1, 0.2, -0.1])
    assert found[:, :3, 3] == pytest.approx(start + fraction[:, None] * way, abs=1e-8)
    places = poses(lines, np.linspace(3, 4, 201))[:, :3, 3]
    a, middle, b = np.array([0.5, -0.1, 0.2]), np.array([0.45, -0.2, 0.3]), np.array([0.4, -0.3, 0.3])
    normal = np.cross(middle - a, b - a)
    assert np.abs((places - a) @ normal).max() < 1e-9
    bisectors = np.array([middle - a, b - a, normal])
    centre = np.linalg.solve(bisectors, [(middle - a) @ (middle + a) / 2, (b - a) @ (b + a) / 2, normal @ a])
    radii = np.linalg.norm(places - centre, axis=1)
    assert radii == pytest.approx(np.full(201, radii[0]), abs=1e-8)
    t, h = np.linspace(1.1, 2.9, 50), 1e-5
    before, _, after = (lines(t + d)[0] for d in (-h, 0, h))
    assert (after - before) / (2 * h) == pytest.approx(lines(t)[1], abs=1e-7)


def test_poses_out_of_reach_and_lines_that_cannot_be_followed_are_refused_at_their_place() -> None:
    text = LINES.replace("[0.5, -0.1, 0.2]", "[5, -0.1, 0.2]")
    with pytest.raises(RobotFileError, match=r"<text>:5:\d+: the arm does not reach c"):
        _ = Motion.from_text(text.replace("line: yes", "via: stop")).trajectory
    with pytest.raises(RobotFileError, match=r"does not reach the way|singular"):
        _ = Motion.from_text(text).trajectory
    text = "robot: puma560-corke\npoints: {a: [0, 30, 10, 5, 0, 5], b: [5, 30, 10, 5, 5, 5]}\n"
    with pytest.raises(RobotFileError, match=r"starts at a singular configuration, where sin\(q5\) = 0"):
        _ = Motion.from_text(text + "path: [a, {to: b, time: 1, line: yes}]\n").trajectory


@pytest.mark.parametrize("branch", ["shoulder left, elbow up, wrist flipped", "Shoulder  right"])
def test_a_branch_is_chosen_by_its_name_or_words_of_it(branch: str) -> None:
    text = LINES.replace("rpy: [6, 115, 17]}", f"rpy: [6, 115, 17]}}, branch: '{branch}'")
    q = Motion.from_text(text.replace(", line: yes", "").replace(", through: d", ""))(1.0)[0]
    robot = Robot.load("puma560-corke")
    solver = InverseSolver.of(robot, solve(robot))
    (pose,) = poses(Motion.from_text(text), np.array([1.0]))
    names = [solution.name for solution in Model(robot).inverse.solutions]
    distances = np.abs(np.exp(1j * solver.solve(pose).q) - np.exp(1j * q)).max(axis=1)
    name = names[int(np.nanargmin(distances))]
    assert np.nanmin(distances) < 1e-8
    assert {part.strip().lower() for part in " ".join(branch.split()).split(",")} <= set(name.split(", "))


@pytest.mark.parametrize(
    ("branch", "message"),
    [
        ("elbow sideways", "point b: no branch 'elbow sideways' of puma560-corke; allowed: shoulder right, .*; or"),
        ("elbow down", "the arm does not reach b within its limits with branch 'elbow down'"),
    ],
)
def test_a_branch_that_there_is_not_is_refused(branch: str, message: str) -> None:
    text = LINES.replace("rpy: [6, 115, 17]}", f"rpy: [6, 115, 17]}}, branch: '{branch}'")
    with pytest.raises(RobotFileError, match=f":4:3: {message}"):
        _ = Motion.from_text(text).trajectory


BRANCHES = """\
robot:
  name: arm
  convention: standard
  inverse: {task: position}
  joints: [{type: revolute, d: 0.5, alpha: pi/2}, {type: revolute, a: 1}, {type: revolute, a: 0.8}]
points:
  a: [0, 0.5, -1]
  b: {pose: {p: [1.2, 0.4, 0.6]}BRANCH}
  c: {pose: {p: [1.0, 0.5, 0.9]}PASSED}
  unused: {pose: {p: [1.0, 0.5, 0.9]}OTHER}
"""

LINE, ARC = "path: [a, {to: b, time: 1, line: yes}]\n", "path: [a, {to: b, time: 1, through: c}]\n"
SPLINE = "profile: spline\nspline: hand\npath: [a, {to: c, time: 1}, {to: b, time: 1}]\n"
NOT_DOWN = r"the way to b comes to {} on branch 'shoulder left, elbow up', not 'elbow down'.* after \d+% of it"


@pytest.mark.parametrize(
    ("path", "point", "branch", "message"),
    [
        *((path, "BRANCH", "Elbow  up", "") for path in (LINE, ARC, SPLINE)),
        *((path, "BRANCH", "elbow down", f":1[0-9]:.*{NOT_DOWN.format('b')}") for path in (LINE, ARC, SPLINE)),
        *((path, "BRANCH", "banana", r":8:3: point b: no branch 'banana' of arm; allowed") for path in (LINE, ARC)),
        (ARC, "PASSED", "elbow up", ""),
        (ARC, "PASSED", "elbow down", NOT_DOWN.format("c")),
        (SPLINE, "PASSED", "elbow up", ""),
        (SPLINE, "PASSED", "elbow down", "the way to c comes to c on branch 'shoulder left, elbow up'"),
        (LINE, "PASSED", "banana", r":9:3: point c: no branch 'banana'"),
        (LINE, "OTHER", "banana", r":10:3: point unused: no branch 'banana'"),
        (LINE, "OTHER", "", r":10:\d+: points, unused, branch: found nothing; leave it out"),
    ],
)
@pytest.mark.first(1)
def test_the_branch_of_a_point_on_a_way_is_kept_or_refused(path: str, point: str, branch: str, message: str) -> None:
    text = BRANCHES.replace(f"}}{point}", f"}}, branch: '{branch}'")
    for other in ("BRANCH", "PASSED", "OTHER"):
        text = text.replace(f"}}{other}", "}")
    if message:
        with pytest.raises(RobotFileError, match=message):
            Motion.from_text(text + path)
    else:
        assert Motion.from_text(text + path)(1.0)[0][2] < 0, "the elbow bends one way"


def test_points_in_joint_variables_stay_exact_and_need_numbers_for_symbols(lines: Motion) -> None:
    text = "robot: planar-2r-perugia\npoints: {a: [0, 1], b: {pose: {p: [1, 0.3, 0]}}}\npath: [a, {to: b, time: 1}]\n"
    with pytest.raises(QuantityError, match=r"the symbol 'a1' .*has no number; write values: \{a1: ...\} in the plan"):
        assert Motion.from_text(text).trajectory
    hand = Hand(lines.plan, lines.values, lambda cells: tuple(map(expression_to_sympy, cells)), lambda *_: np.zeros(6))
    assert hand.configuration("a", None)[0] == 17 * pi / 180


def test_a_trapezoid_along_a_line_has_its_corners_where_it_has_them() -> None:
    """The hand speeds up, goes on and slows down for a third of the time each; no acceleration is beyond."""
    text = LINES.replace("line: yes", "line: yes, profile: trapezoidal")
    motion, times = Motion.from_text(text), np.linspace(1, 3, 181)
    found = poses(motion, times)[:, :3, 3]
    u = (times - 1) / 2
    fraction = np.where(u < 1 / 3, 9 / 4 * u**2, np.where(u <= 2 / 3, 3 / 2 * (u - 1 / 6), 1 - 9 / 4 * (1 - u) ** 2))
    way = np.array([0.1, 0.2, -0.1])
    assert found == pytest.approx(np.array([0.4, -0.3, 0.3]) + fraction[:, None] * way, abs=1e-9)
    largest = np.abs(motion(np.linspace(1, 2.999999, 4000))[2]).max(axis=0)
    peaks = [abs(float(peak.value)) for peak in motion.peaks[1].accelerations]
    assert peaks == pytest.approx(largest, rel=1e-3)


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
    knots, h = np.array([0, 1, 2.5, 3.5]), 1e-5
    assert via.poses(knots)[:, :2, 3] == pytest.approx(PLACES, abs=1e-11)
    assert np.abs(via(knots[[0, -1]])[1]).max() < 1e-12
    t = np.linspace(h, 3.5 - h, 500)
    expected = CubicSpline(knots, PLACES, bc_type="clamped")
    before, p, after = (via.poses(t + step)[:, :2, 3] for step in (-h, 0.0, h))
    assert p == pytest.approx(expected(t), abs=1e-9)
    assert (after - before) / (2 * h) == pytest.approx(expected(t, 1), abs=1e-7)


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
    places = np.array([[0.4, -0.3, 0.3], [0.5, -0.1, 0.2], [0.45, -0.2, 0.35]])
    assert there[:, :3, 3] == pytest.approx(places, abs=1e-10)
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
    text = VIA.replace(", time: 1}", "}").replace(", time: 3/2}", "}")
    motion = Motion.from_text(text.replace("spline: hand", "spline: hand\nspeed: [1, 2]"))
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
    with pytest.raises(DeriveError, match=message):
        _ = Motion.from_text(VIA.replace(old, new)).trajectory
