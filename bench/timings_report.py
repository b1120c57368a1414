"""Times in words and tables, from ``results/timings.json``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from bench import our_times
from bench.floor import floor_of
from bench.operations_report import SYMBOLS
from bench.ours import OURS
from bench.peers import pinocchio_cpp, pinocchio_python
from bench.tables import ABSENT, environment_line, figure, section, table, times

_RULES = """\
One core. A batch has {batch:,} configurations in arrays of doubles, (N, n) in and (N, ...) out, one configuration after
the other; loops over Pinocchio in Python run over 2,000 of them, mapped CasADi functions over 20,000. The rows of a
column take turns, {rounds} rounds; figures are medians, minima are in `timings.json`. C and C++ are compiled with
`-O3 -march=native`. Every time belongs to a result that was checked against an independent recursion, relative error
below 1e-9."""

_SHOWN = (
    our_times.NUMPY,
    our_times.NUMPY + our_times.OUT,
    our_times.C_LOOP,
    our_times.C_BATCH,
    our_times.NATIVE,
    our_times.NATIVE + our_times.OUT,
)
"""Rows whose ratios are shown."""

Measure = Callable[[dict[str, Any]], str]


def timings_markdown(results: dict[str, Any], operations: dict[str, Any]) -> str:
    """The whole page."""
    parts = [
        "# Times",
        "Written by `make bench`. " + environment_line(results["environment"]),
        _RULES.format(batch=results["batch"], rounds=results["rounds"]),
        *(f"Not installed: {name}." for name in results["not installed"]),
    ]
    for entry in results["robots"].values():
        parts += [
            section(f"{entry['title']}, one configuration, µs", _table(entry["one"], _microseconds)),
            section(f"{entry['title']}, batch, ns per configuration", _table(entry["batch"], _nanoseconds)),
            section(f"{entry['title']}: how many times faster", ratios(entry["batch"]), single_ratios(entry["one"])),
        ]
    parts += [section("What the machine can do", *_machine(results, operations))]
    return "\n\n".join(parts) + "\n"


def _table(rows: dict[str, Any], measure: Measure) -> str:
    lines = [[label, *(_cell(cells.get(symbol), measure) for symbol in SYMBOLS)] for label, cells in rows.items()]
    text = table(("program", *SYMBOLS), lines)
    notes = list(_failures(rows))
    return "\n".join([text, "", *notes]) if notes else text


def _cell(cell: dict[str, Any] | None, measure: Measure) -> str:
    if cell is None:
        return ABSENT
    return "failed" if "failed" in cell else measure(cell)


def _microseconds(cell: dict[str, Any]) -> str:
    return figure(cell["median"] / 1000)


def _nanoseconds(cell: dict[str, Any]) -> str:
    return figure(cell["median"])


def _failures(rows: dict[str, Any]) -> Iterator[str]:
    for label, cells in rows.items():
        texts = sorted({cell["failed"] for cell in cells.values() if "failed" in cell})
        if texts:
            yield f"- {label}: {'; '.join(texts)}"


def ratio(rows: dict[str, Any], slow: str, fast: str, symbol: str) -> float | None:
    """How many times faster one row is than another, by medians of that run."""
    cells = [rows.get(label, {}).get(symbol, {}) for label in (slow, fast)]
    if not all("median" in cell for cell in cells):
        return None
    return float(cells[0]["median"] / cells[1]["median"])


def ratios(rows: dict[str, Any]) -> str:
    """Our rows of a batch against Pinocchio's two loops, and NumPy against the same tape as plain lines."""
    pairs = [
        (label, reference)
        for reference in (pinocchio_python.LOOP, pinocchio_cpp.LABEL)
        for label in _SHOWN
        if label in rows
    ]
    return _ratio_table(rows, [*pairs, *((our_times.NUMPY + way, our_times.LINES) for way in ("", our_times.OUT))])


def single_ratios(rows: dict[str, Any]) -> str:
    """Our rows of one configuration against Pinocchio from Python."""
    pairs = [(label, pinocchio_python.ONE) for label in _SHOWN if label in rows]
    return _ratio_table(rows, pairs)


def _ratio_table(rows: dict[str, Any], pairs: Iterable[tuple[str, str]]) -> str:
    lines = []
    for fast, slow in pairs:
        found = [ratio(rows, slow, fast, symbol) for symbol in SYMBOLS]
        if any(value is not None for value in found):
            lines.append([f"{fast} against {slow}", *(ABSENT if v is None else times(v) for v in found)])
    return table(("times faster", *SYMBOLS), lines)


def _machine(results: dict[str, Any], operations: dict[str, Any]) -> Iterator[str]:
    measured = results["floor"]
    if "failed" in measured:
        yield f"Not measured: {measured['failed']}."
        return
    widths = measured["lanes"]
    rows = [
        ["half mul, half add, not fused, G op/s", *(figure(1 / w["operation"]) for w in widths.values())],
        ["sine and cosine of libmvec, ns a pair", *(_optional(w.get("pair")) for w in widths.values())],
        ["sine and cosine of libm, ns a pair", *(figure(w["scalar pair"]) for w in widths.values())],
    ]
    yield table(("one core", *(f"{lanes} lanes" for lanes in widths)), rows)
    if "our pair" in measured:
        yield f"Sine and cosine in our generated C: {figure(measured['our pair'])} ns a pair."
    yield f"Memory, a = b + k c, a read before it is written: {figure(1 / measured['byte'])} GB/s."
    yield _floors(results, operations)
    yield (
        "Floor in cache = arithmetic + sines and cosines, the faster ones, at these rates; floor of a batch = the "
        "larger of that and of the memory traffic, 3 n doubles read, n written and read before. Counts are those of "
        "`operations.md`."
    )


def _floors(results: dict[str, Any], operations: dict[str, Any]) -> str:
    rows = []
    for name, entry in results["robots"].items():
        cell = operations["robots"][name]["counts"][OURS.name]["tau"]
        native = entry["batch"].get(our_times.NATIVE + our_times.OUT, {}).get("tau", {})
        measured = _optional(native.get("median"))
        joints = results["robots"][name]["joints"]
        for lanes in results["floor"]["lanes"]:
            parts = floor_of(results["floor"], int(lanes), cell["arithmetic"], cell["trig"], 5 * joints)
            rows.append([f"{entry['title']}, tau, {lanes} lanes", *(figure(v) for v in parts.values()), measured])
    return table(("ns per configuration", *_PARTS, "measured"), rows)


def _optional(value: float | None) -> str:
    return ABSENT if value is None else figure(value)


_PARTS = ("arithmetic", "sin + cos", "memory", "floor in cache", "floor of a batch")
