"""The table of parts: every part that a robot file may ask for, in its order."""

from __future__ import annotations

from dataclasses import replace

from derive.handouts.assemble import context_of, document, exercise, section_of, solutions
from derive.handouts.document import Blank, Formula, Steps
from derive.handouts.language import Text
from derive.robot.robot import Robot
from derive.robot.style import PARTS, Derivation, HandoutOptions


def test_every_part_is_there_in_its_order() -> None:
    context = context_of(Robot.load("planar-2r-perugia"))
    assert [section.part for section in document(context).sections] == list(PARTS)
    assert all(section.title and section.blocks for section in document(context).sections)


def test_only_the_parts_that_are_asked_for() -> None:
    context = context_of(Robot.load("scara-perugia"), HandoutOptions(parts=("jacobian", "table")))
    assert [section.part for section in document(context).sections] == ["table", "jacobian"]


def test_parts_of_the_dynamics_need_links() -> None:
    context = context_of(Robot.load("dh-modified-deluca"))
    assert section_of(context, "inertia") is None
    assert section_of(context, "motion") is None
    assert section_of(context, "jacobian") is not None


def test_an_exercise_has_room_in_place_of_results_and_no_steps() -> None:
    options = replace(HandoutOptions(), derivation=Derivation.STEPS)
    whole = document(context_of(Robot.load("planar-2r-perugia"), options))
    sheet = exercise(whole, Text())
    blocks = [block for section in sheet.sections for block in section.blocks]
    assert sheet.subtitle == "Exercise"
    assert not any(isinstance(block, Steps) for block in blocks)
    assert not any(isinstance(block, Formula) and block.blanks for block in blocks)
    assert all(2 <= block.lines <= 24 for block in blocks if isinstance(block, Blank))
    assert solutions(whole, Text()).sections == whole.sections
