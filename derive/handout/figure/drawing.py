"""A drawing in the plane: lines, areas and labels, in the order in which they cover each other.

Coordinates are points (1/72.27 inch), x to the right and y upwards. A drawing knows nothing of robots; LaTeX, SVG and
matplotlib writers print it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

Point: TypeAlias = tuple[float, float]
Color: TypeAlias = tuple[float, float, float]
"""Red, green and blue from 0 to 1."""


@dataclass(frozen=True, slots=True)
class Path:
    """A line or an area.

    Attributes:
        points: Corners.
        closed: Whether the last corner is joined to the first.
        stroke: Colour of the line, None for no line.
        fill: Colour of the area, None for no area.
        width: Width of the line [pt].
        dashed: Whether the line is dashed.
    """

    points: tuple[Point, ...]
    closed: bool = False
    stroke: Color | None = (0.0, 0.0, 0.0)
    fill: Color | None = None
    width: float = 0.6
    dashed: bool = False


@dataclass(frozen=True, slots=True)
class Label:
    """A short text.

    Attributes:
        at: Where it stands.
        latex: LaTeX in mathematics mode.
        anchor: Which corner of the text stands there: a pair of -1, 0 or 1 (left, middle, right; bottom, middle, top).
        color: Colour of the text.
    """

    at: Point
    latex: str
    anchor: tuple[int, int] = (0, 0)
    color: Color = (0.0, 0.0, 0.0)


Item: TypeAlias = Path | Label


@dataclass(frozen=True, slots=True)
class Drawing:
    """Items from back to front on a canvas from (0, 0) to (width, height).

    Attributes:
        width: Width of the canvas [pt].
        height: Height of the canvas [pt].
        items: What is drawn.
        title: What it shows, for readers who cannot see it.
    """

    width: float
    height: float
    items: tuple[Item, ...]
    title: str = ""
