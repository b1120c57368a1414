"""Inverse kinematics as a program: every branch, the angles taken once, nothing lost; a step of damped Newton."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

from derive.algebra.constants import to_float
from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import GraphWalk
from derive.inverse.closed.solve import solve
from derive.programs.formulations.trace import Trace
from derive.programs.inverse import FRAME_ENTRIES, Mask, around, inverse_function, solved
from derive.programs.program import DAMPING, NEAR, POSE, Function, Inverse, InverseSearch
from derive.programs.tape.build import cut
from derive.programs.tape.graph import ONE, ZERO, Graph
from derive.programs.tape.tape import PARAMETER, Op, evaluate
from derive.programs.tape.value import Value, least_squares
from derive.robot.evaluate import parameter_values
from derive.robot.names import free_symbols
from derive.robot.options.inverse import ROWS, Task
from derive.robot.options.solution_policy import POLICY
from derive.robot.robot import Robot
from derive.verification.oracle.frames import NumericArm, forward_kinematics, numeric_arm
from tests.inverse.arms import PUBLISHED, arm_of
from tests.random_robots import swept
from tests.rows import robot_of_rows
from tests.targets.searched_arms import GENERAL, LOOSE, PARAMETERS, robot_of, search_of
from tests.targets.test_inverse import model_of

ARITHMETIC: dict[str, Any] = {
    "number": to_float,
    "sin": np.sin,
    "cos": np.cos,
    "sqrt": np.sqrt,
    "sign": np.sign,
    "atan2": np.arctan2,
    "less": lambda a, b: (a < b) * 1.0,
    "select": np.where,
    "maximum": np.maximum,
    "minimum": np.minimum,
    "absolute": np.abs,
}


@cache
def program_of(name: str) -> tuple[Robot, Inverse]:
    robot = Robot.load(name)
    inverse, reason = solved(Trace(robot))
    assert inverse is not None, reason
    return robot, inverse


def numbers_of(robot: Robot) -> dict[str, float]:
    return {name: 0.3 + 0.13 * k for k, name in enumerate(free_symbols(robot))}


def numeric_arm_of(robot: Robot) -> NumericArm:
    return numeric_arm(robot, numbers_of(robot))


def poses_of(robot: Robot, count: int = 200) -> tuple[np.ndarray, np.ndarray]:
    q = np.random.default_rng(robot.n).uniform(-3, 3, (count, robot.n))
    return q, forward_kinematics(numeric_arm_of(robot), q)


def run(robot: Robot, inverse: Inverse, poses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Joint variables and the status of the branches, straight from the tape, nothing checked."""
    entries = [poses[:, i, j] for i in range(4) for j in range(4)]
    inputs = {POSE: entries, NEAR: [0.0] * robot.n, PARAMETER: list(numbers_of(robot).values())}
    with np.errstate(all="ignore"):
        values = np.array([v + 0.0 * entries[0] for v in evaluate(inverse.function.tape, inputs, ARITHMETIC)])
    size = inverse.branches * inverse.joints
    return values[:size].T.reshape(-1, inverse.branches, inverse.joints), values[size:].T % 4


@pytest.mark.parametrize("name", ["planar-3r", "puma560-corke", pytest.param("thumb", marks=pytest.mark.sweep)])
def test_the_tape_gives_what_the_graph_gives(name: str) -> None:
    robot, inverse = program_of(name)
    q, poses = poses_of(robot)
    found, status = run(robot, inverse, poses)
    rows = [[poses[:, i, j] for j in range(4)] for i in range(3)]
    walk = GraphWalk(solve(robot), FloatField(parameter_values(robot, numbers_of(robot))), rows)
    for branch, leaf in enumerate(walk.leaves()):
        exists = np.broadcast_to(leaf.exists, len(q)) & (status[:, branch] > 0)
        wanted = np.stack(np.broadcast_arrays(*walk.angles(leaf), q[:, 0])[:-1], axis=-1)
        turns = np.exp(1j * found[exists, branch]) - np.exp(1j * wanted[exists])
        assert np.abs(turns).max(initial=0.0) < 1e-7


