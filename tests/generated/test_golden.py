"""The committed models are what a build makes now, and stand alone."""

from __future__ import annotations

from tests.places import ROOT

import difflib
import subprocess
import sys
from pathlib import Path

import pytest

from derive.publish.build import check_robot
from derive.publish.build import folder_of
from derive.publish.render import render_robot
from derive.publish.targets import targets_named
from derive.robot.catalogue import catalogue_names
from derive.robot.robot import Robot

GENERATED = ROOT / "generated"
REMEDY = "if the change is meant, run `make models`, look at the differences and commit them"


def difference(robot: Robot, name: str) -> str:
    """The first differences of a stale file."""
    committed = (folder_of(robot, GENERATED) / name).read_text(encoding="utf-8").splitlines()
    fresh = render_robot(robot, targets_named()).files[name].decode().splitlines()
    lines = difflib.unified_diff(committed, fresh, f"committed {name}", f"fresh {name}", lineterm="")
    return "\n".join(list(lines)[:40])


def test_every_robot_of_the_catalogue_has_its_folder_and_no_other_is_there() -> None:
    expected = {folder_of(Robot.load(name), GENERATED).name for name in catalogue_names()}
    assert {path.name for path in GENERATED.iterdir() if path.is_dir() and path.name != "__pycache__"} == expected


@pytest.mark.slow
@pytest.mark.parametrize("name", catalogue_names())
def test_committed_models_are_byte_for_byte_what_a_build_makes(name: str) -> None:
    robot = Robot.load(name)
    result = check_robot(robot, GENERATED)
    assert not result.missing, f"{result.missing}: {REMEDY}"
    assert not result.extra, f"{result.extra}: {REMEDY}"
    assert not result.stale, f"{difference(robot, result.stale[-1])}\n{REMEDY}"


@pytest.mark.parametrize("module", ["model_numpy", "model_casadi"])
def test_a_model_imports_neither_derive_nor_sympy(module: str) -> None:
    forbidden = ("derive", "sympy", "flint")
    script = f"import sys, scara_perugia.{module}; sys.exit(any(m in sys.modules for m in {forbidden}))"
    done = subprocess.run([sys.executable, "-c", script], cwd=GENERATED, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_a_numpy_model_needs_no_casadi() -> None:
    script = "import sys, scara_perugia.model_numpy; sys.exit('casadi' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], cwd=GENERATED, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
