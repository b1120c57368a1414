"""A drawing in the plane: lines, areas and labels, in the order in which they cover each other.

Coordinates are points (1/72.27 inch), x to the right and y upwards. A drawing knows nothing of robots; LaTeX, SVG and
matplotlib writers print it. A label is LaTeX; for writers without TeX, and to know its size, it is read as short runs
of plain characters.
"""

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeAlias

from derive.targets.escape import GREEK_LETTERS

Point: TypeAlias = tuple[float, float]
Color: TypeAlias = tuple[float, float, float]  # red, green and blue from 0 to 1
BLACK: Color = (0.0, 0.0, 0.0)

LABEL_SIZE = 9.0  # size of the letters of a label [pt]
SCRIPT_SIZE = 6.5  # size of subscripts and superscripts [pt]
LABEL_HEIGHT = 9.0  # height of a label with a subscript [pt]
# LaTeX command without its backslash -> letter; what TeX calls epsilon and phi are symbols apart in Unicode.
GREEK = {
    name: unicodedata.lookup(f"GREEK {'SMALL' if name.islower() else 'CAPITAL'} LETTER {name.replace('mbda', 'mda')}")
    for name in GREEK_LETTERS
} | {"epsilon": "ϵ", "varepsilon": "ε", "vartheta": "ϑ", "phi": "ϕ", "varphi": "φ"}
_SYMBOLS = {"cdot": "·", "ldots": "…", "circ": "°", "equiv": "≡", "times": "\N{MULTIPLICATION SIGN}", "sqrt": "√"}
_SPACES = {",": "\N{THIN SPACE}", ";": " ", " ": " ", "quad": "  ", "!": ""}
_STYLES = {"mathrm": "upright", "text": "upright", "mathtt": "mono", "operatorname": "upright"}
_ACCENTS = {"dot": "\N{COMBINING DOT ABOVE}", "ddot": "\N{COMBINING DIAERESIS}"}
_TOKEN = re.compile(r"\\[A-Za-z]+ ?|\\.|.", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Path:
    """A line or an area."""

    points: tuple[Point, ...]  # corners
    closed: bool = False  # whether the last corner is joined to the first
    stroke: Color | None = BLACK  # colour of the line, None for no line
    fill: Color | None = None  # colour of the area, None for no area
    width: float = 0.6  # width of the line [pt]
    dashed: bool = False  # whether the line is dashed


@dataclass(frozen=True, slots=True)
class Label:
    """A short text."""

    at: Point  # where it stands
    latex: str  # LaTeX in mathematics mode
    anchor: tuple[int, int] = (0, 0)  # which of its corners stands there: left and bottom -1, middle 0, right and top 1
    color: Color = BLACK  # colour of the text


Item: TypeAlias = Path | Label


@dataclass(frozen=True, slots=True)
class Drawing:
    """Items from back to front on a canvas from (0, 0) to (width, height)."""

    width: float  # width of the canvas [pt]
    height: float  # height of the canvas [pt]
    items: tuple[Item, ...]  # what is drawn
    title: str = ""  # what it shows, for readers who cannot see it


@dataclass(frozen=True, slots=True)
class LabelRun:
    """Characters of one style."""

    text: str  # the characters
    style: str = "italic"  # ``italic``, ``upright`` or ``mono``
    shift: int = 0  # -1 for a subscript, 1 for a superscript, 0 on the line


def label_runs(latex: str) -> tuple[LabelRun, ...]:
    """The LaTeX of a label as runs of plain characters, neighbours of one style joined."""
    tokens = (token.rstrip() if token.startswith("\\") and len(token) > 2 else token for token in _TOKEN.findall(latex))
    joined: list[LabelRun] = []
    for run in _runs(tokens, LabelRun("")):
        if joined and (joined[-1].style, joined[-1].shift) == (run.style, run.shift):
            joined[-1] = replace(run, text=joined[-1].text + run.text)
        elif run.text:
            joined.append(run)
    return tuple(joined)


def label_width(latex: str) -> float:
    """Width of a label on the page, estimated [pt]."""
    width = 0.0
    for run in label_runs(latex):
        size = SCRIPT_SIZE if run.shift else LABEL_SIZE
        narrow = sum(character in ",.\N{THIN SPACE}il1" for character in run.text)
        width += size * (0.58 * (len(run.text) - narrow) + 0.36 * narrow)
    return width


def _runs(tokens: Iterator[str], style: LabelRun, *, one: bool = False) -> Iterator[LabelRun]:
    """The runs up to the end of the group, or those of one argument."""
    for token in tokens:
        name = token.removeprefix("\\")
        if token == "}" and not one:
            return
        if token == "{":
            yield from _runs(tokens, style)
        elif token in "_^":
            yield from _runs(tokens, replace(style, shift=-1 if token == "_" else 1), one=True)
        elif token == name and not token.isspace():
            upright = style.style == "italic" and not token.isalpha()
            shown = "\N{MINUS SIGN}" if token == "-" else token
            yield replace(style, text=shown, style="upright" if upright else style.style)
        elif name in _STYLES:
            yield from _runs(tokens, replace(style, style=_STYLES[name]), one=True)
        elif name in _ACCENTS:
            yield from (replace(run, text=run.text + _ACCENTS[name]) for run in _runs(tokens, style, one=True))
        elif name == "frac":
            yield from _runs(tokens, style, one=True)
            yield replace(style, text="/", style="upright")
            yield from _runs(tokens, style, one=True)
        elif token != name:
            shown = GREEK.get(name) or _SYMBOLS.get(name) or _SPACES.get(name, name if len(name) == 1 else "")
            yield replace(style, text=shown, style=style.style if name in GREEK else "upright")
        if one:
            return
