r"""A drawing as LaTeX for the sheet, as SVG for the web page, and through matplotlib as a file of its own.

The LaTeX needs no package: a ``picture`` with labels of LaTeX over paths of raw PDF operators. ``\derivepath{...}``
hands PDF operators to pdfTeX, LuaTeX or XeTeX; their origin is the current point and their unit is the PDF point
(1/72 inch). ``\derivelabel{r g b}{...}`` sets a label in a colour.

The SVG is readable on light and on dark: black becomes the colour of the text around; other lines and letters are mixed
with it, so that they stand out from a dark page too. It has a title for those who cannot see it.

The same drawing gives the same bytes, also through matplotlib. Why LaTeX and SVG of the sheet and the page do not go
through it: decision 13 in docs/decisions.
"""

from html import escape
from io import BytesIO
from typing import Any

from derive.errors import DeriveError, optional
from derive.handouts.figure.drawing import BLACK, LABEL_SIZE, SCRIPT_SIZE, Color, Drawing, Label, Path, label_runs

LABEL_FONT = r"\fontsize{9}{11}\selectfont"

_PDF_POINT = 72.0 / 72.27
_LONGEST_LINE = 400
_HORIZONTAL = {-1: "l", 0: "", 1: "r"}
_VERTICAL = {-1: "b", 0: "", 1: "t"}

_ANCHORS = {-1: "start", 0: "middle", 1: "end"}
_RISE = {-1: 0.0, 0: 0.32, 1: 0.72}  # baseline below the anchor, in letter sizes
_SHIFT = {0: 0.0, -1: 2.2, 1: -3.2}  # baseline of a subscript and a superscript below that of the line [pt]
_SERIF = "KaTeX_Main, 'Latin Modern Math', 'Times New Roman', serif"
_FONTS = {"italic": ' font-style="italic"', "upright": "", "mono": ' font-family="monospace"'}


def latex_drawing(drawing: Drawing) -> str:
    """A ``picture`` environment as large as the canvas."""
    lines: list[str] = []
    line: list[str] = []
    # neighbouring paths go into one literal as long as a line allows, which keeps their order among the labels
    for item in (*drawing.items, None):
        operators = _pdf_operators(item) if isinstance(item, Path) else ""
        if line and (not operators or sum(map(len, line)) + len(operators) > _LONGEST_LINE):
            lines.append(f"\\put(0,0){{\\derivepath{{q 1 J 1 j {' '.join(line)} Q}}}}")
            line = []
        if operators:
            line.append(operators)
        if isinstance(item, Label):
            anchor = _HORIZONTAL[item.anchor[0]] + _VERTICAL[item.anchor[1]]
            math, color = f"${item.latex}$", _pdf_color(item.color)
            text = math if item.color == BLACK else f"\\derivelabel{{{color}}}{{{math}}}"
            place = f"({_number(item.at[0])},{_number(item.at[1])})"
            lines.append(f"\\put{place}{{\\makebox(0,0){f'[{anchor}]' if anchor else ''}{{{text}}}}}")
    body = "\n".join(lines)
    size = f"({_number(drawing.width)},{_number(drawing.height)})"
    return (
        f"\\begingroup\\setlength{{\\unitlength}}{{1pt}}{LABEL_FONT}%\n"
        f"\\begin{{picture}}{size}\n{body}\n\\end{{picture}}%\n\\endgroup"
    )


def _pdf_operators(item: Path) -> str:
    """PDF operators: colours, width and dashes, the outline, and how it is painted."""
    points = [f"{_number(x * _PDF_POINT)} {_number(y * _PDF_POINT)}" for x, y in item.points]
    state = [f"{_pdf_color(item.fill)} rg"] if item.fill is not None else []
    if item.stroke is not None:
        state.append(f"{_pdf_color(item.stroke)} RG {_number(item.width * _PDF_POINT)} w")
        state.append("[3 2] 0 d" if item.dashed else "[] 0 d")
    outline = f"{points[0]} m " + " ".join(f"{point} l" for point in points[1:]) + (" h" if item.closed else "")
    painting = {(True, True): "B", (True, False): "f", (False, True): "S", (False, False): "n"}
    return " ".join([*state, outline, painting[item.fill is not None, item.stroke is not None]])


def _pdf_color(color: Color) -> str:
    return " ".join(_number(part, 3) for part in color)


