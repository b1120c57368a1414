"""Generated code of trees: a function of an end by its name, and the same built, verified and found fresh."""

from pathlib import Path

import numpy as np
import pytest

from derive.api.build import build, stale, verify
from derive.robot.robot import Robot
from tests.random_robots import swept
from tests.robot.test_trees import BODY, TORSO
from tests.rows import robot_of_rows
from tests.targets.generated_models import arguments, needs_compiler, numpy_model

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
