"""``derive new``: files that load, from nothing or from what exists."""

from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest

from derive.cli.new import copied_robot_text, new_robot_text
from derive.errors import RobotFileError
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.solve import solve
from derive.inverse.numeric.chain import NumericChain
from derive.robot.load import catalogue_names, robot_file_bytes
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.workspace.point import ArmPoint, joint_ranges
from derive.workspace.poses import RobotPoses
from derive.workspace.views import find_wrist
from tests.cli.command import PENDULUM


@pytest.mark.parametrize("joints", [*range(1, 9), 64])
def test_a_new_file_loads_without_a_remark(joints: int) -> None:
    robot = Robot.from_text(new_robot_text("my-arm", joints=joints))
    assert (robot.name, robot.n, robot.remarks, len(robot.links)) == ("my-arm", joints, (), joints)
    assert "g" not in free_symbols(robot)


def test_a_new_arm_of_six_joints_has_eight_postures_and_a_wrist_that_turns_everywhere() -> None:
    robot = Robot.from_text(new_robot_text("my-arm", joints=6))
    poses = RobotPoses(robot)
    wrist = find_wrist(ArmPoint(poses, joint_ranges(poses)))
    assert wrist.complete
    pose = NumericChain.of(robot, {}).pose_and_jacobian(np.array([0.3, 0.8, -1.0, 0.6, 0.7, -0.4]))[0]
    assert np.isfinite(InverseSolver.of(robot, solve(robot)).solve(pose).q).all(axis=-1).sum() == 8


@pytest.mark.first(6)
@pytest.mark.parametrize("model", catalogue_names())
def test_a_copy_differs_in_its_name_alone(model: str) -> None:
    text = copied_robot_text("mine", model)
    copy, original = Robot.from_text(text), Robot.load(model)
    assert copy.name == "mine"
    parts = attrgetter("joints", "links", "parameters", "units")
    assert parts(copy) == parts(original)
    comments = [line for line in robot_file_bytes(model).decode().splitlines() if line.startswith("#")]
    assert all(line in text for line in comments)


def test_of_a_corpus_file_the_robot_is_copied_and_any_name_is_exchanged(tmp_path: Path) -> None:
    block = "".join(f"  {line}\n" for line in PENDULUM.splitlines())
    notes = tmp_path / "notes.yaml"
    notes.write_text(f"source: {{document: d}}\nrobot:\n{block}expected: []\n")
    text = copied_robot_text("mine", str(notes))
    assert "expected" not in text
    assert Robot.from_text(text).joints == Robot.from_text(PENDULUM).joints
    quoted = PENDULUM.replace("name: pendulum", "'name': \"pendulum\"  # mine")
    path = tmp_path / "arm.yaml"
    for text in (quoted, '{"name": "p", "convention": "standard", "joints": [{"type": "revolute"}]}'):
        path.write_text(text)
        assert Robot.from_text(copied_robot_text("other", str(path))).name == "other"


def test_names_that_no_robot_may_have_are_refused() -> None:
    for name in ("My Arm", "class", "numpy", "", "-x", "../x", "con", "a" * 65):
        for make in (new_robot_text, lambda name: copied_robot_text(name, "scara-perugia")):
            with pytest.raises(RobotFileError, match=r"not a robot name|Python package"):
                make(name)
    for joints in (0, -1, 257):
        with pytest.raises(RobotFileError, match="allowed: 1 to 256"):
            new_robot_text("my-arm", joints)
