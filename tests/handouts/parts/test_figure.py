"""The part of the handout with the pictures of the arm."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from derive.handouts.assemble import section_of
from derive.handouts.context import Context
from derive.handouts.document import Figure, Paragraph
from derive.handouts.figure.poses import RobotPoses
from derive.handouts.language import Text
from derive.model.dynamic_entries import ModelEntries
from derive.model.model import Model
from derive.robot.expression import Number
from derive.robot.robot import Robot
from derive.robot.style import FigureOptions


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
