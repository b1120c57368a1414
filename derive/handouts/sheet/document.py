"""The handout as data: sections made of blocks, the same for paper and for the web page.

Texts are plain Unicode in the language of the handout. Inside a text, mathematics stands between dollar signs as LaTeX
and code between backticks; a writer escapes everything else. Mathematics is LaTeX that pdflatex with amsmath and KaTeX
both understand.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from derive.handouts.figure.drawing import Drawing


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Running text."""

    text: str  # with ``$mathematics$`` and code between backticks
    is_answer: bool = False  # whether it tells what an exercise asks for, which then leaves it out


@dataclass(frozen=True, slots=True)
class Rows:
    """Displayed mathematics, line by line."""

    lines: tuple[str, ...]  # LaTeX of each line, broken to fit
    landscape: bool = False  # whether the lines are as long as a page turned on its side
    is_answer: bool = False  # whether they tell what an exercise asks for, which then leaves them out


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry of a quantity, to be copied."""

    name: str  # its symbol as LaTeX
    latex: str  # its expression as LaTeX on one line
    python: str  # the same as a Python expression in the names of the robot file


@dataclass(frozen=True, slots=True)
class SheetFormula:
    """The result for one quantity: what an exercise leaves blank."""

    rows: tuple[Rows, ...]  # the matrix, or its entries one by one
    named: tuple[str, ...] = ()  # definitions of intermediate terms that the entries use
    omitted: tuple[str, ...] = ()  # entries that are too long, with their numbers of terms
    note: str = ""  # what else a reader must know: that it is symmetric, that entries are left out since they are zero
    function: str = ""  # the generated function that computes it, empty if none does
    entries: Callable[[], Iterable[Entry]] = tuple  # for copying; written when asked for: paper has no use for them
    task: str = ""  # what an exercise asks in its place; empty where it asks nothing
    blanks: tuple[str, ...] = ()  # left sides of the answers, "" for one without; none for what is too long by hand


@dataclass(frozen=True, slots=True)
class Gap:
    """Room for an answer."""

    name: str  # LaTeX of the left side; empty for none
    lines: float  # lines of room
    is_half: bool = False  # whether two of them share a line


@dataclass(frozen=True, slots=True)
class Blank:
    """A question of an exercise with room for its answers."""

    number: str  # its number with a full stop
    task: str  # the sentence that asks
    points: str  # what it is worth, in brackets
    gaps: tuple[Gap, ...]  # room for each answer


@dataclass(frozen=True, slots=True)
class Table:
    """A table."""

    header: tuple[str, ...]  # texts of the head, mathematics between dollars
    rows: tuple[tuple[str, ...], ...]  # texts of the cells
    long: bool = False  # whether it may need more than a page
    is_answer: bool = False  # whether it tells what an exercise asks for, which then leaves it out


@dataclass(frozen=True, slots=True)
class Figure:
    """A drawing with its caption."""

    drawing: Drawing  # lines, areas and labels in the plane
    caption: str  # text below
    is_answer: bool = False  # whether it tells what an exercise asks for, which then leaves it out


@dataclass(frozen=True, slots=True)
class Steps:
    """Intermediate steps: printed on paper, folded on the web page, left out of an exercise."""

    title: str  # what is derived
    blocks: tuple[Block, ...]  # the steps


Block: TypeAlias = Paragraph | Rows | SheetFormula | Blank | Table | Figure | Steps


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the handout."""

    part: str  # its name in ``handout: parts:``
    title: str  # its heading
    blocks: tuple[Block, ...]  # its content
    end: str = ""  # the end of a tree that it is about, if it is about one

    @property
    def anchor(self) -> str:
        """What it is called, unlike any other section of the sheet."""
        return f"{self.part}-{self.end}" if self.end else self.part


@dataclass(frozen=True, slots=True)
class Document:
    """A handout."""

    title: str  # the robot's title: the user's text, to be escaped whole, dollars and backticks included
    subtitle: str  # what kind of sheet it is, such as an exercise
    name: str  # the robot's name
    digest: str  # SHA-256 of the robot file
    footer: str  # one line for every page
    sections: tuple[Section, ...]  # the parts, in their order
    form: tuple[str, ...] = ()  # words of a line to be filled in, such as that for a name; empty for none


def blocks_of(section: Section | Steps) -> Iterator[Block]:
    """All blocks of a section, those inside of steps included."""
    for block in section.blocks:
        yield block
        if isinstance(block, Steps):
            yield from blocks_of(block)


def gap_rows(gaps: Sequence[Gap]) -> list[tuple[Gap, ...]]:
    """Gaps line by line."""
    rows: list[tuple[Gap, ...]] = []
    for gap in gaps:
        if gap.is_half and rows and len(rows[-1]) == 1 and rows[-1][0].is_half:
            rows[-1] = (*rows[-1], gap)
        else:
            rows.append((gap,))
    return rows


def spans(text: str) -> Iterator[tuple[str, str]]:
    """The parts of a text: the mark around each, a dollar sign, a backtick or none, and its contents without it."""
    for k, part in enumerate(re.split(r"(\$[^$]*\$|`[^`]*`)", text)):
        if k % 2:
            yield part[0], part[1:-1]
        elif part:
            yield "", part
