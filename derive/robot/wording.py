"""Pieces of messages: quoting users' text safely on one line, and near misses."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

_LISTS_OF_ROWS = ("joints", "links", "base", "tool")


def quoted(text: str, length: int = 40) -> str:
    """``text`` in quotes, on one line, cut to ``length`` characters, with control characters escaped."""
    shown = text if len(text) <= length else text[: length - 3] + "..."
    return "'" + "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in shown) + "'"


def near_miss(word: str, allowed: Iterable[str]) -> str:
    """``did you mean 'alpha'?`` when one of ``allowed`` is close to ``word``, else an empty string."""
    by_fold = {candidate.casefold(): candidate for candidate in allowed}
    close = difflib.get_close_matches(word.casefold()[:80], by_fold, n=1, cutoff=0.6)
    return f"did you mean '{by_fold[close[0]]}'?" if close else ""


def listed(words: Iterable[str]) -> str:
    """The words separated by commas."""
    return ", ".join(words)


def path_text(path: tuple[str | int, ...]) -> str:
    """A place in the file as a reader says it: ``joints row 2, alpha`` or ``gravity entry 3``."""
    text = ""
    for before, part in zip(("", *path), path, strict=False):
        if isinstance(part, int):
            text += f" {'row' if before in _LISTS_OF_ROWS else 'entry'} {part + 1}"
        else:
            text += (", " if text else "") + part
    return text or "the robot file"
