"""A printed expression as a row of pieces, so that the layout can measure it and break it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from enum import IntEnum
from typing import NamedTuple

from derive.emit.latex.metrics import BINARY_WIDTH, DOT_WIDTH, Box, concatenate


class Break(IntEnum):
    """Whether a new line may start before a piece, and with what."""

    NEVER = 0
    BINARY = 1
    FACTOR = 2
    COMMA = 3


class Piece(NamedTuple):
    """A part of an expression that stays on one line.

    Attributes:
        box: Its LaTeX.
        before: Whether a line may be broken before it.
        depth: How many brackets it stands in.
        nest: Height of the bracket that it opens or closes, 0 for other pieces.
    """

    box: Box
    before: Break = Break.NEVER
    depth: int = 0
    nest: int = 0


_BRACKETS = (("(", ")"), ("[", "]"), ("\\{", "\\}"))


def brackets(height: int) -> tuple[str, str]:
    """The pair for a bracket that holds ``height`` levels of brackets: ( ), [ ], { }, and again."""
    return _BRACKETS[height % len(_BRACKETS)]


def binary(sign: str, depth: int) -> Piece:
    """Plus or minus between two terms."""
    return Piece(Box(f" {sign} ", BINARY_WIDTH), Break.BINARY, depth)


def joined(pieces: Iterable[Piece]) -> Box:
    """All pieces on one line."""
    return concatenate(*(piece.box for piece in pieces))


def line_start(piece: Piece) -> Box:
    """The piece at the start of a continuation line."""
    if piece.before is Break.BINARY:
        return Box("{}" + piece.box.tex.strip() + " ", piece.box.width)
    if piece.before is Break.FACTOR:
        return Box("{}\\cdot " + piece.box.tex, piece.box.width + DOT_WIDTH)
    return piece.box


def highest_nest(pieces: Sequence[Piece]) -> int:
    """Levels of brackets in the pieces."""
    return max((piece.nest for piece in pieces), default=0)
