"""C and Octave as callables: what is wrong with a program or a source is one message."""

import ctypes
from pathlib import Path

import numpy as np
import pytest

from derive.errors import VerificationError
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot
from derive.targets.c import render_c
from derive.targets.compiler import find_compiler, require_compiler
from derive.targets.target import Source
from derive.verification import verify as module
from derive.verification.c_model import CModel, load_c_model
from derive.verification.octave_model import find_octave, octave_package, running_octave
from derive.verification.verify import verify
from tests.targets.generated_models import needs_octave, write_package

TEXT = "name: two-bars\nconvention: standard\njoints: [{type: revolute, a: a1}, {type: prismatic, alpha: pi/2}]\n"


def test_octave_is_found_by_its_variable_or_its_names(tmp_path: Path) -> None:
    (tmp_path / "octave").write_text("#!/bin/sh\n")
    (tmp_path / "octave").chmod(0o755)
    assert find_octave({"PATH": str(tmp_path)}) == (str(tmp_path / "octave"),)
    assert find_octave({"PATH": str(tmp_path), "OCTAVE": "octave -W"}) == (str(tmp_path / "octave"), "-W")
    assert find_octave({"PATH": str(tmp_path), "OCTAVE": "no-such-program"}) is None


@needs_octave
def test_a_wrong_function_fails_the_verification(tmp_path: Path) -> None:
    robot = Robot.from_text(TEXT)
    write_package(tmp_path, robot)
    assert {row.target for row in verify(robot, tmp_path, samples=3).rows} == {"octave"}
    file = tmp_path / "+two_bars" / "jacobian.m"
    right = file.read_text()
    file.write_text(right.replace("J = reshape([\n", "J = 1.5*reshape([\n"))
    with pytest.raises(VerificationError, match=r"jacobian of \+two_bars differs: entry"):
        verify(robot, tmp_path, samples=3)
    file.write_text("function J = jacobian(q\n")
    with pytest.raises(VerificationError, match=r"jacobian of \+two_bars raises VerificationError: .*parse error"):
        verify(robot, tmp_path, samples=3)


@needs_octave
def test_an_octave_that_ends_is_one_message(tmp_path: Path) -> None:
    write_package(tmp_path, Robot.from_text(TEXT))
    with running_octave(tmp_path, find_octave()) as (model,):
        model.process.kill()
        with pytest.raises(VerificationError, match=r"Octave ended while it ran \+two_bars"):
            model.call("jacobian", [np.zeros(2)], {"a1": 1.0})


def test_without_octave_the_report_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = Robot.from_text(TEXT)
    write_package(tmp_path, robot)
    monkeypatch.setattr(module, "find_octave", lambda: None)
    (tmp_path / "MANIFEST.json").write_text('{"files": {"+two_bars/jacobian.m": ""}}')
    report = verify(robot, tmp_path, samples=3)
    assert octave_package(tmp_path) == "+two_bars"
    assert report.reasons == ("+two_bars: not verified, there is no Octave",)
    with running_octave(tmp_path, None) as found:
        assert found == ()


ONE_JOINT = "name: one\nconvention: standard\njoints: [{type: revolute, a: a1, d: d1}]\n"


def test_names_and_numbers_are_those_of_the_header() -> None:
    robot = Robot.from_text(ONE_JOINT)
    program = build_program(robot, Effort.QUICK)
    model = CModel(ctypes.CDLL(None), render_c(Source(robot, program, "0.0.0"))["model.h"])
    shapes = {function.name: function.shape for function in program}
    assert model.constants == {**shapes, "DOF": 1, "PARAMETERS": program.parameters, "GIVEN": ()}
    assert set(program.parameters) == {"a1", "d1"}


@pytest.mark.skipif(find_compiler() is None, reason="no C compiler")
def test_code_that_does_not_compile_is_one_message(tmp_path: Path) -> None:
    (tmp_path / "model.c").write_text("this is no C\n", encoding="utf-8")
    with pytest.raises(VerificationError, match=r"model\.c cannot be compiled"):
        load_c_model(tmp_path / "model.c", require_compiler())
