"""``derive import`` as it is typed."""

import json
from pathlib import Path
from unittest import mock

import pytest

from derive.errors import install_extra
from tests.cli.command import accepted, derive, refused
from tests.exchange.urdfs import HALF, J, body, urdf

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


@pytest.mark.parametrize(
    "arguments",
    [
        ["none.urdf"],
        ["arm.urdf", "--tip", "nothing"],
        ["arm.urdf", "--chain", "l0"],
        ["arm.urdf", "--chain", "l0..tool", "--tip", "tool"],
        ["arm.urdf", "--all", "--tip", "tool"],
        ["arm.urdf", "--convention", "craig"],
        ["arm.urdf", "--snap", "much"],
        ["arm.urdf", "--inertia", "better"],
        ["arm.urdf", "--arg", "name"],
        ["arm.urdf", "-o", "."],
        ["."],
    ],
)
def test_wrong_input_is_one_message_and_writes_nothing(folder: Path, arguments: list[str]) -> None:
    before = sorted(folder.iterdir())
    done = refused("import", *arguments, folder=folder)
    assert not done.stdout
    assert sorted(folder.iterdir()) == before


def test_without_lxml_the_message_says_what_to_install(folder: Path) -> None:
    with mock.patch.dict("sys.modules", {"lxml": None}):
        done = refused("import", "arm.urdf", folder=folder)
    assert install_extra("exchange") in done.stderr
