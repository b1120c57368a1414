"""Loops of robot files: what passive joints follow, and that a file that is written again says the same."""

import pytest

from derive.robot.cells import Cells
from derive.robot.description import Joining
from derive.robot.load import robot_file_bytes
from derive.robot.reading.document import read_document
from derive.robot.reading.table import with_loops
from derive.robot.robot import Robot
from derive.robot.writer import robot_text

LINKAGES = ("delta", "five-bar", "four-bar", "slider-crank")


@pytest.mark.parametrize("name", LINKAGES)
def test_a_written_file_has_the_same_loops_and_passive_joints(name: str) -> None:
    robot = Robot.load(name)
    again = Robot.from_text(robot_text(robot))
    assert (again.loops, again.joints, again.coupled) == (robot.loops, robot.joints, robot.coupled)


def test_passive_joints_follow_the_variables_of_their_own_loops_alone() -> None:
    names = {joint.variable: [name for name, _ in joint.follows] for joint in Robot.load("delta").passive}
    assert set(map(tuple, names.values())) == {("x", "y", "z")}
    robot = Robot.load("slider-crank")
    assert (robot.dof, robot.n, [joint.variable for joint in robot.passive]) == (1, 3, ["q2", "s"])
    assert [loop.by for loop in robot.loops] == [Joining.REVOLUTE]


def test_a_file_without_loops_is_read_as_before() -> None:
    document, robot = read_document(robot_file_bytes("planar-3r"), "planar-3r"), Robot.load("planar-3r")
    assert (
        with_loops(
            document, Cells(document, robot.units), robot, (), lambda path: pytest.fail(f"nothing to read at {path}")
        )
        == robot
    )