def svg_drawing(drawing: Drawing, scale: float = 1.5) -> str:
    """One ``<svg>`` element."""
    width, height = _number(drawing.width), _number(drawing.height)
    title = f"<title>{_xml_text(drawing.title)}</title>" if drawing.title else ""
    role = f'role="img" aria-label="{_xml_text(drawing.title)}"' if drawing.title else 'aria-hidden="true"'
    written = []
    for item in drawing.items:  # a path, or a label run by run; the page's y axis points down
        if isinstance(item, Label):
            x, y = item.at[0], drawing.height - item.at[1] + _RISE[item.anchor[1]] * LABEL_SIZE
            place = f'x="{_number(x)}" y="{_number(y)}" text-anchor="{_ANCHORS[item.anchor[0]]}"'
            spans, before = [], 0.0
            for run in label_runs(item.latex):
                change, before = _SHIFT[run.shift] - before, _SHIFT[run.shift]  # relative to the run before
                shift = f' dy="{_number(change)}"' if change else ""
                size = f' font-size="{_number(SCRIPT_SIZE)}"' if run.shift else ""
                spans.append(f"<tspan{shift}{size}{_FONTS[run.style]}>{_xml_text(run.text)}</tspan>")
            written.append(f"<text {place} {_svg_paint('fill', item.color)}>{''.join(spans)}</text>")
            continue
        points = " L".join(f"{_number(x)} {_number(drawing.height - y)}" for x, y in item.points)
        dashes = ' stroke-dasharray="4 2.5"' if item.dashed else ""
        area = item.fill is not None and item.stroke is not None
        fill = _svg_paint("fill", item.fill, solid=area) if item.fill is not None else 'fill="none"'
        stroke = "" if item.stroke is None else f" {_svg_paint('stroke', item.stroke, solid=area)}"
        line = "" if item.stroke is None else f' stroke-width="{_number(item.width)}"'
        written.append(f'<path d="M{points}{"Z" if item.closed else ""}" {fill}{stroke}{line}{dashes}/>')
    body = "\n".join(written)
    style = f"max-width:100%;width:{_number(drawing.width * scale)}px;height:auto"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {role} viewBox="0 0 {width} {height}" style="{style}" '
        f'stroke-linejoin="round" stroke-linecap="round" font-family="{_SERIF}" font-size="{_number(LABEL_SIZE)}">'
        f"{title}\n{body}\n</svg>"
    )


def _svg_paint(attribute: str, color: Color, solid: bool = False) -> str:
    """Solid bodies keep their colours on every background."""
    if max(color) == 0.0:
        return f'{attribute}="currentColor"'
    code = "#" + "".join(f"{round(255 * part):02x}" for part in color)
    mixed = "" if solid else f' style="{attribute}:color-mix(in srgb,{code} 65%,currentColor)"'
    return f'{attribute}="{code}"{mixed}'


def _xml_text(text: str) -> str:
    """Escaped, without characters that XML cannot hold."""
    return escape("".join(c if c.isprintable() else " " for c in text))


def _number(value: float, digits: int = 2) -> str:
    """A number with as few characters as so many decimals allow."""
    text = f"{value:.{digits}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text


# -- PDF, SVG and PNG through matplotlib

SUFFIXES = (".pdf", ".svg", ".png")
POINTS_PER_INCH = 72.27
RESOLUTION = 300  # of a PNG [dots per inch]
CREATOR = "derive"

STYLE = {
    "svg.hashsalt": "derive",
    "svg.fonttype": "path",
    "pdf.fonttype": 3,
    "mathtext.fontset": "cm",
    "font.family": "serif",
    "path.simplify": False,
}

_ALIGN_X = {-1: "left", 0: "center", 1: "right"}
_ALIGN_Y = {-1: "bottom", 0: "center", 1: "top"}


def require_matplotlib() -> Any:
    """The module matplotlib, set to draw into files."""
    matplotlib = optional("matplotlib", "figures need matplotlib", "handout", DeriveError)
    matplotlib.use("agg")
    return matplotlib


def drawing_bytes(drawing: Drawing, suffix: str, scale: float = 1.0) -> bytes:
    """A drawing as the contents of a file."""
    with require_matplotlib().rc_context(STYLE):
        from matplotlib.figure import Figure
        from matplotlib.patches import Polygon

        figure = Figure(figsize=(scale * drawing.width / POINTS_PER_INCH, scale * drawing.height / POINTS_PER_INCH))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(0.0, drawing.width), ylim=(0.0, drawing.height))
        axes.set_axis_off()
        for order, item in enumerate(drawing.items):
            if isinstance(item, Path):
                outline = Polygon(
                    item.points,
                    closed=item.closed,
                    fill=item.fill is not None,
                    facecolor=item.fill or "none",
                    edgecolor=item.stroke or "none",
                    linewidth=item.width * scale if item.stroke else 0.0,
                    linestyle=(0, (4, 2.5)) if item.dashed else "solid",
                    joinstyle="round",
                    capstyle="round",
                    zorder=order,
                )
                axes.add_patch(outline)
            else:
                axes.text(
                    *item.at,
                    f"${item.latex}$",
                    fontsize=LABEL_SIZE * scale,
                    color=item.color,
                    ha=_ALIGN_X[item.anchor[0]],
                    va=_ALIGN_Y[item.anchor[1]],
                    zorder=order,
                    clip_on=False,
                )
        return figure_bytes(figure, suffix, drawing.title)


def figure_bytes(figure: Any, suffix: str, title: str) -> bytes:
    """A figure of matplotlib as the contents of a file, without date or version in it."""
    form = suffix.removeprefix(".")
    metadata = {
        "svg": {"Date": None, "Creator": CREATOR, "Title": title},
        "pdf": {"CreationDate": None, "Creator": CREATOR, "Producer": None, "Title": title},
        "png": {"Software": CREATOR, "Title": title},
    }[form]
    file = BytesIO()
    figure.savefig(file, format=form, dpi=RESOLUTION, metadata=metadata, facecolor="white")
    return file.getvalue()
