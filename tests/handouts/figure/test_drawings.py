"""Drawings: where things stand, what they are called, that any robot can be drawn, and how they are written."""

import math
import random
from dataclasses import replace
from fractions import Fraction
from pathlib import Path as File
from xml.etree import ElementTree

import numpy as np
import pytest

from derive.handouts.figure.arm import HEIGHT, WIDTH, arm_drawing, arm_view, branches_drawing
from derive.handouts.figure.drawing import LABEL_HEIGHT, Drawing, Label, LabelRun, Path, label_runs, label_width
from derive.handouts.figure.paper import AXIS_COLORS, Paper, around
from derive.handouts.figure.scene import arm_scene
from derive.handouts.figure.workspace_plot import workspace_bytes
from derive.handouts.figure.writers import drawing_bytes, latex_drawing, svg_drawing
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import DataPrinter
from derive.handouts.parts.figure import convention_drawing
from derive.handouts.parts.plan import COLORS, Panel, Panels
from derive.handouts.sheet.latex_writer import latex_template
from derive.robot.description import Convention
from derive.robot.expression import Number
from derive.robot.names import free_symbols
from derive.robot.options.handout import FigureOptions
from derive.robot.robot import Robot
from derive.verification.oracle.frames import chain_frames, forward_kinematics, numeric_arm
from derive.workspace.poses import RobotPoses
from derive.workspace.views import find_workspace
from tests.handouts.latex_runner import overfull, run_latex
from tests.random_robots import chains, robot_text
from tests.rows import robot_of_rows


def drawn(robot: Robot | str, q: list[float] | None = None, title: str = "an arm") -> Drawing:
    robot = Robot.load(robot) if isinstance(robot, str) else robot
    poses, printer = RobotPoses(robot), DataPrinter(robot, Notation.of(robot, robot.handout.notation))
    return arm_drawing(robot, printer, poses.frames(q or poses.zero), title)


def _labels(drawing: Drawing) -> set[str]:
    return {part for item in drawing.items if isinstance(item, Label) for part in item.latex.split(",")}


@pytest.mark.parametrize("name", ["scara-perugia", "puma560-corke", "stanford-deluca", "dh-modified-deluca"])
def test_poses_are_the_frames_of_the_independent_recursion(name: str) -> None:
    robot = Robot.load(name)
    poses = RobotPoses(robot)
    q = np.linspace(0.3, 0.9, robot.n)
    unknown = dict.fromkeys(free_symbols(robot), 1.0)
    arm = numeric_arm(robot, unknown | {name: value for name, value, _ in poses.assumed})
    frames = np.array(poses.frames(q.tolist()))
    np.testing.assert_allclose(frames[:-1], arm.base @ chain_frames(arm, q), atol=1e-12)
    np.testing.assert_allclose(frames[-1], forward_kinematics(arm, q), atol=1e-12)


@pytest.mark.parametrize("name", ["scara-perugia", "puma560-corke", "spherical-arm", "dh-modified-deluca"])
def test_axes_start_at_the_projected_origins_of_the_frames(name: str) -> None:
    robot = Robot.load(name)
    poses = RobotPoses(robot)
    q = [0.4] * robot.n
    frames = np.array(poses.frames(q))
    view = arm_view(arm_scene(robot, frames))
    expected = view.project(frames[: robot.n + 1, :3, 3])[:, :2]
    starts = np.array(
        [i.points[0] for i in drawn(robot, q).items if isinstance(i, Path) and i.stroke in AXIS_COLORS and not i.fill]
    )
    spread = np.ptp(starts, axis=0)
    scale = float(spread.max() / np.ptp(expected, axis=0)[int(spread.argmax())])
    placed = (expected - expected.min(axis=0)) * scale + starts.min(axis=0)
    for point in placed:
        assert np.abs(starts - point).max(axis=1).min() < 0.05


@pytest.mark.parametrize("name", ["scara-perugia", "puma560-corke", "planar-2r-perugia", "human-body"])
def test_every_frame_has_its_x_and_z_named(name: str) -> None:
    labels = _labels(drawn(name))
    for index in range(Robot.load(name).n + 1):
        assert {f"x_{{{index}}}", f"z_{{{index}}}"} <= labels


def test_lengths_are_named_where_they_are_not_zero() -> None:
    assert {"a_{1}", "a_{2}", "d_{4}"} <= _labels(drawn("scara-perugia"))
    assert {"a_{2}", "a_{3}", "d_{3}", "d_{4}"} <= _labels(drawn("puma560-corke"))
    assert "a_{3}" not in _labels(drawn("scara-perugia"))


