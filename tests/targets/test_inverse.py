"""Inverse kinematics in every language: the same solutions, the same words, the nearest one within the limits."""

import ctypes
import json
from functools import cache
from pathlib import Path
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
from tests.inverse.arms import random_arm
from tests.targets.c_models import c_model, needs_compiler
from tests.targets.generated_models import load, numpy_model, source_of
from tests.targets.javascript_model import JavaScriptModel

NAMES = {"forward_kinematics"}
TOLERANCE = 1e-9
TEXT = """
name: elbow
convention: standard
joints:
  - {type: revolute, d: 0.3, alpha: pi/2, limits: [-2, 2]}
  - {type: revolute, a: a2}
  - {type: revolute, a: 0.4}
  - {type: prismatic, alpha: -pi/2, limits: [-1, 1]}
"""
PARAMETERS = {"a2": 0.5}


@cache
def program_of(robot: Robot) -> Program:
    return build_program(robot, Effort.QUICK, names=NAMES, inverse=True)


def elbow() -> Robot:
    return Robot.from_text(TEXT)


@cache
def model_of(robot: Robot) -> ModuleType:
    return numpy_model(robot, program_of(robot))


def cases(robot: Robot, count: int = 40) -> tuple[np.ndarray, np.ndarray, dict[str, float]]:
    parameters = PARAMETERS if "a2" in program_of(robot).parameters else {}
    q = np.random.default_rng(7).uniform(-0.9, 0.9, (count, robot.n))
    return q, np.asarray(model_of(robot).forward_kinematics(q, **options(parameters))), parameters


def options(parameters: dict[str, float]) -> dict[str, Any]:
    """The last arguments of a call."""
    return {"params": parameters} if parameters else {}


ROBOTS = [pytest.param(elbow(), id="elbow"), pytest.param(Robot.load("puma560-corke"), id="puma")]


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_batch_one_pose_and_out_give_the_same(robot: Robot) -> None:
    q, poses, parameters = cases(robot)
    model = model_of(robot)
    found, status = model.inverse_kinematics(poses, status=True, **options(parameters))
    branches = program_of(robot).inverse.branches
    assert (found.shape, status.shape, status.dtype) == ((len(q), branches, robot.n), (len(q), branches), np.uint8)
    assert np.array_equal(np.isnan(found).any(axis=-1), status == model.NONE)
    assert (status == model.EXACT).any(axis=1).all()
    for pose, row, codes in zip(poses, found, status, strict=True):
        one, code = model.inverse_kinematics(pose, status=True, **options(parameters))
        np.testing.assert_allclose(one, row, atol=TOLERANCE)
        assert np.array_equal(code, codes)
    out = np.zeros((5, 2, branches, robot.n)).swapaxes(0, 1)
    result = model.inverse_kinematics(poses[:10].reshape(2, 5, 4, 4), out=out, **options(parameters))
    assert result is out
    np.testing.assert_allclose(out.reshape(10, branches, robot.n), found[:10], atol=TOLERANCE)


@pytest.mark.parametrize("robot", [ROBOTS[0], pytest.param(Robot.load("puma560-corke"), marks=pytest.mark.sweep)])
def test_arrays_of_other_libraries_give_the_same(robot: Robot) -> None:
    _, poses, parameters = cases(robot, 20)
    model = model_of(robot)
    with jax.enable_x64(True):
        found = model.inverse_kinematics(jnp.asarray(poses), **options(parameters))
        wanted = model.inverse_kinematics(poses, **options(parameters))
        np.testing.assert_allclose(np.asarray(found), wanted, atol=TOLERANCE)


@needs_compiler
@pytest.mark.parametrize("robot", ROBOTS)
def test_c_gives_the_same(robot: Robot) -> None:
    q, poses, parameters = cases(robot)
    model = c_model(robot, program_of(robot))
    wanted, codes = model_of(robot).inverse_kinematics(poses, status=True, **options(parameters))
    given = q[:, :0]
    found, status = model.inverse(poses, given, parameters)
    np.testing.assert_allclose(found, wanted, atol=TOLERANCE)
    assert np.array_equal(status, codes)
    one, code = model.inverse(poses[3:4], given[3:4], parameters)
    np.testing.assert_allclose(one, wanted[3:4], atol=TOLERANCE)
    assert np.array_equal(code, codes[3:4])


