"""No page ends between a sentence and what it announces, and the last page of a sheet is not one matrix."""

from dataclasses import replace
from pathlib import Path

import pytest

from derive.handouts.assemble import context_of, document
from derive.handouts.sheet.document import Block, Document, Paragraph, Rows, Section, SheetFormula, Table
from derive.handouts.sheet.language import ENGLISH, Text, languages
from derive.handouts.sheet.latex_writer import latex
from derive.robot.robot import Robot
from tests.handouts.latex_runner import run_latex
from tests.random_robots import sampled, swept_catalogue

pypdf = pytest.importorskip("pypdf")
pytestmark = pytest.mark.slow

LONG = "It goes on over a line and so has a second one, whatever is said there about nothing in particular at all, "
SENTENCE = Paragraph(f"SENTENCE stands here. {LONG * 2}and what follows is announced:")
MATRIX = "\\begin{bmatrix} 1 & 2 \\\\ 3 & 4 \\\\ 5 & 6 \\\\ 7 & 8 \\end{bmatrix}"
CASES: dict[str, tuple[Block, ...]] = {
    "table": (SENTENCE, Table(("NEXT", "$x$"), (("1", "2"),) * 6)),
    "table behind an empty result": (SENTENCE, SheetFormula(()), Table(("NEXT", "$x$"), (("1", "2"),) * 6)),
    "long table": (SENTENCE, Table(("NEXT", "$x$"), (("1", "2"),) * 40, long=True)),
    "matrix": (SENTENCE, Rows((f"\\mathrm{{NEXT}} = {MATRIX}",))),
    "abbreviations": (SheetFormula((Rows(("\\mathrm{NEXT} = b",)),), named=("\\mathrm{SENTENCE} = a",)),),
    "last two": (
        Paragraph("First:"),
        Rows((f"\\mathrm{{SENTENCE}} = {MATRIX}",)),
        Paragraph("Then:"),
        Rows((f"\\mathrm{{NEXT}} = {MATRIX}",)),
    ),
}
QUICK = ("table behind an empty result", "last two")


def pages(sheet: Document, words: Text, folder: Path) -> list[str]:
    assert run_latex(latex(sheet, words), folder).status == 0
    return [page.extract_text() for page in pypdf.PdfReader(folder / "sheet.pdf").pages]


@pytest.mark.parametrize("case", sampled([*CASES], QUICK))
def test_what_is_announced_is_on_the_page_of_its_sentence(case: str, tmp_path: Path) -> None:
    found = set()
    for rows in (30, 34, 38, 42):
        filling = Rows(tuple(f"a_{{{k}}} = b" for k in range(rows)))
        sections = (Section("table", "Table", (filling, Paragraph("Text."), *CASES[case])),)
        text = pages(Document("Bar", "", "bar", "en", "0", "0", "", sections), Text(), tmp_path)
        (sentence,) = (k for k, page in enumerate(text) if "SENTENCE" in page)
        assert "NEXT" in text[sentence]
        found.add(sentence)
    assert found == {0, 1}


@pytest.mark.parametrize("language", sampled(languages(), (ENGLISH,)))
@pytest.mark.parametrize("name", swept_catalogue(usual=("kuka-kr5", "anthropomorphic-wrist")))
def test_sheets_are_well_broken(name: str, language: str, tmp_path: Path) -> None:
    robot = Robot.load(name)
    context = context_of(robot, replace(robot.handout, language=language))
    text = pages(document(context), context.text, tmp_path)
    lines = [[line for line in page.splitlines() if line.strip()] for page in text]
    assert not [page[-2] for page in lines[:-1] if page[-2].rstrip().endswith(":")]
    assert text[-1].count("=") != 1
