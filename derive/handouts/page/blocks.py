"""Blocks of a document as HTML; every formula as its LaTeX, which a script of the page sets with KaTeX."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from derive.handouts.document import Blank, Block, Figure, Formula, Kind, Paragraph, Rows, Steps, Table, spans
from derive.handouts.figure.drawing import label_runs
from derive.handouts.figure.writers import svg_drawing
from derive.handouts.language import Text
from derive.targets import templating
from derive.targets.escape import html_text

_SUBSCRIPTS = str.maketrans("0123456789+-\N{MINUS SIGN}=()aehijklmnoprstuvx", "₀₁₂₃₄₅₆₇₈₉₊₋₋₌₍₎ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ")
_SUPERSCRIPTS = str.maketrans("0123456789+-\N{MINUS SIGN}=()iTn", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁻⁼⁽⁾ⁱᵀⁿ")

_MOST_SHARED = 6
"""Blanks of an exercise that share the room of one answer."""

_NAMESPACE = ' xmlns="http://www.w3.org/2000/svg"'
"""What SVG needs in a file of its own and not in a page."""


def formula(latex: str, *, display: bool = False) -> str:
    """A formula: its LaTeX as text, which stays readable where no script runs.

    Args:
        latex: In mathematics mode.
        display: Whether it stands on a line of its own.

    Returns:
        An element of the class ``math``.
    """
    tag = "div" if display else "span"
    return f"<{tag} class=math>{html_text(latex)}</{tag}>"


def unicode_name(latex: str) -> str:
    """A symbol in letters of Unicode, such as b₁₂; an index that has no letters stands behind ``_`` or ``^``.

    Args:
        latex: LaTeX of the symbol.
    """
    parts = []
    for run in label_runs(latex):
        text = run.text.replace("\N{THIN SPACE}", "").replace(" ", "")
        table = {-1: _SUBSCRIPTS, 0: {}, 1: _SUPERSCRIPTS}[run.shift]
        if all(ord(letter) in table for letter in text):
            text = text.translate(table)
        elif run.shift:
            text = f"{'_' if run.shift < 0 else '^'}{text}"
        parts.append(text)
    return "".join(parts)


class BlockWriter:
    """Writes blocks in one language.

    Args:
        text: Translates the words of the page itself.
    """

    def __init__(self, text: Text) -> None:
        self._text = text

    def words(self, text: str) -> str:
        """A text with its mathematics and its code.

        Args:
            text: Plain words, mathematics between dollar signs, code between backticks.
        """
        parts = []
        for kind, part in spans(text):
            if kind is Kind.MATHEMATICS:
                parts.append(formula(part))
            else:
                parts.append(f"<code>{html_text(part)}</code>" if kind is Kind.CODE else html_text(part))
        return "".join(parts)

    def blocks(self, blocks: Iterable[Block]) -> str:
        """Several blocks.

        Args:
            blocks: In their order.
        """
        return "\n".join(map(self._block, blocks))

    def _block(self, block: Block) -> str:
        match block:
            case Paragraph(text):
                return f"<p>{self.words(text)}</p>"
            case Rows(lines):
                return self._displays(lines)
            case Formula():
                return self._formula(block)
            case Blank(names, lines):
                each = max(1, round(lines / max(1, min(len(names), _MOST_SHARED))))
                ruled = f'<div class=ruled style="--lines:{each}" role=presentation></div>'
                return "\n".join(f"<div class=answer>{formula(name + ' =')}{ruled}</div>" for name in names)
            case Table():
                return self._table(block)
            case Figure(drawing, caption):
                picture = svg_drawing(drawing).replace(_NAMESPACE, "", 1)
                return f"<figure>\n{picture}\n<figcaption>{self.words(caption)}</figcaption>\n</figure>"
            case Steps(title, blocks):
                return f"<details>\n<summary>{self.words(title)}</summary>\n{self.blocks(blocks)}\n</details>"

    def _displays(self, lines: Iterable[str]) -> str:
        """Displayed lines in a box that scrolls, by keys too."""
        _ = self._text
        body = "\n".join(formula(line, display=True) for line in lines)
        return f'<div class=display tabindex=0 role=group aria-label="{html_text(_("Formula"))}">\n{body}\n</div>'

    def _formula(self, block: Formula) -> str:
        _ = self._text
        parts: list[str] = []
        if block.named:
            parts += [f"<p>{self.words(_('With the abbreviations'))}</p>", self._displays(block.named)]
            parts.append(f"<p>{self.words(_('the entries are as follows.'))}</p>")
        parts += [self._displays(rows.lines) for rows in block.rows if rows.lines]
        if block.omitted:
            message = _(
                "Too long to print; multiplied out the numbers of terms are as follows, and `model_numpy.py` computes "
                "them in `%(function)s`:",
                function=block.function,
            )
            parts += [f"<p>{self.words(message)}</p>", self._displays(block.omitted)]
        if block.note:
            parts.append(f"<p class=note>{self.words(block.note)}</p>")
        if block.entries:
            words = {"entry": _("Entry"), "latex": _("Copy LaTeX"), "python": _("Copy Python")}
            entries = [
                {"name": html_text(unicode_name(e.name)), "latex": escape(e.latex), "python": escape(e.python)}
                for e in block.entries
            ]
            words = {name: html_text(word) for name, word in words.items()}
            function = html_text(block.function)
            tools = templating.render("page/tools.html.jinja", words=words, entries=entries, function=function)
            parts.append(tools.rstrip())
        return "<div class=formula>\n{}\n</div>".format("\n".join(parts))

    def _table(self, block: Table) -> str:
        _ = self._text
        head = "".join(self._cell("th scope=col", cell) for cell in block.header)
        rows = "\n".join(
            f"<tr>{''.join(self._cell('td' if k else 'th scope=row', cell) for k, cell in enumerate(row))}</tr>"
            for row in block.rows
        )
        table = f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody>\n</table>"
        return f'<div class=scroll tabindex=0 role=group aria-label="{html_text(_("Table"))}">\n{table}\n</div>'

    def _cell(self, tag: str, text: str) -> str:
        inner = self.words(text)
        return f"<{tag}>{inner}</{tag[:2]}>" if inner.strip() else "<td></td>"
