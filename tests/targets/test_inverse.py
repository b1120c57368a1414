"""Inverse kinematics in Python, in NumPy and compiled: batches, arguments, refusals, the nearest one, and its words."""

from collections.abc import Iterator
from functools import cache
from types import ModuleType
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import sympy

from derive.inverse.words.solutions import inverse_kinematics
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import Program
from derive.robot.evaluate import to_float
from derive.robot.robot import Robot
from derive.targets.casadi import render_casadi
from derive.targets.readme import render as render_readme
from tests.inverse.arms import arm_of
from tests.rows import robot_of_rows
from tests.targets.generated_models import needs_compiler, numpy_model, source_of
from tests.targets.languages import running

NAMES = {"forward_kinematics"}
TOLERANCE = 1e-9
PARAMETERS = {"a2": 0.5}


@cache
def program_of(robot: Robot) -> Program:
    return build_program(robot, Effort.QUICK, names=NAMES, inverse=True)


def elbow() -> Robot:
    rows = "R d: 0.3, alpha: pi/2, limits: [-2, 2] | R a: a2 | R a: 0.4 | P alpha: -pi/2, limits: [-1, 1]"
    return robot_of_rows(rows, name="elbow")


@cache
def model_of(robot: Robot) -> ModuleType:
    return numpy_model(robot, program_of(robot))


@pytest.fixture(scope="module", params=["numpy", pytest.param("native", marks=needs_compiler)])
def model(request: pytest.FixtureRequest) -> Iterator[ModuleType]:
    with running(request.param, elbow(), program_of(elbow())) as found:
        yield found.module


def cases(model: ModuleType, count: int = 40) -> tuple[np.ndarray, np.ndarray]:
    q = np.random.default_rng(7).uniform(-0.9, 0.9, (count, 4))
    return q, model.forward_kinematics(q, params=PARAMETERS)


def test_a_batch_of_any_shape_one_pose_and_out_give_the_same(model: ModuleType) -> None:
    _, poses = cases(model)
    found, status = model.inverse_kinematics(poses, params=PARAMETERS, status=True)
    shape = (40, program_of(elbow()).inverse.branches, 4)
    assert (found.shape, status.shape, status.dtype) == (shape, shape[:2], np.uint8)
    assert np.array_equal(np.isnan(found).any(axis=-1), status == model.NONE)
    assert (status == model.EXACT).any(axis=1).all()
    for pose, row, codes in zip(poses, found, status, strict=True):
        one, code = model.inverse_kinematics(pose, params=PARAMETERS, status=True, near=np.zeros(4))
        np.testing.assert_allclose(one, row, atol=TOLERANCE)
        assert np.array_equal(code, codes)
    out = np.zeros((5, 2, *shape[1:])).swapaxes(0, 1)
    assert model.inverse_kinematics(poses[:10].reshape(2, 5, 4, 4), params=PARAMETERS, out=out) is out
    np.testing.assert_allclose(out.reshape(10, *shape[1:]), found[:10], atol=TOLERANCE)
    none, codes = model.inverse_kinematics(poses[:0], params=PARAMETERS, status=True, near=np.zeros((0, 4)))
    assert (none.shape, codes.shape) == ((0, *shape[1:]), (0, shape[1]))
    assert model.inverse_kinematics_nearest(poses[:0], np.zeros((0, 4)), params=PARAMETERS).shape == (0, 4)


PLANAR = robot_of_rows("R a: 0.5 | R a: 0.4", "inverse: {task: [x, y]}")


@pytest.mark.parametrize("robot", [PLANAR, pytest.param(Robot.load("puma560-corke"), marks=pytest.mark.sweep)])
def test_arrays_of_other_libraries_give_the_same(robot: Robot) -> None:
    model = model_of(robot)
    poses = model.forward_kinematics(np.random.default_rng(7).uniform(-0.9, 0.9, (20, robot.n)))
    with jax.enable_x64(True):
        found = model.inverse_kinematics(jnp.asarray(poses))
        np.testing.assert_allclose(found, model.inverse_kinematics(poses), atol=TOLERANCE)