@pytest.mark.parametrize(
    "name", ["planar-3r", "puma560-corke", "scara-perugia", *swept("kuka-kr5", "stanford-deluca", "thumb")]
)
def test_every_solution_leads_to_its_pose_the_configuration_is_one_and_far_away_there_is_none(name: str) -> None:
    robot, inverse = program_of(name)
    q, poses = poses_of(robot)
    found, status = run(robot, inverse, poses)
    again = forward_kinematics(numeric_arm_of(robot), np.nan_to_num(found))
    errors = np.abs(again - poses[:, None]).max(axis=(2, 3))
    assert errors[status > 0].max() < 1e-10
    turned = np.array([joint.is_revolute for joint in robot.joints])
    difference = np.abs(found - q[:, None])
    angles = np.abs((difference + np.pi) % (2 * np.pi) - np.pi)
    distance = np.where(turned, angles, difference).max(axis=2)
    assert np.where(status > 0, distance, np.inf).min(axis=1).max() < 1e-6
    if name != "stanford-deluca":  # whose slide reaches everywhere
        poses[:, :2, 3] += 50.0
        assert not run(robot, inverse, poses)[1].any()


def test_a_puma_takes_every_angle_once() -> None:
    """2 of joint 1, 2 of joint 3, 4 of joint 2, and one for each pair of opposite wrists."""
    _, inverse = program_of("puma560-corke")
    assert inverse.function.operations.atan2 == 2 + 2 + 4 + 3 * 4
    nodes = inverse.function.tape.nodes
    angles = {nodes[node.operands[0]].source for node in nodes if node.op in (Op.SINE, Op.COSINE)}
    assert {source.kind for source in angles if source is not None} == {NEAR}  # where free joints are, and no others
    assert inverse.branches == 8
    words = "A reachable pose has up to 8 solutions, all of them listed, except where joints are free."
    assert inverse.summary == words


def test_joints_that_are_free_are_zero_and_others_follow() -> None:
    robot, inverse = program_of("puma560-corke")
    q = np.array([[0.3, -0.7, 0.4, 0.5, 0.0, 0.6], [0.3, -0.7, 0.4, -0.2, 0.0, 1.3]])
    poses = forward_kinematics(numeric_arm_of(robot), q)
    np.testing.assert_allclose(poses[0], poses[1], atol=1e-15)
    found, status = run(robot, inverse, poses[:1])
    singular = status[0] == 3
    assert singular.any()
    again = forward_kinematics(numeric_arm_of(robot), found[0][status[0] > 0])
    assert np.abs(again - poses[0]).max() < 1e-10
    assert (found[0][singular, 3] == 0).all()


def test_arms_with_fewer_joints_refuse_poses_beside_their_own() -> None:
    robot, inverse = program_of("scara-perugia")
    _, poses = poses_of(robot, 20)
    turn = np.eye(4)
    turn[1:3, 1:3] = [[np.cos(1e-3), -np.sin(1e-3)], [np.sin(1e-3), np.cos(1e-3)]]
    assert run(robot, inverse, poses)[1].any(axis=1).all()
    assert not run(robot, inverse, poses @ turn)[1].any()


def test_why_there_is_no_function_is_said() -> None:
    rows = "|".join(["R a: 1"] * 3 + ["R a: 1, alpha: 1"] * 8)
    inverse, reason = solved(Trace(robot_of_rows(rows)))
    assert inverse is None
    assert reason == "the arm has more than 10 joints; the task fixes 6 of 11 joints, so the others are to be `given`"
    search, reason = solved(Trace(robot_of_rows(rows, "inverse: {given: [q1, q2, q3, q4, q5]}")))
    assert isinstance(search, InverseSearch)
    assert (search.eliminations, search.given, reason) == ((), (0, 1, 2, 3, 4), "")
    crooked = "base: [[1, 0, 0, 0], [0, 0.9999998, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
    assert solved(Trace(robot_of_rows("R a: 1 | R a: 1 | R a: 1", crooked)))[1].startswith(
        "base or tool is a rotation only"
    )


def test_masks_fold_what_logic_knows() -> None:
    graph = Graph()
    x, y = (Value(graph, graph.input("q", i)) for i in range(2))
    case, never, always = Mask(x.less(y)), Mask(Value(graph, ZERO)), Mask(Value(graph, ONE))
    for folded, wanted in (
        (case & always, case),
        (case | never, case),
        (case & case, case),
        (case & ~case, never),
        (case | ~case, always),
        (~~case, case),
        (case & never, never),
        (always | case, always),
    ):
        assert folded.value.ref == wanted.value.ref


