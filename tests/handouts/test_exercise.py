"""Handouts as files; exercises ask for what the handout tells, tell none of it, and have solutions that match."""

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from derive.handouts.assemble import context_of, document
from derive.handouts.exercise import exercise, solutions
from derive.handouts.render import Format, handout_files
from derive.handouts.sheet.budget import within
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Blank, Block, Document, Gap, Paragraph, Rows, SheetFormula, Steps, gap_rows
from derive.handouts.sheet.latex_writer import latex
from derive.robot.options.handout import PARTS, USUAL_PARTS, Derivation, HandoutOptions
from derive.robot.robot import Robot
from tests.handouts.latex_runner import run_clean
from tests.random_robots import swept_catalogue
from tests.rows import robot_of_rows

ROBOTS = ("planar-2r-perugia", "scara-perugia", "stanford-deluca", "kuka-lwr4", "dh-general-laschi")
ONE_ENTRY = re.compile(r"\(?[A-Za-z\\{}]+\)?_\{\d,?\d\}")


def blocks(sheet: Document) -> list[Block]:
    return [block for section in sheet.sections for block in section.blocks]


def questions(sheet: Document) -> list[Blank]:
    return [block for block in blocks(sheet) if isinstance(block, Blank)]


def sheets(robot: Robot) -> tuple[Context, Document, Document, Document]:
    options = HandoutOptions(derivation=Derivation.STEPS, language="en")
    context = context_of(robot, replace(options, notation=robot.handout.notation))
    whole = document(context)
    return context, whole, exercise(whole, context.text), solutions(whole, context.text)


@cache
def sheets_of(name: str) -> tuple[Context, Document, Document, Document]:
    return sheets(Robot.load(name))


def asked(whole: Document) -> Iterator[SheetFormula]:
    for block in blocks(whole):
        if isinstance(block, SheetFormula) and block.task and block.blanks:
            yield block


@pytest.mark.first(2)
@pytest.mark.parametrize("name", ROBOTS)
def test_every_question_has_a_number_a_sentence_points_and_room(name: str) -> None:
    _, _, sheet, _ = sheets_of(name)
    found = questions(sheet)
    assert [question.number for question in found] == [f"{k}." for k in range(1, len(found) + 1)]
    assert all(re.fullmatch(r"[A-Z].*[.?]", question.task) for question in found)
    assert all(gap.lines >= 2 for question in found for gap in question.gaps)
    assert all(gap.lines <= 24 for question in found for gap in question.gaps)
    points = [int(number) for question in found for number in re.findall(r"\d+", question.points)]
    assert len(points) == len(found)
    assert sheet.form == ("Name:", "Date:", f"Points (of {sum(points)}):")


@pytest.mark.parametrize("name", ROBOTS)
def test_an_exercise_tells_no_answer(name: str) -> None:
    context, whole, sheet, _ = sheets_of(name)
    assert not any(isinstance(block, Steps | SheetFormula) for block in blocks(sheet))
    written = latex(sheet, context.text)
    results = {line for formula in asked(whole) for rows in formula.rows for line in rows.lines}
    assert results
    assert not results & {line for block in blocks(sheet) if isinstance(block, Rows) for line in block.lines}
    assert not [line for line in results if "matrix" in line and line in written]
    assert context.text("Entries that are not listed are zero.") not in written
    entries = [gap.name for question in questions(sheet) for gap in question.gaps if ONE_ENTRY.fullmatch(gap.name)]
    assert not entries


def test_what_is_all_zero_is_asked_for_too() -> None:
    """An arm without Christoffel symbols has the questions of one that has some."""
    _, whole, sheet, answers = sheets(robot_of_rows("P alpha: pi/2 | P", "links: [{mass: m1}, {mass: m2}]"))
    assert "All are zero." in [block.note for block in blocks(whole) if isinstance(block, SheetFormula)]
    tasks = [question.task for question in questions(sheet)]
    assert "Which Christoffel symbols are not zero? Find them." in tasks
    assert not any(isinstance(block, Paragraph) and "zero." in block.text for block in blocks(sheet))
    assert len(questions(sheet)) == sum(
        isinstance(block, Paragraph) and block.text.startswith("Question ") for block in blocks(answers)
    )


