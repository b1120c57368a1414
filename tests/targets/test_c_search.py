"""Functions in C, their parts and arrays; arms without formulas in NumPy, C and CasADi, and the reason if none."""

import re
from fractions import Fraction

import numpy as np
import pytest

from derive.programs.tape.graph import Graph
from derive.programs.tape.tape import PARAMETER
from derive.programs.tape.value import Value
from derive.targets.c import c_function, c_inverse, c_search, render_c
from derive.targets.readme import render as render_readme
from tests.inverse.arms import PUBLISHED
from tests.targets.generated_models import c_model, casadi_model, needs_compiler, small_program, source_of
from tests.targets.searched_arms import (
    CROOKED,
    GENERAL,
    LOOSE,
    PARAMETERS,
    model_of,
    poses_of,
    program_of,
    robot_of,
    search_of,
)
from tests.targets.test_inverse import elbow
from tests.targets.test_inverse import program_of as formulas_of

GIVEN = [3]

INEXACT = np.array(
    [
        [1.2, 0.87, 2.95, -2.16, -0.47, 3.02],
        [0.7, -0.76, 1.44, 2.76, -1.93, 0.92],
        [-2.12, -1.32, -0.01, -2.9, -0.04, 2.16],
        [1.58, -0.89, 1.62, -2.85, 2.83, -1.83],
    ]
)
"""Of the Jaco arm: at their poses the first elimination is worst, with products fused into sums or without."""


def test_every_solution_leads_to_its_pose_and_the_configuration_is_one() -> None:
    model, (q, poses) = model_of(GENERAL), poses_of(GENERAL, 40)
    found, status = model.inverse_kinematics(poses, PARAMETERS, q[:, GIVEN], status=True)
    assert (found.shape, status.shape, status.dtype) == ((40, 16, 7), (40, 16), np.uint8)
    assert np.array_equal(np.isfinite(found).all(axis=-1), status != model.NONE)
    assert (np.diff((status > 0).astype(int), axis=1) <= 0).all()  # those that exist come first
    assert not (np.diff(found[..., 0], axis=1) < -1e-6).any()
    again = model.forward_kinematics(np.nan_to_num(found), PARAMETERS)
    assert np.abs(again - poses[:, None])[status > 0].max() < 1e-12
    apart = np.abs(np.angle(np.exp(1j * (found - q[:, None]))))
    apart[..., GIVEN] = np.abs(found - q[:, None])[..., GIVEN]
    assert np.nanmin(apart.max(axis=-1), axis=1).max() < 1e-8
    one = model.inverse_kinematics(poses[0], PARAMETERS, q[0, GIVEN])
    np.testing.assert_allclose(one, found[0], atol=1e-9)
    found, status = model.inverse_kinematics(np.empty((2, 0, 4, 4)), PARAMETERS, np.empty((2, 0, 1)), status=True)
    assert (found.shape, status.shape) == ((2, 0, 16, 7), (2, 0, 16))


@needs_compiler
def test_c_finds_the_solutions_that_numpy_finds() -> None:
    (q, poses), compiled = poses_of(GENERAL, 40), c_model(robot_of(GENERAL), program_of(GENERAL))
    wanted = model_of(GENERAL).inverse_kinematics(poses, PARAMETERS, q[:, GIVEN])
    found, status = compiled.inverse(poses, q[:, GIVEN], PARAMETERS)
    assert np.array_equal((status > 0).sum(axis=1), np.isfinite(wanted[..., 0]).sum(axis=1))
    np.testing.assert_allclose(found, wanted, atol=1e-9)
    away = poses.copy()
    away[:, 0, 3] += 50.0
    assert not compiled.inverse(away[:4], q[:4, GIVEN], PARAMETERS)[1].any()


