"""Sheets on paper: they compile in every language, keep to their margins, read well and break well."""

import random
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from derive.handouts.assemble import context_of, document
from derive.handouts.exercise import exercise
from derive.handouts.sheet.document import Block, Document, Paragraph, Rows, Section, SheetFormula, Table
from derive.handouts.sheet.language import ENGLISH, Text, languages
from derive.handouts.sheet.latex_writer import latex
from derive.robot.options.handout import (
    AngleLetter,
    Derivation,
    FrameIndices,
    Functions,
    HandoutOptions,
    InertiaLetter,
    NotationOptions,
    SliderLetter,
)
from derive.robot.robot import Robot
from derive.version import __version__
from tests.handouts.latex_runner import run_clean, run_latex
from tests.handouts.parts.test_kinematics import numbered
from tests.random_robots import chains, robot_text, sampled, seeds, swept_catalogue

pytestmark = [pytest.mark.slow, pytest.mark.first(1)]

MOST_PAGES = 40
MOST_PAGES_WITH_STEPS = 64
"""Of random arms of up to seven joints without any parallel axes, derivations and cosines written in full included,
where no page breaks between a sentence and its table."""

LANGUAGES = languages()
RANDOM_ROBOTS = 35
USUAL = chains()[::3]
WIDEST = NotationOptions(
    AngleLetter.VARTHETA, SliderLetter.Q, Functions.FULL, frames=FrameIndices.LEFT, inertia=InertiaLetter.M
)


def options_of(number: int, language: str) -> HandoutOptions:
    pick = random.Random(number).choice
    letters = (AngleLetter, SliderLetter, Functions, FrameIndices, InertiaLetter)
    notation = NotationOptions(*(pick(list(choices)) for choices in letters))
    return HandoutOptions(derivation=pick(list(Derivation)), language=language, notation=notation)


def assert_is_clean(robot: Robot, options: HandoutOptions, folder: Path, most: int = MOST_PAGES) -> None:
    context = context_of(robot, options)
    assert 1 <= run_clean(latex(document(context), context.text), folder).pages <= most


@pytest.mark.parametrize(("number", "name"), list(enumerate(chains())))
def test_the_catalogue_in_one_language_after_another(number: int, name: str, tmp_path: Path) -> None:
    robot, language = numbered(Robot.load(name)), LANGUAGES[number % len(LANGUAGES)]
    options = replace(robot.handout, language=language, derivation=Derivation.STEPS)
    assert_is_clean(robot, options, tmp_path, MOST_PAGES_WITH_STEPS)


@pytest.mark.parametrize("name", sampled(chains(), USUAL))
def test_the_catalogue_in_the_widest_notation_is_clean(name: str, tmp_path: Path) -> None:
    language = random.Random(name).choice(["it", "pt"])
    assert_is_clean(Robot.load(name), HandoutOptions(language=language, notation=WIDEST), tmp_path)


def test_nothing_is_abbreviated_where_functions_are_in_full() -> None:
    context = context_of(Robot.load("scara-perugia"), HandoutOptions(notation=WIDEST))
    text = latex(document(context), context.text)
    assert "c_{12}" not in text
    assert r"\cos (\vartheta_{1} + \vartheta_{2})" in text


@pytest.mark.first(1)
@pytest.mark.parametrize("seed", seeds(RANDOM_ROBOTS, usual=8))
def test_random_robots_in_any_notation(seed: int, tmp_path: Path) -> None:
    robot = Robot.from_text(robot_text(random.Random(7000 + seed), 1 + seed % 7))
    robot = numbered(robot) if seed % 2 else robot
    options = options_of(seed, LANGUAGES[seed % len(LANGUAGES)])
    assert_is_clean(robot, options, tmp_path, MOST_PAGES_WITH_STEPS)


RUN_TOGETHER = re.compile(r"\w*[^\W\d_A-Z](?:[.!?]|[:;,](?![a-z]))[^\W\d_]\w*|[)\]][.!?][A-Z\u00c0-\u00de]\w*")
"""A word, a mark that ends a sentence or a part of one, and the next word without a space."""

CODE = re.compile(r"\w+\.py")
"""``model_numpy.py``, which is one word."""
POINT = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.])")


