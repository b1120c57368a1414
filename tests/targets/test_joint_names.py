"""What others call the joints, and their largest speeds and torques, in every target, whatever the names are."""

import shutil
import subprocess
from pathlib import Path

import pytest

from derive.robot.robot import Robot
from derive.targets.c import render_c
from derive.targets.javascript import render_javascript
from derive.targets.numpy import render_numpy
from derive.targets.octave import render_octave
from derive.targets.readme import render as render_readme
from derive.targets.target import joint_bounds
from tests.targets.generated_models import casadi_model, numpy_model, planar, source_of
from tests.targets.javascript_model import JavaScriptModel
from tests.targets.octave_model import needs_octave, octave_model

NAMES = ('shoulder "pan" \\', "*/ it's ''' \"\"\" <&> `x` --> {{ dof }} %{", "q3")

NAMED = """
name: named
convention: standard
joints:
  - {type: revolute, theta: q1, a: 0.5, limits: [-2, 2], speed: 3, torque: 80, name: "shoulder \\"pan\\" \\\\"}
  - {type: prismatic, d: q2, alpha: pi/2, torque: 9.5, name: "*/ it's ''' \\"\\"\\" <&> `x` --> {{ dof }} %{"}
  - {type: revolute, theta: q3, d: 0.1}
inverse: {task: [x, y, z], given: [q2]}
"""

SPEEDS, TORQUES = (3.0, None, None), (80.0, 9.5, None)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.from_text(NAMED)


def test_a_joint_without_a_name_is_called_by_its_variable(robot: Robot) -> None:
    assert tuple(joint.label for joint in robot.joints) == NAMES
    assert [joint.name for joint in robot.joints] == [*NAMES[:2], ""]
    assert joint_bounds(robot) == {"SPEED_LIMITS": SPEEDS, "TORQUE_LIMITS": TORQUES}
    assert joint_bounds(planar()) == {}


def test_python_has_names_and_bounds_to_the_letter(robot: Robot) -> None:
    for model in (numpy_model(robot), casadi_model(robot)):
        assert (model.JOINT_NAMES, model.SPEED_LIMITS, model.TORQUE_LIMITS) == (NAMES, SPEEDS, TORQUES)
        assert {"SPEED_LIMITS", "TORQUE_LIMITS"} <= {*model.__all__}
        assert "shoulder" in (model.__doc__ or "")
    assert "SPEED_LIMITS" not in render_numpy(source_of(planar()))["model_numpy.py"]


def test_javascript_has_names_and_bounds_to_the_letter(robot: Robot) -> None:
    model = JavaScriptModel(robot)
    assert model.value("model.JOINT_NAMES") == [*NAMES]
    assert model.value("[model.SPEED_LIMITS, model.TORQUE_LIMITS]") == [[*SPEEDS], [*TORQUES]]
    assert "</" not in render_javascript(source_of(robot))["model.mjs"]


@needs_octave
def test_octave_has_names_and_bounds_to_the_letter(robot: Robot, tmp_path: Path) -> None:
    with octave_model(tmp_path, robot):
        pass  # the package is read
    (text,) = (t for name, t in render_octave(source_of(robot)).items() if name.endswith("/model.m"))
    assert "'*/ it''s '''''' \"\"\" <&> `x` --> {{ dof }} %{'" in text
    assert "robot.speed_limits = [3.0; Inf; Inf];" in text


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_names_end_no_comment_of_c(robot: Robot, tmp_path: Path) -> None:
    for name, text in render_c(source_of(robot)).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    command = ["cc", "-std=c99", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-x", "c", str(tmp_path / "model.h")]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr
    assert "shoulder" in (tmp_path / "model.h").read_text(encoding="utf-8")


def test_the_page_names_them_outside_of_code(robot: Robot) -> None:
    page = render_readme(source_of(robot))["README.md"]
    assert "- `1: q1, revolute [rad]` shoulder" in page
    assert "- `3: q3, revolute [rad]`\n" in page
