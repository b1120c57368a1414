"""Generated code of coupled robots: functions of fewer variables than joints."""

from pathlib import Path

import numpy as np
import pytest

from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot
from tests.cli.command import contents, refused
from tests.targets.generated_models import load
from tests.targets.languages import languages, texts_of
from tests.targets.test_conformance import assert_right

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