@pytest.mark.first(2)
@pytest.mark.slow
@pytest.mark.parametrize("key", [*chains(), *range(20)])
def test_every_robot_is_drawn_inside_its_canvas(key: str | int) -> None:
    robot = Robot.load(key) if isinstance(key, str) else Robot.from_text(robot_text(random.Random(key), 1 + key % 7))
    rng = random.Random(robot.n)
    for q in (None, [rng.uniform(-1.5, 1.5) for _ in robot.joints]):
        drawing = drawn(robot, q)
        points = np.array([p for i in drawing.items for p in (i.points if isinstance(i, Path) else (i.at,))])
        assert np.isfinite(points).all()
        assert 0 < drawing.width <= WIDTH
        assert 0 < drawing.height <= HEIGHT
        assert points.min() >= 0
        assert (points.max(axis=0) <= (drawing.width, drawing.height)).all()


def test_numbers_of_the_figure_are_used_and_the_others_are_stated() -> None:
    robot = Robot.load("planar-2r-perugia")
    q = (Number(Fraction(1, 2)), Number(Fraction(1)))
    chosen = replace(robot, figure=FigureOptions(q=q, values=(("a1", Number(Fraction(1, 4))),)))
    poses = RobotPoses(chosen)
    assert poses.configuration == (0.5, 1.0)
    assert [name for name, _, _ in poses.assumed] == ["a2"]
    assert poses.frames(poses.zero)[1][0][3] == 0.25
    assert RobotPoses(robot).configuration is None


WIDE = "z_{2},z_{3},z_{5}"


@pytest.mark.parametrize("degrees", range(0, 360, 45))
def test_a_wide_label_does_not_cover_the_tip_that_it_names(degrees: int) -> None:
    direction = (math.cos(math.radians(degrees)), math.sin(math.radians(degrees)))
    width = label_width(WIDE)
    x, y = around((0.0, 0.0), direction, 6.5, width)[0]
    assert abs(x) >= width / 2 or abs(y) >= LABEL_HEIGHT / 2


def test_a_label_leaves_a_line_for_a_free_place() -> None:
    paper = Paper()
    paper.draw(Path(((0.0, 0.0), (0.0, 60.0))))
    paper.label(WIDE, around((0.0, 30.0), (0.0, 1.0), 6.5, label_width(WIDE)))
    label = paper.items[-1]
    assert isinstance(label, Label)
    assert abs(label.at[0]) >= label_width(WIDE) / 2


@pytest.mark.parametrize("name", ["stanford-deluca", "scara-perugia", "puma560-corke", "kuka-lwr4"])
def test_names_of_dense_wrists_do_not_cover_each_other(name: str) -> None:
    labels = [item for item in drawn(name).items if isinstance(item, Label)]
    for k, one in enumerate(labels):
        for other in labels[:k]:
            beside = abs(one.at[0] - other.at[0]) - (label_width(one.latex) + label_width(other.latex)) / 2
            above = abs(one.at[1] - other.at[1]) - LABEL_HEIGHT
            assert max(beside, above) >= -1.5, f"{one.latex} and {other.latex}"


NAMES = ("scara-perugia", "puma560-corke", "human-body", "spherical-arm")


def test_latex_needs_no_package_fits_the_page_and_has_short_lines(tmp_path: File) -> None:
    drawings = [*map(drawn, NAMES), *map(convention_drawing, Convention)]
    body = "\n\n".join(rf"\noindent {latex_drawing(drawing)}" for drawing in drawings)
    definitions = latex_template("drawings.tex.jinja").render()
    head = f"\\documentclass{{article}}\n{definitions}\\setlength{{\\textwidth}}{{{WIDTH}pt}}\n"
    document = f"{head}\\begin{{document}}\n{body}\n\\end{{document}}\n"
    log = run_latex(document, tmp_path)
    assert log.pages, log.faults
    assert overfull(log) == 0.0
    assert max(map(len, latex_drawing(drawn("human-body")).splitlines())) < 900


def test_lengths_that_are_fractions_or_roots_are_drawn_as_the_symbols_of_their_cells() -> None:
    """Matplotlib sets no small fraction."""
    pytest.importorskip("matplotlib")
    drawing = drawn(robot_of_rows("R a: 1/7, d: 2/3 | R a: sqrt(2)/3"))
    assert {"a_{1}", "d_{1}", "a_{2}"} <= _labels(drawing)
    assert drawing_bytes(drawing, ".svg").startswith(b"<?xml")


