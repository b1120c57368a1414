"""The C model as a callable: its header alone says what there is, and a source that is wrong is one message."""

import ctypes
from pathlib import Path

import pytest

from derive.errors import VerificationError
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot
from derive.targets.c import render_c
from derive.targets.compiler import find_compiler
from derive.targets.target import Source
from derive.verification.c_model import CModel, load_c_model

TEXT = "name: one\nconvention: standard\njoints: [{type: revolute, a: a1, d: d1}]\n"


def test_names_and_numbers_are_those_of_the_header() -> None:
    robot = Robot.from_text(TEXT)
    program = build_program(robot, Effort.QUICK)
    model = CModel(ctypes.CDLL(None), render_c(Source(robot, program, "0.0.0"))["model.h"])
    shapes = {function.name: function.shape for function in program}
    assert model.constants == {**shapes, "DOF": 1, "PARAMETERS": program.parameters, "GIVEN": ()}
    assert set(program.parameters) == {"a1", "d1"}


@pytest.mark.skipif(find_compiler() is None, reason="no C compiler")
def test_code_that_does_not_compile_is_one_message(tmp_path: Path) -> None:
    (tmp_path / "model.c").write_text("this is no C\n", encoding="utf-8")
    compiler = find_compiler()
    assert compiler is not None
    with pytest.raises(VerificationError, match=r"model\.c cannot be compiled"):
        load_c_model(tmp_path / "model.c", compiler)
