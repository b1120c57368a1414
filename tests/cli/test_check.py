"""``derive check``: what it prints and how it ends."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.check.test_corpus_file import ARM
from tests.cli.command import derive, is_one_message

RIGHT = ARM + 'expected:\n  - {quantity: p, entries: {"1": "a1*c1 + a2*c12"}}\n'
WRONG = ARM + 'expected:\n  - {quantity: p, entries: {"1": "a1*c1 + a2*c2"}}\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "right.yaml").write_text(RIGHT)
    (tmp_path / "wrong.yaml").write_text(WRONG)
    (tmp_path / "broken.yaml").write_text(WRONG.replace("c2", "cc"))
    return tmp_path


def test_right_formulas_end_with_0(folder: Path) -> None:
    done = derive("check", "right.yaml", folder=folder)
    assert (done.status, done.stdout, done.stderr) == (0, "right.yaml: 1 equal, 0 wrong\n", "")


def test_a_wrong_formula_ends_with_1_and_is_shown_with_the_right_one_and_numbers(folder: Path) -> None:
    done = derive("check", "right.yaml", "wrong.yaml", folder=folder)
    assert done.status == 1
    first, place, right, numbers, count = done.stdout.splitlines()
    assert first == "right.yaml: 1 equal, 0 wrong"
    assert place == "wrong.yaml:8:35: p[1] is wrong: a1*c1 + a2*c2"
    assert right == "  right: a1*c1 + a2*c12"
    assert numbers.startswith("  at a1 = ")
    assert count == "wrong.yaml: 0 equal, 1 wrong"


def test_a_formula_that_cannot_be_read_ends_with_2_and_its_place(folder: Path) -> None:
    done = derive("check", "right.yaml", "broken.yaml", folder=folder)
    assert (done.status, done.stdout) == (2, "")
    assert is_one_message(done.stderr)
    assert "broken.yaml:8:46: unknown name 'cc'" in done.stderr


@pytest.mark.parametrize("arguments", [["missing.yaml"], ["."], ["scara-perugia"], ["x", "--quantity", "T"], []])
def test_unusable_arguments_end_with_2(folder: Path, arguments: list[str]) -> None:
    done = derive("check", *arguments, folder=folder)
    assert done.status == 2
    assert is_one_message(done.stderr)


def test_the_report_as_json(folder: Path) -> None:
    done = derive("check", "wrong.yaml", "--json", folder=folder)
    (report,) = json.loads(done.stdout)
    assert (done.status, report["equal"], report["wrong"], report["robot"]) == (1, 0, 1, "arm")
    (entry,) = report["entries"]
    assert (entry["quantity"], entry["equal"], entry["exact"], entry["line"]) == ("p[1]", False, True, 8)
    assert entry["right"] == "a1*c1 + a2*c12"
    assert entry["counter_example"]["printed"] != entry["counter_example"]["right"]
    assert set(entry["counter_example"]["values"]) == {"a1", "a2", "q1", "q2"}


@pytest.mark.parametrize(("formula", "status"), [("a1*c1 + a2*c12", 0), ("a1*c1", 1), ("a1*(", 2)])
def test_one_formula_without_a_file(folder: Path, formula: str, status: int) -> None:
    done = derive("check", "scara-perugia", "--quantity", "T[1,4]", "--expression", formula, folder=folder)
    assert done.status == status
    assert (done.stdout == "T[1,4]: equal\n") is (status == 0)