@pytest.mark.sweep
@needs_compiler
def test_no_solution_is_lost_where_the_eigenvalue_problem_of_a_pose_is_inexact() -> None:
    jaco = next(case.text for case in PUBLISHED if case.name == "jaco")
    compiled, model = c_model(robot_of(jaco), program_of(jaco)), model_of(jaco)
    q = (INEXACT[:, None] + np.random.default_rng(6).uniform(-1e-4, 1e-4, (len(INEXACT), 40, 6))).reshape(-1, 6)
    poses = np.asarray(model.forward_kinematics(q))
    found, status = compiled.inverse(poses, np.empty((len(q), 0)), {})
    apart = np.abs(np.angle(np.exp(1j * (found - q[:, None])))).max(axis=-1)
    assert np.nanmin(apart, axis=1).max() < 1e-6
    wanted = np.isfinite(model.inverse_kinematics(poses)[..., 0]).sum(axis=1)
    assert np.array_equal((status > 0).sum(axis=1), wanted)


@needs_compiler
def test_poses_of_short_numbers_have_the_solutions_of_those_next_to_them() -> None:
    (q, poses), compiled = poses_of(GENERAL, 12), c_model(robot_of(GENERAL), program_of(GENERAL))
    short = poses.astype(np.float32)
    wanted = model_of(GENERAL).inverse_kinematics(poses, PARAMETERS, q[:, GIVEN])
    found = model_of(GENERAL).inverse_kinematics(short, PARAMETERS, q[:, GIVEN])
    other, _ = compiled.inverse(short.astype(float), q[:, GIVEN], PARAMETERS)
    for rows, ours, theirs in zip(wanted, found, other, strict=True):
        apart = np.abs(ours[None] - rows[:1, None]).max(axis=-1)
        assert np.nanmin(apart) < 1e-3
        np.testing.assert_allclose(theirs, ours, atol=1e-8)
    again = model_of(GENERAL).forward_kinematics(np.nan_to_num(found), PARAMETERS)
    assert np.abs(again - short[:, None])[np.isfinite(found[..., 0])].max() < 1e-6


@needs_compiler
@pytest.mark.parametrize("entry", [np.nan, np.inf, 1e300], ids=str)
def test_in_c_no_solution_exists_at_what_is_no_number(entry: float) -> None:
    (q, poses), compiled = poses_of(GENERAL, 2), c_model(robot_of(GENERAL), program_of(GENERAL))
    bad = poses.copy()
    bad[1, 1, 3] = entry
    found, status = compiled.inverse(bad, q[:, GIVEN], PARAMETERS)
    assert status[0].any()
    assert not status[1].any()
    assert np.isnan(found[1]).all()


def test_parameters_may_differ_from_pose_to_pose() -> None:
    model, (q, _) = model_of(GENERAL), poses_of(GENERAL, 6)
    lengths = np.array([0.3, 0.4, 0.3, 0.5, 0.4, 0.3])
    poses = model.forward_kinematics(q, {"a3": lengths})
    found = model.inverse_kinematics(poses, {"a3": lengths}, q[:, GIVEN])
    again = model.forward_kinematics(found, {"a3": lengths[:, None]})
    assert np.nanmax(np.abs(again - poses[:, None])) < 1e-12
    assert np.isfinite(found[:, 0]).all()


def test_the_nearest_solution_is_within_the_limits() -> None:
    model, (q, poses) = model_of(GENERAL), poses_of(GENERAL, 10)
    turned = q + np.array([0, 0, 2 * np.pi, 0, 0, 0, 0])
    near = model.inverse_kinematics_nearest(poses, turned, PARAMETERS)
    np.testing.assert_allclose(near, turned, atol=1e-8)


def test_what_is_no_pose_and_arrays_of_others_are_refused() -> None:
    import jax.numpy as jnp

    model, (q, poses) = model_of(GENERAL), poses_of(GENERAL, 2)
    with pytest.raises(ValueError, match="is not a valid pose"):
        model.inverse_kinematics(2.0 * np.eye(4), PARAMETERS, [0.0])
    with pytest.raises(ValueError, match=r"given must have shape \(1,\)"):
        model.inverse_kinematics(poses, PARAMETERS)
    with pytest.raises(ValueError, match="missing in params: a3"):
        model.inverse_kinematics(poses, None, q[:, GIVEN])
    with pytest.raises(TypeError, match="only NumPy arrays are supported; got arrays of jax"):
        model.inverse_kinematics(jnp.asarray(poses), PARAMETERS, q[:, GIVEN])


