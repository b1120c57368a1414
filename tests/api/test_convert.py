"""The other convention and formats of other programs from Python, as functions and as methods of a robot."""

from pathlib import Path

import pytest

import derive
from derive.api.convert import convert, export, possible
from derive.errors import DeriveError, OutputError, RobotFileWarning


def test_a_robot_is_converted_and_written(tmp_path: Path) -> None:
    path = tmp_path / "mdh.yaml"
    made = convert("stanford-deluca", "modified", path, name="stanford-mdh")
    assert path.read_text(encoding="utf-8") == made.text
    assert derive.load(path).joints == made.robot.joints
    assert made.notes == ()
    before = path.read_bytes()
    with pytest.raises(OutputError, match="exists already"):
        convert("thumb", path=path)
    assert path.read_bytes() == before
    convert("thumb", path=path, force=True)
    assert derive.load(path).convention == "modified"


def test_bodies_that_exist_are_converted_where_they_are_asked_for() -> None:
    pytest.importorskip("clarabel")
    robot = derive.load("puma560-corke")
    made = convert(robot, "modified", inertia="possible")
    assert made.notes[0] == "2 of 6 links changed; base parameters and torques stay the same"
    assert f"# {made.notes[0]}" in made.text
    assert made.robot == robot.convert("modified", inertia="possible")
    assert made.robot.links == convert(derive.possible(robot).robot, "modified").robot.links
    assert made.robot.links != convert(robot, "modified").robot.links
    with pytest.raises(
        derive.DeriveError, match="unknown choice of inertia 'posible'; allowed: given, possible; did you"
    ):
        robot.convert("modified", inertia="posible")


def test_a_robot_converts_itself() -> None:
    robot = derive.load("planar-2r-perugia")
    other = robot.convert("modified")
    assert type(other) is derive.Robot
    assert other.convention == "modified"
    assert other.convert("standard").joints == robot.joints
    assert other == convert(robot).robot
    with pytest.raises(derive.DeriveError, match="a standard table already"):
        robot.convert("standard")
    with pytest.raises(derive.DeriveError, match="unknown convention 'mdh'"):
        robot.convert("mdh")


def test_a_robot_by_name_gets_links_that_exist_and_a_robot_file() -> None:
    pytest.importorskip("clarabel")
    found = possible("scara-matlab")
    assert isinstance(found.robot, derive.Robot)
    again = derive.Robot.from_text(found.text, "arm.yaml")
    assert again.links == found.robot.links
    assert again.remarks == ()
    assert "# 1 of 4 links changed; base parameters and torques stay the same\n# link 2 changed by" in found.text
    assert found.text.startswith("# Source: report on the SCARA")


def test_the_text_is_returned_and_written_once(tmp_path: Path) -> None:
    path = tmp_path / "kr5.csv"
    text = export("kuka-kr5", "csv", path)
    assert path.read_text() == text
    with pytest.raises(OutputError, match="exists already"):
        export("kuka-kr5", "csv", path)
    assert export("kuka-kr5", "csv", path, force=True) == text


def test_what_a_format_cannot_say_is_a_warning_and_numbers_of_symbols_are_typed() -> None:
    with pytest.warns(RobotFileWarning) as told:
        text = derive.export("puma560-corke", "urdf")
    bodies, armature, *_ = (str(one.message) for one in told)
    assert "links entry 3, inertia: physically inconsistent" in bodies
    assert armature.startswith("puma560-corke: URDF cannot say the armature of q1")
    assert derive.load("puma560-corke").to_urdf() == text
    arm = derive.load("anthropomorphic-arm")
    assert '"0.25 0 0"' in export(arm, "urdf", values={"a2": 0.5, "a3": "1/4"})
    with pytest.raises(DeriveError, match=r"no 'a4' in anthropomorphic-arm; allowed: a2, a3"):
        export(arm, "urdf", values={"a4": 1})


def test_a_robot_writes_itself_for_mujoco_with_possible_bodies() -> None:
    pytest.importorskip("clarabel")
    robot = derive.load("puma560-corke")
    assert robot.to_mjcf(inertia="possible") == export(robot, "mjcf", inertia="possible")
