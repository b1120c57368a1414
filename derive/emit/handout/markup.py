"""Texts of a document: plain words, mathematics between dollar signs and code between backticks."""

from __future__ import annotations

import re
from collections.abc import Iterator
from enum import Enum
from typing import NamedTuple

_SPAN = re.compile(r"\$([^$]*)\$|`([^`]*)`")


class Kind(Enum):
    """What a span of text is."""

    WORDS = "words"
    MATHEMATICS = "mathematics"
    CODE = "code"


class Span(NamedTuple):
    """A part of a text.

    Attributes:
        kind: What it is.
        text: Its contents without the marks.
    """

    kind: Kind
    text: str


def spans(text: str) -> Iterator[Span]:
    """The parts of a text, in their order."""
    end = 0
    for match in _SPAN.finditer(text):
        if match.start() > end:
            yield Span(Kind.WORDS, text[end : match.start()])
        mathematics, code = match.groups()
        yield Span(Kind.CODE, code) if mathematics is None else Span(Kind.MATHEMATICS, mathematics)
        end = match.end()
    if end < len(text):
        yield Span(Kind.WORDS, text[end:])
