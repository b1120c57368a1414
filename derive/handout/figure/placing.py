"""Where labels stand: near what they name, off lines and off each other.

Bounds of items on the page, and drawings whose canvas starts at the origin.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from derive.handout.figure.drawing import Color, Drawing, Item, Label, Path, Point
from derive.handout.figure.label_text import LABEL_HEIGHT, label_width

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


def bounds(items: Iterable[Item]) -> tuple[float, float, float, float]:
    """Left, bottom, right and top of all that is drawn [pt]."""
    points = [point for item in items for point in _corners(item)]
    xs, ys = [x for x, _ in points], [y for _, y in points]
    return min(xs), min(ys), max(xs), max(ys)


def moved(items: Sequence[Item], margin: float, title: str) -> Drawing:
    """A drawing of the items, shifted so that they lie on its canvas."""
    left, bottom, right, top = bounds(items)
    dx, dy = margin - left, margin - bottom
    shifted = tuple(_mapped(item, 1.0, dx, dy) for item in items)
    return Drawing(round(right - left + 2 * margin, 2), round(top - bottom + 2 * margin, 2), shifted, title)


def resized(items: Sequence[Item], factor: float) -> list[Item]:
    """Items nearer to each other; letters keep their size."""
    return [_mapped(item, factor, 0.0, 0.0) for item in items]


def _corners(item: Item) -> Iterator[Point]:
    if isinstance(item, Path):
        yield from item.points
        return
    width, height = label_width(item.latex), LABEL_HEIGHT
    x = item.at[0] - width * (item.anchor[0] + 1) / 2
    y = item.at[1] - height * (item.anchor[1] + 1) / 2
    yield (x, y)
    yield (x + width, y + height)


def _mapped(item: Item, factor: float, dx: float, dy: float) -> Item:
    def place(point: Point) -> Point:
        return (round(factor * point[0] + dx, 2), round(factor * point[1] + dy, 2))

    if isinstance(item, Label):
        return replace(item, at=place(item.at))
    return replace(item, points=tuple(place(point) for point in item.points))
