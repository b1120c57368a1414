"""A user's name as a symbol in HTML: letter, Greek letter, index."""

from __future__ import annotations

import re
import unicodedata

from derive.emit.escape import html_text

_PARTS = re.compile(r"([A-Za-z]+?)_?([0-9][A-Za-z0-9_]*)?")


def html_symbol(name: str) -> str:
    """``theta1`` is an italic theta with index 1; names that are no letter with an index stay as they are."""
    match = _PARTS.fullmatch(name)
    if match is None:
        return html_text(name)
    head, index = match.group(1), match.group(2)
    letter = _letter(head)
    sub = f"<sub>{html_text(index)}</sub>" if index else ""
    return f"<i>{letter}</i>{sub}"


def _letter(head: str) -> str:
    if len(head) == 1:
        return head
    size = "CAPITAL" if head[0].isupper() else "SMALL"
    word = {"lambda": "LAMDA", "vartheta": "THETA", "varphi": "PHI"}.get(head.lower(), head.upper())
    try:
        return unicodedata.lookup(f"GREEK {size} LETTER {word}")
    except KeyError:
        return html_text(head)
