"""A document as LaTeX that stands alone: pdflatex, amsmath, longtable, booktabs and nothing beyond."""

from __future__ import annotations

from collections.abc import Iterable
from functools import singledispatchmethod

from derive.handout.document import (
    Blank,
    Block,
    Document,
    Figure,
    Formula,
    Kind,
    Paragraph,
    Rows,
    Section,
    Steps,
    Table,
    blocks_of,
    spans,
)
from derive.handout.figure.latex_writer import PREAMBLE, latex_drawing
from derive.handout.language import Text
from derive.handout.layout.lines import displays
from derive.targets import templating
from derive.targets.escape import latex_text

LONGEST_WORD = 16
"""Letters of a title's word after which a line may be broken; longer ones are rare, and no line holds forty."""

_DISPLAY = "\\begin{align*}"
_OPEN = "%"
"""Ends a text whose paragraph goes on: a display right behind it stands closer than one that starts a paragraph."""

_SHARED_ROOM = 6
"""Blanks of an exercise that share the room of one answer."""


def latex(document: Document, text: Text) -> str:
    """The document as ``sheet.tex``.

    Args:
        document: The handout.
        text: The language of the writer's own words.
    """
    writer = _Writer(text)
    blocks = [block for section in document.sections for block in blocks_of(section)]
    return templating.render(
        "handout/document.tex.jinja",
        name=document.name,
        version=document.version,
        digest=document.digest,
        title=breakable_text(document.title),
        subtitle=words(document.subtitle),
        footer=words(document.footer),
        landscape=any(rows.landscape for rows in _all_rows(blocks)),
        figures=any(isinstance(block, Figure) for block in blocks),
        figure_preamble=PREAMBLE.rstrip(),
        sections=[
            {"title": words(section.title), "blocks": writer.blocks(section.blocks)} for section in document.sections
        ],
    )


def fragment(section: Section, text: Text) -> str:
    r"""One section for ``\input`` into other notes; formulas need amsmath alone."""
    return "\n".join(_Writer(text).blocks(section.blocks)) + "\n"


def words(text: str) -> str:
    """A text with its marks."""
    return "".join(_span(kind, part) for kind, part in spans(text))


def _span(kind: Kind, part: str) -> str:
    if kind is Kind.MATHEMATICS:
        return f"${part}$"
    if kind is Kind.CODE:
        return "\\texttt{" + latex_text(part).replace("\\_", "\\_\\allowbreak{}") + "}"
    space_before, space_after = part[:1].isspace(), part[-1:].isspace()
    body = latex_text(part)
    if not body:
        return " "
    return f"{' ' if space_before else ''}{body}{' ' if space_after else ''}"


def breakable_text(text: str) -> str:
    """Escaped text in which even a word without end can be broken."""
    pieces = ([word[k : k + LONGEST_WORD] for k in range(0, len(word), LONGEST_WORD)] for word in text.split())
    return " ".join("\\allowbreak{}".join(latex_text(part) for part in parts) for parts in pieces)


def _all_rows(blocks: Iterable[Block]) -> Iterable[Rows]:
    for block in blocks:
        if isinstance(block, Rows):
            yield block
        elif isinstance(block, Formula):
            yield from block.rows


class _Writer:
    """Writes blocks in one language."""

    def __init__(self, text: Text) -> None:
        self._text = text

    def blocks(self, blocks: Iterable[Block]) -> list[str]:
        """Blocks one after the other; a display joins the paragraph before it."""
        written: list[str] = []
        for block in blocks:
            text = self.block(block)
            if text.startswith(_DISPLAY) and not (written and written[-1].endswith(_OPEN)):
                text = f"\\begingroup\\abovedisplayskip=0pt\n{text}\n\\endgroup"
            elif written and written[-1].endswith(_OPEN) and not text.startswith(_DISPLAY):
                text = f"\\par\n{text}"
            written.append(text)
        if written and written[-1].endswith(_OPEN):
            written.append("\\par")
        return written

    @singledispatchmethod
    def block(self, block: Block) -> str:
        raise TypeError(block)

    @block.register
    def _paragraph(self, block: Paragraph) -> str:
        return words(block.text) + _OPEN

    @block.register
    def _rows(self, block: Rows) -> str:
        body = "\n".join(displays(block.lines))
        return f"\\begin{{landscape}}\n{body}\n\\end{{landscape}}" if block.landscape else body

    @block.register
    def _formula(self, block: Formula) -> str:
        parts = [*self._named(block), *(self._rows(rows) for rows in block.rows if rows.lines), *self._omitted(block)]
        if block.note:
            parts.append(words(block.note) + _OPEN)
        return "\n".join(parts)

    def _named(self, block: Formula) -> list[str]:
        if not block.named:
            return []
        _ = self._text
        return [words(_("With the abbreviations")), *displays(block.named), words(_("the entries are as follows."))]

    def _omitted(self, block: Formula) -> list[str]:
        if not block.omitted:
            return []
        _ = self._text
        message = _(
            "Too long to print; multiplied out the numbers of terms are as follows, and `model_numpy.py` computes them "
            "in `%(function)s`:",
            function=block.function,
        )
        return [words(message), *displays(block.omitted)]

    @block.register
    def _blank(self, block: Blank) -> str:
        height = max(1.2, 1.4 * block.lines / max(1, min(len(block.names), _SHARED_ROOM)))
        room = f"\\rule[-{height:.1f}\\baselineskip]{{0pt}}{{{height:.1f}\\baselineskip}}"
        return "\n".join(displays([f"{name} = {room}" for name in block.names]))

    @block.register
    def _table(self, block: Table) -> str:
        columns = "@{}" + "l" * len(block.header) + "@{}"
        head = " & ".join(words(cell) for cell in block.header) + " \\\\"
        rows = "\n".join(" & ".join(words(cell) for cell in row) + " \\\\" for row in block.rows)
        top = f"\\toprule\n{head}\n\\midrule"
        if block.long:
            body = f"{top}\n\\endhead\n\\bottomrule\n\\endfoot\n{rows}"
            return f"\\begin{{longtable}}{{{columns}}}\n{body}\n\\end{{longtable}}"
        return f"\\begin{{tabular}}{{{columns}}}\n{top}\n{rows}\n\\bottomrule\n\\end{{tabular}}\\par"

    @block.register
    def _figure(self, block: Figure) -> str:
        caption = f"{{\\small {words(block.caption)}\\par}}"
        body = f"\\centering\n{latex_drawing(block.drawing)}\\par\n\\smallskip\n{caption}"
        return f"\\begin{{minipage}}{{\\linewidth}}\n{body}\n\\end{{minipage}}\\par"

    @block.register
    def _steps(self, block: Steps) -> str:
        title = f"\\medskip\\textit{{{words(block.title)}}}{_OPEN}"
        return "\n".join([title, *self.blocks((Paragraph(""), *block.blocks))[1:]])