def test_the_nearest_solution_is_the_configuration_itself_full_turns_included_within_limits(model: ModuleType) -> None:
    q, poses = cases(model)
    turns = 2 * np.pi * np.array([[0, 0, 0, 0], [0, 1, -2, 0], [1, 0, 0, 0]])
    for turn, reached in zip(turns, (turns[0], turns[1], turns[0]), strict=True):  # joint 1 has limits
        found = model.inverse_kinematics_nearest(poses, q + turn, params=PARAMETERS)
        np.testing.assert_allclose(found, q + reached, atol=1e-7)
        one = model.inverse_kinematics_nearest(poses[0], q[0] + turn, params=PARAMETERS)
        np.testing.assert_allclose(one, found[0], atol=TOLERANCE)
    pose = model.forward_kinematics([2.5, 0.2, 0.3, 0.1], params=PARAMETERS)
    assert not np.isnan(model.inverse_kinematics(pose, params=PARAMETERS)).all()
    found = model.inverse_kinematics_nearest(pose, np.zeros(4), params=PARAMETERS)
    assert np.isnan(found).all() or abs(found[0]) <= 2


def test_parameters_may_vary_over_a_batch(model: ModuleType) -> None:
    lengths = np.array([0.4, 0.5, 0.6])
    q = np.random.default_rng(3).uniform(-0.9, 0.9, (3, 4))
    poses = model.forward_kinematics(q, params={"a2": lengths})
    found = model.inverse_kinematics(poses, params={"a2": lengths})
    for pose, length, rows in zip(poses, lengths, found, strict=True):
        np.testing.assert_allclose(rows, model.inverse_kinematics(pose, params={"a2": length}), atol=TOLERANCE)


def pose_with(**entries: float) -> np.ndarray:
    pose = np.eye(4)
    for name, value in entries.items():
        pose[int(name[1]), int(name[2])] = value
    return pose


UNIT = np.eye(4)
LONG = np.concatenate([np.tile(UNIT, (5000, 1, 1)), [pose_with(r22=-1.0)]])
Q_SHAPE = r"q must be real numbers of shape \(4,\) or \(..., 4\); got float64 of shape \(3,\)"
REFUSED: list[tuple[Any, dict[str, Any], str]] = [
    (np.eye(3), {}, r"T must have shape \(4, 4\) or \(..., 4, 4\); got \(3, 3\)"),
    (UNIT.reshape(2, 8), {}, r"T must have shape .*; got \(2, 8\)"),
    (UNIT.reshape(16), {}, r"T must have shape .*; got \(16,\)"),
    ([[1, 2], [3]], {}, r"T must have shape .* got rows of unequal length"),
    ("pose", {}, "T must be real numbers; got dtype"),
    (pose_with(r00=1.1), {}, r"T is not a valid pose: its rotation is not orthonormal \(error 2.1e-01 > 1e-06\)"),
    (pose_with(r22=-1.0), {}, r"T is not a valid pose: its rotation is a reflection \(determinant -1\)"),
    (pose_with(r13=np.nan), {}, r"T is not a valid pose: it has non-finite entries"),
    (pose_with(r00=np.nan), {}, r"T is not a valid pose: it has non-finite entries"),
    (pose_with(r33=2.0), {}, r"T is not a valid pose: its last row is \[0.0, 0.0, 0.0, 2.0\], not \[0, 0, 0, 1\]"),
    (np.array([UNIT, pose_with(r00=2.0)]), {}, r"T\[1\] is not a valid pose: its rotation is not orthonormal"),
    (LONG, {}, r"T\[5000\] is not a valid pose: its rotation"),
    (pose_with(r03=1e200), {}, r"T is not a valid pose: its position is 1e\+200 m away \(allowed: 1e\+30\)"),
    (UNIT, {"given": [0.1]}, r"given must be None, since all joints are solved for; got shape \(1,\)"),
    (UNIT, {"given": "q1"}, "given must be real numbers; got dtype"),
    (UNIT, {"q": [0.0, 0.0, 0.0]}, Q_SHAPE),
    (UNIT, {"q": [0.0, np.inf, 0.0, 0.0]}, "q must be finite numbers"),
    (UNIT, {"near": [0.0, np.nan, 0.0, 0.0]}, "near must be finite numbers"),
    (UNIT, {"near": [0.0]}, "near must be real numbers of shape"),
    (UNIT, {"out": np.zeros((3, 3))}, r"out must be a NumPy array of float64 of shape \(\d, 4\)"),
    (UNIT, {"params": None}, "missing in params: a2"),
]