@pytest.mark.parametrize("name", ROBOTS)
def test_solutions_answer_the_questions_in_their_order(name: str) -> None:
    _, whole, sheet, answers = sheets_of(name)
    solved = blocks(answers)
    heads = [k for k, block in enumerate(solved) if isinstance(block, Paragraph) and block.text.startswith("Question ")]
    assert len(heads) == len(questions(sheet))
    for question, k in zip(questions(sheet), heads, strict=True):
        head, formula = solved[k], next(block for block in solved[k:] if isinstance(block, SheetFormula))
        assert isinstance(head, Paragraph)
        assert head.text == f"Question {question.number.rstrip('.')} {question.points}"
        assert formula.task == question.task
    assert [block for k, block in enumerate(solved) if k not in heads] == blocks(whole)


def test_neighbours_with_one_task_are_one_question() -> None:
    """Transforms that share no line are asked for together."""
    _, whole, sheet, _ = sheets_of("dh-general-laschi")
    first = questions(sheet)[0]
    assert len(first.gaps) == sum(len(f.blanks) for f in asked(whole) if f.task == first.task)
    assert not any(isinstance(block, Paragraph | Rows) and block.is_answer for block in blocks(sheet))


@pytest.mark.slow
@pytest.mark.parametrize("name", swept_catalogue(usual=("stanford-deluca",)))
def test_an_exercise_has_at_most_twice_the_pages_of_the_handout(name: str, tmp_path: Path) -> None:
    robot = Robot.load(name)
    context = context_of(
        robot,
        replace(robot.handout, derivation=Derivation.RESULT, language="pt" if name == "stanford-deluca" else "it"),
    )
    whole = document(context)
    handout, asking, _ = (
        run_clean(latex(sheet, context.text), tmp_path)
        for sheet in (whole, exercise(whole, context.text), solutions(whole, context.text))
    )
    assert asking.pages <= 2 * handout.pages


def test_a_gap_fits_its_answer() -> None:
    _, whole, sheet, _ = sheets_of("planar-2r-perugia")
    gaps = {gap.name: gap for question in questions(sheet) for gap in question.gaps}
    assert gaps["\\mathbf{A}_{1}^{0}"].lines == 6.0
    assert gaps["\\mathbf{A}_{1}^{0}"].is_half
    assert gaps["\\mathbf{J}"].lines == 9.0
    assert not gaps["\\mathbf{J}"].is_half
    for formula in asked(whole):
        symbols = sum(line.count("_{") for rows in formula.rows for line in rows.lines)
        room = sum(gaps[name].lines for name in formula.blanks) * (0.5 if gaps[formula.blanks[0]].is_half else 1.0)
        assert room >= symbols / 12, formula.task


@pytest.mark.parametrize("lines", [2.0, 24.0])
def test_two_halves_share_a_line(lines: float) -> None:
    half, whole = Gap("a", lines, is_half=True), Gap("b", lines)
    assert gap_rows([half, half, half, whole, half, half]) == [(half, half), (half,), (whole,), (half, half)]


def test_what_is_left_out_for_the_page_limit_is_not_asked_for() -> None:
    context, whole, sheet, _ = sheets_of("scara-perugia")
    short = exercise(within(whole, 2, context.text), context.text)
    assert len(questions(short)) < len(questions(sheet))
    assert not any(isinstance(block, Paragraph) and "page limit" in block.text for block in blocks(short))


def test_each_form_is_a_file_of_the_robots_name() -> None:
    bar = robot_of_rows("R", "handout: {parts: [table, kinematics]}", name="bar")
    handout = handout_files(bar, bar.handout, [Format.HTML, Format.TEX])
    assert list(handout.files) == ["bar.tex", "bar.html"]
    assert handout.parts == ("table", "kinematics")
    assert handout.pages == {}
    assert all(b"written by derive" in data for data in handout.files.values())


def test_every_part_is_there_in_its_order_or_those_that_are_asked_for() -> None:
    usual = context_of(Robot.load("planar-2r-perugia"))
    without_loops = [part for part in PARTS if part != "closure"]
    assert [section.part for section in document(usual).sections] == [p for p in without_loops if p in USUAL_PARTS]
    assert "conversion" not in USUAL_PARTS
    context = context_of(Robot.load("planar-2r-perugia"), HandoutOptions(parts=PARTS))
    assert [section.part for section in document(context).sections] == without_loops
    assert all(section.title and section.blocks for section in document(context).sections)
    context = context_of(Robot.load("scara-perugia"), HandoutOptions(parts=("jacobian", "table")))
    assert [section.part for section in document(context).sections] == ["table", "jacobian"]