def test_given_joints_are_arguments() -> None:
    robot = Robot.load("planar-3r")
    graph = solve(robot, ("x", "y"), (2,))
    inverse = inverse_function(Trace(robot), graph)
    assert (inverse.given, inverse.function.arguments) == ((2,), ("T", "given", "near"))


def test_an_arm_without_lengths_reaches_its_centre() -> None:
    model = model_of(arm_of("standard", "R 0 0 0 60; R 0 0 0 50; P 0 0 0 0; R 0 0 0 0"))
    q = np.array([[0.3, -1.2, 0.0, 0.7], [0.3, -1.2, 1e-17, 0.7], [-2.0, 0.4, 0.5, 0.1]])
    found = model.inverse_kinematics(model.forward_kinematics(q))
    assert np.nanmin(np.abs(found - q[:, None]).max(axis=-1), axis=1).max() < 1e-9


def test_joints_that_are_given_stay_where_solutions_are_looked_for():
    short, whole = solve(Robot.load("planar-3r")), solve(Robot.load("planar-3r"), ("x", "y"), (2,))
    assert len(around(short).starts) > 10
    found = around(whole)
    assert all(row[2] == 0 and row[0] and row[1] for row in found.starts)
    assert found.nudge[2] == 0
    assert all(found.nudge[:2])
    assert (around(short).is_short, around(whole).is_short) == (True, False)
    assert min(map(abs, found.nudge[:2])) > 10 * POLICY.back


def near_shoulder(rng: np.random.Generator) -> np.ndarray:
    q = rng.uniform(-2, 2, (60, 4))
    q[:, 2] = np.pi * rng.integers(0, 2, 60) + 10.0 ** rng.uniform(-9, -4, 60)
    return q


def straight_twice(rng: np.random.Generator) -> np.ndarray:
    """With elbow and wrist straight the sum of three angles loses the digits that the elbow needs."""
    q = rng.uniform(-3, 3, (2000, 6))
    q[:, [2, 4]] = np.pi * rng.integers(0, 2, (2000, 2)) + 10.0 ** rng.uniform(-10, -4, (2000, 1))
    return q


def folded(rng: np.random.Generator) -> np.ndarray:
    """Upper arm and forearm have one length: folded, the wrist is on the first axis, and on the second."""
    q = rng.integers(-3, 5, (300, 6)) * np.pi / 4
    q[:, 2] = -np.pi / 2
    return q + 10.0 ** rng.uniform(-10, -3, (300, 1)) * rng.standard_normal(q.shape)


def few_joints(rng: np.random.Generator) -> np.ndarray:
    q = rng.integers(-3, 5, (300, 5)) * np.pi / 4
    return q + 10.0 ** rng.uniform(-10, -3, (300, 1)) * rng.standard_normal((300, 5))


EQUAL = "R 0 0 0 90; R 0 0 0.4 0; R 0 0 0 90; R 0 0.4 0 -90; R 0 0 0 90; R 0 0 0 0"
SHOULDER = "R -90 0 0 0; R 90 0 0 90; R 90 -0.015 -0.105 0; R -90 0 0 0"
THUMB = "R 0 0 0 90; R 90 0 0.038 -90; R 0 0 0 90; R 0 0 0.032 0; R -90 0 0.0275 0"
UR5 = next(case for case in PUBLISHED if case.name == "ur5").robot()


@pytest.mark.first(1)
@pytest.mark.parametrize(
    ("robot", "draw", "seed", "most"),
    [
        (arm_of("modified", SHOULDER), near_shoulder, 1, 1e-10),
        (arm_of("standard", EQUAL), folded, 2, 3e-11),
        (arm_of("standard", THUMB), few_joints, 11, 1e-10),
        pytest.param(UR5, straight_twice, 2, 1e-9, marks=pytest.mark.sweep),
    ],
    ids=["shoulder", "equal", "thumb", "ur5"],
)
def test_beside_singular_poses_there_is_a_solution_and_none_that_is_almost_right(
    robot: Robot, draw: Callable[[np.random.Generator], np.ndarray], seed: int, most: float
) -> None:
    """Of arms with few joints those count beside another one that is right."""
    model, q = model_of(robot), draw(np.random.default_rng(seed))
    poses = model.forward_kinematics(q)
    found = model.inverse_kinematics(poses)
    off = np.abs(model.forward_kinematics(np.nan_to_num(found)) - poses[:, None]).max(axis=(2, 3))
    off[np.isnan(found[..., 0])] = np.nan
    assert np.isfinite(off).any(axis=1).all()
    assert np.nanmax(off[np.nanmin(off, axis=1) < 3e-11] if robot.n == 5 else off) < most


