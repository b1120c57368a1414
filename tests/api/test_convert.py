"""The other convention from Python, as a function and as a method of a robot."""

from pathlib import Path

import pytest

import derive
from derive.api.convert import convert, possible
from derive.errors import OutputError


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
