"""Figures on pages come from the results."""

import re
from pathlib import Path
from typing import Any

import pytest

from bench.operations_report import best_other, operations_markdown, summary
from bench.peers.passes import one_by_one
from bench.peers.peer import Timed
from bench.report import BEGIN, END, PAGE, block, with_block
from bench.results import FOLDER, read_json
from bench.stopwatch import Effort, measure
from bench.timings_report import ratio, timings_markdown

CELL = {"arithmetic": 10, "mul": 6, "add": 4, "div": 0, "trig": 2, "other": 0, "error": 1e-16}
OPERATIONS: dict[str, Any] = {
    "environment": {"processor": "P", "system": "S", "C compiler": "none", "derive": "1"},
    "not installed": {"adam": ["adam"]},
    "robots": {
        "puma560-numeric": {
            "title": "PUMA",
            "counts": {
                "derive": {"tau": CELL},
                "X": {"tau": {**CELL, "arithmetic": 12}, "B": {"failed": "ValueError: no"}},
                "Y": {"tau": {**CELL, "arithmetic": 11}},
            },
        }
    },
}


def timings() -> dict[str, Any]:
    batch = {
        "Pinocchio, C++ loop": {"tau": {"median": 900.0, "min": 890.0, "error": 0.0}},
        "derive: model_native, out=": {"tau": {"median": 30.0, "min": 29.0, "error": 0.0}, "B": {"failed": "no"}},
    }
    robots = {"puma560-numeric": {"title": "PUMA", "joints": 6, "one": {}, "batch": batch}}
    widths = {"4": {"operation": 0.02, "pair": 2.5, "scalar pair": 15.0}}
    return {**OPERATIONS, "batch": 1000, "rounds": 3, "floor": {"lanes": widths, "byte": 0.05}, "robots": robots}


def test_a_page_says_the_best_other_tool_what_is_missing_and_what_failed() -> None:
    assert best_other(OPERATIONS["robots"]["puma560-numeric"]["counts"], "tau") == (11, "Y")
    assert "| PUMA | 10 (11) |" in summary(OPERATIONS)
    text = operations_markdown(OPERATIONS)
    assert "Not installed: adam (adam)." in text
    assert "X, B: ValueError: no" in text


def test_ratios_are_of_medians_of_one_run_and_the_floor_adds_arithmetic_and_sines() -> None:
    rows = timings()["robots"]["puma560-numeric"]["batch"]
    assert ratio(rows, "Pinocchio, C++ loop", "derive: model_native, out=", "tau") == pytest.approx(30)
    assert ratio(rows, "Pinocchio, C++ loop", "derive: model_native, out=", "B") is None
    text = timings_markdown(timings(), OPERATIONS)
    assert "| PUMA, tau, 4 lanes | 0.20 | 2.50 | 12.0 | 2.70 | 12.0 | 30.0 |" in text


def test_the_block_is_put_between_the_marks_once() -> None:
    page = f"a\n{BEGIN}\nold\n{END}\nb\n"
    once = with_block(page, "new")
    assert once == f"a\n{BEGIN}\n\nnew\n\n{END}\nb\n"
    assert with_block(once, "new") == once
    with pytest.raises(ValueError, match="bench:begin"):
        with_block("no marks", "new")


def test_figures_on_the_page_are_those_of_the_committed_results() -> None:
    page = PAGE.read_text(encoding="utf-8")
    if BEGIN not in page:
        pytest.skip("the page has no marks")
    assert with_block(page, block(read_json("operations"), read_json("timings"))) == page


@pytest.mark.parametrize("name", ["operations", "timings"])
def test_committed_pages_are_those_of_the_committed_results(name: str) -> None:
    page = FOLDER / f"{name}.md"
    if not page.is_file():
        pytest.skip("no committed results")
    operations = read_json("operations")
    text = operations_markdown(operations) if name == "operations" else timings_markdown(read_json(name), operations)
    assert page.read_text(encoding="utf-8") == text


def test_results_name_no_folder_of_a_machine() -> None:
    texts = [path.read_text(encoding="utf-8") for path in Path(FOLDER).glob("*")]
    assert not [text for text in texts if re.search(r"/(home|work|root|tmp|usr)/", text)]


def test_rows_take_turns_and_single_calls_get_rows_whose_results_stay_in_order() -> None:
    order: list[str] = []
    rows = {name: Timed(lambda name=name: order.append(name), 1, list) for name in "ab"}  # type: ignore[misc, arg-type]
    times = measure(rows, Effort(rounds=2, seconds=0.0))
    assert "".join(order).endswith("abab")
    assert all(cell["min"] <= cell["median"] for cell in times.values())
    import numpy as np

    inputs = [np.arange(6.0).reshape(3, 2)]
    timed = one_by_one(lambda q: 2 * q, inputs, (2,), count=2)
    assert timed.count == 2
    np.testing.assert_array_equal(timed.values(), [[0, 2], [4, 6]])
