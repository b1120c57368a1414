"""The handout as data: sections made of blocks, the same for paper and for the web page.

Texts are plain Unicode in the language of the handout. Inside a text, mathematics stands between dollar signs as LaTeX
and code between backticks; a writer escapes everything else. Mathematics is LaTeX that pdflatex with amsmath and KaTeX
both understand.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, TypeAlias

from derive.handouts.figure.drawing import Drawing


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Running text.

    Attributes:
        text: With ``$mathematics$`` and code between backticks.
        is_answer: Whether it tells what an exercise asks for, which then leaves it out.
    """

    text: str
    is_answer: bool = False


@dataclass(frozen=True, slots=True)
class Rows:
    """Displayed mathematics, line by line.

    Attributes:
        lines: LaTeX of each line, broken to fit.
        landscape: Whether the lines are as long as a page turned on its side.
        is_answer: Whether they tell what an exercise asks for, which then leaves them out.
    """

    lines: tuple[str, ...]
    landscape: bool = False
    is_answer: bool = False


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry of a quantity, to be copied.

    Attributes:
        name: Its symbol as LaTeX.
        latex: Its expression as LaTeX on one line.
        python: The same as a Python expression in the names of the robot file.
    """

    name: str
    latex: str
    python: str


@dataclass(frozen=True, slots=True)
class Formula:
    """The result for one quantity: what an exercise leaves blank.

    Attributes:
        rows: The matrix, or its entries one by one.
        named: Definitions of intermediate terms that the entries use.
        omitted: Entries that are too long, with their numbers of terms.
        note: What else a reader must know: which entries are left out because they are zero, that it is symmetric.
        function: The generated function that computes it, empty if none does.
        entries: Every printed entry for copying.
        task: What an exercise asks in its place; empty where it asks nothing.
        blanks: Left sides of the answers, empty for an answer without one; none for what is too long by hand.
    """

    rows: tuple[Rows, ...]
    named: tuple[str, ...] = ()
    omitted: tuple[str, ...] = ()
    note: str = ""
    function: str = ""
    entries: Sequence[Entry] = ()
    task: str = ""
    blanks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Gap:
    """Room for an answer.

    Attributes:
        name: LaTeX of the left side; empty for none.
        lines: Lines of room.
        is_half: Whether two of them share a line.
    """

    name: str
    lines: float
    is_half: bool = False


@dataclass(frozen=True, slots=True)
class Blank:
    """A question of an exercise with room for its answers.

    Attributes:
        number: Its number with a full stop.
        task: The sentence that asks.
        points: What it is worth, in brackets.
        gaps: Room for each answer.
    """

    number: str
    task: str
    points: str
    gaps: tuple[Gap, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """A table.

    Attributes:
        header: Texts of the head, mathematics between dollars.
        rows: Texts of the cells.
        long: Whether it may need more than a page.
        is_answer: Whether it tells what an exercise asks for, which then leaves it out.
    """

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    long: bool = False
    is_answer: bool = False


@dataclass(frozen=True, slots=True)
class Figure:
    """A drawing with its caption.

    Attributes:
        drawing: Lines, areas and labels in the plane.
        caption: Text below.
        is_answer: Whether it tells what an exercise asks for, which then leaves it out.
    """

    drawing: Drawing
    caption: str
    is_answer: bool = False


@dataclass(frozen=True, slots=True)
class Steps:
    """Intermediate steps: printed on paper, folded on the web page, left out of an exercise.

    Attributes:
        title: What is derived.
        blocks: The steps.
    """

    title: str
    blocks: tuple[Block, ...]


Block: TypeAlias = Paragraph | Rows | Formula | Blank | Table | Figure | Steps


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the handout.

    Attributes:
        part: Its name in ``handout: parts:``, also its anchor.
        title: Its heading.
        blocks: Its content.
    """

    part: str
    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True, slots=True)
class Document:
    """A handout.

    Attributes:
        title: The robot's title: the user's text, to be escaped whole, dollars and backticks included.
        subtitle: What kind of sheet it is, such as an exercise.
        name: The robot's name.
        language: Code of the language, such as ``it``.
        digest: SHA-256 of the robot file.
        version: Version of the tool.
        footer: One line for every page.
        sections: The parts, in their order.
        form: Words of a line to be filled in, such as that for a name; empty for none.
    """

    title: str
    subtitle: str
    name: str
    language: str
    digest: str
    version: str
    footer: str
    sections: tuple[Section, ...]
    form: tuple[str, ...] = ()

    def section(self, part: str) -> Section:
        """The section of that name.

        Args:
            part: A name in ``handout: parts:``.

        Returns:
            The section.

        Raises:
            KeyError: The document has no such part.
        """
        for section in self.sections:
            if section.part == part:
                return section
        raise KeyError(part)


def blocks_of(section: Section) -> Iterator[Block]:
    """All blocks of a section, those inside of steps included.

    Args:
        section: The section.

    Yields:
        Each block, before the blocks inside of it.
    """
    pending = list(reversed(section.blocks))
    while pending:
        block = pending.pop()
        yield block
        if isinstance(block, Steps):
            pending += reversed(block.blocks)


def gap_rows(gaps: Sequence[Gap]) -> list[tuple[Gap, ...]]:
    """Gaps line by line.

    Args:
        gaps: In their order.

    Returns:
        One gap for each line, two where both are half a line wide.
    """
    rows: list[tuple[Gap, ...]] = []
    for gap in gaps:
        if gap.is_half and rows and len(rows[-1]) == 1 and rows[-1][0].is_half:
            rows[-1] = (*rows[-1], gap)
        else:
            rows.append((gap,))
    return rows


def rows_of(block: Block) -> tuple[Rows, ...]:
    """The displayed mathematics of a block.

    Args:
        block: Any block.

    Returns:
        Its rows; none for a block without any, or whose rows stand in the blocks inside of it.
    """
    if isinstance(block, Formula):
        return block.rows
    return (block,) if isinstance(block, Rows) else ()


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
    """The parts of a text.

    Args:
        text: With ``$mathematics$`` and code between backticks.

    Yields:
        Its spans, in their order.
    """
    end = 0
    for match in _SPAN.finditer(text):
        if match.start() > end:
            yield Span(Kind.WORDS, text[end : match.start()])
        mathematics, code = match.groups()
        yield Span(Kind.CODE, code) if mathematics is None else Span(Kind.MATHEMATICS, mathematics)
        end = match.end()
    if end < len(text):
        yield Span(Kind.WORDS, text[end:])
