"""A sheet within a number of pages: what is least useful is left out first, and the sheet says so.

Pages are estimated from what is printed, so that the same robot gives the same sheet with and without LaTeX; the
estimate is on the high side.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import ceil

from derive.handouts.sheet import document as sheet
from derive.handouts.sheet.language import Text

PAGE = 780.0  # what a page holds by the heights below, which are on the high side [pt]; its text is 731 pt high
# Parts of the handout, the least useful first: what follows from other parts by rule comes before what does not.
USEFULNESS = (
    *("conversion", "skew", "christoffel", "link-jacobians", "newton-euler", "coriolis", "energies", "orientation"),
    *("singularities", "motion", "example", "parameters", "convention", "gravity", "inverse", "transforms", "inertia"),
    *("jacobian", "closure", "kinematics", "figure", "table"),
)
_LINE, _ROW, _FRACTION, _DISPLAY, _HEADING, _LANDSCAPE = 12.0, 15.0, 14.0, 22.0, 36.0, 440.0
"""Heights of a line of text, of a row of a display, more for a fraction, around a display, of a heading, of a page
turned on its side [pt]."""

_LETTERS = 95  # letters on a line of text
_LONG = 60.0  # height from which a formula may be left out on its own [pt]
_MARKUP = re.compile(r"\\[A-Za-z]+|[{}$`_^]")


def pages(document: sheet.Document) -> int:
    """About how many pages a document has on paper."""
    count, filled = 1, 3 * _HEADING
    for section in document.sections:
        above = _HEADING  # a heading goes to the next page with what follows it
        for block in section.blocks:
            for piece in _pieces(block):
                if filled + above + piece > PAGE:
                    count, filled = count + 1, 0.0
                filled, above = filled + above + piece, 0.0
                while filled > PAGE:  # a piece that is higher than a page
                    count, filled = count + 1, filled - PAGE
    return count


def height(block: sheet.Block) -> float:
    """About how much of a page a block takes."""
    return sum(_pieces(block))


def _pieces(block: sheet.Block) -> Iterator[float]:
    """Heights of what no page divides, one below the other [pt]."""
    match block:
        case sheet.Paragraph(text):
            yield _words(text)
        case sheet.Rows(lines, landscape):
            heights = (_LINE * x.count("\\\\") * ("bmatrix" in x) + _FRACTION * ("\\frac" in x) for x in lines)
            drawn = [_DISPLAY, *(_ROW + height for height in heights)]  # a page may end between any two rows of it
            yield from [PAGE] * ceil(sum(drawn) / _LANDSCAPE) if landscape else drawn
        case sheet.SheetFormula():
            for rows in block.rows:
                yield from _pieces(rows)
            # Above named terms and above what is omitted stand two lines of words.
            for entries in (block.named, block.omitted):
                yield from (*_pieces(sheet.Rows(entries)), 2 * _ROW) if entries else ()
            yield _words(block.note)
        case sheet.Blank(_, task, _, gaps):
            yield _words(task) + _LINE * sum(gap.lines for gap in gaps)
        case sheet.Table(_, rows, long):
            count = len(rows) + 3  # with the head and its rules
            yield from [_LINE] * count if long else [_LINE * count]
        case sheet.Figure(drawing, caption):
            yield drawing.height + _words(caption) + _LINE
        case sheet.Steps(_, blocks):
            yield 1.5 * _LINE
            for inner in blocks:
                yield from _pieces(inner)


def _words(text: str) -> float:
    return _LINE * ceil(len(_MARKUP.sub("", text)) / _LETTERS) + 4.0 if text else 0.0


Test = Callable[[sheet.Block], bool]  # whether a block may be left out


def _spared(blocks: tuple[sheet.Block, ...], test: Test, limit: int, text: Text) -> tuple[sheet.Block, ...]:
    """What may be left out replaced by a sentence, where the first of it stood."""
    kept: list[sheet.Block] = []
    for block in blocks:
        shown: sheet.Block = block
        if test(block):
            shown = sheet.Paragraph(_sentence(block, limit, text), is_answer=True)
        elif isinstance(block, sheet.Steps):
            shown = replace(block, blocks=_spared(block.blocks, test, limit, text))
        elif isinstance(block, sheet.SheetFormula) and any(map(test, block.rows)):
            rows = tuple(rows for rows in block.rows if not test(rows))
            sentence = text("The longest entries are left out to keep within the page limit (%(pages)s).", pages=limit)
            shown = replace(block, rows=rows, note=f"{block.note} {sentence}".strip(), blanks=())
        kept += [shown] if not kept or shown != kept[-1] else []
    return tuple(kept)


def _sentence(block: sheet.Block, limit: int, _: Text) -> str:
    if isinstance(block, sheet.Steps):
        return _("%(title)s: left out to keep within the page limit (%(pages)s).", title=block.title, pages=limit)
    if isinstance(block, sheet.SheetFormula) and block.function:
        return _(
            "Left out to keep within the page limit (%(pages)s); `%(function)s` in `model_numpy.py` computes it.",
            pages=limit,
            function=block.function,
        )
    return _("Left out to keep within the page limit (%(pages)s).", pages=limit)


def within(document: sheet.Document, limit: int, text: Text, spare: int = 0) -> sheet.Document:
    """The document, shortened until it has no more pages than that: see `_shortened` for what goes first."""
    most = limit - spare
    if not limit or pages(document) <= most:
        return document
    # Greedy: after each cut the pages are counted anew, and the first document that fits is taken.
    sections = {section.anchor: section for section in document.sections}
    touched: list[str] = []
    for anchor, shorter in _shortened(sections, limit, text):
        if shorter == sections.get(anchor):
            continue
        touched += [anchor] if anchor not in touched else []
        if shorter is None:
            del sections[anchor]
        else:
            sections[anchor] = shorter
        found = _said(document, sections, touched, limit, text)
        if pages(found) <= most:
            return found
    return _said(document, sections, touched, limit, text)


def _shortened(parts: dict[str, sheet.Section], limit: int, text: Text) -> Iterator[tuple[str, sheet.Section | None]]:
    """One part after the other, shorter each time it comes; None in place of a part that is left out as a whole."""
    tests: tuple[Test, ...] = (
        lambda block: isinstance(block, sheet.Rows) and block.landscape,
        # Of steps the tallest display counts, for they need not go as a whole.
        lambda block: (
            isinstance(block, sheet.SheetFormula | sheet.Steps)
            and max(map(height, block.blocks if isinstance(block, sheet.Steps) else block.rows), default=0.0) > PAGE
        ),
        lambda block: isinstance(block, sheet.Steps),
        lambda block: isinstance(block, sheet.SheetFormula) and height(block) > _LONG,
    )
    for test in tests:  # from what is missed least to what is missed most, through all parts each time
        for anchor in _least_useful(parts, USEFULNESS):
            yield anchor, replace(parts[anchor], blocks=_spared(parts[anchor].blocks, test, limit, text))
    for anchor in _least_useful(parts, USEFULNESS[:-1]):
        yield anchor, None


def _least_useful(sections: dict[str, sheet.Section], parts: Sequence[str]) -> list[str]:
    return [anchor for part in parts for anchor, section in sections.items() if section.part == part]


def _said(
    document: sheet.Document, sections: dict[str, sheet.Section], touched: list[str], limit: int, text: Text
) -> sheet.Document:
    """The shorter document with a sentence at its head that names what it lacks."""
    titles = ", ".join(section.title for section in document.sections if section.anchor in touched)
    sentence = text("Omitted or shortened because of the %(pages)s-page limit: %(titles)s.", pages=limit, titles=titles)
    kept = [sections[section.anchor] for section in document.sections if section.anchor in sections]
    first = replace(kept[0], blocks=(sheet.Paragraph(sentence, is_answer=True), *kept[0].blocks))
    return replace(document, sections=(first, *kept[1:]))
