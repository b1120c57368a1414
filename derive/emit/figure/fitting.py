"""Bounds of items on the page, and drawings whose canvas starts at the origin."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from derive.emit.figure.drawing import Drawing, Item, Label, Path, Point
from derive.emit.figure.label_text import LABEL_HEIGHT, label_width


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
