"""Motions from CSV files."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.motion.curves.recording import read_recording
from derive.motion.motion import Motion
from derive.motion.output.table import samples
from derive.robot.robot import Robot
from tests.motion.plans import PICK_AND_PLACE

HEADING = "t, q1 [deg] ,other,q2"


def test_angles_in_degrees_become_the_cubic_spline_through_them(tmp_path: Path) -> None:
    """A cubic polynomial is its own spline."""
    t = np.linspace(0, 2, 9)
    q1, q2 = 30 * t**3 - 20 * t, t**2
    rows = [f"{a + 5},{b},walking,{c}" for a, b, c in zip(t.tolist(), q1.tolist(), q2.tolist(), strict=True)]
    (tmp_path / "walk.csv").write_text("\n".join([HEADING, *rows]) + "\n")
    (tmp_path / "plan.yaml").write_text("robot: planar-2r-perugia\nrecorded: walk.csv\nvalues: {a1: 1, a2: 1}\n")
    motion = Motion.load(tmp_path / "plan.yaml")
    assert motion.duration == 2
    at = np.linspace(0, 2, 101)
    q, qd, qdd = motion(at)
    assert q == pytest.approx(np.stack([np.deg2rad(30 * at**3 - 20 * at), at**2], axis=1), abs=1e-12)
    assert qd == pytest.approx(np.stack([np.deg2rad(90 * at**2 - 20), 2 * at], axis=1), abs=1e-11)
    assert qdd[1:-1] == pytest.approx(np.stack([np.deg2rad(180 * at), np.full(101, 2.0)], axis=1)[1:-1], abs=1e-10)


def test_what_is_written_is_read_back_with_its_rates(tmp_path: Path) -> None:
    motion = Motion.from_text(PICK_AND_PLACE.replace("sample: 0.01", "sample: 0.1"))
    names, rows = samples(motion)
    lines = [",".join(names), *(",".join(map(repr, map(float, row))) for row in rows)]
    (tmp_path / "samples.csv").write_text("\n".join(lines))
    again = read_recording(tmp_path / "samples.csv", Robot.load("scara-matlab"))
    for ours, theirs in zip(again(motion.times), motion(motion.times), strict=True):
        assert ours == pytest.approx(theirs, abs=1e-14)
    between = motion.times[:-1] + 0.05
    assert again(between)[0] == pytest.approx(motion(between)[0], abs=1e-7)


def test_long_files_are_read_to_their_end_or_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Longer than a robot file may be."""
    rows = "\n".join(f"{t},{t / 100 + 0.123456789:.25f},{t / 200:.25f}" for t in range(6000))
    (tmp_path / "walk.csv").write_text(f"t,q1,q2\n{rows}\n")
    assert (tmp_path / "walk.csv").stat().st_size > 262_144
    made = read_recording(tmp_path / "walk.csv", Robot.load("planar-2r-perugia"))
    assert float(made.duration) == 5999
    monkeypatch.setattr("derive.motion.curves.recording.BYTES", 1000)
    with pytest.raises(DeriveError, match="more than 1000 bytes"):
        read_recording(tmp_path / "walk.csv", Robot.load("planar-2r-perugia"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,q1\n0,0\n1,1\n", r"file.csv:1:1: no column 'q2' among 't', 'q1'; allowed: t and q1, q2"),
        ("t,q1,q2\n0,0,0\n1,x,0\n", r"file.csv:3:3: found 'x'; allowed: a number"),
        ("t,q1,q2\n0,0,0\n1,0\n", r"file.csv:3:5: found ''; allowed: a number"),
        ("t,q1,q2\n0,0,0\n1,0,nan\n", r"file.csv:3:5: found 'nan'"),
        ("t,q1,q2\n0,0,0\n1,1,1\n1,1,1\n", r"file.csv:4:1: the time 1 after 1; allowed: times that ascend"),
        ("t,q1,q2\n0,0,0\n", r"file.csv:2:\d+: 1 rows?; allowed: 2 to 200000"),
        ("", r"no heading"),
        ("t,q1 [furlong],q2\n0,0,0\n1,0,0\n", r"no column 'q1'"),
    ],
)
def test_wrong_files_are_refused_with_their_place(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "file.csv").write_text(text)
    with pytest.raises(DeriveError) as caught:
        read_recording(tmp_path / "file.csv", Robot.load("planar-2r-perugia"))
    assert caught.value.exit_status == 2
    assert re.search(message, str(caught.value)), str(caught.value)


def test_a_file_that_is_not_there_is_told_at_its_name() -> None:
    with pytest.raises(DeriveError, match=r"<text>:2:11: no file 'nowhere.csv'"):
        Motion.from_text("robot: planar-2r-perugia\nrecorded: nowhere.csv\n")
