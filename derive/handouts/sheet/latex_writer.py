"""A document as LaTeX that stands alone: pdflatex, amsmath, longtable, booktabs and nothing beyond."""

from collections.abc import Iterable
from functools import cache
from typing import Any

from jinja2.environment import Template

from derive.handouts.figure.writers import latex_drawing
from derive.handouts.layout.lines import displays
from derive.handouts.sheet import document as sheet
from derive.handouts.sheet.language import Text
from derive.targets.escape import latex_text
from derive.targets.templating import environment
from derive.version import __version__

_LONGEST_WORD = 16  # letters of a title's word after which a line may be broken: no line holds forty
_DISPLAY, _DISPLAY_END = "\\begin{align*}", "\\end{align*}"
_OPEN = "%"  # ends a text whose paragraph goes on: a display right behind it stands closer
_TABLE_FOLLOWS = "\\nopagebreak"  # between a paragraph and what it announces
_NO_SECTION_BREAK = "\\makeatletter\\global\\@secpenalty=10000 \\makeatother\n"


def latex(document: sheet.Document, text: Text) -> str:
    """The document as ``sheet.tex``."""
    blocks = [block for section in document.sections for block in sheet.blocks_of(section)]
    rows = [part for block in blocks for part in (block.rows if isinstance(block, sheet.SheetFormula) else (block,))]
    long = _LONGEST_WORD
    words = ([word[k : k + long] for k in range(0, len(word), long)] for word in document.title.split())
    sections: list[dict[str, Any]] = []
    for part in document.sections:
        if (is_short := len(part.blocks) == 1 and isinstance(part.blocks[0], sheet.Paragraph)) and sections:
            # no page ends behind the last display before a sentence in a section of its own, which is never alone then
            before, display, last = "\n".join(sections[-1]["blocks"]).rpartition(_DISPLAY)
            sections[-1]["blocks"] = [before + _with_next(display + last)]
        sections.append({"title": latex_words(part.title), "blocks": _joined(part.blocks, text), "stays": is_short})
    source = latex_template("document.tex.jinja").render(
        name=document.name,
        version=__version__,
        digest=document.digest,
        title=" ".join("\\allowbreak{}".join(map(latex_text, word)) for word in words),
        subtitle=latex_words(document.subtitle),
        form=[latex_words(word) for word in document.form],
        footer=latex_words(document.footer),
        landscape=any(isinstance(part, sheet.Rows) and part.landscape for part in rows),
        figures=any(isinstance(block, sheet.Figure) for block in blocks),
        sections=sections,
    )
    before, display, rest = source.rpartition(_DISPLAY)
    if _DISPLAY not in before:
        return source
    before, _, last_but_one = before.rpartition(_DISPLAY)
    held = _with_next(_DISPLAY + last_but_one)  # so that no matrix is alone on the last page
    return f"{before}{_NO_SECTION_BREAK}{held}{display}{rest}"


def _with_next(source: str) -> str:
    """A display behind which no page ends, and what follows it; one that is broken itself stays as it is."""
    display, end, rest = source.partition(_DISPLAY_END)
    if not end or "\\\\\n" in display:
        return source
    return f"\\begingroup\\postdisplaypenalty=10000 \\interdisplaylinepenalty=10000\n{display}{end}\n\\endgroup{rest}"


@cache
def latex_template(name: str) -> Template:
    """A template of LaTeX, which is full of braces, so that its marks are ``<< >>`` and ``<% %>``."""
    marks = environment().overlay(
        block_start_string="<%",
        block_end_string="%>",
        variable_start_string="<<",
        variable_end_string=">>",
        comment_start_string="<#",
        comment_end_string="#>",
    )
    return marks.get_template(f"handout/{name}")


def macro(template: str, name: str, /, **values: object) -> str:
    """What a macro of a template of LaTeX writes."""
    return str(getattr(latex_template(template).module, name)(**values))


