"""Tables in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

ABSENT = "-"
"""Stands where a tool has no figure."""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table: texts to the left in the first column, figures to the right in the others."""
    rule = ["---", *("--:" for _ in head[1:])]
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, rule, *rows))


def figure(value: float) -> str:
    """Three significant digits, thousands with commas."""
    if value >= 100:
        return f"{value:,.0f}"
    return f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def times(value: float) -> str:
    """A ratio."""
    return f"{figure(value)}x"


def section(title: str, *parts: str, level: int = 2) -> str:
    """A heading and what is under it."""
    return "\n\n".join([f"{'#' * level} {title}", *parts])


def environment_line(environment: dict[str, str]) -> str:
    """Processor and versions in one sentence."""
    versions = ", ".join(f"{name} {value}" for name, value in environment.items() if name not in _APART)
    return f"{environment['processor']}; {environment['system']}; {versions}; C compiler {environment['C compiler']}."


_APART = ("processor", "system", "C compiler")
