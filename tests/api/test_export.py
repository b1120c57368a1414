"""`derive.export` and the methods of `derive.Robot`."""

from pathlib import Path

import pytest

import derive
from derive.api.convert import export
from derive.errors import DeriveError, OutputError, RobotFileWarning


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
