"""Texts and blocks of a document."""

import pytest

from derive.handouts.sheet.document import (
    Document,
    Paragraph,
    Rows,
    Section,
    SheetFormula,
    Steps,
    blocks_of,
    rows_of,
    spans,
)

ROWS = Rows(("a = b",))
SECTION = Section("table", "Table", (Paragraph("one"), Steps("two", (ROWS, Paragraph("three"))), Paragraph("four")))


def test_a_text_has_words_mathematics_and_code() -> None:
    found = list(spans("The matrix $\\mathbf{B}$ of `inertia_matrix`."))
    assert [span.kind.value for span in found] == ["words", "mathematics", "words", "code", "words"]
    assert [span.text for span in found] == ["The matrix ", "\\mathbf{B}", " of ", "inertia_matrix", "."]
    assert list(spans("")) == []


def test_blocks_inside_of_steps_are_blocks_of_the_section() -> None:
    texts = [block.text for block in blocks_of(SECTION) if isinstance(block, Paragraph)]
    assert texts == ["one", "three", "four"]


def test_rows_stand_alone_or_in_a_formula() -> None:
    assert rows_of(ROWS) == (ROWS,)
    assert rows_of(SheetFormula((ROWS, ROWS))) == (ROWS, ROWS)
    assert rows_of(SECTION.blocks[1]) == ()


def test_a_section_is_found_by_its_part() -> None:
    document = Document("Arm", "", "arm", "en", "", "0", "", (SECTION,))
    assert document.section("table") is SECTION
    with pytest.raises(KeyError):
        document.section("jacobian")
