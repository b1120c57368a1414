"""Times of inverse kinematics in words and tables, from ``results/inverse.json``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from bench.inverse.problem import BATCH, ONE, SINGLE, C
from bench.tables import ABSENT, environment_line, figure, section, table

_RULES = """\
Microseconds a pose, all branches, one core. Poses of random configurations, {single} different ones from Python, up to
{batch:,} in C and in a batch; the rows of a column take turns, {rounds} rounds, and figures are medians of the
processor's time, which other work on the machine changes little (the time that passed is in `inverse.json`). Every
solver is given the same Denavit-Hartenberg table. Solutions are put into an independent recursion, and a solver that
misses the configuration that a pose comes from has no time."""

_TITLES = {
    ONE: "One pose from Python, µs",
    C: "One pose in C, a loop, µs",
    BATCH: "A batch, µs per pose",
}


def inverse_markdown(results: dict[str, Any]) -> str:
    """The whole page.

    Args:
        results: The content of ``inverse.json``.
    """
    rules = _RULES.format(single=SINGLE, batch=results["batch"], rounds=results["rounds"])
    parts = [
        "# Inverse kinematics",
        f"Written by `python -m bench.inverse`. {environment_line(results['environment'])}",
        rules,
        *(f"Not installed: {label} ({', '.join(modules)})." for label, modules in results["not installed"].items()),
        *(section(title, times(results, way), "\n".join(_failures(results, way))) for way, title in _TITLES.items()),
        section("Solutions found, mean of the checked poses", _solutions(results)),
    ]
    return "\n\n".join(parts) + "\n"


def times(results: dict[str, Any], way: str) -> str:
    """The table of one way of calling.

    Args:
        results: The content of ``inverse.json``.
        way: One of `bench.inverse.problem.WAYS`.
    """
    return _table(results, way, "processor", lambda value: figure(value / 1000))


def _solutions(results: dict[str, Any]) -> str:
    return _table(results, ONE, "solutions", lambda value: f"{value:.2f}")


def _table(results: dict[str, Any], way: str, key: str, shown: Any) -> str:
    arms = results["arms"].values()
    labels = dict.fromkeys(label for arm in arms for label in arm["ways"][way])
    lines = [[label, *_figures(arms, way, label, key, shown)] for label in labels]
    return table(("program", *(arm["title"] for arm in arms)), lines)


def _figures(arms: Iterable[dict[str, Any]], way: str, label: str, key: str, shown: Any) -> Iterator[str]:
    for arm in arms:
        cell = arm["ways"][way].get(label, {})
        yield shown(cell[key]) if key in cell else ABSENT


def _failures(results: dict[str, Any], way: str) -> Iterator[str]:
    for arm in results["arms"].values():
        for label, cell in arm["ways"][way].items():
            if "failed" in cell:
                yield f"- {label}, {arm['title']}: {cell['failed']}"
