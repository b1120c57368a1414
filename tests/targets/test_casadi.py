"""The CasADi module: the same functions, named inputs and outputs, fit for optimisation and code export."""

import random
from pathlib import Path

import casadi
import numpy as np
import pytest

from derive.robot.robot import Robot
from tests.random_robots import random_robot, seeds
from tests.targets.generated_models import FUNCTIONS, PARAMETERS, casadi_model, numpy_model, planar

MODEL = casadi_model(planar())


def arranged(result: object, shape: tuple[int, ...]) -> np.ndarray:
    """A CasADi result in the shape of the NumPy one."""
    matrix = np.array(result)
    if len(shape) == 3:
        return np.array(np.split(matrix, shape[0], axis=1))
    return matrix.reshape(shape)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_have_named_inputs_and_outputs(name: str) -> None:
    function = getattr(MODEL, name)
    assert isinstance(function, casadi.Function)
    assert function.name() == name
    assert function.is_a("SXFunction")
    assert function.name_in()[0] == "q"
    assert function.name_in()[-1] == "params"
    assert function.size_in("q") == (2, 1)
    assert function.size_in("params") == (len(PARAMETERS), 1)
    assert function.n_out() == 1


@pytest.mark.parametrize("seed", seeds(10, usual=3))
def test_results_agree_with_numpy(seed: int) -> None:
    drawn = random_robot(random.Random(100 + seed), 1 + seed % 5)
    robot = Robot.from_text(drawn.text)
    model, reference = casadi_model(robot), numpy_model(robot)
    rng = np.random.default_rng(seed)
    for name, function in ((name, getattr(model, name)) for name in reference.OPERATIONS):
        kinds = [kind for kind in function.name_in() if kind != "params"]
        given = [rng.uniform(-2, 2, robot.n) for _ in kinds]
        wanted = getattr(reference, name)(*given, params=drawn.values)
        extra = [[drawn.values[p] for p in model.PARAMETERS]] if model.PARAMETERS else []
        result = function(*given, *extra) if given or extra else function()[function.name_out(0)]
        found = arranged(result, wanted.shape)
        assert np.abs(found - wanted).max() <= 1e-12 * max(1, np.abs(wanted).max())


def test_no_parameters_no_input() -> None:
    robot = Robot.from_text("name: one\nconvention: standard\njoints: [{type: revolute, a: 0.5}]\n")
    assert casadi_model(robot).forward_kinematics.name_in() == ["q"]


def test_functions_differentiate_and_export(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    jacobian = MODEL.inverse_dynamics.jacobian()
    assert jacobian.n_out() >= 3
    MODEL.inverse_dynamics.generate("torque.c")
    assert "double" in (tmp_path / "torque.c").read_text()


def test_links_stand_side_by_side() -> None:
    reference = numpy_model(planar())
    found = np.array(MODEL.link_transforms([0.3, 0.2], list(PARAMETERS.values())))
    assert found.shape == (4, 8)
    assert found[:, 4:] == pytest.approx(reference.link_transforms([0.3, 0.2])[1])


def test_base_parameters_of_a_robot_in_numbers_have_no_input() -> None:
    robot = Robot.load("scara-matlab")
    function, reference = casadi_model(robot).base_parameters, numpy_model(robot).base_parameters()
    assert function.n_in() == 0
    np.testing.assert_allclose(function()["beta"].full()[:, 0], reference, rtol=1e-14)
