"""Arms from books: the order of the joints, the number of solutions, and all of them checked by forward kinematics."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from derive.errors import QuantityError
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import SolutionGraph
from derive.inverse.closed.solve import solve
from derive.inverse.closed.walk import GraphWalk
from derive.mechanics.floats import value_at
from derive.robot.evaluate import parameter_values
from derive.robot.expression import Number
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, numeric_arm


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


def run_at(graph: SolutionGraph, pose: np.ndarray, values: dict[str, float], given: Any = ()) -> GraphWalk:
    return GraphWalk(
        graph, FloatField(values), [[np.float64(x) for x in row] for row in pose], list(map(np.float64, given))
    )


def assert_the_solutions_are_those_of(graph: SolutionGraph, q: np.ndarray, values: dict[str, float]) -> None:
    """The configuration is among them, and all lead to its pose."""
    pose = _pose(graph.robot, q, values)
    run = run_at(graph, pose, values)
    found = [np.array(run.angles(leaf)) for leaf in run.leaves() if leaf.exists]
    assert 0 < len(found) <= graph.count
    assert max(np.abs(_pose(graph.robot, other, values) - pose).max() for other in found) < 1e-10
    assert min(np.abs(np.exp(1j * other) - np.exp(1j * q)).max() for other in found) < 1e-8


@pytest.mark.parametrize("name", ["planar-3r", "scara-perugia", "puma560-usp", "anthropomorphic-wrist", "kuka-kr5"])
def test_the_configuration_is_among_the_solutions_and_all_lead_to_its_pose(name: str) -> None:
    robot, rng = Robot.load(name), np.random.default_rng(5)
    values = numbers_of(robot, rng)
    for _ in range(5):
        assert_the_solutions_are_those_of(solve(robot), rng.uniform(-3, 3, robot.n), values)


def test_who_asks_again_has_the_same_graph_and_another_task_another_one() -> None:
    graph = solve(Robot.load("planar-3r"))
    assert solve(Robot.load("planar-3r")) is graph
    assert solve(Robot.load("planar-3r"), ("x", "y"), [2]) is not graph
    assert solve(Robot.load("planar-3r"), ("x", "y"), (2,)) is solve(Robot.load("planar-3r"), ("x", "y"), [2])


def _pose(robot: Robot, q: np.ndarray, values: dict[str, float]) -> np.ndarray:
    numbers = tuple((name, Number(Fraction(value))) for name, value in values.items())
    return np.array(value_at(replace(robot, parameters=numbers), "T", list(q)))


def test_of_a_redundant_arm_the_swivel_of_the_elbow_is_given_or_the_last_joint_and_too_few_are_refused() -> None:
    assert solve(Robot.load("kuka-lwr4")).given == (2,)
    planar = Robot.load("planar-3r")
    graph = solve(planar, ("x", "y"))
    assert graph.given == (2,)
    assert graph.count == 2
    assert solve(planar, ("x", "y", "phi")).count == 2
    with pytest.raises(QuantityError, match=r"1 joint more to be given of q1, q2, q3"):
        solve(Robot.load("planar-3r"), ("x", "y"), ())


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"task": "pose"}, "the task 'pose'; allowed: a tuple of x, y"),
        ({"task": ("foo",)}, "the task ('foo',); allowed"),
        ({"task": ()}, "the task (); allowed"),
        ({"given": ["q1"]}, "the given joints ['q1']; allowed: indices from 0 to 5"),
        ({"given": [-1]}, "the given joints [-1]; allowed"),
    ],
)
def test_rows_and_joints_that_there_are_not_are_refused(asked: dict[str, Any], message: str) -> None:
    with pytest.raises(QuantityError) as refusal:
        solve(Robot.load("puma560-corke"), **asked)
    assert str(refusal.value).startswith(message)


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ("inverse: {task: [z]}", "<text>:8:17: a task of z, which no joint changes; allowed: x, y, phi, orientation"),
        ("inverse: {task: [x, y], given: []}", "<text>:8:32: with no joint given the others are not determined"),
    ],
)
def test_what_a_file_asks_and_the_arm_cannot_do_is_said_with_its_place(block: str, message: str) -> None:
    rows = "".join(f"  - {{type: revolute, a: a{k}}}\n" for k in (1, 2, 3))
    robot = Robot.from_text(f"name: arm\ntitle: planar\nconvention: standard\njoints:\n{rows}{block}\n")
    with pytest.raises(QuantityError) as refusal:
        solve(robot)
    assert str(refusal.value).startswith(message)


def test_an_arm_of_many_joints_has_no_closed_form_and_says_why() -> None:
    graph = solve(Robot.load("human-body"))
    assert not graph.is_closed
    assert "joints" in graph.why_not


PARALLEL_WHEN_STRAIGHT = """
name: parallel-when-straight
convention: standard
joints:
  - {type: revolute, d: 0.36, a: 0.6, alpha: pi/2}
  - {type: revolute, alpha: pi/2}
  - {type: revolute, a: 0.26}
  - {type: revolute, d: 0.7, a: 0.7}