def latex_words(text: str) -> str:
    """A text with its marks."""
    written = []
    for mark, part in sheet.spans(text):
        if mark == "$":
            written.append(f"${part}$")
        elif mark:
            code = latex_text(part).replace("\\_", "\\_\\allowbreak{}").replace(" ", "\\ ")
            written.append(f"\\texttt{{{code}}}")
        else:
            before, after = (" " if edge.isspace() else "" for edge in (part[:1], part[-1:]))
            body = latex_text(part)
            written.append(f"{before}{body}{after}" if body else " ")
    return "".join(written)


def _joined(blocks: Iterable[sheet.Block], text: Text, is_open: bool = False) -> list[str]:
    """Blocks one after the other; a display joins the paragraph before it, which may be that of a title."""
    written: list[str] = []
    for block in blocks:
        if not (source := _written(block, text)):  # a result of which only an exercise and a page say more
            continue
        is_display = source.startswith(_DISPLAY)
        if is_display and not is_open:  # the group ends with the display: a note behind it leaves the paragraph open
            first, rest = source.split(_DISPLAY_END, 1)
            source = f"\\begingroup\\abovedisplayskip=0pt\n{first}{_DISPLAY_END}\n\\endgroup{rest}"
        elif is_open and not is_display:
            if isinstance(block, sheet.Table) and block.long and written:
                written[-1] = f"\\tableroom\n{written[-1]}"
            announced = isinstance(block, sheet.Table) or (written and written[-1].endswith(f":{_OPEN}"))
            source = f"{_TABLE_FOLLOWS if announced else ''}\\par\n{source}"
        written.append(source)
        is_open = source.endswith(_OPEN)
    return [*written, "\\par"] if is_open else written


def _written(block: sheet.Block, _: Text) -> str:
    match block:
        case sheet.Paragraph(text):
            return latex_words(text) + _OPEN
        case sheet.Rows(lines, landscape):
            return _macro("rows", displays=displays(lines), landscape=landscape)
        case sheet.SheetFormula():
            named = displays(block.named)
            sentences = {
                "named": latex_words(_("With the abbreviations")),
                "entries": latex_words(_("the entries are as follows.")),
                "omitted": latex_words(omitted_words(block, _)),
            }
            return _macro(
                "formula",
                named=[*named[:-1], *map(_with_next, named[-1:])],
                rows=[_written(rows, _) for rows in block.rows if rows.lines],
                omitted=displays(block.omitted),
                note=latex_words(block.note),
                words=sentences,
            )
        case sheet.Blank(number, task, points, gaps):
            room = displays(["".join(map(_gap, row)) for row in sheet.gap_rows(gaps)], kept=False)
            return _macro("blank", number=number, task=latex_words(task), points=points, displays=room)
        case sheet.Table(header, rows, long):
            struts = ("\\rule[-1.3ex]{0pt}{4ex}" * any("frac" in cell for cell in row) for row in (header, *rows))
            cells = (" & ".join(map(latex_words, row)) for row in (header, *rows))
            head, *body = map(str.__add__, struts, cells)  # struts keep fractions off the rules
            return _macro("table", columns="l" * len(header), header=head, rows=body, long=long)
        case sheet.Figure(drawing, caption):
            return _macro("figure", drawing=latex_drawing(drawing), caption=latex_words(caption))
        case sheet.Steps(title, blocks):
            return _macro("steps", title=latex_words(title), blocks=_joined(blocks, _, is_open=True))


def omitted_words(block: sheet.SheetFormula, _: Text) -> str:
    """What stands before the numbers of terms of entries that are left out."""
    if block.function:
        return _(
            "These entries are too long to print; `%(function)s` in `model_numpy.py` computes them. "
            "Multiplied out they have so many terms:",
            function=block.function,
        )
    return _("These entries are too long to print; multiplied out they have so many terms:")


def _gap(gap: sheet.Gap) -> str:
    """The left side of an answer with room behind it and below, as an invisible rule."""
    room = f"\\rule[-{gap.lines:.1f}\\baselineskip]{{0pt}}{{{gap.lines:.1f}\\baselineskip}}"
    whole = f"{gap.name} = {room}" if gap.name else room
    return f"\\makebox[.47\\linewidth][l]{{$\\displaystyle {whole}$}}" if gap.is_half else whole


def _macro(name: str, **values: object) -> str:
    return macro("blocks.tex.jinja", name, **values).removesuffix("\n")
