"""Generated code of trees, a function of an end by its name, and of coupled robots, with arguments for variables."""

from pathlib import Path

import numpy as np
import pytest

from derive.api.build import build, stale, verify
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot
from tests.cli.command import contents, refused
from tests.random_robots import swept
from tests.robot.test_trees import BODY, TORSO
from tests.rows import robot_of_rows
from tests.targets.generated_models import arguments, load, needs_compiler, numpy_model
from tests.targets.languages import languages, texts_of
from tests.targets.test_conformance import assert_right

OF_ENDS = (
    *("forward_kinematics", "jacobian", "jacobian_end", "jacobian_hessian", "analytic_jacobian_rpy", "manipulability"),
    *("manipulability_position", "manipulability_dq", "wrench_torques", "wrench_torques_end", "wrench_torques_end_dq"),
)


def test_functions_take_the_name_of_an_end() -> None:
    torso = numpy_model(Robot.from_text(TORSO))
    given = arguments(4, joints=5)
    numbers = dict.fromkeys(torso.PARAMETERS, 0.7)
    assert torso.ENDS == ("left", "right")
    for name in OF_ENDS:
        taken = (given["q"], given["h"]) if name.startswith("wrench") else (given["q"],)
        for end in torso.ENDS:
            wanted = getattr(torso, f"{name}_{end}")(*taken, params=numbers)
            out = np.empty_like(wanted)
            assert getattr(torso, name)(*taken, params=numbers, end=end, out=out) is out
            np.testing.assert_array_equal(out, wanted)
        for wrong in ("Left", "", None, 0):
            with pytest.raises(ValueError, match=f"{name}: end {wrong!r}; allowed: left, right"):
                getattr(torso, name)(*taken, params=numbers, end=wrong)
        with pytest.raises(TypeError, match="end"):
            getattr(torso, name)(*taken, params=numbers)
    left, right = (torso.jacobian(given["q"], params=numbers, end=end) for end in torso.ENDS)
    assert not left[..., 3:].any()
    assert not right[..., 1:3].any()


@needs_compiler
@pytest.mark.parametrize("text", swept(TORSO, BODY), ids=["torso", "body"])
def test_trees_are_built_verified_and_fresh(text: str, tmp_path: Path) -> None:
    robot = Robot.from_text(text)
    assert {"model_numpy.py", "model_casadi.py", "model.c"} <= {*build(robot, tmp_path, effort="quick").files}
    assert verify(robot, tmp_path, samples=6).worst < 1e-9
    (found,) = stale([robot], tmp_path, effort="quick")
    assert found.is_current


def test_a_joint_that_nothing_loads_has_base_parameters_that_are_zero(tmp_path: Path) -> None:
    robot = robot_of_rows("R | R a: 1 | R", "gravity: [0, 0, -g]\nlinks: [{mass: m1}, {mass: m2}, {mass: m3}]")
    assert build(robot, tmp_path, targets=["numpy"], only=True).report.worst < 1e-9


GEARED = """
name: geared
convention: standard
units: {angle: deg}
root: {type: planar}
variables: {q1: {limits: [-90, 90], speed: 60, torque: 5}}
joints:
  - {type: revolute, theta: 2*q1 + 30, a: 0.4}
  - {type: prismatic, d: p*x - y/2, alpha: 90}
  - {type: revolute, theta: q1 - phi, a: 0.2}
links: [{mass: m, com: [-0.1, 0, 0]}, {mass: 2}, {mass: 1, inertia: {zz: 0.02}, friction: {coulomb: [0.2, 0.3]}}]
"""
WORDS = "whose joints are coupled; allowed: robots of which each joint has its own variable"
REFUSED = (
    "export {} --format csv",
    *(f"show {{}} {name}" for name in ("inverse", "singularities", "workspace", "aspects", "manipulability", "detJv")),
    *("plot {} --workspace -o arm.svg", "convert {} -o other.yaml"),
)


@pytest.mark.parametrize("language", languages("numpy", "c"))
def test_functions_have_as_many_arguments_as_variables(language: str) -> None:
    robot = Robot.from_text(GEARED)
    assert (robot.n, robot.dof) == (6, 4)
    program = build_program(robot, Effort.QUICK, inverse=True)
    assert program.inverse is None
    assert_right(language, robot, program)


def test_constants_are_those_of_the_variables() -> None:
    model = load(texts_of("numpy", Robot.from_text(GEARED))["model_numpy.py"])
    assert (model.DOF, model.JOINT_NAMES) == (4, ("x", "y", "phi", "q1"))
    assert (model.LIMITS[:3], model.LIMITS[3]) == ((None,) * 3, pytest.approx((-np.pi / 2, np.pi / 2)))
    assert (model.SPEED_LIMITS[3], model.TORQUE_LIMITS[3]) == (pytest.approx(np.pi / 3), 5)


@pytest.mark.parametrize("command", REFUSED)
def test_what_is_made_of_joints_with_their_own_variables_refuses(command: str, tmp_path: Path) -> None:
    words = command.format("palletiser").split()
    outcome = refused(*words, folder=tmp_path)
    assert (WORDS in outcome.stderr, outcome.stdout, contents(tmp_path)) == (True, "", {})
