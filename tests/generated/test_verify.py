"""`make verify-generated` finds what is wrong in a committed folder."""

import shutil
from pathlib import Path

import pytest

from tests.generated import verify

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
