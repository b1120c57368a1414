"""A target: the files that it writes and the function that renders them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

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
        requires: Names of the targets whose files it needs.
        compiled: Libraries that a build compiles from them: for each the files that it depends on, the first of
            which is given to the compiler.
    """

    name: str
    summary: str
    files: tuple[str, ...]
    render: Callable[[Source], dict[str, str]]
    default: bool = True
    requires: tuple[str, ...] = ()
    compiled: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
