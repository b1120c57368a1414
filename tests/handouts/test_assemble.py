"""The table of parts: every part that a robot file may ask for, in its order."""

from derive.handouts.assemble import context_of, document, section_of
from derive.robot.options.handout import PARTS, USUAL_PARTS, HandoutOptions
from derive.robot.robot import Robot


def test_every_part_is_there_in_its_order() -> None:
    usual = context_of(Robot.load("planar-2r-perugia"))
    assert [section.part for section in document(usual).sections] == list(USUAL_PARTS)
    context = context_of(Robot.load("planar-2r-perugia"), HandoutOptions(parts=PARTS))
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
