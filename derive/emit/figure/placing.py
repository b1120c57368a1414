"""Where labels stand: near what they name, off lines and off each other."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from derive.emit.figure.drawing import Color, Item, Label, Path, Point
from derive.emit.figure.label_text import LABEL_HEIGHT, label_width

Array = npt.NDArray[np.float64]

_STEP = 2.5
_LABEL_COST = 14.0


class Paper:
    """A page on which items and labels are put; it knows what is taken."""

    def __init__(self) -> None:
        self.items: list[Item] = []
        self._ink: list[Array] = []
        self._boxes: list[tuple[float, float, float, float]] = []

    def line(self, points: Sequence[Point], weight: float = 1.0) -> None:
        """Marks a line as taken."""
        for start, end in pairwise(points):
            a, b = np.array(start), np.array(end)
            count = max(2, int(np.hypot(*(b - a)) / _STEP) + 1)
            part = np.linspace(0.0, 1.0, count)[:, None]
            self._ink.append(np.hstack([a + (b - a) * part, np.full((count, 1), weight)]))

    def draw(self, path: Path, weight: float = 1.0) -> None:
        """Puts a path on top and marks it."""
        self.items.append(path)
        self.line((*path.points, path.points[0]) if path.closed else path.points, weight)

    def crossing(self, start: Point, end: Point) -> float:
        """How much a line would run over what is there."""
        a, b = np.array(start), np.array(end)
        count = max(2, int(np.hypot(*(b - a)) / _STEP) + 1)
        samples = a + (b - a) * np.linspace(0.0, 1.0, count)[:, None]
        ink = self._all_ink()
        near = np.abs(samples[:, None, :] - ink[None, :, :2]).max(axis=2) < 4.0
        over = sum(_overlap((x - 1, y - 1, x + 1, y + 1), box) for x, y in samples for box in self._boxes)
        return float((near * ink[:, 2]).max(axis=1, initial=0.0).sum()) + 3.0 * over

    def label(self, latex: str, candidates: Iterable[Point], color: Color = (0.0, 0.0, 0.0)) -> None:
        """Puts a label at the best of its candidates; the first ones are liked better."""
        size = (label_width(latex) / 2 + 1.0, LABEL_HEIGHT / 2 + 0.5)
        places = list(candidates)
        costs = [self.cost(place, size) + 0.15 * rank for rank, place in enumerate(places)]
        x, y = places[int(np.argmin(np.round(costs, 6)))]
        self._boxes.append((x - size[0], y - size[1], x + size[0], y + size[1]))
        self.items.append(Label((x, y), latex, color=color))

    def cost(self, place: Point, size: tuple[float, float]) -> float:
        """How much a label of half size ``size`` would cover."""
        (x, y), (w, h) = place, size
        box = (x - w, y - h, x + w, y + h)
        over = sum(_overlap(box, other) for other in self._boxes)
        ink = self._all_ink()
        inside = (np.abs(ink[:, 0] - x) < w + 0.5) & (np.abs(ink[:, 1] - y) < h + 0.5)
        return _LABEL_COST * over / 10.0 + float(ink[inside, 2].sum())

    def _all_ink(self) -> Array:
        if len(self._ink) > 1:
            self._ink = [np.concatenate(self._ink)]
        return self._ink[0] if self._ink else np.zeros((0, 3))


def _overlap(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> float:
    """Area that two boxes share."""
    width = min(a[2], b[2]) - max(a[0], b[0])
    height = min(a[3], b[3]) - max(a[1], b[1])
    return width * height if width > 0 and height > 0 else 0.0


def around(place: Point, direction: Point, reach: float) -> list[Point]:
    """Candidates beyond the tip of an arrow, then beside it, then farther away."""
    size = float(np.hypot(*direction))
    dx, dy = (direction[0] / size, direction[1] / size) if size > 1e-9 else (0.0, 1.0)
    found = []
    for far in (reach, 1.5 * reach, 2.2 * reach):
        for along, across in ((1.0, 0.0), (0.6, 0.8), (0.6, -0.8), (0.0, 1.0), (0.0, -1.0), (-0.6, 0.8), (-0.6, -0.8)):
            x, y = along * dx - across * dy, along * dy + across * dx
            found.append((place[0] + far * x, place[1] + far * y))
    return found
