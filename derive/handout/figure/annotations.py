"""What stands on top of the solid arm: axes with their names, dimension lines with the lengths, joint variables."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from derive.handout.figure.drawing import Color, Path, Point
from derive.handout.figure.label_text import label_width
from derive.handout.figure.placing import Paper, around
from derive.handout.figure.projection import View
from derive.handout.figure.scene import LETTERS, Axis, Scene, Stretch
from derive.handout.figure.solids import Sizes, joint_centers
from derive.handout.notation.pieces import joined
from derive.handout.tables import DataPrinter
from derive.robot.description import Convention
from derive.robot.expression import Name, Number, Product, Sum, names
from derive.robot.robot import Robot

Array = npt.NDArray[np.float64]

AXIS_COLORS: tuple[Color, Color, Color] = ((0.78, 0.10, 0.10), (0.08, 0.50, 0.15), (0.10, 0.22, 0.78))
"""Of x, y and z."""

DIMENSION: Color = (0.35, 0.35, 0.35)
LONGEST_LABEL = 70.0
"""A wider length is labelled by its symbol of the table, such as a_2 [pt]."""

_SHORT = 15.0
_OFFSETS = (14.0, -14.0, 20.0, -20.0, 28.0, -28.0, 38.0, -38.0)
_MOST_NAMES = 8


@dataclass(frozen=True, eq=False)
class _Arrow:
    start: Point
    tip: Point
    axis: Axis


def annotate(
    paper: Paper, robot: Robot, data: DataPrinter, scene: Scene, view: View, scale: float, sizes: Sizes
) -> None:
    """Axes, lengths and joint variables on the paper.

    Args:
        paper: Holds the solid arm already.
        robot: The robot.
        data: Prints lengths and variables.
        scene: The arm.
        view: From where it is seen.
        scale: Points per metre.
        sizes: How large things are.
    """
    arrows = list(_arrows(scene, view, scale, sizes))
    for arrow in arrows:
        for path in arrow_paths(arrow.start, arrow.tip, AXIS_COLORS[arrow.axis.letter], 0.9):
            paper.draw(path)
    for arrow in arrows:
        if arrow.axis.letter != 1:
            _name_axis(paper, arrow)
    for stretch in scene.stretches:
        _dimension(paper, robot, data, stretch, view, scale)
    if robot.n <= _MOST_NAMES:
        for joint, center in zip(robot.joints, joint_centers(scene, scale, sizes), strict=True):
            x, y = _flat(view, center)
            reach = 11.0 + 4.0 * sizes.factor
            paper.label(
                data.notation.glyph(joint.variable).box.tex.strip(), around((x, y), (1.0, 0.3), reach), DIMENSION
            )


def _flat(view: View, point: Array) -> Point:
    x, y, _ = view.project(point)
    return float(x), float(y)


def _arrows(scene: Scene, view: View, scale: float, sizes: Sizes) -> Iterator[_Arrow]:
    for axis in sorted(scene.axes, key=lambda axis: (-sizes.arrow[axis.letter], axis.frames)):
        start = axis.origin * scale
        tip = start + axis.direction * sizes.arrow[axis.letter]
        yield _Arrow(_flat(view, start), _flat(view, tip), axis)


def arrow_paths(start: Point, tip: Point, color: Color, width: float, both: bool = False) -> Iterator[Path]:
    """A line with a filled head, or one at each end."""
    yield Path((start, tip), stroke=color, width=width)
    length = math.hypot(tip[0] - start[0], tip[1] - start[1])
    if length < 1.0:
        return
    head = min(5.5 if width > 0.7 else 4.0, 0.6 * length)
    ends = ((tip, start), (start, tip)) if both else ((tip, start),)
    for point, other in ends:
        dx, dy = (point[0] - other[0]) / length, (point[1] - other[1]) / length
        back = (point[0] - head * dx, point[1] - head * dy)
        half = 0.36 * head
        corners = (point, (back[0] - half * dy, back[1] + half * dx), (back[0] + half * dy, back[1] - half * dx))
        yield Path(corners, closed=True, stroke=None, fill=color)


def _name_axis(paper: Paper, arrow: _Arrow) -> None:
    letter = LETTERS[arrow.axis.letter]
    latex = ",".join(f"{letter}_{{{'e' if index < 0 else index}}}" for index in arrow.axis.frames)
    direction = (arrow.tip[0] - arrow.start[0], arrow.tip[1] - arrow.start[1])
    reach = 6.5 + 0.3 * max(0.0, label_width(latex) - 9.0) * (abs(direction[0]) / (math.hypot(*direction) + 1e-9) + 0.3)
    paper.label(latex, around(arrow.tip, direction, reach), AXIS_COLORS[arrow.axis.letter])


def _dimension(paper: Paper, robot: Robot, data: DataPrinter, stretch: Stretch, view: View, scale: float) -> None:
    latex = _length(robot, data, stretch)
    if not latex:
        return
    start, end = _flat(view, stretch.start * scale), _flat(view, stretch.end * scale)
    length = math.hypot(end[0] - start[0], end[1] - start[1])
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    if length < _SHORT:
        direction = (-(end[1] - start[1]), end[0] - start[0]) if length > 1e-6 else (0.0, 1.0)
        paper.label(latex, around(middle, direction, 9.0 + 0.3 * label_width(latex)), DIMENSION)
        return
    nx, ny = -(end[1] - start[1]) / length, (end[0] - start[0]) / length
    costs = [paper.crossing(_shift(start, nx, ny, o), _shift(end, nx, ny, o)) + 0.12 * abs(o) for o in _OFFSETS]
    offset = _OFFSETS[int(np.argmin(np.round(costs, 6)))]
    a, b = _shift(start, nx, ny, offset), _shift(end, nx, ny, offset)
    over = offset + math.copysign(2.5, offset)
    for point in (start, end):
        gap = math.copysign(4.0, offset)
        paper.draw(
            Path((_shift(point, nx, ny, gap), _shift(point, nx, ny, over)), stroke=DIMENSION, width=0.3), weight=0.4
        )
    for path in arrow_paths(a, b, DIMENSION, 0.45, both=True):
        paper.draw(path)
    center = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
    outward = (math.copysign(1.0, offset) * nx, math.copysign(1.0, offset) * ny)
    reach = 6.0 + abs(outward[0]) * label_width(latex) / 2
    paper.label(latex, around(center, outward, reach), DIMENSION)


def _shift(point: Point, nx: float, ny: float, by: float) -> Point:
    return (point[0] + by * nx, point[1] + by * ny)


def _length(robot: Robot, data: DataPrinter, stretch: Stretch) -> str:
    """The cell of the table that a stretch shows, as LaTeX; its symbol where the cell is too wide."""
    if stretch.cell == "tool":
        return ""
    joint = robot.joints[stretch.row]
    cell = joint.a if stretch.cell == "a" else joint.d
    if stretch.cell == "d" and not joint.is_revolute:
        cell = Sum((Product((Number(Fraction(joint.sign)), Name(joint.variable))), cell))
    box = joined(data.value(cell))
    latex = box.tex.strip()
    if not any(True for _ in names(cell)):
        latex += r"\,\mathrm{m}"
    if label_width(latex) <= LONGEST_LABEL and "\\frac" not in latex and "\\sqrt" not in latex:
        return latex
    behind = stretch.cell == "a" and robot.convention is Convention.MODIFIED
    return f"{stretch.cell}_{{{stretch.row + (0 if behind else 1)}}}"