@needs_compiler
@pytest.mark.parametrize("robot", ROBOTS)
def test_the_nearest_solution_in_c_is_that_of_numpy(robot: Robot) -> None:
    q, poses, parameters = cases(robot)
    model = c_model(robot, program_of(robot))
    near = q + np.random.default_rng(1).uniform(-0.3, 0.3, q.shape)
    wanted = model_of(robot).inverse_kinematics_nearest(poses, near, **options(parameters))
    prefix = f"{robot.name.replace('-', '_')}_inverse_kinematics"
    constants = np.zeros(64)
    if parameters:
        numbers = np.array(list(parameters.values()))
        getattr(model.shared, f"{prefix}_constants")(pointer(numbers), pointer(constants))
    for pose, start, row in zip(poses, near, wanted, strict=True):
        found = np.zeros(robot.n)
        inputs = [pointer(np.ascontiguousarray(pose)), pointer(start), *([pointer(constants)] if parameters else [])]
        status = getattr(model.shared, f"{prefix}_nearest")(*inputs, pointer(found))
        assert bool(status) == (not np.isnan(row).any())
        np.testing.assert_allclose(found, row, atol=TOLERANCE)


def pointer(array: np.ndarray) -> Any:
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


@pytest.mark.parametrize("robot", ROBOTS)
def test_casadi_has_a_function_for_each_branch(robot: Robot) -> None:
    _, poses, parameters = cases(robot, 6)
    module = load(render_casadi(source_of(robot, program_of(robot)))["model_casadi.py"])
    wanted, codes = model_of(robot).inverse_kinematics(poses, status=True, **options(parameters))
    assert len(module.inverse_kinematics) == wanted.shape[1]
    for k, branch in enumerate(module.inverse_kinematics):
        assert (branch.name(), branch.name_in()[0], branch.name_out()) == (
            f"inverse_kinematics_{k + 1}",
            "T",
            ["q", "status"],
        )
        for pose, row, code in zip(poses, wanted, codes, strict=True):
            q, status = branch(pose, *([list(parameters.values())] if parameters else []))
            np.testing.assert_allclose(np.array(q)[:, 0], row[k], atol=TOLERANCE)
            assert int(status) == code[k]


@pytest.mark.parametrize("entry", [np.nan, np.inf, 1e160], ids=str)
def test_in_casadi_no_branch_exists_at_what_is_no_number_or_out_of_any_reach(entry: float) -> None:
    robot = elbow()
    model = load(render_casadi(source_of(robot, program_of(robot)))["model_casadi.py"])
    _, poses, _ = cases(robot, 1)
    bad = poses[0].copy()
    bad[1, 1 if np.isnan(entry) else 3] = entry
    for function in model.inverse_kinematics:
        q, status = function(bad, [0.5])
        assert float(status) == 0.0
        assert np.isnan(np.array(q)).all()


def test_javascript_gives_the_same_and_the_nearest() -> None:
    robot = elbow()
    q, poses, parameters = cases(robot, 5)
    model, numpy = JavaScriptModel(robot, program_of(robot)), model_of(robot)
    wanted, codes = numpy.inverse_kinematics(poses, status=True, params=parameters)
    for k, pose in enumerate(poses):
        text = json.dumps(pose.tolist())
        found = model.value(f"model.inverseKinematics({text}, {json.dumps(parameters)})")
        assert found["status"] == codes[k].tolist()
        rows = [[np.nan] * robot.n if row is None else row for row in found["q"]]
        np.testing.assert_allclose(rows, wanted[k], atol=TOLERANCE)
        near = model.value(f"model.inverseKinematicsNearest({text}, {q[k].tolist()}, {json.dumps(parameters)})")
        np.testing.assert_allclose(near["q"], q[k], atol=1e-7)
    with pytest.raises(
        Exception, match=r"T is not a valid pose: the columns of its rotation are 2.1e-1 from orthonormal"
    ):
        model.value("model.inverseKinematics([[1.1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], [0.5])")
    unit = "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"
    for call, message in (
        (f"inverseKinematics({unit}, [0.5], [0, NaN, 0, 0])", "near must be finite numbers"),
        (f"inverseKinematicsNearest({unit}, [0, Infinity, 0, 0], [0.5])", "q must be finite numbers"),
        ("inverseKinematics([[1,0,0,1e200],[0,1,0,0],[0,0,1,0],[0,0,0,1]], [0.5])", "1e\\+200 m away"),
    ):
        with pytest.raises(Exception, match=message):
            model.value(f"model.{call}")


