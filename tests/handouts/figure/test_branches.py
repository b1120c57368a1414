"""The drawing of an arm in several configurations over each other, and panels of curves over time."""

import math

import numpy as np
import pytest

from derive.handouts.figure.branches import branches_drawing
from derive.handouts.figure.drawing import Drawing, Label, Path
from derive.handouts.figure.panels import COLORS, Panel, Panels
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses

ARM = Robot.load("planar-2r-perugia")


def drawn(*configurations: tuple[float, float]) -> Drawing | None:
    poses = RobotPoses(ARM)
    names = [str(k) for k in range(1, len(configurations) + 1)]
    return branches_drawing(ARM, [poses.frames(q) for q in configurations], names, "two elbows")


def lines(drawing: Drawing | None) -> list[Path]:
    assert drawing is not None
    return [item for item in drawing.items if isinstance(item, Path) and item.width == 1.5]


def test_a_planar_arm_is_seen_from_above_and_both_elbows_end_at_one_point() -> None:
    up, down = lines(drawn((0.2, 0.9), (1.1, -0.9)))
    scale = math.dist(up.points[0], up.points[1])
    assert math.dist(down.points[0], down.points[1]) == pytest.approx(scale, rel=1e-2)  # nothing is foreshortened
    angle = math.atan2(up.points[1][1] - up.points[0][1], up.points[1][0] - up.points[0][0])
    assert angle == pytest.approx(0.2, abs=1e-2)


def test_configurations_that_cover_each_other_are_one_line_with_both_numbers() -> None:
    drawing = drawn((0.2, 0.9), (1.1, -0.9), (0.2, 0.9))
    assert len(lines(drawing)) == 2
    assert drawing is not None
    assert [item.latex for item in drawing.items if isinstance(item, Label)] == ["1,3", "2"]


def test_an_arm_that_looks_the_same_in_all_of_them_is_not_drawn() -> None:
    assert drawn((0.2, 0.9), (0.2, 0.9)) is None


def test_many_lines_are_two_drawings_side_by_side_in_the_order_of_the_numbers() -> None:
    few, many = (lines(drawn(*((0.4 * k, 0.9) for k in range(count)))) for count in (4, 6))
    assert len({line.points[0] for line in few}) == 1
    left, right = sorted({line.points[0] for line in many})
    assert [line.points[0] for line in many] == [left] * 3 + [right] * 3
    assert max(x for line in many[:3] for x, _ in line.points) < min(x for line in many[3:] for x, _ in line.points)
    assert [line.stroke for line in many[:3]] == [line.stroke for line in many[3:]]


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
