"""A paper on which items are put one by one; it finds room for labels, off lines and off other labels."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from derive.arrays import Array
from derive.handouts.figure.drawing import BLACK, LABEL_HEIGHT, Color, Drawing, Item, Label, Path, Point, label_width

AXIS_COLORS: tuple[Color, Color, Color] = ((0.78, 0.10, 0.10), (0.08, 0.50, 0.15), (0.10, 0.22, 0.78))  # of x, y and z
DIMENSION: Color = (0.35, 0.35, 0.35)  # of the lines and names of lengths
_STEP = 2.5  # distance of the points of a line that count as taken [pt]
_LABEL_COST = 14.0
LETTER_WIDTH = 9.0  # of a letter with its index [pt]
_Box = tuple[float, float, float, float]  # left, bottom, right and top [pt]


class Paper:
    """A page on which items and labels are put, from back to front; it knows what is taken."""

    def __init__(self) -> None:
        self.items: list[Item] = []
        self._ink: list[Array] = []
        self._boxes: list[_Box] = []

    def line(self, points: Sequence[Point], weight: float = 1.0) -> None:
        """Marks a line as taken without drawing it."""
        for start, end in pairwise(points):
            samples = _samples(start, end)
            self._ink.append(np.hstack([samples, np.full((len(samples), 1), weight)]))

    def draw(self, path: Path, weight: float = 1.0) -> None:
        """Puts a path on top and marks it as taken."""
        self.items.append(path)
        self.line((*path.points, path.points[0]) if path.closed else path.points, weight)

    def arrow(self, start: Point, tip: Point, color: Color, width: float, both: bool = False) -> None:
        """Draws a line with a filled head, or one at each end."""
        self.draw(Path((start, tip), stroke=color, width=width))
        if math.dist(start, tip) < 1.0:
            return
        self.draw(arrow_head(start, tip, color, width))
        if both:
            self.draw(arrow_head(tip, start, color, width))

    def crossing(self, start: Point, end: Point) -> float:
        """How much a line would run over what is there."""
        # Each point of the line costs the heaviest ink within 4 pt, and three times the labels that it lies on.
        samples, ink = _samples(start, end), self._all_ink()
        near = np.abs(samples[:, None, :] - ink[None, :, :2]).max(axis=2) < 4.0
        over = sum(_shared_area((x - 1, y - 1, x + 1, y + 1), box) for x, y in samples for box in self._boxes)
        return float((near * ink[:, 2]).max(axis=1, initial=0.0).sum()) + 3.0 * over

    def label(self, latex: str, candidates: Iterable[Point], color: Color = BLACK) -> None:
        """Puts a label at the best of its candidates; the first ones are liked better."""
        w, h = label_width(latex) / 2 + 1.0, LABEL_HEIGHT / 2 + 0.5
        # Half sizes of the box w, h; a place costs the labels it covers, the ink inside of it, and its rank.
        places = list(candidates)
        ink = self._all_ink()
        costs = []
        for rank, (x, y) in enumerate(places):
            over = sum(_shared_area((x - w, y - h, x + w, y + h), box) for box in self._boxes)
            inside = (np.abs(ink[:, 0] - x) < w + 0.5) & (np.abs(ink[:, 1] - y) < h + 0.5)
            costs.append(_LABEL_COST * over / 10.0 + float(ink[inside, 2].sum()) + 0.15 * rank)
        # rounded, so that the choice between equal costs is the same on every machine
        x, y = places[int(np.argmin(np.round(costs, 6)))]
        self._boxes.append((x - w, y - h, x + w, y + h))
        self.items.append(Label((x, y), latex, color=color))

    def _all_ink(self) -> Array:
        """Points that are taken, with their weights: (k, 3)."""
        if len(self._ink) > 1:
            self._ink = [np.concatenate(self._ink)]
        return self._ink[0] if self._ink else np.zeros((0, 3))


def arrow_head(start: Point, tip: Point, color: Color, width: float) -> Path:
    """The head of an arrow."""
    length = math.dist(start, tip)
    head = min(5.5 if width > 0.7 else 4.0, 0.6 * length)
    dx, dy = (tip[0] - start[0]) / length, (tip[1] - start[1]) / length
    back = (tip[0] - head * dx, tip[1] - head * dy)
    half = 0.36 * head
    corners = (tip, (back[0] - half * dy, back[1] + half * dx), (back[0] + half * dy, back[1] - half * dx))
    return Path(corners, closed=True, stroke=None, fill=color)


def around(place: Point, direction: Point, reach: float, width: float = 0.0) -> list[Point]:
    """Candidates for a label: beyond the tip of an arrow, then beside it, then farther away."""
    size = float(np.hypot(*direction))
    dx, dy = (direction[0] / size, direction[1] / size) if size > 1e-9 else (0.0, 1.0)
    found = []
    for far in (reach, 1.5 * reach, 2.2 * reach, 3.0 * reach):
        for along, across in ((1.0, 0.0), (0.6, 0.8), (0.6, -0.8), (0.0, 1.0), (0.0, -1.0), (-0.6, 0.8), (-0.6, -0.8)):
            # (along, across) in the axes of the direction; a wide label goes aside by its letters beyond the first
            x, y = along * dx - across * dy, along * dy + across * dx
            aside = max(0.0, width - LETTER_WIDTH) / 2 * min(1.0, max(-1.0, 1.5 * x))
            found.append((place[0] + far * x + aside, place[1] + far * y))
    return found


def bounds(items: Iterable[Item]) -> _Box:
    """Left, bottom, right and top of all that is drawn [pt]."""
    points: list[Point] = []
    for item in items:
        if isinstance(item, Path):
            points += item.points
            continue
        width, height = label_width(item.latex), LABEL_HEIGHT
        x = item.at[0] - width * (item.anchor[0] + 1) / 2
        y = item.at[1] - height * (item.anchor[1] + 1) / 2
        points += [(x, y), (x + width, y + height)]
    xs, ys = [x for x, _ in points], [y for _, y in points]
    return min(xs), min(ys), max(xs), max(ys)


def moved(items: Sequence[Item], margin: float, title: str) -> Drawing:
    """A drawing of items, shifted so that they lie on its canvas."""
    left, bottom, right, top = bounds(items)
    dx, dy = margin - left, margin - bottom
    shifted = tuple(_mapped(item, 1.0, dx, dy) for item in items)
    return Drawing(round(right - left + 2 * margin, 2), round(top - bottom + 2 * margin, 2), shifted, title)


def resized(items: Sequence[Item], factor: float) -> list[Item]:
    """Items nearer to each other; letters keep their size."""
    return [_mapped(item, factor, 0.0, 0.0) for item in items]


def _samples(start: Point, end: Point) -> Array:
    """Points of a line, (k, 2)."""
    a, b = np.array(start), np.array(end)
    count = max(2, int(np.hypot(*(b - a)) / _STEP) + 1)
    return np.asarray(a + (b - a) * np.linspace(0.0, 1.0, count)[:, None])


def _shared_area(a: _Box, b: _Box) -> float:
    width = min(a[2], b[2]) - max(a[0], b[0])
    height = min(a[3], b[3]) - max(a[1], b[1])
    return width * height if width > 0 and height > 0 else 0.0


def _mapped(item: Item, factor: float, dx: float, dy: float) -> Item:
    points = (item.at,) if isinstance(item, Label) else item.points
    placed = tuple((round(factor * x + dx, 2), round(factor * y + dy, 2)) for x, y in points)
    return replace(item, at=placed[0]) if isinstance(item, Label) else replace(item, points=placed)
