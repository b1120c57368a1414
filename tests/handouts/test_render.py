"""The table of parts, and a handout as files in memory: which there are, what they are called, who wrote them."""

import pytest

from derive.handouts.assemble import context_of, document
from derive.handouts.render import Format, handout_files
from derive.robot.options.handout import PARTS, USUAL_PARTS, HandoutOptions
from derive.robot.robot import Robot
from tests.handouts.latex_runner import require_latex

ARM = "name: bar\nconvention: standard\njoints: [{type: revolute, a: a1}]\nhandout: {parts: [table, kinematics]}\n"


@pytest.fixture(scope="module")
def bar() -> Robot:
    return Robot.from_text(ARM)


def test_each_form_is_a_file_of_the_robots_name(bar: Robot) -> None:
    handout = handout_files(bar, bar.handout, [Format.HTML, Format.TEX])
    assert list(handout.files) == ["bar.tex", "bar.html"]
    assert handout.parts == ("table", "kinematics")
    assert handout.pages == {}
    assert all(b"written by derive" in data for data in handout.files.values())


def test_exercises_come_with_their_solutions(bar: Robot) -> None:
    handout = handout_files(bar, bar.handout, [Format.TEX], exercise_sheets=True)
    assert list(handout.files) == ["bar-exercise.tex", "bar-solutions.tex"]
    assert len(set(handout.files.values())) == 2


def test_pages_of_a_pdf_are_counted(bar: Robot) -> None:
    require_latex()
    handout = handout_files(bar, bar.handout, [Format.PDF])
    assert handout.files["bar.pdf"].startswith(b"%PDF")
    assert handout.pages == {"bar.pdf": 1}


def test_every_part_is_there_in_its_order() -> None:
    usual = context_of(Robot.load("planar-2r-perugia"))
    assert [section.part for section in document(usual).sections] == list(USUAL_PARTS)
    assert "conversion" not in USUAL_PARTS
    context = context_of(Robot.load("planar-2r-perugia"), HandoutOptions(parts=PARTS))
    assert [section.part for section in document(context).sections] == list(PARTS)
    assert all(section.title and section.blocks for section in document(context).sections)


def test_only_the_parts_that_are_asked_for() -> None:
    context = context_of(Robot.load("scara-perugia"), HandoutOptions(parts=("jacobian", "table")))
    assert [section.part for section in document(context).sections] == ["table", "jacobian"]