CONIC = arm_of(
    "modified",
    "R -90 0 0 35; R 0 -0.6 0.21 0; R 0 0.436 0 35; R 90 0 0.249 180; R -90 0.638 0 0; R -90 0 0 -90",
    "base: [[2/3, -1/3, 2/3, -0.361], [2/3, 2/3, -1/3, 0], [-1/3, 2/3, 2/3, 0], [0, 0, 0, 1]]\n"
    "tool: [[2/3, -1/3, 2/3, 0], [2/3, 2/3, -1/3, 0.671], [-1/3, 2/3, 2/3, 0.502], [0, 0, 0, 1]]\n"
    "inverse: {task: [x, z], given: [q2, q3, q5, q6]}\n",
)
"""Two joints at a quartic: at the pose of the test three of its roots are near each other, and one is not."""


@pytest.mark.sweep
def test_a_solution_that_has_lost_more_digits_than_another_is_checked_not_dropped() -> None:
    model = model_of(CONIC)
    q = np.array(
        [1.562502459623249, 0.232427656493978, 2.536934967848191, 1.04966957, 2.847566218114313, -0.547344406959437]
    )
    found = model.inverse_kinematics(model.forward_kinematics(q), given=q[[1, 2, 4, 5]])
    assert np.isfinite(found).all()
    assert np.abs(found[:, 0] - 2.75855005).min() < 1e-7


POINT_TASK: Task = ("x", "y")
CASES = [("stanford-deluca", None, ()), ("planar-3r", POINT_TASK, (2,))]


def step_of(name: str, task: Task | None, given: tuple[int, ...]) -> tuple[Robot, Function, list[tuple[int, int]]]:
    robot = Robot.load(name)
    graph = solve(robot, task, given or None)
    places = [(i - 1, j - 1) for row in graph.task for i, j in ROWS[row]]
    return robot, inverse_function(Trace(robot), graph).step, places


def stepped(robot: Robot, step: Function, q: np.ndarray, pose: np.ndarray, damping: float) -> tuple[np.ndarray, float]:
    """Where a step leads, and the error before it."""
    inputs = {"q": list(q), POSE: list(pose.ravel()), DAMPING: [damping], PARAMETER: list(numbers_of(robot).values())}
    *ahead, error, unit = (float(value) for value in evaluate(step.tape, inputs, ARITHMETIC))
    assert unit > 0
    return np.array(ahead), error


@pytest.mark.parametrize(("name", "task", "given"), CASES)
def test_the_step_solves_the_damped_normal_equations(name: str, task: Task | None, given: tuple[int, ...]) -> None:
    robot, step, places = step_of(name, task, given)
    arm, rng = numeric_arm_of(robot), np.random.default_rng(4)
    q, goal = rng.uniform(-1, 1, (2, robot.n))
    pose = forward_kinematics(arm, goal)
    ahead, error = stepped(robot, step, q, pose, 1e9)
    lengths = np.array([*arm.a, *arm.d, *pose[:3, 3]])
    reach = np.sqrt((lengths**2).sum())
    weight = np.array([1 / reach if j == 3 else 1.0 for _, j in places])

    def errors(x: np.ndarray) -> np.ndarray:
        return np.array([(forward_kinematics(arm, x) - pose)[place] for place in places]) * weight

    assert error == pytest.approx(np.linalg.norm(errors(q)), rel=1e-12)
    scale = np.array([1.0 if joint.is_revolute else reach for joint in robot.joints])
    slopes = np.array([(errors(q + h) - errors(q - h)) / 2e-6 for h in 1e-6 * np.diag(scale)]).T
    for damping in (1e-3, 10.0):
        ahead, _ = stepped(robot, step, q, pose, damping)
        free = [k for k in range(robot.n) if k not in given]
        g = slopes[:, free]
        wanted = np.zeros(robot.n)
        wanted[free] = -np.linalg.solve(g.T @ g + damping * np.eye(len(free)), g.T @ errors(q))
        np.testing.assert_allclose(ahead - q, wanted * scale, rtol=1e-5, atol=1e-8)


