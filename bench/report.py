"""Pages, the marked block of docs/benchmarks.md and the plot from the results: `python -m bench.report`.

The block between the two marks of that page is written from the results, so that every figure in it comes from a
command that anyone can run.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from bench import our_times
from bench.operations_report import SYMBOLS, operations_markdown, summary
from bench.peers import casadi_by_hand, pinocchio_cpp, pinocchio_python
from bench.results import FOLDER, read_json
from bench.tables import ABSENT, environment_line, figure, table
from bench.timings_report import timings_markdown

ROOT = Path(__file__).parents[1]
PAGE, PLOT = ROOT / "docs" / "benchmarks.md", ROOT / "docs" / "images" / "benchmarks.svg"
BEGIN, END = "<!-- bench:begin -->", "<!-- bench:end -->"

HEADLINE = (
    "stanford-symbolic",
    "puma560-symbolic",
    "rx90-symbolic",
    "arm-7r-symbolic",
    "puma560-numeric",
    "stanford-numeric",
    "scara-symbolic",
    "planar-2r-symbolic",
)
BATCH_ROWS = (
    pinocchio_python.LOOP,
    pinocchio_cpp.LABEL,
    f"{casadi_by_hand.BASE.name}: generated C, C loop",
    our_times.LINES,
    our_times.NUMPY,
    our_times.NUMPY + our_times.OUT,
    our_times.C_BATCH,
    our_times.NATIVE,
    our_times.NATIVE + our_times.OUT,
)
SINGLE_ROWS = (pinocchio_python.ONE, our_times.NUMPY, our_times.NATIVE)


def block(operations: dict[str, Any], timings: dict[str, Any]) -> str:
    """What stands between the marks."""
    return "\n\n".join(_block(operations, timings))


def _block(operations: dict[str, Any], timings: dict[str, Any]) -> Iterator[str]:
    yield "Multiplications and additions of one evaluation, sines and cosines apart:"
    yield summary(operations, HEADLINE)
    for entry in timings["robots"].values():
        yield f"{entry['title']}, nanoseconds per configuration in a batch of {timings['batch']:,}, one core:"
        yield table(("", *SYMBOLS), list(_lines(entry["batch"], BATCH_ROWS, 1)))
        yield f"{entry['title']}, one configuration from Python, microseconds:"
        yield table(("", *SYMBOLS), list(_lines(entry["one"], SINGLE_ROWS, 1000)))
    yield environment_line(timings["environment"])


def _lines(rows: dict[str, Any], labels: Iterable[str], unit: float) -> Iterator[list[str]]:
    for label in labels:
        cells = [rows.get(label, {}).get(symbol, {}).get("median") for symbol in SYMBOLS]
        if any(cells):
            yield [label, *(ABSENT if value is None else figure(value / unit) for value in cells)]


def with_block(page: str, text: str) -> str:
    """The page with the text between its marks.

    Raises:
        ValueError: The page has not one pair of marks.
    """
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end or BEGIN in after:
        raise ValueError(f"the page needs one line {BEGIN} and one line {END}")
    return f"{before}{BEGIN}\n\n{text}\n\n{END}{after}"


def write_pages(folder: Path = FOLDER) -> None:
    """``operations.md`` and ``timings.md`` beside the results."""
    operations, timings = read_json("operations", folder), read_json("timings", folder)
    (folder / "operations.md").write_text(operations_markdown(operations), encoding="utf-8")
    (folder / "timings.md").write_text(timings_markdown(timings, operations), encoding="utf-8")


def write_block(page: Path = PAGE, folder: Path = FOLDER) -> bool:
    """Write the marked block; False where the page has no marks."""
    text = page.read_text(encoding="utf-8")
    if BEGIN not in text:
        return False
    page.write_text(with_block(text, block(read_json("operations", folder), read_json("timings", folder))), "utf-8")
    return True


def main() -> int:
    """Write or print."""
    parser = argparse.ArgumentParser(prog="python -m bench.report", description=__doc__)
    parser.add_argument("--print", action="store_true", dest="shown", help="print the marked block and write nothing")
    parser.add_argument("--no-plot", action="store_true", help="leave docs/images/benchmarks.svg as it is")
    options = parser.parse_args()
    if options.shown:
        print(block(read_json("operations"), read_json("timings")))
        return 0
    write_pages()
    write_block()
    if not options.no_plot:
        from bench.plot import write_plot

        write_plot(read_json("timings"), PLOT)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
