"""Broken and hostile files are refused quickly, in one line, with the file's name and the line."""

import re
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from derive.errors import DeriveError, ExpressionError, RobotFileError
from derive.robot.load import catalogue_names, robot_file_bytes
from derive.robot.robot import Robot
from tests.refusals import one_message
from tests.robot.hostile import HOSTILE

SECONDS = 5.0


def refusal(path: Path) -> str:
    begin = time.process_time()
    with pytest.raises((RobotFileError, ExpressionError)) as caught:
        Robot.load(path)
    assert time.process_time() - begin < SECONDS
    assert caught.value.location is not None
    return str(caught.value)


@pytest.mark.parametrize("name", HOSTILE)
def test_refused_in_one_line_with_file_and_line(name: str, tmp_path: Path) -> None:
    data, words = HOSTILE[name]
    path = tmp_path / f"{name}.yaml"
    path.write_bytes(data)
    message = refusal(path)
    assert re.match(re.escape(str(path)) + r":\d+:\d+: \S", message)
    assert words in message
    assert message.isprintable()
    assert len(message) < 600
    assert not Path("/tmp/derive-was-here").exists(), "it was run"


@pytest.mark.parametrize(
    ("name", "line", "column"),
    [
        ("import", 5, 26), ("unknown-key", 12, 1), ("unknown-cell", 5, 28), ("duplicate-key", 13, 1),
        ("duplicate-parameter", 11, 28), ("wrong-convention", 3, 13), ("missing-type", 6, 5), ("com-two", 9, 21),
        ("coulomb-three", 10, 36), ("coulomb-signed", 10, 40), ("unused-parameter", 11, 32),
        ("unknown-runtime", 12, 11), ("tool-scaled", 13, 8), ("negative-mass", 9, 12), ("tabs", 3, 1),
        ("latin-1", 2, 11), ("cell-octal", 5, 26), ("links-too-few", 9, 3), ("division-by-zero", 5, 26),
    ],
)  # fmt: skip
def test_the_place_is_exact(name: str, line: int, column: int, tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    path.write_bytes(HOSTILE[name][0])
    assert refusal(path).startswith(f"{path}:{line}:{column}: ")


def test_offsets_in_quoted_cells_count_the_quotation_mark() -> None:
    with one_message(ExpressionError, "<text>:4:28", "unexpected"):
        Robot.from_text('name: r\nconvention: standard\njoints:\n  - {type: revolute, a: "x $"}\n')


def test_a_file_name_with_a_line_break_does_not_break_the_message(tmp_path: Path) -> None:
    path = tmp_path / "a\nb.yaml"
    path.write_bytes(b"- x\n")
    assert refusal(path).isprintable()


TEXTS = [robot_file_bytes(name).decode() for name in catalogue_names()]
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


@settings(deadline=None, max_examples=200)
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
