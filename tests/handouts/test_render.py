"""A handout as files in memory: which there are, what they are called, and that all say who wrote them."""

import pytest

from derive.handouts.render import Format, handout_files
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
