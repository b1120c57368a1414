"""``derive show``: numbers in few digits, and it says so; exactly where that is asked for."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.command import derive, is_one_message

NOTE = "numbers are rounded to {} significant digits; --exact prints all of them"
ROD = """\
name: rod
convention: standard
joints:
  - {type: revolute, a: 0.4318}
links:
  - {mass: 1.2345, com: [-0.2159, 0, 0], inertia: {zz: 0.019}}
gravity: [0, -9.81, 0]
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rod.yaml").write_text(ROD)
    return tmp_path


def printed(folder: Path, *arguments: str) -> list[str]:
    """The lines of ``derive show rod.yaml ...``."""
    outcome = derive("show", "rod.yaml", *arguments, folder=folder)
    assert outcome.status == 0, outcome.stderr
    return outcome.stdout.splitlines()


def test_numbers_have_six_digits_and_a_line_says_so(folder: Path) -> None:
    assert printed(folder, "B[1,1]", "p[1]") == [f"# {NOTE.format(6)}", "B[1,1] = 0.0765435", "", "p[1] = 0.4318*c1"]
    assert printed(folder, "B[1,1]", "--format", "latex") == [f"% {NOTE.format(6)}", "0.0765435"]


def test_nothing_is_said_where_nothing_is_rounded(folder: Path) -> None:
    assert printed(folder, "p[1]") == ["p[1] = 0.4318*c1"]


def test_digits_may_be_chosen(folder: Path) -> None:
    assert printed(folder, "B[1,1]", "--digits", "2") == [f"# {NOTE.format(2)}", "B[1,1] = 0.077"]


def test_exact_and_python_and_json_have_every_digit(folder: Path) -> None:
    exact = "15308702789/200000000000"
    assert printed(folder, "B[1,1]", "--exact") == [f"B[1,1] = {exact}"]
    assert printed(folder, "B[1,1]", "--exact", "--format", "latex") == ["0.076543513945"]
    assert printed(folder, "B[1,1]", "--format", "python") == [f"B_1_1 = {exact}"]
    assert exact in "".join(printed(folder, "B[1,1]", "--format", "json"))


@pytest.mark.parametrize(
    "options", [("--digits", "0"), ("--digits", "4", "--exact"), ("--digits", "4", "--format", "json")]
)
def test_digits_that_make_no_sense_are_refused(options: tuple[str, ...], folder: Path) -> None:
    outcome = derive("show", "rod.yaml", "B", *options, folder=folder)
    assert outcome.status == 2
    assert is_one_message(outcome.stderr)
