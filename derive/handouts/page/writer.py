"""A document as one HTML file: formulas, figures, fonts, styles and scripts inside of it, nothing from a network.

The file holds every formula as LaTeX, and KaTeX, which sets it in the reader's browser: what is on the screen first,
the rest while the reader reads. Without scripts the LaTeX is there to be read.
"""

import math
import re
from base64 import b64encode
from collections.abc import Iterable
from functools import cache
from html import escape
from importlib.resources import files

from derive.handouts.figure.drawing import label_runs
from derive.handouts.figure.writers import svg_drawing
from derive.handouts.page.player import html_messages
from derive.handouts.page.viewer import Viewer
from derive.handouts.sheet import document as sheet
from derive.handouts.sheet.language import Text
from derive.handouts.sheet.latex_writer import omitted_words
from derive.targets import templating
from derive.targets.escape import html_text
from derive.version import __version__

_SCRIPT_END = re.compile(r"<(?=/script|!--|script)", re.IGNORECASE)
_STYLE_END = re.compile(r"<(?=/style)", re.IGNORECASE)
_FONT_FACE = re.compile(r"(@font-face\{[^}]*?src:url\(fonts/([\w-]+\.woff2)\)[^}]*\})")
_FONT_SOURCES = re.compile(r"src:[^;}]*")


def page(document: sheet.Document, text: Text, viewer: Viewer | None = None, *, is_marked: bool = False) -> str:
    """The document as a web page, with a figure that the reader moves, and a mark of who wrote it, where wanted."""
    sections = [
        {"anchor": html_text(section.anchor), "title": _words(section.title), "body": _blocks(section.blocks, text)}
        for section in document.sections
    ]
    content = templating.render(
        "page/content.html.jinja",
        _=html_messages(text),
        title=html_text(document.title),
        subtitle=_words(document.subtitle),
        form=[_words(word) for word in document.form],
        sections=sections,
        viewer=viewer.html if viewer else "",
        steps=any(isinstance(block, sheet.Steps) for part in document.sections for block in sheet.blocks_of(part)),
        footer=_words(document.footer),
        name=html_text(document.name),
        digest=html_text(document.digest),
        version=html_text(__version__),
    )
    return templating.render(
        "page/page.html.jinja",
        version=html_text(__version__) if is_marked else "",
        language=html_text(text.language),
        title=html_text(document.title or document.name),
        style="\n".join((formula_style(), templating.render("page/style.css.jinja"))),
        script=templating.render("page/page.js.jinja"),
        katex=safe_script(_asset("katex.min.js").decode()),
        viewer_style=safe_style(viewer.css) if viewer else "",
        viewer_script=safe_script(viewer.script) if viewer else "",
        content=content,
    )


@cache
def formula_style() -> str:
    """The style sheet of KaTeX with its fonts inside; families of which we have no file are left out."""
    folder = files("derive").joinpath("assets", "katex")
    css = _asset("katex.min.css").decode()
    for face, font in _FONT_FACE.findall(css):
        inside = ""
        if folder.joinpath(font).is_file():
            data = b64encode(_asset(font)).decode("ascii")
            inside = _FONT_SOURCES.sub(f'src:url(data:font/woff2;base64,{data}) format("woff2")', face)
        css = css.replace(face, inside)
    return safe_style(css)


def _asset(name: str) -> bytes:
    return files("derive").joinpath("assets", "katex", name).read_bytes()


def safe_script(script: str) -> str:
    r"""A script that cannot end its element: in strings ``<\/script`` means the same as ``</script``."""
    return _SCRIPT_END.sub(lambda found: "<\\", script)


def safe_style(css: str) -> str:
    """A style sheet that cannot end its element."""
    return _STYLE_END.sub(lambda found: "<\\", css)


