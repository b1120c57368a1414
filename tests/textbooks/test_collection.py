"""Formulas of textbooks: all are equal to ours, most come out as printed, and a book's style is found from them."""

from pathlib import Path

import pytest

from derive.checking.style_finding import Example
from tests.lectures.test_same_form import compared, contains_sum, shape
from tests.places import CORPUS, ROOT
from tests.textbooks.collection import FILES, by_book, by_robot, report, share

DEFAULT, FOUND = 0.72, 0.98
"""Shares that are reached; docs/lecture-form.md names them."""

QUICK = ("Angeles", "Ghosal", "Yoshikawa")


def examples_of_all() -> list[Example]:
    return [example for examples in by_robot().values() for example in examples]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
@pytest.mark.first(15)
def test_every_formula_is_right(path: Path) -> None:
    findings = report(path).findings
    assert findings
    assert [finding.entry for finding in findings if not finding.verdict.equal] == []
    assert all(finding.verdict.exact for finding in findings)


def test_the_collection_is_as_large_as_the_documentation_says() -> None:
    page = " ".join((ROOT / "docs" / "lecture-form.md").read_text(encoding="utf-8").split())
    examples = examples_of_all()
    assert f"{len(examples)} formulas with a sum of {len(FILES)} robots from {len(by_book())} books" in page
    assert f"{100 * DEFAULT:.0f} % of them come out as printed in the default style, {100 * FOUND:.0f} % in" in page
    assert all(contains_sum(example.formula) for example in examples)


def test_no_robot_of_the_collection_is_in_the_corpus_of_lectures() -> None:
    names = {path.stem.partition("-")[2] for path in CORPUS.glob("0*.yaml")}
    assert not names & {path.stem for path in FILES}


def test_most_formulas_come_out_as_printed_in_the_default_style() -> None:
    rows = [row for path in FILES for row in compared(path)]
    same = sum(shape(ours) == shape(printed) for _, ours, printed in rows)
    assert len(rows) == len(examples_of_all())
    assert same >= DEFAULT * len(rows), f"{same} of {len(rows)}"


@pytest.mark.parametrize("author", QUICK)
def test_the_style_of_a_book_is_found_from_its_formulas(author: str) -> None:
    books = [title for title in by_book() if title.startswith(author)]
    assert books
    for book in books:
        found = share(by_book()[book], foretell=False)
        assert found.found == found.formulas > found.default


@pytest.mark.sweep
def test_nearly_all_formulas_come_out_as_printed_in_the_style_found_for_their_book() -> None:
    found = sum(share(examples, foretell=False).found for examples in by_book().values())
    assert found >= FOUND * len(examples_of_all())
