"""From a handout to an exercise and its solutions.

A formula that answers a task becomes a question with room for the answer; what belongs to an answer is left out, and so
are derivations and whatever is too long to be worked out by hand. A matrix is asked for as a whole, so that no entry
tells by its absence that it is zero. Room and points follow the symbols and numbers of the answer in print.
"""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from derive.handouts.sheet.document import Blank, Block, Document, Gap, Paragraph, Section, SheetFormula, Steps
from derive.handouts.sheet.language import Text

_LEAST_LINES = 2.0  # lines of room for one answer
_LEAST_OPEN = 4.0  # lines of room for an answer without a left side, which may have several equations or none
_MOST_LINES = 24.0  # lines of room for one formula: less than half a page, however long it is
_HANDWRITING = 1.5  # lines by hand for one in print
_MATRIX = re.compile(r"\\begin\{bmatrix\}(.*?)\\end\{bmatrix\}", re.DOTALL)
_SYMBOL = re.compile(r"[A-Za-z}]_\{|\d(?:\.|\{,\})\d")  # a symbol with an index, or a number with decimals
_SYMBOLS_OF_A_LINE = 6  # by hand
_SYMBOLS_OF_A_POINT = 6
_MOST_POINTS = 10

_GIVEN = frozenset({"figure", "table", "convention", "parameters"})  # parts with data, which an exercise keeps


@dataclass(frozen=True, slots=True)
class _Question:
    """Neighbouring formulas that answer the same task."""

    number: int  # from 1, through the whole sheet
    formulas: tuple[SheetFormula, ...]  # the answers

    @property
    def points(self) -> int:
        return max(1, min(_MOST_POINTS, math.ceil(sum(map(_symbols, self.formulas)) / _SYMBOLS_OF_A_POINT)))

    def blank(self, text: Text) -> Blank:
        gaps: list[Gap] = []
        for formula in self.formulas:
            lines, count = _lines(formula), len(formula.blanks)
            # Answers that share lines in print share them in the exercise, two on each.
            if lines and len(lines) < count:
                each = max(_LEAST_LINES, _HANDWRITING * max(map(_rows, lines)))
                gaps += [Gap(name, each, is_half=True) for name in formula.blanks]
                continue
            room = max(_HANDWRITING * sum(map(_rows, lines)), _symbols(formula) / _SYMBOLS_OF_A_LINE)
            each = max(_LEAST_LINES, min(_MOST_LINES / count, room / count))
            gaps += [Gap(name, each if name else max(_LEAST_OPEN, each)) for name in formula.blanks]
        return Blank(f"{self.number}.", self.formulas[0].task, f"({_points(self.points, text)})", tuple(gaps))


def exercise(document: Document, text: Text) -> Document:
    """The handout with questions and room for the answers in place of the results."""
    sections, total = [], 0
    for section, items in _asked(document):
        if (questions := [item for item in items if isinstance(item, _Question)]) or section.part in _GIVEN:
            total += sum(question.points for question in questions)
            blocks = (item.blank(text) if isinstance(item, _Question) else item for item in items)
            sections.append(replace(section, blocks=tuple(blocks)))
    form = (text("Name:"), text("Date:"), text("Points (of %(total)s):", total=total))
    return replace(document, subtitle=text("Exercise"), form=form if total else (), sections=tuple(sections))


def solutions(document: Document, text: Text) -> Document:
    """The same handout as the sheet of solutions: the answers have the numbers and points of the questions."""
    pending = [item for _, items in _asked(document) for item in items if isinstance(item, _Question)][::-1]
    sections = []
    for section in document.sections:
        blocks: list[Block] = []
        for block in section.blocks:
            if pending and block is pending[-1].formulas[0]:
                question = pending.pop()
                points = _points(question.points, text)
                lead_in = [blocks.pop()] if blocks and _leads_in(blocks[-1]) else []
                head = text("Question %(number)s (%(points)s)", number=question.number, points=points)
                blocks += [Paragraph(head), *lead_in]
            blocks.append(block)
        sections.append(replace(section, blocks=tuple(blocks)))
    return replace(document, subtitle=text("Solutions"), sections=tuple(sections))


def _asked(document: Document) -> Iterator[tuple[Section, Sequence[Block | _Question]]]:
    """What an exercise keeps of each section, questions in place of the formulas that answer them."""
    number = 0
    for section in document.sections:
        items: list[Block | _Question] = []
        for block in section.blocks:
            if isinstance(block, Steps) or getattr(block, "is_answer", False):
                continue
            if not isinstance(block, SheetFormula):
                items.append(block)
                continue
            if items and _leads_in(items[-1]):
                items.pop()
            if not block.task or not block.blanks:
                continue
            before = items[-1] if items else None
            if isinstance(before, _Question) and before.formulas[0].task == block.task:
                items[-1] = replace(before, formulas=(*before.formulas, block))
            else:
                number += 1
                items.append(_Question(number, (block,)))
        yield section, items


def _leads_in(item: Block | _Question) -> bool:
    """Whether a paragraph is the beginning of a sentence that ends with a formula."""
    return isinstance(item, Paragraph) and item.text.endswith(":")


def _rows(line: str) -> int:
    """Lines of a line in print: as many as its tallest matrix has rows."""
    return max((matrix.count("\\\\") + 1 for matrix in _MATRIX.findall(line)), default=1)


def _symbols(formula: SheetFormula) -> int:
    """Symbols with an index and decimal numbers of a formula in print."""
    return sum(len(_SYMBOL.findall(line)) for line in _lines(formula))


def _lines(formula: SheetFormula) -> list[str]:
    return [*formula.named, *(line for part in formula.rows for line in part.lines)]


def _points(points: int, text: Text) -> str:
    return text("1 point") if points == 1 else text("%(points)s points", points=points)