@pytest.mark.parametrize(("name", "task", "given"), CASES)
def test_steps_from_nearby_arrive(name: str, task: Task | None, given: tuple[int, ...]) -> None:
    robot, step, _ = step_of(name, task, given)
    goal = np.random.default_rng(1).uniform(0.3, 1, robot.n)
    pose = forward_kinematics(numeric_arm_of(robot), goal)
    q = goal + 1e-3 * np.array([k not in given for k in range(robot.n)])
    for _ in range(4):
        q, error = stepped(robot, step, q, pose, 1e-12)
    assert error < 1e-14
    np.testing.assert_allclose(q, goal, atol=1e-12)


def test_what_a_matrix_is_off_a_pose_is_no_error() -> None:
    robot, step, _ = step_of(*CASES[0])
    q = np.full(robot.n, 0.4)
    pose = forward_kinematics(numeric_arm_of(robot), q)
    assert stepped(robot, step, q, pose, 1e-12)[1] == 0
    pose[0, :3] *= 1 + 1e-7
    assert stepped(robot, step, q, pose, 1e-12)[1] == 0
    pose[0, 3] += 1e-3
    assert stepped(robot, step, q, pose, 1e-12)[1] > 1e-5


def test_least_squares_lose_the_digits_of_a_matrix_and_not_of_its_square() -> None:
    rng = np.random.default_rng(2)
    left, right = (np.linalg.qr(rng.normal(size=(rows, 4)))[0] for rows in (7, 4))
    matrix, wanted, weights = left * [1, 0.5, 1e-3, 1e-9] @ right.T, rng.normal(size=4), rng.uniform(1, 2, 7)
    graph = Graph()
    columns = [[Value(graph, graph.input("m", 4 * i + j)) for i in range(7)] for j in range(4)]
    values = least_squares(columns, *([Value(graph, graph.input(name, i)) for i in range(7)] for name in "wr"))
    inputs = {"m": list(matrix.ravel()), "w": list(weights), "r": list(matrix @ wanted)}
    found = evaluate(cut(graph, [value.ref for value in values]), inputs, ARITHMETIC)
    np.testing.assert_allclose(np.array(found, dtype=float), wanted, atol=1e-5)


def test_frames_and_motions_between_them_are_the_pose() -> None:
    robot, search = robot_of(GENERAL), search_of(GENERAL)
    values = evaluate(search.function.tape, {PARAMETER: list(PARAMETERS.values())}, ARITHMETIC | {"number": to_float})
    frames = np.tile(np.eye(4), (robot.n + 1, 1, 1))
    frames[:, :3] = np.reshape(np.array(values, dtype=float), (robot.n + 1, 3, FRAME_ENTRIES // 3))
    q = np.random.default_rng(1).uniform(-2, 2, robot.n)
    pose = np.eye(4)
    for joint, frame, variable in zip(robot.joints, frames[:-1], q, strict=True):
        motion, value = np.eye(4), joint.sign * variable
        if joint.is_revolute:
            motion[:2, :2] = [[np.cos(value), -np.sin(value)], [np.sin(value), np.cos(value)]]
        else:
            motion[2, 3] = value
        pose = pose @ frame @ motion
    expected = forward_kinematics(numeric_arm(robot, PARAMETERS), q[None])[0]
    np.testing.assert_allclose(pose @ frames[-1], expected, atol=1e-14)


def test_general_arms_have_eliminations_and_a_count_and_others_neither() -> None:
    general, loose = search_of(GENERAL), search_of(LOOSE)
    assert general.given == (3,)
    assert general.count == general.branches == 16
    assert general.summary.startswith(
        "A reachable pose has up to 16 solutions (more only where joints are free), computed from the eigenvalues of a "
    )
    assert all(each.hidden != each.multiplied for each in general.eliminations)
    assert (loose.eliminations, loose.count, loose.branches) == ((), 0, 16)
    assert "solutions may be missing" in loose.summary
    assert set(loose.entries) == {(0, 0), (1, 0), (0, 3), (1, 3), (2, 3)}