def read(sheet: Document, text: Text, folder: Path) -> str:
    """The text of the PDF, without its footers, which name the version of the tool."""
    if shutil.which("pdftotext") is None:
        pytest.skip("pdftotext is not installed")
    assert run_latex(latex(sheet, text), folder).pages
    command = ["pdftotext", "-layout", "sheet.pdf", "-"]
    done = subprocess.run(command, cwd=folder, capture_output=True, check=True, timeout=60)
    lines = done.stdout.decode().splitlines()
    return "\n".join(line for line in lines if not line.strip().startswith(f"derive {__version__}"))


@pytest.mark.parametrize(
    ("together", "apart"),
    [
        ("are zero.Check: that", "are zero. Check: that"),
        ("nulli.Troppo lunghi", "nulli. Troppo lunghi"),
        ("zero:The column", "zero: The column"),
        ("(plus).Then", "(plus). Then"),
        ("s\u00e3o nulos.\u00c9 isso", "c1,12 = 0.5 and atan2(a, b)."),
    ],
)
def test_the_reader_notices_what_runs_together(together: str, apart: str) -> None:
    assert RUN_TOGETHER.search(together)
    assert not RUN_TOGETHER.search(apart)


@pytest.mark.parametrize(("name", "language"), [("scara-matlab", "it"), ("stanford-deluca", "en")])
def test_a_sheet_reads_well(name: str, language: str, tmp_path: Path) -> None:
    assert_reads_well(name, language, tmp_path)


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", swept_catalogue())
def test_every_sheet_reads_well(name: str, language: str, tmp_path: Path) -> None:
    assert_reads_well(name, language, tmp_path)


def assert_reads_well(name: str, language: str, folder: Path) -> None:
    robot = Robot.load(name)
    context = context_of(robot, replace(robot.handout, language=language, derivation=Derivation.STEPS))
    whole = document(context)
    for sheet in (whole, exercise(whole, context.text)):
        found = read(sheet, context.text, folder)
        assert not RUN_TOGETHER.findall(CODE.sub("", found)), sheet.subtitle
        assert not context.text.comma or not POINT.findall(found), sheet.subtitle


LONG = "It goes on over a line and so has a second one, whatever is said there about nothing in particular at all, "
SENTENCE = Paragraph(f"SENTENCE stands here. {LONG * 2}and what follows is announced:")
MATRIX = "\\begin{bmatrix} 1 & 2 \\\\ 3 & 4 \\\\ 5 & 6 \\\\ 7 & 8 \\end{bmatrix}"
ANNOUNCED: dict[str, tuple[Block, ...]] = {
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


def pages_of(sheet: Document, words: Text, folder: Path) -> list[str]:
    pypdf = pytest.importorskip("pypdf")
    assert run_latex(latex(sheet, words), folder).pages
    return [page.extract_text() for page in pypdf.PdfReader(folder / "sheet.pdf").pages]


@pytest.mark.parametrize("case", sampled([*ANNOUNCED], ("table behind an empty result", "last two")))
def test_what_is_announced_is_on_the_page_of_its_sentence(case: str, tmp_path: Path) -> None:
    found = set()
    for rows in (30, 34, 38, 42):
        filling = Rows(tuple(f"a_{{{k}}} = b" for k in range(rows)))
        sections = (Section("table", "Table", (filling, Paragraph("Text."), *ANNOUNCED[case])),)
        text = pages_of(Document("Bar", "", "bar", "0", "", sections), Text(), tmp_path)
        (sentence,) = (k for k, page in enumerate(text) if "SENTENCE" in page)
        assert "NEXT" in text[sentence]
        found.add(sentence)
    assert found == {0, 1}


@pytest.mark.parametrize("language", sampled(LANGUAGES, (ENGLISH,)))
@pytest.mark.parametrize("name", swept_catalogue(usual=("kuka-kr5", "anthropomorphic-wrist")))
def test_sheets_are_well_broken(name: str, language: str, tmp_path: Path) -> None:
    robot = Robot.load(name)
    context = context_of(robot, replace(robot.handout, language=language))
    text = pages_of(document(context), context.text, tmp_path)
    lines = [[line for line in page.splitlines() if line.strip()] for page in text]
    assert not [page[-2] for page in lines[:-1] if page[-2].rstrip().endswith(":")]
    assert text[-1].count("=") != 1
