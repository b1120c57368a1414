"""The committed models are what a build makes now, stand alone, and `make verify-generated` finds what is wrong in them."""

import os
import subprocess
import sys
from datetime import date
from pathlib import Path
import numpy as np
import pytest
from derive.publish.build import folder_of
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from tests.places import ROOT
import shutil
from tests.generated import verify

GENERATED = ROOT / "generated"


def test_every_robot_of_the_catalogue_has_its_folder_and_no_other_is_there() -> None:
    expected = {folder_of(Robot.load(name), GENERATED).name for name in catalogue_names()}
    assert {path.name for path in GENERATED.iterdir() if path.is_dir() and path.name != "__pycache__"} == expected


# Instruction sets that NumPy uses here and can do without.
WIDE = " ".join(np.show_config(mode="dicts")["SIMD Extensions"].get("found", ()))
OTHER_MACHINES = {
    "an old processor in Turkey": {
        "PYTHONHASHSEED": "1",
        "NPY_DISABLE_CPU_FEATURES": WIDE,
        "OPENBLAS_CORETYPE": "Prescott",
        "OPENBLAS_NUM_THREADS": "2",
        "LC_ALL": "tr_TR.UTF-8",
        "TZ": "Asia/Kolkata",
        "COLUMNS": "40",
        "HOME": "/nowhere",
        "USER": "nobody",
    },
    "another order of hashes": {"PYTHONHASHSEED": "4711", "LC_ALL": "C.UTF-8", "COLUMNS": "200"},
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "robot",
    [
        "scara-perugia",
        pytest.param("puma560-corke", marks=pytest.mark.sweep),
        pytest.param("human-body", marks=pytest.mark.sweep),
    ],
)
@pytest.mark.parametrize("machine", OTHER_MACHINES.values(), ids=OTHER_MACHINES.keys())
@pytest.mark.first(1)
def test_another_machine_makes_the_same_bytes(machine: dict[str, str], robot: str) -> None:
    command = [sys.executable, "-m", "derive", "build", robot, "--check", "--out", str(GENERATED)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **machine}
    done = subprocess.run(command, env=environment, capture_output=True, encoding="utf-8", timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr


def test_no_committed_file_names_a_place_or_a_day() -> None:
    words = (str(ROOT), str(Path.home()), str(date.today()))
    files = [path for path in GENERATED.rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    found = [f"{path}: {w}" for path in files for w in words if len(w) > 4 and w in path.read_text(encoding="utf-8")]
    assert len(files) > 100
    assert not found


@pytest.mark.parametrize(("module", "further"), [("model_numpy", ("casadi",)), ("model_casadi", ())])
def test_a_model_imports_neither_derive_nor_sympy(module: str, further: tuple[str, ...]) -> None:
    forbidden = ("derive", "sympy", "flint", *further)
    script = f"import sys, scara_perugia.{module}; sys.exit(any(m in sys.modules for m in {forbidden}))"
    done = subprocess.run([sys.executable, "-c", script], cwd=GENERATED, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr


FOLDER = "planar_2r_perugia"


@pytest.fixture
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    shutil.copytree(verify.GENERATED / FOLDER, tmp_path / FOLDER)
    monkeypatch.setattr(verify, "GENERATED", tmp_path)
    return tmp_path / FOLDER


def test_a_committed_folder_is_right(copy: Path) -> None:
    line, right = verify.verified("planar-2r-perugia")
    assert right, line
    assert "numpy, casadi" in line


def test_a_folder_that_was_edited_is_found(copy: Path) -> None:
    """A sign in the code, which no hash protects from being committed."""
    path = copy / "model_numpy.py"
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("s1 = sin(q1)", "s1 = -sin(q1)"), encoding="utf-8")
    line, right = verify.verified("planar-2r-perugia")
    assert not right
    assert "of model_numpy.py differs" in line


def test_a_missing_folder_is_found(copy: Path) -> None:
    shutil.rmtree(copy)
    assert not verify.verified("planar-2r-perugia")[1]
