"""Whatever the bytes are, the answer is a robot or one refusal."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from derive.errors import DeriveError
from derive.robot.load import catalogue_names, catalogue_text
from derive.robot.robot import Robot

TEXTS = [catalogue_text(name) for name in catalogue_names()]
SYNTAX = ["\t", "\n", " ", ":", "-", "[", "]", "{", "}", "'", '"', "#", "&a ", "*a", "!!x ", "%", "?", "|", ">"]
CONTROL = ["\0", "\r", "\u2028", "\x85", "\ufeff", "---\n", "...\n"]
CELLS = ["q1", "pi", "**", "1/0", "sqrt(-1)", "type: prismatic", "theta: 0"]


def answer(data: bytes) -> Robot | str:
    try:
        return Robot.from_bytes(data, "x.yaml")
    except DeriveError as refusal:
        return str(refusal)


@st.composite
def edited_texts(draw: st.DrawFn) -> str:
    text = draw(st.sampled_from(TEXTS))
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(text)))
        end = min(len(text), start + draw(st.integers(0, 12)))
        text = text[:start] + draw(st.sampled_from([*SYNTAX, *CONTROL, *CELLS, "", text[start:end] * 2])) + text[end:]
    return text


@settings(deadline=None, max_examples=300)
@given(edited_texts())
def test_edited_files_give_a_robot_or_one_line(text: str) -> None:
    result = answer(text.encode("utf-8"))
    assert isinstance(result, Robot) or (result.startswith("x.yaml:") and result.isprintable())


@settings(deadline=None, max_examples=200)
@given(st.binary(max_size=200))
def test_random_bytes_are_refused_in_one_line(data: bytes) -> None:
    result = answer(data)
    assert isinstance(result, str)
    assert result.startswith("x.yaml:")
    assert result.isprintable()


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_line_endings_do_not_matter(ending: str) -> None:
    for text in TEXTS:
        result = answer(text.replace("\n", ending).encode())
        assert isinstance(result, Robot)
