"""Curves over time: panels below each other with one axis of time, and beside each other where units differ."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from derive.arrays import Array
from derive.handouts.figure.drawing import Color, Drawing, Item, Label, Path, Point, label_width

HEIGHT = 74.0  # height of a panel [pt]
WIDTHS = {1: 330.0, 2: 185.0}  # width of a panel by the number of panels beside each other [pt]
# Room for numbers on the left of a panel, on its right, above and below all, and between two [pt].
LEFT, RIGHT, TOP, BOTTOM, GAP = 34.0, 8.0, 16.0, 46.0, 16.0
PALE: Color = (0.82, 0.82, 0.82)

# Of curves, told apart with colour-blind eyes and on grey paper.
COLORS: tuple[Color, ...] = (
    (0.11, 0.31, 0.61), (0.76, 0.34, 0.10), (0.18, 0.49, 0.26), (0.54, 0.23, 0.56), (0.66, 0.53, 0.10),
    (0.30, 0.33, 0.38), (0.69, 0.19, 0.29), (0.13, 0.50, 0.56),
)  # fmt: skip
STEPS = (1.0, 2.0, 5.0, 10.0)  # between numbers at an axis, times a power of ten


@dataclass(frozen=True, slots=True)
class Panel:
    """Some curves over time with one unit."""

    latex: str  # what they are, with the unit
    curves: tuple[tuple[int, Array], ...]  # numbers of their colours, and their values at the common times, (k,) each


@dataclass(frozen=True)
class Panels:
    """Panels with one axis of time."""

    times: Array  # at which all curves are known, (k,)
    rows: tuple[tuple[Panel, ...], ...]  # panels beside each other, row by row; as many in each
    corners: tuple[float, ...]  # times at which something begins, marked by dashed lines
    names: tuple[str, ...]  # LaTeX of what each colour means
    write: Callable[[float], str]  # writes a number as LaTeX

    def drawing(self, title: str) -> Drawing:
        """The drawing."""
        across = len(self.rows[0])
        width = across * (LEFT + WIDTHS[across] + RIGHT)
        height = TOP + len(self.rows) * (HEIGHT + GAP) + BOTTOM
        items: list[Item] = []
        for i, row in enumerate(self.rows):
            for k, panel in enumerate(row):
                corner = LEFT + k * (LEFT + WIDTHS[across] + RIGHT), height - TOP - (i + 1) * HEIGHT - i * GAP
                items += self._panel(panel, corner, WIDTHS[across], is_last=i == len(self.rows) - 1)
        lengths = [16.0 + label_width(name) + 14.0 for name in self.names]
        x = (width - sum(lengths) + 14.0) / 2  # what each colour means, in the middle below all
        for color, (name, length) in enumerate(zip(self.names, lengths, strict=True)):
            items.append(Path(((x, 6.0), (x + 12.0, 6.0)), stroke=COLORS[color % len(COLORS)], width=1.2))
            items.append(Label((x + 16.0, 6.0), name, (-1, 0)))
            x += length
        return Drawing(width, height, tuple(items), title)

    def _panel(self, panel: Panel, corner: Point, width: float, *, is_last: bool) -> Iterator[Item]:
        (x, y), start, end = corner, float(self.times[0]), float(self.times[-1])
        # The values with a rim of 6 % above and below; what is constant but for rounding has a panel of height 2.
        values = [row for _, row in panel.curves]
        low, high = min(float(row.min()) for row in values), max(float(row.max()) for row in values)
        if high - low < 1e-9 * max(abs(low), abs(high), 1e-3):
            low, high = low - 1.0, high + 1.0
        room = 0.06 * (high - low)
        low, high = low - room, high + room

        def _at(time: float, value: float) -> Point:
            return x + width * (time - start) / (end - start), y + HEIGHT * (value - low) / (high - low)

        for tick in _ticks(low, high, 4):
            yield Path((_at(start, tick), _at(end, tick)), stroke=PALE, width=0.3)
            yield Label((x - 3.0, _at(start, tick)[1]), self.write(tick), (1, 0))
        for time in self.corners:
            yield Path((_at(time, low), _at(time, high)), stroke=PALE, width=0.5, dashed=True)
        for color, row in panel.curves:
            points = tuple(_at(float(t), float(value)) for t, value in zip(self.times, row, strict=True))
            yield Path(points, stroke=COLORS[color % len(COLORS)], width=0.9)
        yield Path(((x, y + HEIGHT), (x, y), (x + width, y)), width=0.5)
        yield Label((x + 2.0, y + HEIGHT + 3.0), panel.latex, (-1, -1))
        if is_last:
            for tick in _ticks(start, end, 6):
                yield Path((_at(tick, low), (_at(tick, low)[0], y - 2.5)), width=0.4)
                yield Label((_at(tick, low)[0], y - 4.0), self.write(tick), (0, 1))
            yield Label((x + width / 2, y - 15.0), "t\\,[\\mathrm{s}]", (0, 1))


def _ticks(low: float, high: float, most: int) -> Sequence[float]:
    """Round numbers between two, so many at most."""
    # the smallest step 1, 2, 5 or 10 times a power of ten that gives no more numbers than there is room for
    least = (high - low) / most
    power = 10.0 ** math.floor(math.log10(least))
    step = next(step * power for step in STEPS if step * power >= least)
    first = math.ceil(low / step - 1e-9)
    return [float(np.round(k * step, 12)) for k in range(first, math.floor(high / step + 1e-9) + 1)]
