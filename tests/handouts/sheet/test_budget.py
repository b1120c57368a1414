"""A sheet within a number of pages: it fits, says what it lacks, and loses the least useful first."""

from dataclasses import replace
from pathlib import Path

import pytest

from derive.handouts.assemble import context_of, document
from derive.handouts.render import Format, handout_files
from derive.handouts.sheet import budget
from derive.handouts.sheet.budget import USEFULNESS, pages, within
from derive.handouts.sheet.document import Document, Paragraph, Rows, Section, SheetFormula, Steps, Table, blocks_of
from derive.handouts.sheet.language import Text
from derive.handouts.sheet.latex_writer import latex
from derive.robot.options.handout import PARTS, Derivation
from derive.robot.robot import Robot
from tests.handouts.latex_runner import require_latex, run_latex
from tests.random_robots import swept_catalogue

SHORT = Rows(("a = b",))
LONG = SheetFormula((Rows(("a = b",) * 40),), function="jacobian", blanks=("a",))


def sheet(**sections: tuple[object, ...]) -> Document:
    made = (Section(name.replace("_", "-"), name.title(), blocks) for name, blocks in sections.items())
    return Document("Bar", "", "bar", "en", "0", "0", "", tuple(made))  # type: ignore[arg-type]


def section(document: Document, part: str) -> Section:
    return {section.part: section for section in document.sections}[part]


def said(document: Document) -> str:
    return " ".join(b.text for section in document.sections for b in blocks_of(section) if isinstance(b, Paragraph))


def test_every_part_has_its_rank() -> None:
    assert sorted(USEFULNESS) == sorted(PARTS)


def test_a_sheet_that_fits_is_left_as_it_is() -> None:
    whole = sheet(table=(SHORT,), skew=(LONG,))
    assert within(whole, pages(whole), Text()) is whole
    assert within(whole, 0, Text()) is whole


def test_pages_are_filled_by_what_no_page_divides() -> None:
    column = (("x",),) * 35
    half = Table(("a",), column)  # more than half a page
    divided = replace(half, long=True)
    assert pages(sheet(table=(half, half, half))) == 3
    assert pages(sheet(table=(divided, divided, divided))) == 2
    assert pages(sheet(table=(Table(("a",), column * 4),))) > 2  # higher than a page


def test_steps_go_before_results_and_rules_before_what_they_follow_from() -> None:
    steps = Steps("How", (LONG,))
    whole = sheet(table=(SHORT,), kinematics=(steps, LONG), coriolis=(LONG,), skew=(LONG, steps))
    once = within(whole, pages(whole) - 1, Text())
    assert steps not in section(once, "skew").blocks
    assert LONG in section(once, "skew").blocks
    assert section(once, "coriolis") == section(whole, "coriolis")
    assert "within the page limit" in said(once)
    assert "Skew" in said(once)
    least = within(whole, 1, Text())
    assert all(LONG not in section.blocks for section in least.sections)
    assert SHORT in section(least, "table").blocks
    assert pages(least) == 1


def test_at_last_whole_parts_are_left_out() -> None:
    rows = (Rows(("a = b",) * 40),)
    shorter = within(sheet(table=(SHORT,), jacobian=rows, skew=rows), 1, Text())
    assert "skew" not in {section.part for section in shorter.sections}
    assert "Skew" in said(shorter)


def test_what_computes_a_formula_that_is_left_out_is_named() -> None:
    whole = sheet(table=(SHORT,), jacobian=(LONG, LONG, LONG))
    assert said(within(whole, 1, Text())).count("`jacobian` in `model_numpy.py`") == 1


def clean_pages(name: str, limit: int, derivation: Derivation, folder: Path) -> int:
    robot = Robot.load(name)
    context = context_of(robot, replace(robot.handout, derivation=derivation))
    log = run_latex(latex(within(document(context), limit, context.text), context.text), folder)
    assert not log.errors
    return log.pages


@pytest.mark.slow
def test_a_limit_of_pages_is_kept_on_paper(tmp_path: Path) -> None:
    assert 3 <= clean_pages("scara-perugia", 5, Derivation.STEPS, tmp_path) <= 5


@pytest.mark.slow
def test_a_pdf_that_is_longer_than_estimated_is_made_shorter(monkeypatch: pytest.MonkeyPatch) -> None:
    require_latex()
    monkeypatch.setattr(budget, "PAGE", 3000.0)
    robot = Robot.load("scara-perugia")
    options = replace(robot.handout, derivation=Derivation.STEPS, pages=4)
    made = handout_files(robot, options, [Format.PDF, Format.TEX])
    assert 1 < made.pages["scara-perugia.pdf"] <= 4
    assert made.shortened
    assert b"page limit (4)" in made.files["scara-perugia.tex"]


@pytest.mark.slow
@pytest.mark.parametrize("name", swept_catalogue())
def test_limits_are_kept_by_every_robot(name: str, tmp_path: Path) -> None:
    for limit in (20, 10, 6, 4, 2):
        assert clean_pages(name, limit, Derivation.STEPS, tmp_path) <= limit