"""


@pytest.mark.parametrize("name", ["puma560-corke", "stanford-deluca", "parallel-when-straight", "planar-3r"])
def test_at_singular_poses_there_is_a_solution_and_joints_that_are_free_are_said_to_be(name: str) -> None:
    robot = Robot.from_text(PARALLEL_WHEN_STRAIGHT) if name == "parallel-when-straight" else Robot.load(name)
    graph, rng = solve(robot), np.random.default_rng(8)
    values, free = numbers_of(robot, rng), 0
    for _ in range(12):
        q = rng.choice([0, np.pi / 2, -np.pi / 2, np.pi, 0.7], robot.n)
        pose = _pose(robot, q, values)
        run = run_at(graph, pose, values)
        found = [leaf for leaf in run.leaves() if leaf.exists]
        rests = [np.abs(_pose(robot, np.array(run.angles(leaf)), values) - pose).max() for leaf in found]
        assert min(rests) < 1e-7
        free += any(any(leaf.free) for leaf in found)
    assert (free > 0) == (name in ("puma560-corke", "stanford-deluca"))


PIEPER = """
name: pieper
convention: standard
joints:
  - {type: revolute, d: 0.6, a: 0.5, alpha: -pi/2}
  - {type: revolute, d: 0.13, a: 0.44, alpha: pi/3}
  - {type: revolute, d: 0.68, a: 0.2, alpha: pi/2}
  - {type: revolute, d: 0.15, alpha: pi/2}
  - {type: revolute, alpha: -pi/2}
  - {type: revolute, d: 0.1}
"""


def test_a_wrist_on_three_skew_axes_has_the_quartic_of_pieper() -> None:
    robot, rng = Robot.from_text(PIEPER), np.random.default_rng(2)
    graph = solve(robot)
    assert graph.nodes[0].kind == "conic"
    assert order(graph)[0] == "3"
    assert (graph.leaves, graph.count) == (8, 8)
    assert_the_solutions_are_those_of(graph, rng.uniform(-3, 3, 6), {})


def test_a_given_joint_may_have_an_offset() -> None:
    text = PIEPER.replace("name: pieper", "name: offset").replace("d: 0.68", "theta: q3 + pi/7, d: 0.68")
    robot = Robot.from_text(text)
    graph = solve(robot, ("x", "y", "z"), (2, 3, 4, 5))
    assert graph.count == 1
    q = np.array([0.3, -1.2, 0.4, 0.5, 0.6, 0.7])
    run = run_at(graph, _pose(robot, q, {}), {}, q[2:])
    assert min(np.abs(np.array(run.angles(leaf)) - q).max() for leaf in run.leaves() if leaf.exists) < 1e-9


COINCIDENCE = """
name: coincidence
convention: standard
joints:
  - {type: revolute, d: h, alpha: pi/2}
  - {type: revolute, a: b1}
  - {type: revolute, a: 0.05, alpha: pi/2}
  - {type: revolute, d: 0.4, alpha: -pi/2}
  - {type: revolute, d: b1 - b2, alpha: pi/2}
  - {type: revolute, d: 0.1}
