"""Blocks of a document as HTML.

Names of entries without mathematics, for a list to choose from.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import singledispatchmethod
from html import escape

from derive.handout.document import Blank, Block, Figure, Formula, Kind, Paragraph, Rows, Steps, Table, spans
from derive.handout.figure.svg_writer import svg_drawing
from derive.handout.language import Text
from derive.handout.page.formulas import Collector
from derive.targets import templating
from derive.targets.escape import html_text

_NAMES = (
    "alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi pi rho sigma tau "
    "upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega"
)
_GREEK = dict(
    zip(
        _NAMES.split(" "),
        "αβγδϵεζηθϑικλμνξπρστυϕφχψωΓΔΘΛΞΠΣΥΦΨΩ",
        strict=True,
    )
)
_ACCENTS = {"dot": "\u0307", "ddot": "\u0308", "hat": "\u0302", "bar": "\u0304", "tilde": "\u0303"}
_SUBSCRIPTS = str.maketrans("0123456789+-=()aehijklmnoprstuvx", "₀₁₂₃₄₅₆₇₈₉₊₋₌₍₎ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ")
_SUPERSCRIPTS = str.maketrans("0123456789+-=()iTn", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁼⁽⁾ⁱᵀⁿ")
_ACCENTED = re.compile(r"\\(dot|ddot|hat|bar|tilde)\s*(?:\{([^{}]*)\}|(\\[A-Za-z]+|\S))")
_INDEX = re.compile(r"([_^])(?:\{([^{}]*)\}|(\\[A-Za-z]+|\S))")
_COMMAND = re.compile(r"\\([A-Za-z]+)\s?")
_SPACES = re.compile(r"\\[,;:! ]|[{}]|~")


def plain(latex: str) -> str:
    """LaTeX of a symbol in letters of Unicode: ``b_{12}`` as b₁₂; what has no letter stays as it is."""
    text = _ACCENTED.sub(_accented, latex)
    text = _INDEX.sub(_index, text)
    text = _COMMAND.sub(_command, text)
    return _SPACES.sub("", text).strip()


def _command(found: re.Match[str]) -> str:
    return _GREEK.get(found[1], "")


def _accented(found: re.Match[str]) -> str:
    base = _COMMAND.sub(_command, found[2] or found[3])
    return base[:1] + _ACCENTS[found[1]] + base[1:]


def _index(found: re.Match[str]) -> str:
    table = _SUBSCRIPTS if found[1] == "_" else _SUPERSCRIPTS
    text = _SPACES.sub("", _COMMAND.sub(_command, found[2] or found[3]))
    small = text.translate(table)
    changed = all(ord(letter) in table for letter in text)
    return small if changed else f"{found[1]}{text}"


_MOST_SHARED = 6
"""Blanks of an exercise that share the room of one answer."""

_NAMESPACE = ' xmlns="http://www.w3.org/2000/svg"'
"""What SVG needs in a file of its own and not in a page."""


class BlockWriter:
    """Writes blocks in one language.

    Args:
        text: Translates the words of the page itself.
        formulas: Takes every formula and gives it a place.
    """

    def __init__(self, text: Text, formulas: Collector) -> None:
        self._text = text
        self._formulas = formulas

    def blocks(self, blocks: Iterable[Block]) -> str:
        """Several blocks."""
        return "\n".join(self.block(block) for block in blocks)

    def words(self, text: str) -> str:
        """A text with its mathematics and its code."""
        return "".join(self._span(kind, part) for kind, part in spans(text))

    def _span(self, kind: Kind, part: str) -> str:
        if kind is Kind.MATHEMATICS:
            return self._formulas.place(part)
        if kind is Kind.CODE:
            return f"<code>{html_text(part)}</code>"
        return html_text(part)

    @singledispatchmethod
    def block(self, block: Block) -> str:
        """One block."""
        raise TypeError(block)

    @block.register
    def _paragraph(self, block: Paragraph) -> str:
        return f"<p>{self.words(block.text)}</p>"

    @block.register
    def _rows(self, block: Rows) -> str:
        return self._displays(block.lines)

    def _displays(self, lines: Iterable[str]) -> str:
        """Displayed lines in a box that scrolls, by keys too."""
        _ = self._text
        body = "\n".join(self._formulas.place(line, display=True) for line in lines)
        return f'<div class=display tabindex=0 role=group aria-label="{html_text(_("Formula"))}">\n{body}\n</div>'

    @block.register
    def _formula(self, block: Formula) -> str:
        _ = self._text
        parts: list[str] = []
        if block.named:
            parts += [f"<p>{self.words(_('With the abbreviations'))}</p>", self._displays(block.named)]
            parts.append(f"<p>{self.words(_('the entries are as follows.'))}</p>")
        parts += [self._rows(rows) for rows in block.rows if rows.lines]
        parts += self._omitted(block)
        if block.note:
            parts.append(f"<p class=note>{self.words(block.note)}</p>")
        if block.entries:
            parts.append(self._tools(block))
        return "<div class=formula>\n{}\n</div>".format("\n".join(parts))

    def _omitted(self, block: Formula) -> list[str]:
        if not block.omitted:
            return []
        _ = self._text
        message = _(
            "Too long to print; multiplied out the numbers of terms are as follows, and `model_numpy.py` computes them "
            "in `%(function)s`:",
            function=block.function,
        )
        return [f"<p>{self.words(message)}</p>", self._displays(block.omitted)]

    def _tools(self, block: Formula) -> str:
        entries = [
            {"name": html_text(plain(entry.name)), "latex": escape(entry.latex), "python": escape(entry.python)}
            for entry in block.entries
        ]
        return templating.render(
            "page/tools.html.jinja", words=self._tool_words(), entries=entries, function=html_text(block.function)
        ).rstrip()

    def _tool_words(self) -> dict[str, str]:
        _ = self._text
        words = {"entry": _("Entry"), "latex": _("Copy LaTeX"), "python": _("Copy Python")}
        return {name: html_text(word) for name, word in words.items()}

    @block.register
    def _blank(self, block: Blank) -> str:
        lines = max(1, round(block.lines / max(1, min(len(block.names), _MOST_SHARED))))
        answers = (
            f"<div class=answer>{self._formulas.place(name + ' =')}"
            f'<div class=ruled style="--lines:{lines}" role=presentation></div></div>'
            for name in block.names
        )
        return "\n".join(answers)

    @block.register
    def _table(self, block: Table) -> str:
        _ = self._text
        head = "".join(self._cell("th scope=col", "th", cell) for cell in block.header)
        rows = "\n".join(f"<tr>{self._row(row)}</tr>" for row in block.rows)
        table = f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody>\n</table>"
        return f'<div class=scroll tabindex=0 role=group aria-label="{html_text(_("Table"))}">\n{table}\n</div>'

    def _row(self, row: tuple[str, ...]) -> str:
        first = (self._cell("th scope=row", "th", cell) for cell in row[:1])
        return "".join((*first, *(self._cell("td", "td", cell) for cell in row[1:])))

    def _cell(self, start: str, end: str, text: str) -> str:
        inner = self.words(text)
        return f"<{start}>{inner}</{end}>" if inner.strip() else "<td></td>"

    @block.register
    def _figure(self, block: Figure) -> str:
        picture = svg_drawing(block.drawing).replace(_NAMESPACE, "", 1)
        return f"<figure>\n{picture}\n<figcaption>{self.words(block.caption)}</figcaption>\n</figure>"

    @block.register
    def _steps(self, block: Steps) -> str:
        return f"<details>\n<summary>{self.words(block.title)}</summary>\n{self.blocks(block.blocks)}\n</details>"
