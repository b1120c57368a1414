"""The part with the other convention: both products, what moves, the new table and the links in its frames."""

import pytest

from derive.handouts.assemble import context_of, document
from derive.handouts.parts.conversion import conversion
from derive.handouts.sheet.document import Block, Paragraph, Rows, SheetFormula, Table
from derive.robot.options.handout import HandoutOptions
from derive.robot.robot import Robot


def blocks(name: str, language: str = "en") -> list[Block]:
    return list(conversion(context_of(Robot.load(name), HandoutOptions(parts=("conversion",), language=language))))


def lines(found: list[Block]) -> list[str]:
    return [line for block in found if isinstance(block, Rows) for line in block.lines]


def test_the_same_factors_stand_in_other_brackets_and_the_last_one_is_in_the_tool() -> None:
    shown = lines(blocks("planar-2r-perugia"))
    factors = [f"\\mathbf{{{letter}}}_{{{i}}}" for letter, i in (("Z", 1), ("X", 1), ("Z", 2), ("X", 2), ("X", 0))]
    z1, x1, z2, x2, x0 = factors
    tool, new_tool = "\\mathbf{T}_{\\mathrm{tool}}", "\\mathbf{T}'_{\\mathrm{tool}}"
    plain = [line.replace(" ", "").replace(")\\,", ")") for line in shown]
    assert f"\\mathbf{{T}}=({z1}{x1})({z2}{x2}){tool}" in plain
    assert f"\\mathbf{{T}}=({x0}{z1})({x1}{z2}){new_tool}" in plain
    assert f"{new_tool}={x2}{tool}" in plain
    assert not [line for line in plain if "base" in line]


def test_the_new_table_has_a_neighbours_factors() -> None:
    (table,) = [block for block in blocks("puma560-corke") if isinstance(block, Table)]
    assert table.header[2:4] == ("$\\alpha_{i-1}$", "$a_{i-1}$")
    assert [row[2:4] for row in table.rows[:3]] == [("$0$", "$0$"), ("$90^{\\circ}$", "$0$"), ("$0$", "$a_{2}$")]
    assert len([block for block in blocks("puma560-corke") if isinstance(block, SheetFormula)]) > 0


def test_links_are_shown_as_far_as_they_are_written_otherwise() -> None:
    found = [block.text for block in blocks("puma560-corke") if isinstance(block, Paragraph)]
    assert [text for text in found if text.startswith("Link ")] == [f"Link {i}:" for i in range(1, 6)]
    assert not [text for text in found if "rotor" in text]
    assert not [line for line in lines(blocks("puma560-corke")) if "friction" in line]


@pytest.mark.parametrize(("name", "moves"), [("planar-3r", False), ("planar-2r-perugia", True)])
def test_torques_are_named_where_there_are_any(name: str, moves: bool) -> None:
    text = " ".join(block.text for block in blocks(name) if isinstance(block, Paragraph))
    assert ("torques" in text) is moves
    assert "Jacobian" in text


def test_a_modified_table_goes_the_other_way() -> None:
    plain = "\n".join(lines(blocks("skeleton-modified"))).replace(" ", "")
    assert "\\mathbf{T}'_{\\mathrm{tool}}=\\mathbf{X}_{2}^{-1}\\mathbf{T}_{\\mathrm{tool}}" in plain
    assert "\\mathbf{T}'_{\\mathrm{base}}=\\mathbf{T}_{\\mathrm{base}}\\mathbf{X}_{0}" in plain


@pytest.mark.parametrize(("language", "title"), [("it", "L'altra convenzione"), ("pt", "A outra convenção")])
def test_it_speaks_every_language(language: str, title: str) -> None:
    robot = Robot.load("planar-2r-perugia")
    (section,) = document(context_of(robot, HandoutOptions(parts=("conversion",), language=language))).sections
    assert section.title == title
    english = [block for block in blocks("planar-2r-perugia") if isinstance(block, Paragraph)]
    theirs = [block for block in section.blocks if isinstance(block, Paragraph)]
    assert not [ours for ours, other in zip(english, theirs, strict=True) if ours == other and ours.text != "Standard:"]


def test_it_is_shown_where_it_is_asked_for() -> None:
    robot = Robot.load("planar-2r-perugia")
    assert "conversion" not in [section.part for section in document(context_of(robot)).sections]
