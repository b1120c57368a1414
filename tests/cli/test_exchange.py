"""``derive convert``, ``derive export`` and ``derive import``: the file or its text, and what is said about it."""

import json
from pathlib import Path
from unittest import mock

import pytest

from derive.cli import export
from derive.errors import install_extra
from derive.exchange.formats import FORMS
from derive.robot.robot import Robot
from tests.cli.command import PENDULUM, accepted, derive, refused
from tests.exchange.urdfs import HALF, J, body, urdf


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


def test_the_file_is_written_remarks_are_told_and_every_format_is_offered(tmp_path: Path) -> None:
    done = derive("export", "puma560-corke", "--to", "urdf", "-o", "puma.urdf", folder=tmp_path)
    assert (done.status, done.stdout) == (0, "puma.urdf\n")
    assert "derive: warning: puma560-corke: URDF cannot say the armature of q1, q2, q3, q4, q5, q6" in done.stderr
    assert (tmp_path / "puma.urdf").read_text().startswith("<?xml")
    assert tuple(FORMS) == export.FORMATS


@pytest.mark.parametrize("to", export.FORMATS)
def test_every_format_goes_to_standard_output(to: str, tmp_path: Path) -> None:
    (tmp_path / "pendulum.yaml").write_text(PENDULUM)
    values = ("--values", "a1=0.5,l1=1/4", "--values", "g=9.81, m1=2, I1=0.1")
    done = accepted("export", "pendulum.yaml", "--to", to, *values, folder=tmp_path)
    assert "pendulum" in done.stdout
    assert "0.5" in done.stdout


def test_the_report_for_scripts_holds_what_the_format_cannot_say(tmp_path: Path) -> None:
    done = derive("export", "puma560-corke", "--to", "urdf", "-o", "puma.urdf", "--json", folder=tmp_path)
    report = json.loads(done.stdout)
    assert (report["file"], report["format"]) == ("puma.urdf", "urdf")
    assert [remark["line"] for remark in report["remarks"]] == [31]  # of the robot file: a link that no body can be
    assert report["report"]
    assert all(f"derive: warning: puma560-corke: {line}" in done.stderr for line in report["report"])


ARM = urdf(
    [
        J("0 0 0.3", inertial=body("3", "0 0 0.1", moments="0.3 0.1 0.1 0 0 0"), more='<safety_controller k="1"/>'),
        J("0 0 0.2", "1.570796 0 0", inertial=body("2", "0.1 0 0", moments="0.1 0.1 0.1 0 0 0")),
        J("0.4 0 0", f"0 {HALF} 0", type="fixed", link="tool"),
    ]
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.urdf").write_text(ARM)
    return tmp_path


def test_a_file_is_written_and_reported_on(folder: Path) -> None:
    done = accepted("import", "arm.urdf", "-o", "arm.yaml", folder=folder)
    head, snapped, *notes = done.stdout.splitlines()
    assert head == "arm.yaml: 2 joints (RR), standard, l0 to tool; base and tool constant"
    assert snapped.startswith("  2 angles rounded, largest change 3.3e-07 rad; pose error over all limits <= ")
    assert notes == [
        "  link l1: physically inconsistent inertia (A + B < C by 0.1 kg m^2)",
        "  not read: safety_controller",
    ]
    assert "inertia" not in done.stderr, "told twice"
    text = (folder / "arm.yaml").read_text()
    assert all(f"# {note.strip()}" in text.splitlines() for note in notes)
    assert "proven" in derive("verify", "arm.yaml", folder=folder).stdout
    assert derive("show", "arm.yaml", "p", folder=folder).status == 0


def test_bodies_that_cannot_be_are_exchanged_for_ones_that_can(folder: Path) -> None:
    assert derive("import", "arm.urdf", "-o", "given.yaml", folder=folder).status == 0
    done = accepted("import", "arm.urdf", "--inertia", "possible", "-o", "possible.yaml", folder=folder)
    assert "base parameters and torques stay the same" in done.stdout
    shown = [derive("show", name, "B", folder=folder).stdout for name in ("given.yaml", "possible.yaml")]
    assert shown[0] == shown[1]
    assert "proven" in derive("verify", "possible.yaml", folder=folder).stdout


def test_a_urdf_comes_from_standard_input_and_without_an_output_the_file_is_printed(folder: Path) -> None:
    done = derive("import", "arm.urdf", folder=folder)
    (folder / "printed.yaml").write_text(done.stdout)
    assert derive("show", "printed.yaml", "p", folder=folder).status == 0
    assert "2 joints" in done.stderr
    with mock.patch("sys.stdin") as stdin:
        stdin.buffer.read.return_value = ARM.encode()
        done = derive("import", "-", "-o", "arm.yaml", folder=folder)
    assert done.status == 0, done.stderr
    assert "not tested" in derive("verify", "arm.yaml", folder=folder).stdout


def test_all_tips_get_files(folder: Path) -> None:
    two = urdf([J(link="left"), J(link="right", parent="l0"), J(link="head", parent="l0", type="planar")], name="torso")
    (folder / "torso.urdf").write_text(two)
    done = accepted("import", "torso.urdf", "--all", "-o", "arms", "--json", folder=folder)
    report = json.loads(done.stdout)
    assert [robot["tip"] for robot in report["robots"]] == ["left", "right"]
    assert "planar" in report["refused"]["head"]
    assert sorted(path.name for path in (folder / "arms").iterdir()) == ["torso-left.yaml", "torso-right.yaml"]


def test_without_lxml_the_message_says_what_to_install(folder: Path) -> None:
    with mock.patch.dict("sys.modules", {"lxml": None}):
        done = refused("import", "arm.urdf", folder=folder)
    assert install_extra("exchange") in done.stderr
