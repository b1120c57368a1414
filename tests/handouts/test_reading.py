"""Sheets read as text, as a reader meets them: sentences stand apart, numbers are those of the language."""

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from derive.handouts.assemble import context_of, document
from derive.handouts.exercise import exercise
from derive.handouts.sheet.document import Document
from derive.handouts.sheet.language import Text, languages
from derive.handouts.sheet.latex_writer import latex
from derive.robot.options.handout import Derivation
from derive.robot.robot import Robot
from tests.handouts.latex_runner import run_latex
from tests.random_robots import swept_catalogue

RUN_TOGETHER = re.compile(r"\w*[^\W\d_A-Z](?:[.!?]|[:;,](?![a-z]))[^\W\d_]\w*|[)\]][.!?][A-Z\u00c0-\u00de]\w*")
"""A word, a mark that ends a sentence or a part of one, and the next word without a space."""

CODE = re.compile(r"\w+\.py")
"""``model_numpy.py``, which is one word."""
POINT = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.])")


def sheets(name: str, language: str) -> tuple[Text, list[Document]]:
    robot = Robot.load(name)
    context = context_of(robot, replace(robot.handout, language=language, derivation=Derivation.STEPS))
    whole = document(context)
    return context.text, [whole, exercise(whole, context.text)]


def read(sheet: Document, text: Text, folder: Path) -> str:
    """The text of the PDF, without its footers, which name the version of the tool."""
    if shutil.which("pdftotext") is None:
        pytest.skip("pdftotext is not installed")
    assert run_latex(latex(sheet, text), folder).status == 0
    command = ["pdftotext", "-layout", "sheet.pdf", "-"]
    done = subprocess.run(command, cwd=folder, capture_output=True, check=True, timeout=60)
    lines = done.stdout.decode().splitlines()
    return "\n".join(line for line in lines if not line.strip().startswith(f"derive {sheet.version}"))


def assert_reads_well(sheet: Document, text: Text, folder: Path) -> None:
    found = read(sheet, text, folder)
    assert not RUN_TOGETHER.findall(CODE.sub("", found)), sheet.subtitle
    if text.comma:
        assert not POINT.findall(found), sheet.subtitle


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


@pytest.mark.slow
@pytest.mark.parametrize(("name", "language"), [("scara-matlab", "it"), ("stanford-deluca", "en")])
def test_a_sheet_reads_well(name: str, language: str, tmp_path: Path) -> None:
    text, made = sheets(name, language)
    assert_reads_well(made[0], text, tmp_path)


@pytest.mark.parametrize("language", languages())
@pytest.mark.parametrize("name", swept_catalogue())
def test_every_sheet_reads_well(name: str, language: str, tmp_path: Path) -> None:
    text, made = sheets(name, language)
    for sheet in made:
        assert_reads_well(sheet, text, tmp_path)
