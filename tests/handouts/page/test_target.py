"""What of an end effector is dragged, and what the branches are called."""

from dataclasses import replace

import pytest

from derive.handouts.page.target import dragging
from derive.handouts.page.viewer import symbol_values
from derive.robot.options.inverse import POSE, InverseOptions
from derive.robot.robot import Robot
from tests.handouts.page.viewer_page import assumed

VERTICAL = """
name: vertical
convention: standard
base: [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
joints: [{type: revolute, a: 0.5}, {type: revolute, a: 0.4}]
"""
HEAD = """
name: head
convention: standard
joints: [{type: revolute, alpha: pi/2}, {type: revolute, a: 0.4}]
"""


def numbers(robot: Robot) -> dict[str, float]:
    return symbol_values(robot, (), assumed(robot))


@pytest.mark.parametrize(
    ("name", "task", "normal"),
    [
        ("planar-2r-perugia", ("x", "y"), (0.0, 0.0, 1.0)),
        ("planar-3r", POSE, (0.0, 0.0, 1.0)),
        ("scara-perugia", POSE, None),
        ("anthropomorphic-arm", ("x", "y", "z"), None),
        ("puma560-laschi", POSE, None),
        ("kuka-lwr4", POSE, None),
        ("thumb", ("x", "y", "z"), None),
    ],
)
def test_the_orientation_is_kept_where_the_arm_can_keep_it(
    name: str, task: tuple[str, ...], normal: tuple[float, float, float] | None
) -> None:
    robot = Robot.load(name)
    found = dragging(robot, numbers(robot))
    assert found is not None
    assert (found.task.task, found.normal) == (task, normal)


def test_a_plane_may_stand_upright() -> None:
    robot = Robot.from_text(VERTICAL)
    found = dragging(robot, numbers(robot))
    assert found is not None
    assert (found.task.task, found.normal) == (("x", "z"), (0.0, 1.0, 0.0))


@pytest.mark.parametrize(
    "robot", [Robot.from_text(HEAD), Robot.load("dh-general-laschi"), Robot.load("spherical-wrist")]
)
def test_what_moves_on_a_line_on_a_sphere_or_not_at_all_is_not_dragged(robot: Robot) -> None:
    assert dragging(robot, numbers(robot)) is None


def test_the_task_of_the_file_is_kept() -> None:
    robot = replace(Robot.load("planar-3r"), inverse=InverseOptions(("x", "y", "phi")))
    found = dragging(robot, numbers(robot))
    assert found is not None
    assert (found.task, found.normal) == (robot.inverse, (0.0, 0.0, 1.0))
