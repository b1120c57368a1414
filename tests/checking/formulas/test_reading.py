"""What stands around formulas in files: mappings, lists, texts, words, remarks; each refusal has its place."""

from __future__ import annotations

import pytest

from derive.checking.formulas import reading
from derive.checking.formulas.printed import Citation
from derive.errors import CheckError, UnknownNameError
from derive.robot.expression import ZERO, Name
from derive.robot.reading.document import Node, YamlMapping, read_tree
from derive.robot.robot import Robot

ARM = Robot.from_text("name: arm\nconvention: standard\njoints: [{type: revolute, a: a1}]\n")


def node(text: str) -> Node:
    found = read_tree(text.encode(), "notes.yaml")
    assert found is not None
    return found


def item(text: str) -> YamlMapping:
    return reading.mapping(node(text), "an item")


@pytest.mark.parametrize(
    ("text", "message"),
    [("[1]", "not a mapping"), ("{b: 1}", "without 'a'"), ("{a: 1, bb: 2}", "unknown key 'bb'.*did you mean 'b'")],
)
def test_a_mapping_has_the_keys_that_it_must_and_no_others(text: str, message: str) -> None:
    assert reading.mapping(node("{a: 1, b: 2}"), "an item", ("a",), ("b",)).entries.keys() == {"a", "b"}
    with pytest.raises(CheckError, match=message) as caught:
        reading.mapping(node(text), "an item", ("a",), ("b",))
    assert caught.value.location is not None


def test_what_is_missing_has_a_default() -> None:
    empty = item("{x: 1}")
    assert reading.items(None, "a list") == []
    assert reading.child(empty, "y") is None
    assert reading.word(empty, "kind", ("a", "b"), "b") == "b"
    assert not reading.flag(empty, "implied")
    assert reading.status(empty) == "ok"
    assert reading.text_of(empty, "note") == ""
    assert list(reading.pairs(empty, "at", "a value")) == []


@pytest.mark.parametrize("text", ["{status: wrong}", "{status: [ok]}"])
def test_other_words_are_refused(text: str) -> None:
    with pytest.raises(CheckError):
        reading.status(item(text))


def test_a_remark_says_why_and_where() -> None:
    said = reading.remark(
        item("{note: 'two  lines', kind: notation, duplicate: true, source: {document: D, section: 3}}")
    )
    assert (said.note, said.kind, said.duplicate, said.document) == ("two lines", "notation", True, Citation("D", "3"))
    assert reading.printed_in(item("{source: a book}")) == Citation("a book")


def test_remarks_on_two_items_are_two() -> None:
    assert reading.remark(item("{note: a}")) != reading.remark(item("{note: a}"))


def test_a_name_defined_by_an_unknown_one_is_unknown_too() -> None:
    text = item("{h: 'a1*zz', k: '2*a1', f: 'h + a1', g: 'k + a1'}")
    short = reading.NO_ABBREVIATIONS
    for name in ("h", "k"):
        short = short.defining(name, reading.read_printed(reading.required_text(text, name), ARM, short))
    undecided = reading.read_printed(reading.required_text(text, "f"), ARM, short)
    assert isinstance(undecided.unknown, UnknownNameError)
    assert undecided.formula == ZERO
    assert reading.read_printed(reading.required_text(text, "g"), ARM, short).unknown is None
    assert short.names["h"] == Name("h")
