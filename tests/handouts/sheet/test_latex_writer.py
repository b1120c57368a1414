"""The sheet compiles, leaves nothing out in silence, and within a number of pages loses the least useful first."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from derive.handouts.assemble import context_of, document
from derive.handouts.layout.quantity import POLICY, SheetPolicy
from derive.handouts.render import Format, handout_files
from derive.handouts.sheet import budget
from derive.handouts.sheet.budget import USEFULNESS, pages, within
from derive.handouts.sheet.document import (
    Block,
    Document,
    Paragraph,
    Rows,
    Section,
    SheetFormula,
    Steps,
    Table,
    blocks_of,
)
from derive.handouts.sheet.language import Text
from derive.handouts.sheet.latex_writer import latex
from derive.model.entries import ModelEntries
from derive.model.model import Model
from derive.robot.options.handout import PARTS, Derivation
from derive.robot.robot import Robot
from tests.handouts.latex_runner import require_latex, run_clean, run_latex
from tests.handouts.reading import changed
from tests.random_robots import swept_catalogue
from tests.rows import robot_of_rows

MOST_PAGES = 40

DISPLAY = Rows(("a = b",))
TITLES = [
    r"\input{/etc/passwd} \write18{touch x} \end{document}",
    r"$ & % # _ { } ~ ^ \ \\ \par \csname x\endcsname ^^41",
    "\"\"\" ''' ``quotes'' */ /* -- <b>html</b> {{ 7*7 }} {% raw %} {# #}",
    "two\nlines\n\nand a paragraph\ttab",
    "\N{GREEK SMALL LETTER ALPHA} \N{CJK UNIFIED IDEOGRAPH-4E2D} \N{LATIN SMALL LETTER E WITH ACUTE} \N{PILE OF POO} ß",
    "W" * 500,
]


def section_source(blocks: tuple[Block, ...]) -> str:
    document = Document("Bar", "", "bar", "0", "", (Section("table", "Table", blocks),))
    return latex(document, Text()).partition("\\section*")[2]


def sheet(robot: Robot, policy: SheetPolicy = POLICY) -> str:
    context = changed(context_of(robot), policy=policy)
    return latex(document(context), context.text)


def assert_is_clean(text: str, folder: Path) -> None:
    assert 1 <= run_clean(text, folder).pages <= MOST_PAGES


@pytest.mark.parametrize("title", TITLES, ids=range(len(TITLES)))
def test_titles_are_text_and_nothing_else(title: str, tmp_path: Path) -> None:
    quoted = "".join(f"\\U{ord(char):08X}" for char in title)
    robot = Robot.from_text(f'name: arm\ntitle: "{quoted}"\nconvention: standard\njoints: [{{type: revolute}}]\n')
    assert robot.title == title
    text = sheet(robot)
    assert_is_clean(text, tmp_path)
    assert text.rstrip().endswith(r"\end{document}")
    assert {path.name for path in tmp_path.iterdir()} <= {"sheet.tex", "sheet.log", "sheet.aux", "sheet.pdf"}


def long_names(i: int) -> str:

    def name(stem: str) -> str:
        return f"{stem}{i}_".ljust(64, "x")

    return (
        f"R q: {name('joint')}, a: {name('A')}, "
        f"d: '2*{name('D')} + 1/({name('E')} + {name('F')}) + sqrt({name('G')} + 1)', "
        f"alpha: '{name('b')} + pi/7', limits: ['-pi + {name('lo')}', '{name('hi')}/7']"
    )


def test_the_longest_names_fit(tmp_path: Path) -> None:
    assert_is_clean(sheet(robot_of_rows(f"{long_names(1)} | {long_names(2)}")), tmp_path)


def chain(n: int) -> Robot:
    rows = "|".join(f"R a: a{i}, alpha: pi/{2 if i % 2 else 3}" for i in range(1, n + 1))
    links = "".join(f"  - {{mass: m{i}, com: [x{i}, y{i}, z{i}], inertia: {{xx: I{i}}}}}\n" for i in range(1, n + 1))
    return robot_of_rows(rows, f"links:\n{links}", convention="modified")


@pytest.mark.sweep
@pytest.mark.parametrize("n", [5, 9, 20])
def test_long_arms_have_a_clean_sheet(n: int, tmp_path: Path) -> None:
    text = sheet(chain(n))
    assert "terms" in text
    assert_is_clean(text, tmp_path)


ENTRY = re.compile(r"(b|C|N|J|t|g|\\tau )_\{(\d),?(\d?)\}(?: = | \\colon)")


def test_no_entry_is_left_out_in_silence() -> None:
    """With a budget of next to nothing every entry that is not zero appears with its number of terms."""
    robot, joints = chain(3), (1, 2, 3)
    entries = ModelEntries(Model(robot))
    policy = SheetPolicy(flat_terms=3, grouped_terms=3, matrix_terms=0, compact_terms=0)
    text = sheet(robot, policy)
    listed = {match.groups() for match in ENTRY.finditer(text)}
    for letter, name, columns in (("t", "T", 4), ("J", "J", 3), ("b", "B", 3)):
        quantity = getattr(entries, name)
        for i in range(1, quantity.shape[0] + 1):
            for j in range(1, columns + 1):
                wanted = quantity.terms(i, j) and (letter != "b" or i <= j)
                assert not wanted or (letter, str(i), str(j)) in listed, (name, i, j)
    for i, j, k in ((i, j, k) for i in joints for j in joints for k in joints if k >= j):
        assert bool(entries.christoffel(i, j, k).terms(1, 1)) == (
            f"c_{{{i},{j}{k}}} \\colon" in text or (f"c_{{{i},{j}{k}}} = " in text)
        )


def test_the_whole_matrix_is_printed_where_it_fits() -> None:
    assert r"\mathbf{T} = \begin{bmatrix} c_{12}c_{4} + s_{12}s_{4} & " in sheet(Robot.load("scara-perugia"))
    assert "With the abbreviations" in sheet(Robot.load("puma560-laschi"))


NOTED = SheetFormula((DISPLAY,), note="They end.")


@pytest.mark.parametrize(
    "blocks",
    [
        (Paragraph("They end."), Paragraph("Others begin.")),
        (NOTED, Paragraph("Others begin.")),
        (Paragraph("Before."), NOTED, Paragraph("Others begin.")),
        (DISPLAY, NOTED, Paragraph("Others begin.")),
        (NOTED, SheetFormula((DISPLAY,), named=("c = d",), note="Others begin.")),
        (Steps("Steps", (NOTED,)), Paragraph("Others begin.")),
        (Steps("Steps", (Paragraph("They end."), NOTED)), Paragraph("Others begin.")),
    ],
)
def test_what_follows_a_sentence_is_a_paragraph_of_its_own(blocks: tuple[Block, ...]) -> None:
    """Wherever the sentence stands: an unfinished line would run into the next one."""
    text = section_source(blocks)
    *_, behind = text.split("They end.")
    assert re.match(r"%?\n(\\endgroup\n)?\\par\n", behind), text
    assert text.count("\\begingroup") == text.count("\\endgroup")


def test_code_has_spaces_of_one_width() -> None:
    """TeX would stretch the one behind a colon."""
    text = section_source((Paragraph("Under `figure: values:`."),))
    assert "\\texttt{figure:\\ values:}" in text


def test_short_displays_stay_on_one_page_and_fractions_off_the_rules() -> None:
    short, long = (section_source((Rows(("a = b",) * rows),)) for rows in (14, 15))
    assert short.count("\\\\*") == 13
    assert "\\\\*" not in long
    table = section_source((Table(("$i$",), (("$\\tfrac{\\pi}{2}$",), ("$0$",))),))
    assert table.count("\\rule[") == 1


def page_of(mark: str) -> str:
    """LaTeX that writes into the log on which page it is printed."""
    return f"x \\write16{{{mark} on \\the\\count0}}"


@pytest.mark.slow
def test_a_section_of_one_sentence_does_not_stand_alone_on_a_page(tmp_path: Path) -> None:
    pages = set()
    for rows in (38, 40, 42):
        filling = Rows(tuple(f"a_{{{k}}} = b" for k in range(rows)))
        last = Rows((page_of("display"),))
        ending = Section("example", "Example", (Paragraph(f"A sentence ${page_of('sentence')}$."),))
        sections = (Section("table", "Table", (filling, Paragraph("Then:"), last)), ending)
        log = run_latex(latex(Document("Bar", "", "bar", "0", "", sections), Text()), tmp_path)
        display, sentence = (re.search(rf"{mark} on (\d)", log.text) for mark in ("display", "sentence"))
        assert display[1] == sentence[1]
        pages.add(sentence[1])
    assert pages == {"1", "2"}


LONG = SheetFormula((Rows(("a = b",) * 40),), function="jacobian", blanks=("a",))


def made_of(**sections: tuple[object, ...]) -> Document:
    made = (Section(name.replace("_", "-"), name.title(), blocks) for name, blocks in sections.items())
    return Document("Bar", "", "bar", "0", "", tuple(made))  # type: ignore[arg-type]


def section_named(document: Document, part: str) -> Section:
    return {section.part: section for section in document.sections}[part]


def said(document: Document) -> str:
    return " ".join(b.text for section in document.sections for b in blocks_of(section) if isinstance(b, Paragraph))


def test_every_part_has_its_rank_and_a_sheet_that_fits_is_left_as_it_is() -> None:
    assert sorted(USEFULNESS) == sorted(PARTS)
    whole = made_of(table=(DISPLAY,), skew=(LONG,))
    assert within(whole, pages(whole), Text()) is whole
    assert within(whole, 0, Text()) is whole


def test_pages_are_filled_by_what_no_page_divides() -> None:
    column = (("x",),) * 35
    half = Table(("a",), column)  # more than half a page
    divided = replace(half, long=True)
    assert pages(made_of(table=(half, half, half))) == 3
    assert pages(made_of(table=(divided, divided, divided))) == 2
    assert pages(made_of(table=(Table(("a",), column * 4),))) > 2  # higher than a page


def test_steps_go_before_results_and_rules_before_what_they_follow_from() -> None:
    steps = Steps("How", (LONG,))
    whole = made_of(table=(DISPLAY,), kinematics=(steps, LONG), coriolis=(LONG,), skew=(LONG, steps))
    once = within(whole, pages(whole) - 1, Text())
    assert steps not in section_named(once, "skew").blocks
    assert LONG in section_named(once, "skew").blocks
    assert section_named(once, "coriolis") == section_named(whole, "coriolis")
    assert "within the page limit" in said(once)
    assert "Skew" in said(once)
    least = within(whole, 1, Text())
    assert all(LONG not in section.blocks for section in least.sections)
    assert DISPLAY in section_named(least, "table").blocks
    assert pages(least) == 1


def test_at_last_whole_parts_are_left_out_and_what_computes_their_formulas_is_named() -> None:
    rows = (Rows(("a = b",) * 40),)
    shorter = within(made_of(table=(DISPLAY,), jacobian=rows, skew=rows), 1, Text())
    assert "skew" not in {section.part for section in shorter.sections}
    assert "Skew" in said(shorter)
    whole = made_of(table=(DISPLAY,), jacobian=(LONG, LONG, LONG))
    assert said(within(whole, 1, Text())).count("`jacobian` in `model_numpy.py`") == 1


def clean_pages(name: str, limit: int, folder: Path) -> int:
    robot = Robot.load(name)
    context = context_of(robot, replace(robot.handout, derivation=Derivation.STEPS))
    log = run_latex(latex(within(document(context), limit, context.text), context.text), folder)
    assert not log.faults
    return log.pages


@pytest.mark.slow
def test_a_limit_of_pages_is_kept_on_paper(tmp_path: Path) -> None:
    assert 3 <= clean_pages("scara-perugia", 5, tmp_path) <= 5


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
        assert clean_pages(name, limit, tmp_path) <= limit