def test_svg_is_well_formed_titled_whatever_the_title_holds_and_holds_every_item() -> None:
    root = ElementTree.fromstring(svg_drawing(drawn("scara-perugia", title="a < b & \"c\" \x00 'd'")))
    title = root.find("{http://www.w3.org/2000/svg}title")
    assert title.text == "a < b & \"c\"   'd'"
    assert root.get("role") == "img"
    drawing = drawn("puma560-corke")
    root = ElementTree.fromstring(svg_drawing(drawing))
    kinds = [child.tag.rpartition("}")[2] for child in root]
    assert kinds.count("path") == sum(isinstance(item, Path) for item in drawing.items)
    assert kinds.count("text") == sum(isinstance(item, Label) for item in drawing.items)
    svg = svg_drawing(Drawing(10, 10, (Path(((0.0, 0.0), (5.0, 5.0))), Label((5.0, 5.0), "a_{1}"))))
    assert svg.count('"currentColor"') == 2


@pytest.mark.parametrize("convention", list(Convention))
def test_convention_shows_its_four_parameters(convention: Convention) -> None:
    index = "i" if convention is Convention.STANDARD else "i-1"
    assert _labels(convention_drawing(convention)) == {
        *(f"{axis}_{{{i}}}" for axis in "xz" for i in ("i-1", "i")),
        f"a_{{{index}}}",
        f"\\alpha_{{{index}}}",
        "d_{i}",
        r"\theta_{i}",
    }


def test_labels_are_read_as_runs() -> None:
    assert label_runs("a_{12}") == (LabelRun("a"), LabelRun("12", "upright", -1))
    assert label_runs(r"\vartheta _{1}") == (LabelRun("\N{GREEK THETA SYMBOL}"), LabelRun("1", "upright", -1))
    assert "".join(run.text for run in label_runs(r"-0.5\,\mathrm{m}")) == "\N{MINUS SIGN}0.5\N{THIN SPACE}m"
    assert label_width("x_{0},x_{1}") > label_width("x_{0}") > 0


@pytest.mark.filterwarnings("error")
def test_a_workspace_of_one_point_is_plotted_without_a_warning() -> None:
    pytest.importorskip("shapely")
    pytest.importorskip("matplotlib")
    found = find_workspace(RobotPoses(Robot.load("dh-modified-deluca")))
    assert all(view.reachable.region.is_empty for view in found.views)
    assert workspace_bytes(found.views, ".svg", "a point").startswith(b"<?xml")


PLANAR_ARM = Robot.load("planar-2r-perugia")


def branches(*configurations: tuple[float, float]) -> Drawing | None:
    poses = RobotPoses(PLANAR_ARM)
    names = [str(k) for k in range(1, len(configurations) + 1)]
    return branches_drawing(PLANAR_ARM, [poses.frames(q) for q in configurations], names, "two elbows")


def arms(drawing: Drawing | None) -> list[Path]:
    return [item for item in drawing.items if isinstance(item, Path) and item.width == 1.5]


def test_a_planar_arm_is_seen_from_above_and_both_elbows_end_at_one_point() -> None:
    up, down = arms(branches((0.2, 0.9), (1.1, -0.9)))
    scale = math.dist(up.points[0], up.points[1])
    assert math.dist(down.points[0], down.points[1]) == pytest.approx(scale, rel=1e-2)  # nothing is foreshortened
    angle = math.atan2(up.points[1][1] - up.points[0][1], up.points[1][0] - up.points[0][0])
    assert angle == pytest.approx(0.2, abs=1e-2)


def test_configurations_that_cover_each_other_are_one_line_and_an_arm_that_always_looks_the_same_is_none() -> None:
    drawing = branches((0.2, 0.9), (1.1, -0.9), (0.2, 0.9))
    assert len(arms(drawing)) == 2
    assert [item.latex for item in drawing.items if isinstance(item, Label)] == ["1,3", "2"]
    assert branches((0.2, 0.9), (0.2, 0.9)) is None


def test_many_lines_are_two_drawings_side_by_side_in_the_order_of_the_numbers() -> None:
    few, many = (arms(branches(*((0.4 * k, 0.9) for k in range(count)))) for count in (4, 6))
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
    drawing = panels((("q", curves), ("d", curves[:1])), (("v", curves), ("w", curves))).drawing("two")
    points = np.array([point for item in drawing.items if isinstance(item, Path) for point in item.points])
    assert (points >= 0).all()
    assert (points <= (drawing.width, drawing.height)).all()
    long = [item.stroke for item in drawing.items if isinstance(item, Path) and len(item.points) == TIMES.size]
    assert long == [COLORS[0], COLORS[1], COLORS[0], COLORS[0], COLORS[1], COLORS[0], COLORS[1]]


def test_numbers_at_the_axes_are_round_and_a_curve_that_stands_has_room() -> None:
    drawing = panels((("q", ((0, np.full(31, 2.0)),)),)).drawing("one")
    labels = [item.latex for item in drawing.items if isinstance(item, Label)]
    assert labels[:3] == ["1", "2", "3"]
    assert labels[-2:] == ["q_1", "q_2"]
    assert labels[4:11] == ["0", "0.5", "1", "1.5", "2", "2.5", "3"]