parameters: {h: 0.3, b1: 0.35, b2: 0.35}
"""


def test_a_wrist_that_is_one_by_the_numbers_of_its_parameters_alone_is_solved_with_these_numbers() -> None:
    graph = solve(Robot.from_text(COINCIDENCE))
    assert (graph.count, graph.leaves) == (8, 8)
    assert all(node.kind != "general" for node in graph.nodes)


OPPOSED = """
name: opposed
convention: standard
joints:
  - {type: revolute, alpha: 0.3, d: d1}
  - {type: prismatic, alpha: pi/2}
  - {type: revolute, a: a3, alpha: pi/2}
  - {type: revolute, alpha: pi, d: d4}
  - {type: revolute, a: a5, alpha: pi, theta: q5 + pi/2}
  - {type: revolute, alpha: pi/2}
"""
"""An arm of which a branch has the right pose with numbers that are no cosine and sine of an angle."""


def test_a_branch_is_counted_where_its_cosines_and_sines_are_those_of_angles() -> None:
    graph = solve(Robot.from_text(OPPOSED))
    assert (graph.leaves, graph.count, graph.complete) == (2, 1, True)


def test_the_constant_of_a_given_slide_may_be_an_argument() -> None:
    text = "name: rails\nconvention: standard\nparameters: {d2: 0.2}\nruntime: [d2]\njoints:\n"
    rows = ["{type: prismatic, a: 0.1}", "{type: prismatic, q: x2, d: d2 + x2, alpha: pi}", "{type: revolute, a: 0.3}"]
    graph = solve(Robot.from_text(text + "".join(f"  - {row}\n" for row in rows)))
    assert (graph.given, graph.count, graph.complete) == ((1,), 1, True)


TURNED = {
    "planar": (
        "standard",
        "base: [[2/3, -1/3, 2/3, 0.1], [2/3, 2/3, -1/3, 0], [-1/3, 2/3, 2/3, 0], [0, 0, 0, 1]]\n",
        ["{type: revolute, a: 0.5}", "{type: revolute, a: 0.4}", "{type: revolute, a: 0.2}"],
        "[x, y, phi]",
    ),
    "slide": (
        "modified",
        "",
        ["{type: prismatic, alpha: 7*pi/12}", "{type: revolute, a: -0.25, alpha: pi/2}", "{type: revolute, a: 0.3}"],
        "[x, z]",
    ),
    "height": (
        "standard",
        "base: [[cos(0.4), 0, sin(0.4), 0], [0, 1, 0, 0], [-sin(0.4), 0, cos(0.4), 0.3], [0, 0, 0, 1]]\n",
        ["{type: revolute, a: 0.3, alpha: pi/3}"],
        "[z]",
    ),
}
"""Bases that turn what the task tells and what it does not into each other."""


@pytest.mark.parametrize("name", TURNED)
def test_some_rows_of_a_turned_base_are_solved_by_formulas(name: str) -> None:
    convention, base, rows, task = TURNED[name]
    joints = "".join(f"  - {row}\n" for row in rows)
    robot = Robot.from_text(
        f"name: turned\nconvention: {convention}\n{base}inverse: {{task: {task}}}\njoints:\n{joints}"
    )
    graph = solve(robot)
    assert graph.is_closed
    assert graph.complete
    arm, given = numeric_arm(robot), list(graph.given)
    q = np.random.default_rng(5).uniform(-1.5, 1.5, (20, robot.n))
    found = InverseSolver.of(robot, graph).solve(forward_kinematics(arm, q), q[:, given]).q
    assert np.nanmin(np.abs(found - q[:, None]).max(axis=-1), axis=1).max() < 1e-10
    assert (np.isfinite(found[..., 0]).sum(axis=1) <= graph.count).all()
