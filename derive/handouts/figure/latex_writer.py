r"""Drawings as LaTeX without any package: a ``picture`` with labels of LaTeX over paths of raw PDF operators.

``\derivepath{...}`` hands PDF operators to pdfTeX, LuaTeX or XeTeX; their origin is the current point and their unit
is the PDF point (1/72 inch). ``\derivelabel{r g b}{...}`` sets a label in a colour.
"""

from __future__ import annotations

from collections.abc import Iterator

from derive.handouts.figure.drawing import BLACK, Color, Drawing, Label, Path

PREAMBLE = r"""\ifdefined\pdfextension
  \providecommand{\derivepath}[1]{\pdfextension literal {#1}}
\else\ifdefined\pdfliteral
  \providecommand{\derivepath}[1]{\pdfliteral{#1}}
\else
  \providecommand{\derivepath}[1]{\special{pdf:content #1}}
\fi\fi
\ifdefined\XeTeXversion
  \providecommand{\derivelabel}[2]{\special{color push rgb #1}#2\special{color pop}}
\else
  \providecommand{\derivelabel}[2]{\derivepath{#1 rg}#2\derivepath{0 g}}
\fi
"""
"""Definitions that the drawings need; no package."""

LABEL_FONT = r"\fontsize{9}{11}\selectfont"

_PDF_POINT = 72.0 / 72.27
_LONGEST_LINE = 400
_HORIZONTAL = {-1: "l", 0: "", 1: "r"}
_VERTICAL = {-1: "b", 0: "", 1: "t"}


def latex_drawing(drawing: Drawing) -> str:
    """A ``picture`` environment as large as the canvas.

    Args:
        drawing: What to draw.
    """
    body = "\n".join(_body(drawing))
    size = f"({_number(drawing.width)},{_number(drawing.height)})"
    return (
        f"\\begingroup\\setlength{{\\unitlength}}{{1pt}}{LABEL_FONT}%\n"
        f"\\begin{{picture}}{size}\n{body}\n\\end{{picture}}%\n\\endgroup"
    )


def _body(drawing: Drawing) -> Iterator[str]:
    """Neighbouring paths go into one literal as long as a line allows, which keeps their order among the labels."""
    line: list[str] = []
    for item in (*drawing.items, None):
        operators = _operators(item) if isinstance(item, Path) else ""
        if line and (not operators or sum(map(len, line)) + len(operators) > _LONGEST_LINE):
            yield f"\\put(0,0){{\\derivepath{{q 1 J 1 j {' '.join(line)} Q}}}}"
            line = []
        if operators:
            line.append(operators)
        if isinstance(item, Label):
            yield _label(item)


def _operators(item: Path) -> str:
    """PDF operators: colours, width and dashes, the outline, and how it is painted."""
    points = [f"{_number(x * _PDF_POINT)} {_number(y * _PDF_POINT)}" for x, y in item.points]
    state = []
    if item.fill is not None:
        state.append(f"{_color(item.fill)} rg")
    if item.stroke is not None:
        state.append(f"{_color(item.stroke)} RG {_number(item.width * _PDF_POINT)} w")
        state.append("[3 2] 0 d" if item.dashed else "[] 0 d")
    outline = f"{points[0]} m " + " ".join(f"{point} l" for point in points[1:]) + (" h" if item.closed else "")
    painting = {(True, True): "B", (True, False): "f", (False, True): "S", (False, False): "n"}
    return " ".join([*state, outline, painting[item.fill is not None, item.stroke is not None]])


def _label(item: Label) -> str:
    anchor = _HORIZONTAL[item.anchor[0]] + _VERTICAL[item.anchor[1]]
    text = f"${item.latex}$"
    if item.color != BLACK:
        text = f"\\derivelabel{{{_color(item.color)}}}{{{text}}}"
    place = f"({_number(item.at[0])},{_number(item.at[1])})"
    return f"\\put{place}{{\\makebox(0,0){f'[{anchor}]' if anchor else ''}{{{text}}}}}"


def _color(color: Color) -> str:
    return " ".join(_number(part, 3) for part in color)


def _number(value: float, digits: int = 2) -> str:
    text = f"{value:.{digits}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text