def test_the_nearest_solution_is_the_configuration_itself_full_turns_included() -> None:
    robot = elbow()
    q, poses, parameters = cases(robot)
    model = model_of(robot)
    np.testing.assert_allclose(model.inverse_kinematics_nearest(poses, q, params=parameters), q, atol=1e-7)
    turned = q + 2 * np.pi * np.array([0, 1, -2, 0])
    np.testing.assert_allclose(model.inverse_kinematics_nearest(poses, turned, params=parameters), turned, atol=1e-7)
    beyond = q + 2 * np.pi * np.array([1, 0, 0, 0])  # joint 1 has limits
    np.testing.assert_allclose(model.inverse_kinematics_nearest(poses, beyond, params=parameters), q, atol=1e-7)


def test_what_is_beyond_the_limits_is_not_near() -> None:
    robot, model = elbow(), model_of(elbow())
    pose = model.forward_kinematics([2.5, 0.2, 0.3, 0.1], params=PARAMETERS)
    assert not np.isnan(model.inverse_kinematics(pose, params=PARAMETERS)).all()
    found = model.inverse_kinematics_nearest(pose, np.zeros(robot.n), params=PARAMETERS)
    assert np.isnan(found).all() or abs(found[0]) <= 2


def test_parameters_may_vary_over_a_batch() -> None:
    model = model_of(elbow())
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


@pytest.mark.parametrize(
    ("pose", "message"),
    [
        (np.eye(3), r"T must have shape \(4, 4\) or \(..., 4, 4\); got \(3, 3\)"),
        (
            pose_with(r00=1.1),
            r"T is not a valid pose: its rotation is not orthonormal \(error 2.1e-01 > 1e-06\)",
        ),
        (pose_with(r22=-1.0), r"T is not a valid pose: its rotation mirrors: the determinant is -1"),
        (pose_with(r13=np.nan), r"T is not a valid pose: it has non-finite entries"),
        (pose_with(r00=np.nan), r"T is not a valid pose: it has non-finite entries"),
        (pose_with(r33=2.0), r"T is not a valid pose: its last row is \[0.0, 0.0, 0.0, 2.0\], not \[0, 0, 0, 1\]"),
        (np.array([np.eye(4), pose_with(r00=2.0)]), r"T\[1\] is not a valid pose: its rotation is not orthonormal"),
        (
            np.concatenate([np.tile(np.eye(4), (5000, 1, 1)), [pose_with(r22=-1.0)]]),
            r"T\[5000\] is not a valid pose: its rotation",
        ),
        (pose_with(r03=1e200), r"T is not a valid pose: its position is 1e\+200 m away \(allowed: 1e\+30\)"),
        ([[1, 2], [3]], r"T must have shape .* got rows of unequal length"),
    ],
)
def test_what_is_no_pose_is_refused(pose: Any, message: str) -> None:
    with pytest.raises(ValueError, match=f"^inverse_kinematics: {message}"):
        model_of(elbow()).inverse_kinematics(pose, params=PARAMETERS)


def test_what_else_is_refused() -> None:
    model = model_of(elbow())
    with pytest.raises(ValueError, match=r"given must be None, since all joints are solved for; got shape \(1,\)"):
        model.inverse_kinematics(np.eye(4), params=PARAMETERS, given=[0.1])
    with pytest.raises(
        ValueError, match=r"q must be real numbers of shape \(4,\) or \(..., 4\); got float64 of shape \(3,\)"
    ):
        model.inverse_kinematics_nearest(np.eye(4), [0.0, 0.0, 0.0], params=PARAMETERS)
    with pytest.raises(ValueError, match=r"out must be a NumPy array of float64 of shape \(\d, 4\)"):
        model.inverse_kinematics(np.eye(4), params=PARAMETERS, out=np.zeros((3, 3)))
    with pytest.raises(ValueError, match="missing in params: a2"):
        model.inverse_kinematics(np.eye(4))
    with pytest.raises(TypeError, match="T must be real numbers; got dtype"):
        model.inverse_kinematics("pose", params=PARAMETERS)
    with pytest.raises(ValueError, match="inverse_kinematics: near must be finite numbers"):
        model.inverse_kinematics(np.eye(4), params=PARAMETERS, near=[0.0, np.nan, 0.0, 0.0])
    with pytest.raises(ValueError, match="inverse_kinematics_nearest: q must be finite numbers"):
        model.inverse_kinematics_nearest(np.eye(4), [0.0, np.inf, 0.0, 0.0], params=PARAMETERS)


