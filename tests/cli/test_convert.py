"""``derive convert``: the file or its text, a report, one message for what is wrong."""

import json
from pathlib import Path

import pytest

from derive.robot.robot import Robot
from tests.cli.command import PENDULUM, derive, refused


def test_the_file_is_written_and_the_report_says_what_has_moved(tmp_path: Path) -> None:
    typed, moved = ("convert", "planar-2r-perugia", "-o", "mdh.yaml"), "Trans(x, a2) of row 2 is in the tool now"
    done = derive(*typed, "--convention", "modified", folder=tmp_path)
    assert (done.status, done.stderr) == (0, "")
    assert done.stdout.splitlines() == ["mdh.yaml: 2 joints (RR), modified", f"  {moved}"]
    found = json.loads(derive(*typed, "--force", "--json", folder=tmp_path).stdout)
    assert found == {"file": "mdh.yaml", "convention": "modified", "report": [moved], "remarks": []}
    assert Robot.load(tmp_path / "mdh.yaml").convention == "modified"


def test_the_text_goes_to_standard_output_and_back_again(tmp_path: Path) -> None:
    (tmp_path / "pendulum.yaml").write_text(PENDULUM)
    there = derive("convert", "pendulum.yaml", folder=tmp_path)
    (tmp_path / "there.yaml").write_text(there.stdout)
    back = derive("convert", "there.yaml", "--name", "swing", folder=tmp_path)
    robot = Robot.from_text(back.stdout)
    assert (there.status, back.status, robot.name, robot.title) == (0, 0, "swing", "swing")
    assert robot.joints == Robot.from_text(PENDULUM).joints
    assert robot.links == Robot.from_text(PENDULUM).links


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--convention", "craig"), "unknown convention 'craig'; allowed: standard (distal), modified (Craig, Khalil)"),
        (("-o", "."), "'.' is a folder; write the name of a file in it"),
        (("--convention", "modifid"), "did you mean 'modified'?"),
        (("--convention", "standard"), "thumb has a standard table already; write --convention modified"),
        (("--name", "Thumb"), "'Thumb' is not a robot name; allowed: a-z, 0-9 and -"),
        (("-o", "taken.yaml"), "taken.yaml exists already; choose another name"),
        (("-o", "folder", "--force"), "folder"),
        (("--format", "latex"), "--format latex without --derivation; add --derivation"),
    ],
)
def test_wrong_options_are_one_message_and_no_file(options: tuple[str, ...], message: str, tmp_path: Path) -> None:
    (tmp_path / "taken.yaml").write_text("x")
    (tmp_path / "folder").mkdir()
    done = refused("convert", "thumb", *options, folder=tmp_path)
    assert done.stdout == ""
    assert message in done.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"taken.yaml", "folder"}
    assert (tmp_path / "taken.yaml").read_text() == "x"
