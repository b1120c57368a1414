"""Panels of curves over time."""

import numpy as np
import pytest

from derive.handouts.figure.drawing import Label, Path
from derive.handouts.figure.panels import COLORS, Panel, Panels

TIMES = np.linspace(0, 3, 31)


def panels(*rows: tuple[Panel, ...]) -> Panels:
    return Panels(TIMES, rows, (1.0,), ("q_1", "q_2"), lambda x: f"{x:g}")


@pytest.mark.parametrize("scale", [1e-6, 1.0, 700.0])
def test_everything_lies_on_the_canvas_and_curves_have_their_colours(scale: float) -> None:
    curves = ((0, scale * np.sin(TIMES)), (1, scale * TIMES))
    drawing = panels((Panel("q", curves), Panel("d", curves[:1])), (Panel("v", curves), Panel("w", curves))).drawing(
        "two"
    )
    points = np.array([point for item in drawing.items if isinstance(item, Path) for point in item.points])
    assert (points >= 0).all()
    assert (points <= (drawing.width, drawing.height)).all()
    long = [item.stroke for item in drawing.items if isinstance(item, Path) and len(item.points) == TIMES.size]
    assert long == [COLORS[0], COLORS[1], COLORS[0], COLORS[0], COLORS[1], COLORS[0], COLORS[1]]


def test_numbers_at_the_axes_are_round_and_a_curve_that_stands_has_room() -> None:
    drawing = panels((Panel("q", ((0, np.full(31, 2.0)),)),)).drawing("one")
    labels = [item.latex for item in drawing.items if isinstance(item, Label)]
    assert labels[:3] == ["1", "2", "3"]
    assert labels[-2:] == ["q_1", "q_2"]
    assert labels[4:11] == ["0", "0.5", "1", "1.5", "2", "2.5", "3"]
