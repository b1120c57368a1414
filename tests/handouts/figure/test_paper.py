"""Room for labels: they stand beside what they name, off lines and off each other."""

import math

import pytest

from derive.handouts.figure.arm import arm_drawing
from derive.handouts.figure.drawing import LABEL_HEIGHT, Label, Path, label_width
from derive.handouts.figure.paper import Paper, around
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import DataPrinter
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses

WIDE = "z_{2},z_{3},z_{5}"


@pytest.mark.parametrize("degrees", range(0, 360, 45))
def test_a_wide_label_does_not_cover_the_tip_that_it_names(degrees: int) -> None:
    direction = (math.cos(math.radians(degrees)), math.sin(math.radians(degrees)))
    width = label_width(WIDE)
    x, y = around((0.0, 0.0), direction, 6.5, width)[0]
    assert abs(x) >= width / 2 or abs(y) >= LABEL_HEIGHT / 2


def test_a_label_leaves_a_line_for_a_free_place() -> None:
    paper = Paper()
    paper.draw(Path(((0.0, 0.0), (0.0, 60.0))))
    paper.label(WIDE, around((0.0, 30.0), (0.0, 1.0), 6.5, label_width(WIDE)))
    label = paper.items[-1]
    assert isinstance(label, Label)
    assert abs(label.at[0]) >= label_width(WIDE) / 2


@pytest.mark.parametrize("name", ["stanford-deluca", "scara-perugia", "puma560-corke", "kuka-lwr4"])
def test_names_of_dense_wrists_do_not_cover_each_other(name: str) -> None:
    robot = Robot.load(name)
    poses = RobotPoses(robot)
    printer = DataPrinter(robot, Notation.of(robot, robot.handout.notation))
    drawing = arm_drawing(robot, printer, poses.frames(poses.zero))
    labels = [item for item in drawing.items if isinstance(item, Label)]
    for k, one in enumerate(labels):
        for other in labels[:k]:
            beside = abs(one.at[0] - other.at[0]) - (label_width(one.latex) + label_width(other.latex)) / 2
            above = abs(one.at[1] - other.at[1]) - LABEL_HEIGHT
            assert max(beside, above) >= -1.5, f"{one.latex} and {other.latex}"