@pytest.mark.parametrize(("pose", "options", "message"), REFUSED)
def test_what_is_no_pose_or_does_not_fit_is_refused(model: ModuleType, pose: Any, options: Any, message: str) -> None:
    name = "inverse_kinematics_nearest" if "q" in options else "inverse_kinematics"
    with pytest.raises((ValueError, TypeError), match=f"^{name}: {message}"):
        getattr(model, name)(pose, **{"params": PARAMETERS, **options})


UR5 = arm_of(
    "standard",
    "R 0 0.089159 0 90; R 0 0 -0.425 0; R 0 0 -0.39225 0; R 0 0.10915 0 90; R 0 0.09465 0 -90; R 0 0.0823 0 0",
)
STUCK = [-1.5409894385291336, np.pi, 0.7, -2.451063785379106, np.pi, -2.0214145260521557]
"""A wrist in line with the others: the last joint is free, but for most of its values the elbow does not reach."""


def test_free_joints_are_where_the_caller_has_them_or_elsewhere() -> None:
    model = model_of(UR5)
    q = np.array([0.4, -1.0, 1.2, 0.3, 0.0, 0.8])
    pose = model.forward_kinematics(q)
    found, status = model.inverse_kinematics(pose, status=True, near=q)
    free = status == model.SINGULAR
    assert free.any()
    np.testing.assert_allclose(model.inverse_kinematics_nearest(pose, q), q, atol=1e-6)
    for rows in (model.inverse_kinematics(pose), found):
        there = rows[~np.isnan(rows).any(axis=1)]
        assert np.abs(model.forward_kinematics(there) - pose).max() < 1e-10


def test_a_singular_wrist_gives_each_posture_once() -> None:
    model = model_of(Robot.load("puma560-corke"))
    pose = model.forward_kinematics([0.3, 0.4, 0.5, 0.6, 0.0, 0.7])
    status = model.inverse_kinematics(pose, status=True)[1]
    assert ((status > 0).sum(), (status == model.SINGULAR).sum()) == (7, 1)


def test_readme_says_what_there_is_and_why_not() -> None:
    text = render_readme(source_of(elbow(), program_of(elbow())))["README.md"]
    assert "## Inverse kinematics" in text
    assert "| `inverse_kinematics(T)` |" in text
    without = Program((), (), None, "an arm of straw")
    page = render_readme(source_of(elbow(), without))["README.md"]
    assert "There is no function: an arm of straw." in page


def test_rows_are_the_printed_solutions_in_their_order_by_their_names() -> None:
    robot = Robot.load("puma560-corke")
    poses = model_of(robot).forward_kinematics(np.random.default_rng(7).uniform(-0.9, 0.9, (12, 6)))
    found, solutions = model_of(robot).inverse_kinematics(poses), inverse_kinematics(robot, robot.style).solutions
    for pose, rows in zip(poses, found, strict=True):
        entries = {f"r{i + 1}{j + 1}": pose[i, j] for i in range(3) for j in range(3)}
        values = {sympy.Symbol(n): x for n, x in (*entries.items(), *zip(("px", "py", "pz"), pose[:3, 3], strict=True))}
        values |= {sympy.Symbol(name): to_float(x, {}) for name, x in robot.parameters}
        for row, solution in zip(rows, solutions, strict=True):
            numbers = solution.numbers(values)
            if numbers is not None and np.isfinite(row).all():
                own = [float(numbers[sympy.Symbol(joint.variable)]) for joint in robot.joints]
                assert np.abs(np.exp(1j * row) - np.exp(1j * np.array(own))).max() < 1e-6
    listed = [f"{k}. {solution.name}" for k, solution in enumerate(solutions, 1)]
    texts = (
        render_casadi(source_of(robot, program_of(robot)))["model_casadi.py"],
        model_of(robot).inverse_kinematics.__doc__,
    )
    assert all(line in text for line in listed for text in texts)
