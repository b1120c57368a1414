"""A step of damped Newton, and what generated code of arms without formulas takes of the arm."""

import numpy as np
import pytest

from derive.algebra.constants import to_float
from derive.inverse.closed.solve import solve
from derive.programs.formulations.trace import Trace
from derive.programs.inverse import FRAME_ENTRIES, inverse_function
from derive.programs.newton_step import least_squares
from derive.programs.program import DAMPING, POSE, Function
from derive.programs.tape.build import cut
from derive.programs.tape.graph import Graph
from derive.programs.tape.tape import PARAMETER, evaluate
from derive.programs.tape.value import Value
from derive.robot.options.inverse import ROWS, Task
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, numeric_arm
from tests.programs.test_inverse import ARITHMETIC, arm_of, numbers_of
from tests.targets.searched_arms import GENERAL, LOOSE, PARAMETERS, robot_of, search_of

POINT: Task = ("x", "y")
CASES = [("stanford-deluca", None, ()), ("planar-3r", POINT, (2,))]


def program_of(name: str, task: Task | None, given: tuple[int, ...]) -> tuple[Robot, Function, list[tuple[int, int]]]:
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
    robot, step, places = program_of(name, task, given)
    arm, rng = arm_of(robot), np.random.default_rng(4)
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
    robot, step, _ = program_of(name, task, given)
    goal = np.random.default_rng(1).uniform(0.3, 1, robot.n)
    pose = forward_kinematics(arm_of(robot), goal)
    q = goal + 1e-3 * np.array([k not in given for k in range(robot.n)])
    for _ in range(4):
        q, error = stepped(robot, step, q, pose, 1e-12)
    assert error < 1e-14
    np.testing.assert_allclose(q, goal, atol=1e-12)


def test_what_a_matrix_is_off_a_pose_is_no_error() -> None:
    robot, step, _ = program_of(*CASES[0])
    q = np.full(robot.n, 0.4)
    pose = forward_kinematics(arm_of(robot), q)
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
    for joint, frame, value in zip(robot.joints, frames[:-1], joint_values(robot.joints, q), strict=True):
        motion = np.eye(4)
        if joint.is_revolute:
            motion[:2, :2] = [[np.cos(value), -np.sin(value)], [np.sin(value), np.cos(value)]]
        else:
            motion[2, 3] = value
        pose = pose @ frame @ motion
    expected = forward_kinematics(numeric_arm(robot, PARAMETERS), q[None])[0]
    np.testing.assert_allclose(pose @ frames[-1], expected, atol=1e-14)


def joint_values(joints: tuple, q: np.ndarray) -> list[float]:  # type: ignore[type-arg]
    """How far each joint moves about or along its axis."""
    return [joint.sign * value for joint, value in zip(joints, q, strict=True)]


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
