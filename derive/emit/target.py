"""A target: the files that it writes and the function that renders them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from derive.emit.source import Source


@dataclass(frozen=True, slots=True)
class Target:
    """One kind of output.

    Attributes:
        name: What the user says to choose it.
        summary: One line for help texts.
        files: Names of the files that it writes.
        render: Makes their contents, by file name; a pure function.
        default: Whether a build writes it when no target is named.
    """

    name: str
    summary: str
    files: tuple[str, ...]
    render: Callable[[Source], dict[str, str]]
    default: bool = True
