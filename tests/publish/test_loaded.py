"""Functions that are written for the occasion: compiled or not, and gone with their folder."""

import numpy as np
import pytest

from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.publish.loaded import loaded
from derive.robot.robot import Robot
from derive.targets.target import Source
from tests.targets.generated_models import needs_compiler


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=needs_compiler)])
def test_functions_are_imported_and_go_with_their_folder(compiled: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = Robot.load("anthropomorphic-arm")
    source = Source(robot, build_program(robot, Effort.QUICK, names={"jacobian"}), "0")
    module, folder = loaded(source, compiled=compiled)
    path = folder.path
    assert (path / "model_native.py").exists() is compiled
    assert module.jacobian(np.zeros((5, 3)), params={"a2": 1.0, "a3": 1.0}).shape == (5, 6, 3)
    del folder, module
    assert not path.exists()
    monkeypatch.setenv("CC", "false")  # a compiler that does not serve is none
    assert (loaded(source, compiled=True)[1].path / "model_numpy.py").exists()
