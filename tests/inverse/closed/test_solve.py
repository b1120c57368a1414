"""Arms from books: the order of the joints, the number of solutions, and all of them in floats, at batches of poses."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from derive.errors import QuantityError
from derive.inverse.closed.branches import STARTS, InverseSolver, starts
from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import GraphWalk, SolutionGraph
from derive.inverse.closed.solve import solve
from derive.inverse.numeric.newton import Status
from derive.robot.evaluate import parameter_values
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, numeric_arm
from tests.inverse.arms import arm_of


def order(graph: SolutionGraph) -> list[str]:
    """The unknowns of a graph by the numbers of their joints, without sums that follow from others."""
    return ["".join(str(j + 1) for j in node.unknown.joints) for node in graph.nodes if node.kind != "sum"]


@pytest.mark.parametrize(
    ("name", "unknowns", "count"),
    [
        ("planar-3r", ["123", "2", "1"], 2),
        ("scara-perugia", ["124", "2", "1", "3"], 2),
        ("spherical-wrist", ["1", "2", "3"], 2),
        ("puma560-corke", ["1", "3", "23", "4", "5", "6"], 8),
        ("stanford-deluca", ["1", "2", "3", "4", "5", "6"], 8),
    ],
)
def test_the_order_and_the_number_of_solutions_are_those_of_books(name: str, unknowns: list[str], count: int) -> None:
    graph = solve(Robot.load(name))
    assert order(graph) == unknowns
    assert (graph.count, graph.leaves, graph.complete) == (count, count, True)


def numbers_of(robot: Robot, rng: np.random.Generator) -> dict[str, float]:
    """A number for every symbol, a random one where the file has none."""
    values = dict(parameter_values(robot))
    missing = (symbol for symbol in free_symbols(robot) if symbol not in values)
    return values | {symbol: float(rng.uniform(0.2, 1)) for symbol in missing}


def leaves_at(graph: SolutionGraph, robot: Robot, q: np.ndarray, values: dict[str, float]) -> tuple[Any, Any, Any]:
    """The leaves that exist at the pose of a configuration, their joint variables, and by how much these miss it."""
    arm, given = numeric_arm(robot, values), list(map(np.float64, q[list(graph.given)]))
    pose = forward_kinematics(arm, q)
    run = GraphWalk(graph, FloatField(values), [[np.float64(x) for x in row] for row in pose], given)
    leaves = [leaf for leaf in run.leaves() if leaf.exists]
    found = np.array([run.angles(leaf) for leaf in leaves])
    return leaves, found, np.abs(forward_kinematics(arm, found) - pose).max(axis=(1, 2))


def assert_the_solutions_are_those_of(robot: Robot, q: np.ndarray, values: dict[str, float]) -> None:
    """The configuration is among them, and all lead to its pose."""
    graph = solve(robot)
    _, found, misses = leaves_at(graph, robot, q, values)
    assert 0 < len(found) <= graph.count
    assert misses.max() < 1e-10
    assert np.abs(np.exp(1j * found) - np.exp(1j * q)).max(axis=1).min() < 1e-8


@pytest.mark.parametrize("name", ["planar-3r", "scara-perugia", "puma560-usp", "anthropomorphic-wrist", "kuka-kr5"])
def test_the_configuration_is_among_the_solutions_and_all_lead_to_its_pose(name: str) -> None:
    robot, rng = Robot.load(name), np.random.default_rng(5)
    values = numbers_of(robot, rng)
    for _ in range(5):
        assert_the_solutions_are_those_of(robot, rng.uniform(-3, 3, robot.n), values)


def test_who_asks_again_has_the_same_graph_and_another_task_another_one() -> None:
    planar = Robot.load("planar-3r")
    assert solve(Robot.load("planar-3r")) is solve(planar)
    assert solve(planar, ("x", "y"), [2]) is solve(planar, ("x", "y"), (2,)) is not solve(planar)


def test_of_a_redundant_arm_the_swivel_of_the_elbow_is_given_or_the_last_joint_and_too_few_are_refused() -> None:
    assert solve(Robot.load("kuka-lwr4")).given == (2,)
    planar = Robot.load("planar-3r")
    graph = solve(planar, ("x", "y"))
    assert (graph.given, graph.count) == ((2,), 2)
    assert solve(planar, ("x", "y", "phi")).count == 2
    with pytest.raises(QuantityError, match=r"give 1 more of q1, q2, q3"):
        solve(planar, ("x", "y"), ())


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"task": "pose"}, "the task 'pose' is not valid; allowed: a tuple of x, y"),
        ({"task": ("foo",)}, "the task ('foo',) is not valid; allowed"),
        ({"task": ()}, "the task () is not valid; allowed"),
        ({"given": ["q1"]}, "the given joints ['q1'] are not valid; allowed: indices from 0 to 5"),
        ({"given": [-1]}, "the given joints [-1] are not valid; allowed"),
    ],
)
def test_rows_and_joints_that_there_are_not_are_refused(asked: dict[str, Any], message: str) -> None:
    with pytest.raises(QuantityError) as refusal:
        solve(Robot.load("puma560-corke"), **asked)
    assert str(refusal.value).startswith(message)


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ("inverse: {task: [z]}", "17: no joint changes the task z; allowed: x, y, phi, orientation"),
        ("inverse: {task: [x, y], given: []}", "32: the task does not determine all joints; give 1 more of q1, q2, q3"),
    ],
)
def test_what_a_file_asks_and_the_arm_cannot_do_is_said_with_its_place(block: str, message: str) -> None:
    with pytest.raises(QuantityError, match=rf"\A<text>:9:{message}"):
        solve(arm_of("standard", "R 0 0 a1 0; R 0 0 a2 0; R 0 0 a3 0", block))


def test_sums_of_angles_come_in_the_order_of_joints_whatever_the_hashes() -> None:
    graph = solve(arm_of("standard", "; ".join(f"R 0 0 0.{length} 0" for length in range(3, 9))), ("x", "y"))
    sums = [node.unknown.joints for node in graph.nodes if node.kind == "sum"]
    assert sums[:3] == [(2, 3), (2, 3, 4), (2, 3, 4, 5)]


def test_an_arm_of_many_joints_has_no_closed_form_and_says_why() -> None:
    graph = solve(Robot.load("human-body"))
    assert not graph.is_closed
    assert "joints" in graph.why_not


SINGULAR_ARMS = {name: Robot.load(name) for name in ("puma560-corke", "stanford-deluca", "planar-3r")}
SINGULAR_ARMS["parallel when straight"] = arm_of("standard", "R 0 0.36 0.6 90; R 0 0 0 90; R 0 0 0.26 0; R 0 0.7 0.7 0")


@pytest.mark.parametrize("name", SINGULAR_ARMS)
def test_at_singular_poses_there_is_a_solution_and_joints_that_are_free_are_said_to_be(name: str) -> None:
    robot, rng, free = SINGULAR_ARMS[name], np.random.default_rng(8), 0
    values = numbers_of(robot, rng)
    for _ in range(12):
        q = rng.choice([0, np.pi / 2, -np.pi / 2, np.pi, 0.7], robot.n)
        leaves, _, misses = leaves_at(solve(robot), robot, q, values)
        assert misses.min() < 1e-7
        free += any(any(leaf.free) for leaf in leaves)
    assert (free > 0) == (name in ("puma560-corke", "stanford-deluca"))


PIEPER = "R 0 0.6 0.5 -90; R 0 0.13 0.44 60; R {} 0.68 0.2 90; R 0 0.15 0 90; R 0 0 0 -90; R 0 0.1 0 0"


def test_skew_wrists_and_given_joints_with_offsets_are_solved() -> None:
    robot = arm_of("standard", PIEPER.format(0))
    graph = solve(robot)
    assert graph.nodes[0].kind == "conic"
    assert order(graph)[0] == "3"
    assert (graph.leaves, graph.count) == (8, 8)
    assert_the_solutions_are_those_of(robot, np.random.default_rng(2).uniform(-3, 3, 6), {})
    robot, q = arm_of("standard", PIEPER.format("180/7")), np.array([0.3, -1.2, 0.4, 0.5, 0.6, 0.7])
    graph = solve(robot, ("x", "y", "z"), (2, 3, 4, 5))
    assert graph.count == 1
    assert np.abs(leaves_at(graph, robot, q, {})[1] - q).max(axis=1).min() < 1e-9


def test_a_wrist_that_is_one_by_the_numbers_of_its_parameters_alone_is_solved_with_these_numbers() -> None:
    rows = "R 0 h 0 90; R 0 0 b1 0; R 0 0 0.05 90; R 0 0.4 0 -90; R 0 b1-b2 0 90; R 0 0.1 0 0"
    graph = solve(arm_of("standard", rows, "parameters: {h: 0.3, b1: 0.35, b2: 0.35}"))
    assert (graph.count, graph.leaves) == (8, 8)
    assert all(node.kind != "general" for node in graph.nodes)


@pytest.mark.parametrize(
    ("rows", "more", "given", "leaves"),
    [
        # a branch has the right pose with numbers that are no cosine and sine of an angle
        ("R 0 d1 0 20; P 0 0 0 90; R 0 0 a3 90; R 0 d4 0 180; R 90 0 a5 180; R 0 0 0 90", "", (4,), 2),
        # the constant of a slide that is given is an argument
        ("P 0 0 0.1 0; P 0 d2 0 180; R 0 0 0.3 0", "parameters: {d2: 0.2}\nruntime: [d2]", (1,), 1),
    ],
)
def test_of_all_branches_the_real_one_is_counted(rows: str, more: str, given: tuple[int, ...], leaves: int) -> None:
    graph = solve(arm_of("standard", rows, more))
    assert (graph.given, graph.leaves, graph.count, graph.complete) == (given, leaves, 1, True)


SKEW = "[[2/3, -1/3, 2/3, 0.1], [2/3, 2/3, -1/3, 0], [-1/3, 2/3, 2/3, 0], [0, 0, 0, 1]]"
TILTED = "[[cos(23), 0, sin(23), 0], [0, 1, 0, 0], [-sin(23), 0, cos(23), 0.3], [0, 0, 0, 1]]"
TURNED = [
    ("standard", "R 0 0 0.5 0; R 0 0 0.4 0; R 0 0 0.2 0", f"base: {SKEW}\ninverse: {{task: [x, y, phi]}}"),
    ("modified", "P 105 0 0 0; R 90 -0.25 0 0; R 0 0.3 0 0", "inverse: {task: [x, z]}"),
    ("standard", "R 0 0 0.3 60", f"base: {TILTED}\ninverse: {{task: [z]}}"),
]


@pytest.mark.parametrize("text", TURNED, ids=["planar", "slide", "height"])
def test_some_rows_of_a_base_that_turns_them_into_others_are_solved_by_formulas(text: tuple[str, str, str]) -> None:
    robot = arm_of(*text)
    graph = solve(robot)
    assert graph.is_closed
    assert graph.complete
    q = np.random.default_rng(5).uniform(-1.5, 1.5, (20, robot.n))
    poses = forward_kinematics(numeric_arm(robot), q)
    found = InverseSolver.of(robot, graph).solve(poses, q[:, list(graph.given)]).q
    assert np.nanmin(np.abs(found - q[:, None]).max(axis=-1), axis=1).max() < 1e-10
    assert (np.isfinite(found[..., 0]).sum(axis=1) <= graph.count).all()


@cache
def solver_and_arm(name):
    robot = Robot.load(name)
    numbers = {symbol: 0.3 + 0.1 * k for k, symbol in enumerate(free_symbols(robot))}
    return InverseSolver.of(robot, solve(robot), numbers), numeric_arm(robot, numbers)


def branches_at(name, q):
    solver, arm = solver_and_arm(name)
    pose = forward_kinematics(arm, np.array(q, dtype=float))
    return solver.solve(pose), pose, arm


def test_a_batch_has_the_branches_of_its_poses_one_by_one():
    q = np.random.default_rng(2).uniform(-2, 2, (2, 3, 6))
    together, poses, arm = branches_at("puma560-corke", q)
    assert together.q.shape == (2, 3, 8, 6)
    assert (together.status == Status.EXACT).all()
    assert np.abs(forward_kinematics(arm, together.q) - poses[..., None, :, :]).max() < 1e-12
    alone = solver_and_arm("puma560-corke")[0].solve(poses[1, 2])
    assert np.allclose(alone.q, together.q[1, 2], atol=1e-12)
    away = np.abs(np.exp(1j * together.q) - np.exp(1j * q[..., None, :])).max(axis=-1)
    assert away.min(axis=-1).max() < 1e-9


def test_a_singular_wrist_gives_each_posture_once_and_takes_its_free_joint_from_near():
    found, pose, arm = branches_at("puma560-corke", [0.3, 0.4, 0.5, 0.6, 0, 0.7])
    there = found.status != Status.NONE
    assert np.isnan(found.q[~there]).all()
    assert there.sum() == 7
    assert (found.status == Status.SINGULAR).sum() == 1
    assert np.abs(forward_kinematics(arm, found.q[there]) - pose).max() < 1e-12
    found = solver_and_arm("puma560-corke")[0].solve(pose, near=[0, 0, 0, 1.1, 0, 0])
    free = found.q[found.status == Status.SINGULAR]
    assert any(np.allclose(q[3:], [1.1, 0, 0.2], atol=1e-9) for q in free)


@pytest.mark.parametrize(("part", "branches"), [(1, 1), (1 + 1e-13, 1), (0.9, 2), (1.1, 0), (0.1, 0)])
def test_a_stretched_scara_has_one_branch_on_the_boundary_two_inside_and_none_outside(part, branches):
    solver, arm = solver_and_arm("scara-perugia")
    pose = forward_kinematics(arm, np.array([0.3, 0.0, 0.5, 0.2]))
    pose[:2, 3] *= part
    found = solver.solve(pose)
    there = found.status != Status.NONE
    assert there.sum() == branches
    assert np.isnan(found.q[~there]).all()
    if branches == 1:
        assert found.status[there].tolist() == [Status.BOUNDARY]
        assert np.allclose(found.q[there], [[0.3, 0, 0.5, 0.2]], atol=1e-5)


def test_an_arm_without_closed_form_is_solved_by_newton_in_the_same_shape():
    solver, arm = solver_and_arm("puma560-corke")
    robot, graph = Robot.load("puma560-corke"), solver.graph
    other = InverseSolver.of(robot, replace(graph, nodes=(), why_not="for the test"))
    poses = forward_kinematics(arm, np.random.default_rng(1).uniform(-2, 2, (2, 6)))
    ours, theirs = other.solve(poses), solver.solve(poses)
    for k in range(2):
        a, b = (np.sort_complex(np.exp(1j * found.q[k]).sum(axis=-1)) for found in (ours, theirs))
        assert np.allclose(a, b, atol=1e-9)


@pytest.mark.parametrize(
    ("pose", "message"),
    [
        (np.eye(3), "shape"),
        (np.full((2, 4, 4), np.nan), "finite"),
        (np.diag([1, 1, 1.1, 1]), r"not orthonormal \(error 2.1e-01 > "),
        (np.diag([1, 1, -1, 1]), "reflection"),
        (np.diag([1, 1, 1, 2]), "last row"),
        (np.eye(4) + np.diag([1e200] * 1, 3), "1e\\+200 m away"),
        ([[1, 2], [3]], "equal length"),
    ],
)
def test_what_is_no_pose_is_refused(pose, message):
    with pytest.raises(ValueError, match=message):
        solver_and_arm("puma560-corke")[0].solve(pose)
    with pytest.raises(ValueError, match=r"given must be finite numbers of shape \(..., 0\)"):
        solver_and_arm("puma560-corke")[0].solve(np.eye(4), given=[0.3])


def test_what_else_a_caller_gives_is_refused_in_words():
    solver, one = solver_and_arm("puma560-corke")[0], np.eye(4)
    for value in ("pose", None, one + 0j):
        with pytest.raises(TypeError, match="poses must be real numbers; got dtype"):
            solver.solve(value)
    for near in ([0.0, 0.0], [0.0, np.nan, 0.0, 0.0, 0.0, 0.0]):
        with pytest.raises(ValueError, match=r"near must be finite numbers of shape \(6,\); got shape \([26],\)"):
            solver.solve(one, near=near)
    with pytest.raises(ValueError, match=r"given has the batch shape \(3,\), but the poses have \(2,\)"):
        solver.solve(np.stack([one, one]), given=np.zeros((3, 0)))


def test_starts_fill_the_joint_space_evenly():
    for joints in (1, 3, 5):
        table = starts(joints)
        assert table.shape == (STARTS, joints)
        assert np.abs(table).max() <= 1
        assert np.abs(table.mean(axis=0)).max() < 0.15
        assert ((table > 0).sum(axis=0) >= STARTS // 3).all()
