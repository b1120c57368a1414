"""Times: rows that are compared take turns, so that a disturbance meets all of them; medians and minima."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from time import perf_counter, process_time

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
    """Nanoseconds per configuration of every row over the rounds.

    Returns:
        ``median`` and ``min`` of the time that passes, and ``processor``, the median of the time that the processor was
        ours: much less than ``median`` where the machine had other work.
    """
    repeats = {label: _repeats(timed, effort.seconds) for label, timed in rows.items()}
    samples: dict[str, list[tuple[float, float]]] = {label: [] for label in rows}
    for _ in range(effort.rounds):
        for label, timed in rows.items():
            samples[label].append(_nanoseconds(timed, repeats[label]))
    return {label: _statistics(values) for label, values in samples.items()}


def _statistics(samples: Sequence[tuple[float, float]]) -> dict[str, float]:
    passed, ours = zip(*samples, strict=True)
    values = {"median": median(passed), "min": min(passed), "processor": median(ours)}
    return {name: float(f"{value:.4g}") for name, value in values.items()}


def _repeats(timed: Timed, seconds: float) -> int:
    """Passes in one turn; the first pass is for warming up."""
    timed.run()
    once = _nanoseconds(timed, 1)[0] * timed.count * 1e-9
    return max(1, round(seconds / max(once, 1e-9)))


def _nanoseconds(timed: Timed, repeats: int) -> tuple[float, float]:
    """Time that passes, and this process's own, all threads together."""
    run, scale = timed.run, 1e9 / (repeats * timed.count)
    ours, start = process_time(), perf_counter()
    for _ in range(repeats):
        run()
    passed = perf_counter() - start
    return passed * scale, (process_time() - ours) * scale