_SUBSCRIPTS = str.maketrans("0123456789+-\N{MINUS SIGN}=()aehijklmnoprstuvx", "₀₁₂₃₄₅₆₇₈₉₊₋₋₌₍₎ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ")
_SUPERSCRIPTS = str.maketrans("0123456789+-\N{MINUS SIGN}=()iTn", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁻⁼⁽⁾ⁱᵀⁿ")

_NAMESPACE = ' xmlns="http://www.w3.org/2000/svg"'  # what SVG needs in a file of its own and not in a page


def formula(latex: str, *, display: bool = False) -> str:
    """A formula: its LaTeX as text, which stays readable where no script runs."""
    tag = "div" if display else "span"
    return f"<{tag} class=math>{html_text(latex)}</{tag}>"


def unicode_name(latex: str) -> str:
    """A symbol in letters of Unicode, such as b₁₂; an index that has no letters stands behind ``_`` or ``^``."""
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


def _words(text: str) -> str:
    write = {"$": formula, "`": lambda part: f"<code>{html_text(part)}</code>", "": html_text}
    return "".join(write[mark](part) for mark, part in sheet.spans(text))


def _blocks(blocks: Iterable[sheet.Block], _: Text) -> str:
    parts: list[str] = []
    for block in blocks:
        match block:
            case sheet.Paragraph(text):
                written = f"<p>{_words(text)}</p>"
            case sheet.Rows(lines):
                written = _displays(lines, _)
            case sheet.SheetFormula():
                written = _formula(block, _)
            case sheet.Blank(number, task, points, gaps):
                asked = f"<p class=task><b>{number}</b> {_words(task)} {html_text(points)}</p>"
                rows = ("".join(_gap(gap) for gap in row) for row in sheet.gap_rows(gaps))
                written = "\n".join((asked, *(f"<div class=answers>{row}</div>" for row in rows)))
            case sheet.Table():
                written = _table(block, _)
            case sheet.Figure(drawing, caption):
                picture = svg_drawing(drawing).replace(_NAMESPACE, "", 1)
                written = f"<figure>\n{picture}\n<figcaption>{_words(caption)}</figcaption>\n</figure>"
            case sheet.Steps(title, inner):
                written = f"<details>\n<summary>{_words(title)}</summary>\n{_blocks(inner, _)}\n</details>"
        parts.append(written)
    return "\n".join(parts)


def _displays(lines: Iterable[str], _: Text) -> str:
    """Displayed lines in a box that scrolls, by keys too."""
    body = "\n".join(formula(line, display=True) for line in lines)
    return f'<div class=display tabindex=0 role=group aria-label="{html_text(_("Formula"))}">\n{body}\n</div>'


def _formula(block: sheet.SheetFormula, _: Text) -> str:
    parts: list[str] = []
    if block.named:
        parts += [f"<p>{_words(_('With the abbreviations'))}</p>", _displays(block.named, _)]
        parts.append(f"<p>{_words(_('the entries are as follows.'))}</p>")
    parts += [_displays(rows.lines, _) for rows in block.rows if rows.lines]
    parts += [f"<p>{_words(omitted_words(block, _))}</p>", _displays(block.omitted, _)] if block.omitted else []
    parts += [f"<p class=note>{_words(block.note)}</p>"] if block.note else []
    if written := tuple(block.entries()):
        entries = [
            {"name": html_text(unicode_name(e.name)), "latex": escape(e.latex), "python": escape(e.python)}
            for e in written
        ]
        function = html_text(block.function)
        tools = templating.render("page/tools.html.jinja", _=html_messages(_), entries=entries, function=function)
        parts.append(tools.rstrip())
    return "<div class=formula>\n{}\n</div>".format("\n".join(parts))


def _gap(gap: sheet.Gap) -> str:
    ruled = f'<div class=ruled style="--lines:{math.ceil(gap.lines)}" role=presentation></div>'
    return f"<div class=answer>{formula(f'{gap.name} =') if gap.name else ''}{ruled}</div>"


def _table(block: sheet.Table, _: Text) -> str:
    head = "".join(_cell("th scope=col", cell) for cell in block.header)
    cells = ((_cell("td" if k else "th scope=row", cell) for k, cell in enumerate(row)) for row in block.rows)
    rows = "\n".join(f"<tr>{''.join(row)}</tr>" for row in cells)
    table = f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody>\n</table>"
    return f'<div class=scroll tabindex=0 role=group aria-label="{html_text(_("Table"))}">\n{table}\n</div>'


def _cell(tag: str, text: str) -> str:
    return f"<{tag}>{inner}</{tag[:2]}>" if (inner := _words(text)).strip() else "<td></td>"
