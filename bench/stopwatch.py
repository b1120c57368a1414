"""Times: rows that are compared take turns, so that a disturbance meets all of them; medians and minima."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from statistics import median
from time import perf_counter

from bench.peers.peer import Timed


@dataclass(frozen=True, slots=True)
class Effort:
    """How long to measure.

    Attributes:
        rounds: Turns of every row.
        seconds: Shortest time of one turn.
    """

    rounds: int
    seconds: float


FULL = Effort(9, 0.04)
QUICK = Effort(3, 0.01)


def measure(rows: Mapping[str, Timed], effort: Effort) -> dict[str, dict[str, float]]:
    """Nanoseconds per configuration of every row, its median and its minimum over the rounds."""
    repeats = {label: _repeats(timed, effort.seconds) for label, timed in rows.items()}
    samples: dict[str, list[float]] = {label: [] for label in rows}
    for _ in range(effort.rounds):
        for label, timed in rows.items():
            samples[label].append(_nanoseconds(timed, repeats[label]))
    return {label: {"median": _rounded(median(v)), "min": _rounded(min(v))} for label, v in samples.items()}


def _repeats(timed: Timed, seconds: float) -> int:
    """Passes in one turn; the first pass is for warming up."""
    timed.run()
    once = _nanoseconds(timed, 1) * timed.count * 1e-9
    return max(1, round(seconds / max(once, 1e-9)))


def _nanoseconds(timed: Timed, repeats: int) -> float:
    run = timed.run
    start = perf_counter()
    for _ in range(repeats):
        run()
    return (perf_counter() - start) * 1e9 / (repeats * timed.count)


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")
