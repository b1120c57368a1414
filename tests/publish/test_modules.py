"""Modules of generated code that are imported from texts: compiled or not, the same functions."""

import pickle

import numpy as np
import pytest

from derive.errors import TargetError
from derive.programs.build import build_program
from derive.publish.modules import ModuleSources, imported, loaded
from derive.robot.robot import Robot
from derive.targets.target import Source
from tests.targets.generated_models import ONE_JOINT, needs_compiler


def sources(*, compiled: bool) -> ModuleSources:
    robot = Robot.from_text(ONE_JOINT)
    return ModuleSources.of(Source(robot, build_program(robot, names={"jacobian"}), "0.0.0"), compiled=compiled)


@needs_compiler
def test_a_compiled_module_has_the_functions_of_the_other_wherever_its_texts_go() -> None:
    (plain, _), (native, folder) = (imported(sources(compiled=compiled)) for compiled in (False, True))
    q = np.linspace(-3, 3, 50)[:, None]
    np.testing.assert_allclose(native.jacobian(q), plain.jacobian(q), atol=1e-15)
    assert imported(pickle.loads(pickle.dumps(sources(compiled=True))))[1] is folder  # kept by its texts


def test_no_compiler_is_refused_and_one_that_does_not_serve_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("CC", "nowhere-to-be-found")
    imported.cache_clear()
    with pytest.raises(TargetError, match="was not found"):
        imported(sources(compiled=True))
    monkeypatch.setenv("CC", "false")
    imported.cache_clear()
    robot = Robot.from_text(ONE_JOINT)
    source = Source(robot, build_program(robot, names={"jacobian"}), "0.0.1")
    assert (loaded(source, compiled=True)[1].path / "model_numpy.py").exists()
