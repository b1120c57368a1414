"""The end effector on lines and arcs, and poses as points."""

from __future__ import annotations

import numpy as np
import pytest
from sympy import pi

from derive.errors import QuantityError, RobotFileError
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.solve import solve
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.model.model import Model
from derive.motion.motion import Motion
from derive.motion.paths.hand import Hand
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


def test_the_end_effector_stays_on_the_line_with_the_profile_along_it(lines: Motion) -> None:
    times = np.linspace(1, 3, 401)
    found, u = poses(lines, times), np.linspace(0, 1, 401)
    fraction = 10 * u**3 - 15 * u**4 + 6 * u**5
    start, way = np.array([0.4, -0.3, 0.3]), np.array([0.1, 0.2, -0.1])
    assert found[:, :3, 3] == pytest.approx(start + fraction[:, None] * way, abs=1e-8)


def test_the_end_effector_stays_on_the_circle(lines: Motion) -> None:
    places = poses(lines, np.linspace(3, 4, 201))[:, :3, 3]
    a, middle, b = np.array([0.5, -0.1, 0.2]), np.array([0.45, -0.2, 0.3]), np.array([0.4, -0.3, 0.3])
    normal = np.cross(middle - a, b - a)
    assert np.abs((places - a) @ normal).max() < 1e-9
    bisectors = np.array([middle - a, b - a, normal])
    centre = np.linalg.solve(bisectors, [(middle - a) @ (middle + a) / 2, (b - a) @ (b + a) / 2, normal @ a])
    radii = np.linalg.norm(places - centre, axis=1)
    assert radii == pytest.approx(np.full(201, radii[0]), abs=1e-8)


def test_velocities_are_derivatives_of_positions_on_a_line(lines: Motion) -> None:
    t, h = np.linspace(1.1, 2.9, 50), 1e-5
    before, _, after = (lines(t + d)[0] for d in (-h, 0, h))
    assert (after - before) / (2 * h) == pytest.approx(lines(t)[1], abs=1e-7)


def test_a_pose_out_of_reach_is_refused_at_its_place() -> None:
    text = LINES.replace("[0.5, -0.1, 0.2]", "[5, -0.1, 0.2]")
    with pytest.raises(RobotFileError, match=r"<text>:5:\d+: the arm does not reach c"):
        _ = Motion.from_text(text.replace("line: yes", "via: stop")).trajectory


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
        (
            "elbow sideways",
            r":4:3: point b: no branch 'elbow sideways' of puma560-corke; allowed: shoulder right, .*; or",
        ),
        (
            "elbow down",
            r":4:3: the arm does not reach b within its limits with branch 'elbow down'; with another branch it does",
        ),
    ],
)
def test_a_branch_that_there_is_not_is_refused(branch: str, message: str) -> None:
    text = LINES.replace("rpy: [6, 115, 17]}", f"rpy: [6, 115, 17]}}, branch: '{branch}'")
    with pytest.raises(RobotFileError, match=message):
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
def test_the_branch_of_a_point_on_a_way_of_the_hand_is_kept_or_refused(
    path: str, point: str, branch: str, message: str
) -> None:
    text = BRANCHES.replace(f"}}{point}", f"}}, branch: '{branch}'")
    for other in ("BRANCH", "PASSED", "OTHER"):
        text = text.replace(f"}}{other}", "}")
    if message:
        with pytest.raises(RobotFileError, match=message):
            Motion.from_text(text + path)
    else:
        assert Motion.from_text(text + path)(1.0)[0][2] < 0, "the elbow bends one way"


def test_a_line_that_leaves_the_workspace_is_refused() -> None:
    text = LINES.replace("[0.5, -0.1, 0.2]", "[5, -0.1, 0.2]")
    with pytest.raises(RobotFileError, match=r"does not reach the way|singular"):
        _ = Motion.from_text(text).trajectory


def test_a_line_from_a_singular_configuration_is_refused() -> None:
    text = "robot: puma560-corke\npoints: {a: [0, 30, 10, 5, 0, 5], b: [5, 30, 10, 5, 5, 5]}\n"
    with pytest.raises(RobotFileError, match=r"starts at a singular configuration, where sin\(q5\) = 0"):
        _ = Motion.from_text(text + "path: [a, {to: b, time: 1, line: yes}]\n").trajectory


def test_a_planar_arm_goes_straight_in_its_task() -> None:
    robot = "{name: arm, convention: standard, inverse: {task: [x, y]}, joints: [JOINT, JOINT]}"
    robot = robot.replace("JOINT", "{type: revolute, a: 1}")
    text = f"robot: {robot}\npoints: {{a: [0.2, 1.2], b: [0.9, 0.8]}}\npath: [a, {{to: b, time: 1, line: yes}}]\n"
    motion = Motion.from_text(text)
    q = motion(np.linspace(0, 1, 101))[0]
    place = np.stack([np.cos(q[:, 0]) + np.cos(q.sum(1)), np.sin(q[:, 0]) + np.sin(q.sum(1))], axis=1)
    way = place[-1] - place[0]
    off = (place - place[0]) @ np.array([-way[1], way[0]])
    assert np.abs(off).max() < 1e-9


def test_a_symbol_without_a_number_is_named_before_a_pose_is_looked_for() -> None:
    text = "robot: planar-2r-perugia\npoints: {a: [0, 1], b: {pose: {p: [1, 0.3, 0]}}}\npath: [a, {to: b, time: 1}]\n"
    with pytest.raises(QuantityError, match=r"the symbol 'a1' .*has no number; write values: \{a1: ...\} in the plan"):
        assert Motion.from_text(text).trajectory


def test_points_in_joint_variables_stay_exact(lines: Motion) -> None:
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
