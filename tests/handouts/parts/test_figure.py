"""The part of the handout with the pictures of the arm."""

import math
from dataclasses import replace
from fractions import Fraction

import pytest

from derive.handouts.assemble import section_of
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Figure, Paragraph
from derive.handouts.sheet.language import Text
from derive.model.dynamic_entries import ModelEntries
from derive.model.model import Model
from derive.robot.expression import Number, names
from derive.robot.load import catalogue_names
from derive.robot.options.handout import FigureOptions
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses


def _context(robot: Robot, drawn: bool = True) -> Context:
    poses = RobotPoses(robot) if drawn else None
    return Context(ModelEntries(Model(robot)), robot.handout, Text(), "1", poses)


def test_nothing_is_drawn_without_poses() -> None:
    assert section_of(_context(Robot.load("scara-perugia"), drawn=False), "figure") is None


def test_zero_configuration_and_assumed_lengths_are_stated() -> None:
    made = section_of(_context(Robot.load("scara-perugia")), "figure")
    assert made is not None
    figures = [block for block in made.blocks if isinstance(block, Figure)]
    texts = [block.text for block in made.blocks if isinstance(block, Paragraph)]
    assert len(figures) == 1
    assert "zero configuration" in figures[0].caption
    assert "$a_{1} = 1\\,\\mathrm{m}$" in texts[-1]


def test_configuration_of_the_figure_is_drawn_with_its_values() -> None:
    q = (Number(Fraction(1, 2)), Number(Fraction(1)), Number(Fraction(3, 10)), Number(Fraction(0)))
    robot = replace(Robot.load("scara-perugia"), figure=FigureOptions(q=q))
    made = section_of(_context(robot), "figure")
    assert made is not None
    figures = [block for block in made.blocks if isinstance(block, Figure)]
    assert len(figures) == 2
    assert "$q_{1} = 0.5\\,\\mathrm{rad}$" in figures[1].caption
    assert "$q_{3} = 0.3\\,\\mathrm{m}$" in figures[1].caption


def test_a_robot_with_all_numbers_assumes_nothing() -> None:
    made = section_of(_context(Robot.load("puma560-corke")), "figure")
    assert made is not None
    assert not any("assumed" in block.text for block in made.blocks if isinstance(block, Paragraph))


LIMITED = """
name: arm
convention: standard
units: {angle: deg}
joints:
  - {type: revolute, a: 0.4, limits: [-90, 90]}
  - {type: revolute, a: 0.3, limits: [20, 130]}
  - {type: prismatic, alpha: 180, limits: [0.1, 0.4]}
  - {type: revolute, limits: [low, high]}
"""


def test_a_joint_whose_limits_exclude_zero_is_drawn_in_their_middle() -> None:
    robot = Robot.from_text(LIMITED)
    assert RobotPoses(robot).zero == pytest.approx((0, math.radians(75), 0.25, 0))
    made = section_of(_context(robot), "figure")
    assert made is not None
    (figure,) = (block for block in made.blocks if isinstance(block, Figure))
    assert figure.caption.endswith(
        "in the middle of their limits: $q_{2} = 75^{\\circ}$, $q_{3} = 0.25\\,\\mathrm{m}$."
    )


def test_the_zero_configuration_is_within_the_limits_of_the_catalogue() -> None:
    for name in catalogue_names():
        robot = Robot.load(name)
        poses = RobotPoses(robot)
        for joint, value, bounds in zip(robot.joints, poses.zero, poses.limits, strict=True):
            if bounds is not None and not any(symbol for cell in joint.limits or () for symbol in names(cell)):
                assert min(bounds) <= value <= max(bounds), (name, joint.variable)
