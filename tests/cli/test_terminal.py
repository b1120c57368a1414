"""How commands speak: one line for a message, aligned columns, and arguments that are refused with what is allowed."""

import argparse
import contextlib
import io
import re
from collections.abc import Callable

import pytest

from derive.cli import terminal


def test_a_message_is_one_line_whatever_it_quotes_and_columns_are_aligned(capsys: pytest.CaptureFixture[str]) -> None:
    assert terminal.one_line("a\nb\x1b[31m\tc d") == "a\\nb\\x1b[31m\\tc d"
    terminal.print_columns([("arm", "RR"), ("anthropomorphic", "R")], ("name", "joints"))
    assert capsys.readouterr().out == "name             joints\narm              RR\nanthropomorphic  R\n"
    terminal.print_columns([])
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("read", "good", "bad"),
    [
        (terminal.positive, {"1": 1, "99999999": 99999999}, ("0", "-1", "1.5", "100000000", "\u0663", "")),
        (terminal.magnification, {"0.1": 0.1, "10": 10.0}, ("0", "11", "nan", "inf", "x")),
    ],
)
def test_numbers_have_bounds(read: Callable[[str], float], good: dict[str, float], bad: tuple[str, ...]) -> None:
    assert {text: read(text) for text in good} == good
    for text in bad:
        with pytest.raises(argparse.ArgumentTypeError, match="is not a"):
            read(text)


def test_nobody_watches_a_pipe() -> None:
    with terminal.progress(3, quiet=False) as tell:
        assert tell is None


@pytest.mark.parametrize(
    ("terminal_there", "variables", "coloured"),
    [
        (True, {}, True),
        (False, {}, False),
        (True, {"NO_COLOR": "1"}, False),
        (True, {"NO_COLOR": ""}, True),
        (True, {"TERM": "dumb"}, False),
        (False, {"FORCE_COLOR": "1"}, True),
        (False, {"FORCE_COLOR": "1", "NO_COLOR": "1"}, False),
    ],
)
def test_colours_are_for_terminals_and_for_who_wants_them(
    terminal_there: bool, variables: dict[str, str], coloured: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in {"NO_COLOR": "", "FORCE_COLOR": "", "TERM": "xterm", **variables}.items():
        monkeypatch.setenv(name, value)
    stream = io.StringIO()
    monkeypatch.setattr(stream, "isatty", lambda: terminal_there)
    with contextlib.redirect_stderr(stream), contextlib.redirect_stdout(stream):
        terminal.print_error("wrong")
        terminal.print_columns([("a", "b")], ("name", "joints"))
    text = stream.getvalue()
    assert ("\x1b[" in text) == coloured
    assert re.sub(r"\x1b\[\d+m", "", text) == "derive: error: wrong\nname  joints\na     b\n"
