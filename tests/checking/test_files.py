"""Corpus files: what is read, and what is refused with its place."""

from __future__ import annotations

import pytest

from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.printed import CorpusFile
from derive.errors import DeriveError, Location

ARM = """\
robot:
  name: arm
  convention: standard
  joints:
    - {type: revolute, a: a1}
    - {type: revolute, a: a2}
"""


def read(tail: str) -> CorpusFile:
    return corpus_from_bytes((ARM + tail).encode(), "notes.yaml")


def test_entries_matrices_and_corrections_are_read_with_their_places() -> None:
    file = read(
        "expected:\n"
        '  - {quantity: p, entries: {"1": "a1*c1", "2": "a1*s1"}, status: erratum, correct: {"1": "a1*c1 + a2*c12"}}\n'
        '  - {quantity: "A[1]", matrix: [["c1", 0], [0, 1]]}\n'
    )
    first, second = file.expected
    assert [(e.row, e.column, e.text) for e in first.entries] == [(1, 1, "a1*c1"), (2, 1, "a1*s1")]
    assert first.entries[0].location == Location("notes.yaml", 8, 35)
    assert (first.status, first.corrections[0].text) == ("erratum", "a1*c1 + a2*c12")
    assert second.shape == (2, 2)
    assert second.status == "ok"


def test_blocks_that_are_not_compared_are_named() -> None:
    assert read("expected: []\nsingularities: [{of: J}]\n").unread == ("singularities",)


@pytest.mark.parametrize(
    ("tail", "line", "message"),
    [
        ('expected:\n  - {quantity: p, entries: {"1": "a1*"}}\n', 8, "ends too early"),
        ('expected:\n  - {quantity: p, entries: {"1": "a1*foo + ("}}\n', 8, "ends too early"),
        ('expected:\n  - {quantity: p, entries: {"0,1": "0"}}\n', 8, "place '0,1'"),
        ('expected:\n  - {quantity: p, entries: {"1": "0", "1,1": "0"}}\n', 8, "place '1,1' twice"),
        ('expected:\n  - {quantity: p, entries: {x: "0"}}\n', 8, "place 'x'"),
        ("expected:\n  - {quantity: p}\n", 8, "either 'matrix' or 'entries'"),
        ("expected:\n  - {quantity: p, matrix: [[1, 2], [3]]}\n", 8, "rows differ in length"),
        ("expected:\n  - {quantity: p, matrix: []}\n", 8, "rows differ in length or are empty"),
        ("expected:\n  - {quantity: p, matrix: [1]}\n", 8, "is not a list"),
        ("expected:\n  - {quantity: p, matrix: [[1]], statsu: ok}\n", 8, "did you mean 'status'"),
        ("expected:\n  - {quantity: p, matrix: [[1]], status: fine}\n", 8, "allowed: ok, erratum"),
        ("expected:\n  - {matrix: [[1]]}\n", 8, "without 'quantity'"),
        ("expected: 5\n", 7, "expected is not a list"),
        ("expectd: []\n", 7, "did you mean 'expected'"),
        ('expected:\n  - {quantity: p, entries: {"1": 1}, correct: {"2": 1}}\n', 8, "not among the printed entries"),
        ("expected:\n  - {quantity: p, matrix: [[1]], abbreviations: {a1: 2}, abbreviated: [[1]]}\n", 8, "also a name"),
        ("identities: [{left: c1}]\n", 7, "without 'right'"),
        ("factorisation: {of: T, factors: []}\n", 7, "without factors"),
        ('expected:\n  - {quantity: p, entries: {"1": "__import__(1)"}}\n', 8, "unexpected character"),
    ],
)
def test_what_cannot_be_read_is_refused_at_its_line(tail: str, line: int, message: str) -> None:
    with pytest.raises(DeriveError, match=message) as caught:
        read(tail)
    assert caught.value.location is not None
    assert caught.value.location.line == line


def test_a_formula_in_folded_text_is_placed_at_its_beginning() -> None:
    with pytest.raises(DeriveError, match="ends too early") as caught:
        read('expected:\n  - quantity: p\n    entries:\n      "1": >-\n        a1*c1\n        +\n')
    assert caught.value.location == Location("notes.yaml", 10, 12)


def test_a_robot_file_alone_prints_nothing() -> None:
    with pytest.raises(DeriveError, match="no block 'robot:'"):
        corpus_from_bytes(b"name: arm\nconvention: standard\njoints: [{type: revolute}]\n", "arm.yaml")
