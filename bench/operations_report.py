"""Operation counts in words and tables, from ``results/operations.json``."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from bench.ours import OURS
from bench.quantities import QUANTITIES
from bench.tables import ABSENT, environment_line, section, table

SYMBOLS = tuple(quantity.symbol for quantity in QUANTITIES)

_RULES = """\
Multiplications + additions + divisions (m = multiplications, a = additions and subtractions, t = sines and cosines).
A change of sign is free, x**2 is one multiplication, the same sine twice in one function counts once. What depends on
parameters alone (grouped inertial parameters) is computed once and not counted, for every tool. CasADi functions are
expanded to SX, `cse`d and counted by opcode; printed code is parsed. Every count belongs to a result that was checked
at random configurations against an independent recursion, relative error below 1e-9 (a C through C qd).

"By hand" is no product: a textbook recursion in frames on the joint axes (`bench/byhand`) through that system's
expressions and common subexpressions."""


def operations_markdown(results: dict[str, Any]) -> str:
    """The whole page."""
    robots = results["robots"]
    parts = [
        "# Operation counts",
        "Written by `make bench`. " + environment_line(results["environment"]),
        _RULES,
        *_absent(results),
        section("derive and the best other tool", summary(results)),
        *(section(entry["title"], _details(entry["counts"])) for entry in robots.values()),
    ]
    return "\n\n".join(parts) + "\n"


def summary(results: dict[str, Any], robots: tuple[str, ...] | None = None) -> str:
    """Per robot and quantity: ours, and in brackets the fewest of any other tool in that run."""
    chosen = robots or tuple(results["robots"])
    rows = [_summary_row(results["robots"][name]) for name in chosen if name in results["robots"]]
    return table(("derive (best other tool)", *SYMBOLS), rows)


def best_other(counts: dict[str, Any], symbol: str) -> tuple[int, str] | None:
    """The fewest operations of another tool, and whose they are."""
    found = [
        (cells[symbol]["arithmetic"], name)
        for name, cells in counts.items()
        if name != OURS.name and "arithmetic" in cells.get(symbol, {})
    ]
    return min(found) if found else None


def _summary_row(entry: dict[str, Any]) -> list[str]:
    counts = entry["counts"]
    cells = []
    for symbol in SYMBOLS:
        ours, best = counts[OURS.name].get(symbol, {}).get("arithmetic"), best_other(counts, symbol)
        cells.append(f"{_text(ours)} ({_text(best[0] if best else None)})")
    return [entry["title"], *cells]


def _text(count: int | None) -> str:
    return ABSENT if count is None else f"{count:,}"


def _details(counts: dict[str, Any]) -> str:
    rows = [[name, *(_cell(cells.get(symbol)) for symbol in SYMBOLS)] for name, cells in counts.items() if cells]
    text = table(("program", *SYMBOLS), rows)
    notes = list(_failures(counts))
    return "\n".join([text, "", *notes]) if notes else text


def _cell(cell: dict[str, Any] | None) -> str:
    if cell is None:
        return ABSENT
    if "failed" in cell:
        return "failed"
    return f"**{cell['arithmetic']:,}** ({cell['mul']}m {cell['add'] + cell['div']}a {cell['trig']}t)"


def _failures(counts: dict[str, Any]) -> Iterator[str]:
    for name, cells in counts.items():
        for symbol, cell in cells.items():
            if "failed" in cell:
                yield f"- {name}{'' if symbol == 'failed' else f', {symbol}'}: {cell['failed']}"


def _absent(results: dict[str, Any]) -> Iterator[str]:
    for name, modules in results["not installed"].items():
        yield f"Not installed: {name} ({', '.join(modules)})."