@pytest.mark.parametrize(("text", "least"), [(LOOSE, 1), (CROOKED, 2)], ids=["loose", "crooked"])
def test_damped_newton_finds_what_eigenvalues_do_not_also_on_a_base_of_eight_digits(text: str, least: int) -> None:
    model, (q, poses) = model_of(text), poses_of(text, 2)
    found, status = model.inverse_kinematics(poses, status=True)
    assert (status > 0).sum(axis=1).min() >= least
    places = tuple(zip(*search_of(text).entries, strict=True))
    reached = model.forward_kinematics(np.nan_to_num(found))[(..., *places)]
    assert np.abs(reached - poses[(..., *places)][:, None])[status > 0].max() < 1e-10
    apart = np.abs(np.angle(np.exp(1j * (found - q[:, None])))).max(axis=-1)
    assert np.nanmin(apart, axis=1).max() < 1e-6


def test_casadi_and_the_page_of_the_folder_say_why() -> None:
    robot, program = robot_of(GENERAL), program_of(GENERAL)
    with pytest.raises(AttributeError, match="no inverse_kinematics in CasADi: its joints follow from the eigenvalues"):
        _ = casadi_model(robot, program).inverse_kinematics
    page = " ".join(render_readme(source_of(robot, program))["README.md"].split())
    assert "`inverse_kinematics(T, given)` | 16 x 7 | by numbers" in page
    assert search_of(GENERAL).summary in page
    assert "inverse_kinematics" not in render_c(source_of(robot_of(LOOSE), program_of(LOOSE)))["model.h"]


def test_arrays_of_c_are_as_long_as_the_arm_needs() -> None:
    text = c_search(search_of(GENERAL), robot_of(GENERAL))
    assert (text["free_count"], text["given_count"], text["entry_count"]) == (6, 1, 12)
    assert text["free"] == "0, 1, 2, 4, 5, 6"
    assert text["signs"].split(", ")[2] == "-1.0"
    assert text["size"] >= 16
    assert text["columns"] >= max(sum(each.rows) for each in search_of(GENERAL).eliminations)
    assert not text["is_position"]


def test_work_goes_to_the_part_that_needs_nothing_more() -> None:
    graph = Graph()
    angle, length = Value(graph, graph.input("q", 0)), Value(graph, graph.input(PARAMETER, 0))
    program = small_program(graph, [angle.cos() * length.sqrt(), (angle + length).sin()])
    (text,) = [c_function(function, ["a1"]) for function in program]
    assert (text["used"], text["constant_count"], text["angle_count"]) == (("q",), 2, 2)
    assert "sqrt" in " ".join(text["constants"]["body"] + text["constants"]["results"])
    assert array_names(text["constants"]["declaration"]) == ["params", "k"]
    assert array_names(text["angles"]["declaration"]) == ["q", "k", "angles"]
    assert array_names(text["lane"]["declaration"]) == ["sines", "cosines", "k", "result"]


def test_an_argument_without_a_say_is_declared_and_not_loaded() -> None:
    graph = Graph()
    (text,) = [c_function(f, ()) for f in small_program(graph, [Value(graph, graph.number(Fraction(3)))])]
    assert (text["used"], text["unused"]) == ((), text["arguments"])
    assert array_names(text["declaration"]) == [*text["arguments"], "result"]
    assert array_names(text["block_declaration"]) == ["result"]


def array_names(declaration: str) -> list[str]:
    return re.findall(r"\*(?:restrict )?(\w+)", declaration)


def test_inverse_kinematics_has_the_limits_and_lengths_of_the_robot() -> None:
    program = formulas_of(elbow())
    text = c_inverse(program.inverse, source_of(elbow(), program))
    assert text["lower"] == "-2.0, -INFINITY, -INFINITY, -1.0"
    assert text["upper"] == "2.0, INFINITY, INFINITY, 1.0"
    assert text["revolute"] == "1, 1, 1, 0"
    assert text["size"] == text["branches"] * 4
    assert {load["name"]: load["width"] for load in text["loads"]}["T"] == 16
    assert {load["name"] for load in text["loads"] if load["is_optional"]} <= {"near"}