@needs_compiler
@pytest.mark.parametrize("entry", [np.nan, np.inf, 1e160, 1e300], ids=str)
def test_in_c_no_branch_exists_at_what_is_no_number_or_out_of_any_reach(entry: float) -> None:
    robot = Robot.load("puma560-corke")
    _, poses, parameters = cases(robot)
    model = c_model(robot, program_of(robot))
    bad = np.repeat(poses[:1], 3, axis=0)
    bad[1, 0, 3] = entry
    for batch in (bad, bad[1:2]):  # of several poses, and of one
        q, status = model.inverse(batch, np.zeros((len(batch), 0)), parameters)
        wrong = len(batch) // 2
        assert not status[wrong].any()
        assert np.isnan(q[wrong]).all()
        assert status.any(axis=1).sum() == len(batch) - 1


def test_on_the_boundary_one_branch_is_listed() -> None:
    model = model_of(elbow())
    pose = model.forward_kinematics([0.3, 0.5, 0.0, 0.2], params=PARAMETERS)
    found, status = model.inverse_kinematics(pose, params=PARAMETERS, status=True)
    assert (status > 0).any()
    again = model.forward_kinematics(found[status > 0], params=PARAMETERS)
    np.testing.assert_allclose(again, np.broadcast_to(pose, again.shape), atol=1e-10)


