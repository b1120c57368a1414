"""Motions from Python: files complete or untouched."""

import re
from pathlib import Path

import pytest

import derive
from derive.api.move import FORMS
from derive.errors import DeriveError, OutputError
from derive.motion.output import page
from tests.motion.plans import swing


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    path = tmp_path / "swing.yaml"
    path.write_text(swing("1/5", "kp: 30, kd: 8"))
    return path


def test_files_are_written_beside_each_other_and_named(plan: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    found = derive.move(plan, csv=tmp_path / "new" / "run.csv", plot=tmp_path / "tau.svg")
    assert found.files == (tmp_path / "new" / "run.csv", tmp_path / "tau.svg")
    assert (tmp_path / "new" / "run.csv").read_text().count("\n") == 22
    assert found.run is None
    assert b"<svg" in (tmp_path / "tau.svg").read_bytes()


def test_another_ending_is_refused_before_anything_is_computed(tmp_path: Path) -> None:
    for option, name in (("plot", "tau.jpg"), ("gif", "a.mp4"), ("mp4", "a.gif")):
        said = f"'{name}' has the ending of another kind of file; allowed: {', '.join(FORMS[option])}"
        with pytest.raises(DeriveError, match=re.escape(said)):
            derive.move("no-such-plan", **{option: tmp_path / name})  # type: ignore[arg-type]


def test_when_one_file_fails_none_is_touched(plan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "run.csv").write_text("mine")

    def refuse(*_: object) -> bytes:
        raise OutputError("no page")

    monkeypatch.setattr(page, "motion_page", refuse)
    with pytest.raises(OutputError, match="no page"):
        derive.move(plan, csv=tmp_path / "run.csv", html=tmp_path / "a.html", force=True)
    assert (tmp_path / "run.csv").read_text() == "mine"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.csv", "swing.yaml"]
