"""The page of errata is what the command finds today."""

from __future__ import annotations

from tests.docs.errata import PAGE, TITLES, page


def test_the_page_is_current() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "run: make errata"


def test_documents_are_named_in_words() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert ".txt" not in text
    found = [line.removeprefix("## ") for line in text.splitlines() if line.startswith("## Document")]
    assert found == [title for number, title in TITLES.items() if number != "003"]