UR5 = Robot.from_text(
    "name: ur5\nconvention: standard\njoints:\n"
    "  - {type: revolute, d: 0.089159, alpha: pi/2}\n  - {type: revolute, a: -0.425}\n"
    "  - {type: revolute, a: -0.39225}\n  - {type: revolute, d: 0.10915, alpha: pi/2}\n"
    "  - {type: revolute, d: 0.09465, alpha: -pi/2}\n  - {type: revolute, d: 0.0823}\n"
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
        np.testing.assert_allclose(
            model.forward_kinematics(there), np.broadcast_to(pose, (len(there), 4, 4)), atol=1e-10
        )


@needs_compiler
def test_no_reachable_pose_is_without_a_solution_for_the_place_of_free_joints() -> None:
    model, compiled = model_of(UR5), c_model(UR5, program_of(UR5))
    poses = model.forward_kinematics(np.array([STUCK, [0.4, -1.0, 1.2, 0.3, 0.5, 0.8]] * 20))
    solutions = {
        "one": np.array([model.inverse_kinematics(pose) for pose in poses]),
        "batch": model.inverse_kinematics(poses),
        "c": compiled.inverse(poses, poses[:, :0, 0], {})[0],
        "c one": np.array([compiled.inverse(pose[None], pose[None, :0, 0], {})[0][0] for pose in poses]),
    }
    for way, found in solutions.items():
        exists = ~np.isnan(found).any(axis=2)
        assert exists.any(axis=1).all(), way
        errors = np.abs(model.forward_kinematics(np.nan_to_num(found)) - poses[:, None]).max(axis=(2, 3))
        assert errors[exists].max() < 1e-10, way


@needs_compiler
def test_a_singular_wrist_gives_each_posture_once() -> None:
    robot = Robot.load("puma560-corke")
    model, compiled = model_of(robot), c_model(robot, program_of(robot))
    pose = model.forward_kinematics([0.3, 0.4, 0.5, 0.6, 0.0, 0.7])
    status = model.inverse_kinematics(pose, status=True)[1]
    assert ((status > 0).sum(), (status == model.SINGULAR).sum()) == (7, 1)
    assert np.array_equal(compiled.inverse(pose[None], pose[None, :0, 0], {})[1][0], status)


@needs_compiler
def test_at_poses_of_right_angles_every_language_has_solutions_and_all_lead_there() -> None:
    model, compiled, script = model_of(UR5), c_model(UR5, program_of(UR5)), JavaScriptModel(UR5, program_of(UR5))
    q = np.random.default_rng(5).integers(-2, 3, (60, 6)) * np.pi / 2
    poses = model.forward_kinematics(q)
    found, status = model.inverse_kinematics(poses, status=True)
    ways = {"one": np.array([model.inverse_kinematics(pose) for pose in poses]), "batch": found}
    ways["c"], codes = compiled.inverse(poses, poses[:, :0, 0], {})
    assert (codes == status).mean() > 0.98
    rows = [script.value(f"model.inverseKinematics({json.dumps(pose.tolist())})")["q"] for pose in poses[:12]]
    ways["javascript"] = np.array([[[np.nan] * 6 if row is None else row for row in every] for every in rows])
    for way, solutions in ways.items():
        exists = ~np.isnan(solutions).any(axis=2)
        assert exists.any(axis=1).all(), way
        errors = np.abs(model.forward_kinematics(np.nan_to_num(solutions)) - poses[: len(exists), None]).max(
            axis=(2, 3)
        )
        assert errors[exists].max() < 1e-10, way
    module = load(render_casadi(source_of(UR5, program_of(UR5)))["model_casadi.py"])
    for pose in poses[:12]:
        results = [[np.array(value) for value in branch(pose)] for branch in module.inverse_kinematics]
        there = np.array([joints[:, 0] for joints, code in results if code > 0])
        assert np.abs(model.forward_kinematics(there) - pose).max(initial=0.0) < 1e-7


@needs_compiler
def test_every_language_has_solutions_that_stand_alone_beside_infinitely_many() -> None:
    case = random_arm("5dof", 17)
    robot = case.robot()
    model, compiled = model_of(robot), c_model(robot, program_of(robot))
    pose = model.forward_kinematics(np.array([np.radians(55), np.pi, -np.pi / 2, -2.342869, np.pi]), case.values)
    script = JavaScriptModel(robot, program_of(robot))
    call = f"model.inverseKinematics({json.dumps(pose.tolist())}, {json.dumps(case.values)})"
    ways = {
        "numpy": model.inverse_kinematics(pose, case.values),
        "c": compiled.inverse(pose[None], pose[None, :0, 0], case.values)[0][0],
        "javascript": np.array([row or [np.nan] * 5 for row in script.value(f"{call}.q")]),
    }
    alone = [
        [0.959931, 0, 1.570796],
        [0.959931, np.pi, -1.570796],
        [1.393032, 0, 2.003897],
        [-2.53632, np.pi, 1.925454],
    ]
    for way, found in ways.items():
        apart = np.abs(np.exp(1j * found[:, None, :3]) - np.exp(1j * np.array(alone))).max(axis=2)
        assert (np.nanmin(apart, axis=0) < 2e-3).all(), way


OFFSET_SHOULDER = """
name: offset-shoulder
convention: modified
joints:
  - {type: revolute, d: 0.3}
  - {type: revolute, alpha: -pi/2, d: 0.1}
  - {type: revolute, a: 0.4}
  - {type: revolute, alpha: -pi/2, d: 0.4}
  - {type: revolute, alpha: pi/2}
  - {type: revolute, alpha: -pi/2}
"""


def test_javascript_has_the_solutions_of_numpy_at_poses_of_right_angles() -> None:
    robot = Robot.from_text(OFFSET_SHOULDER)
    model, script = model_of(robot), JavaScriptModel(robot, program_of(robot))
    q = np.random.default_rng(1).choice([0, np.pi / 2, -np.pi / 2, np.pi, 0.7], (150, 6))
    poses = model.forward_kinematics(q)
    status = model.inverse_kinematics(poses, status=True)[1]
    matrices = json.dumps(poses.tolist())
    found = script.value(f"{matrices}.map((T) => Array.from(model.inverseKinematics(T).status))")
    assert found == status.tolist()


def test_readme_says_what_there_is_and_why_not() -> None:
    text = render_readme(source_of(elbow(), program_of(elbow())))["README.md"]
    assert "## Inverse kinematics" in text
    assert "| `inverse_kinematics(T)` |" in text
    without = Program((), (), None, "an arm of straw")
    page = render_readme(source_of(elbow(), without))["README.md"]
    assert "There is no function: an arm of straw." in page


@needs_compiler
def test_the_header_names_what_a_program_needs(tmp_path: Path) -> None:
    model = c_model(elbow(), program_of(elbow()))
    for name in ("elbow_branches = ", "elbow_singular = 3", "int elbow_inverse_kinematics_nearest("):
        assert name in model.header


def test_rows_are_the_printed_solutions_in_their_order_by_their_names() -> None:
    robot = Robot.load("puma560-corke")
    _, poses, _ = cases(robot, 12)
    found, solutions = model_of(robot).inverse_kinematics(poses), inverse_kinematics(robot, robot.style).solutions
    for pose, rows in zip(poses, found, strict=True):
        entries = {f"r{i + 1}{j + 1}": pose[i, j] for i in range(3) for j in range(3)}
        values = {
            sympy.Symbol(name): x for name, x in (*entries.items(), *zip(("px", "py", "pz"), pose[:3, 3], strict=True))
        }
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
