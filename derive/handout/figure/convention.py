"""The four Denavit-Hartenberg parameters between two frames, for both conventions.

Source: the figures in Siciliano et al., Robotics: Modelling, Planning and Control, ch. 2.8 (standard), and Craig,
Introduction to Robotics, ch. 3.4 (modified).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from derive.handout.figure.annotations import AXIS_COLORS, DIMENSION, arrow_paths
from derive.handout.figure.drawing import Color, Drawing, Path, Point
from derive.handout.figure.placing import Paper, around, moved
from derive.handout.figure.projection import View, paint
from derive.handout.figure.solids import REVOLUTE, prism
from derive.robot.description import Convention

Array = npt.NDArray[np.float64]

_X, _Z = np.array((1.0, 0.0, 0.0)), np.array((0.0, 0.0, 1.0))
_ALPHA, _THETA = math.radians(38), math.radians(52)
_A, _D = 150.0, 78.0
_AXIS = 58.0
_ARC = 34.0
_GREY: Color = (0.45, 0.45, 0.45)


def convention_drawing(convention: Convention) -> Drawing:
    """Frames i-1 and i with a, alpha, d and theta of row i.

    Args:
        convention: Standard or modified.
    """
    sketch = _Sketch()
    if convention is Convention.STANDARD:
        _standard(sketch)
        title = "d_i, theta_i, a_i, alpha_i between frames i-1 and i"
    else:
        _modified(sketch)
        title = "alpha_{i-1}, a_{i-1}, d_i, theta_i between frames i-1 and i"
    return moved(sketch.paper.items, 4.0, title)


def _standard(sketch: _Sketch) -> None:
    """d along z_{i-1} to the common normal, a along it; theta turns x_{i-1} into x_i, alpha z_{i-1} into z_i."""
    origin, foot = np.zeros(3), _D * _Z
    second = foot + _A * _X
    x_before, z_after = _turned(_X, _Z, -_THETA), _turned(_Z, _X, _ALPHA)
    sketch.joint(origin - 34 * _Z, _Z)
    sketch.joint(second - 42 * z_after, z_after)
    sketch.dashes(origin - 62 * _Z, foot + 62 * _Z)
    sketch.dashes(second - 68 * z_after, second + 44 * z_after)
    sketch.dashes(second, second + 52 * _Z)
    sketch.dashes(foot, foot + 60 * x_before)
    sketch.line(foot, second)
    sketch.axis(origin, _Z, 2, "z_{i-1}")
    sketch.axis(origin, x_before, 0, "x_{i-1}")
    sketch.axis(second, z_after, 2, "z_{i}")
    sketch.axis(second, _X, 0, "x_{i}")
    sketch.arc(foot, x_before, _Z, _THETA, r"\theta_{i}")
    sketch.arc(second, _Z, _X, _ALPHA, r"\alpha_{i}")
    sketch.length(origin, foot, -24.0, "d_{i}")
    sketch.length(foot, second, -20.0, "a_{i}")


def _modified(sketch: _Sketch) -> None:
    """a along x_{i-1}, the common normal, d along z_i; alpha turns z_{i-1} into z_i, theta x_{i-1} into x_i."""
    origin, foot = np.zeros(3), _A * _X
    z_after = _turned(_Z, _X, _ALPHA)
    second, x_after = foot + _D * z_after, _turned(_X, z_after, _THETA)
    sketch.joint(origin - 34 * _Z, _Z)
    sketch.joint(foot - 42 * z_after, z_after)
    sketch.dashes(origin - 62 * _Z, origin + 84 * _Z)
    sketch.dashes(foot - 68 * z_after, second + 80 * z_after)
    sketch.dashes(foot, foot + 62 * _Z)
    sketch.dashes(second, second + 60 * _X)
    sketch.line(origin, foot)
    sketch.line(foot, second)
    sketch.beside(foot, second, "d_{i}")
    sketch.axis(origin, _Z, 2, "z_{i-1}")
    sketch.axis(origin, _X, 0, "x_{i-1}")
    sketch.axis(second, z_after, 2, "z_{i}")
    sketch.axis(second, x_after, 0, "x_{i}")
    sketch.arc(second, _X, z_after, _THETA, r"\theta_{i}")
    sketch.arc(foot, _Z, _X, _ALPHA, r"\alpha_{i-1}")
    sketch.length(origin, foot, 18.0, "a_{i-1}")


@dataclass
class _Sketch:
    """Puts parts in space on a paper."""

    @cached_property
    def paper(self) -> Paper:
        return Paper()

    @cached_property
    def view(self) -> View:
        return View(math.radians(-58), math.radians(24))

    def flat(self, point: Array) -> Point:
        x, y, _ = self.view.project(point)
        return float(x), float(y)

    def joint(self, center: Array, axis: Array) -> None:
        """A revolute joint."""
        for path in paint(list(prism(center - 13 * axis, center + 13 * axis, 10.0, REVOLUTE, sides=28)), self.view):
            self.paper.draw(path, weight=0.2)

    def dashes(self, start: Array, end: Array) -> None:
        """An axis, or a direction carried over from elsewhere."""
        self.paper.draw(Path((self.flat(start), self.flat(end)), stroke=_GREY, width=0.5, dashed=True), weight=0.7)

    def line(self, start: Array, end: Array) -> None:
        """The common normal."""
        self.paper.draw(Path((self.flat(start), self.flat(end)), width=1.1))

    def axis(self, origin: Array, direction: Array, letter: int, latex: str) -> None:
        """An axis of a frame with its name."""
        start, tip = self.flat(origin), self.flat(origin + _AXIS * direction)
        for path in arrow_paths(start, tip, AXIS_COLORS[letter], 1.3):
            self.paper.draw(path)
        self.paper.label(latex, around(tip, (tip[0] - start[0], tip[1] - start[1]), 10.0), AXIS_COLORS[letter])

    def arc(self, center: Array, start: Array, axis: Array, angle: float, latex: str) -> None:
        """An angle about an axis, with its arrow and its name."""
        points = [self.flat(center + _ARC * _turned(start, axis, angle * k / 24)) for k in range(25)]
        self.paper.draw(Path(tuple(points[:-2]), width=0.8))
        for path in arrow_paths(points[-6], points[-1], (0.0, 0.0, 0.0), 0.8):
            if path.closed:
                self.paper.draw(path)
        middle, heart = points[12], self.flat(center)
        self.paper.label(latex, around(middle, (middle[0] - heart[0], middle[1] - heart[1]), 9.0))

    def beside(self, start: Array, end: Array, latex: str) -> None:
        """The name of a part of a line, to its left."""
        a, b = self.flat(start), self.flat(end)
        across = (-(b[1] - a[1]), b[0] - a[0])
        self.paper.label(latex, around(((a[0] + b[0]) / 2, (a[1] + b[1]) / 2), across, 9.0))

    def length(self, start: Array, end: Array, offset: float, latex: str) -> None:
        """A length beside what it measures."""
        a, b = self.flat(start), self.flat(end)
        size = math.hypot(b[0] - a[0], b[1] - a[1])
        nx, ny = -(b[1] - a[1]) / size * -offset, (b[0] - a[0]) / size * -offset
        c, d = (a[0] + nx, a[1] + ny), (b[0] + nx, b[1] + ny)
        for near, far in ((a, c), (b, d)):
            self.paper.draw(Path((near, far), stroke=DIMENSION, width=0.3), weight=0.4)
        for path in arrow_paths(c, d, DIMENSION, 0.5, both=True):
            self.paper.draw(path)
        self.paper.label(latex, around(((c[0] + d[0]) / 2, (c[1] + d[1]) / 2), (nx, ny), 9.0))


def _turned(vector: Array, axis: Array, angle: float) -> Array:
    """A vector turned about a unit axis (Rodrigues)."""
    along = axis * (axis @ vector)
    turned: Array = along + math.cos(angle) * (vector - along) + math.sin(angle) * np.cross(axis, vector)
    return turned
