"""Drawings on paper and on the screen."""

from pathlib import Path as File
from xml.etree import ElementTree

import pytest

from derive.handouts.figure.arm import WIDTH, arm_drawing
from derive.handouts.figure.convention import convention_drawing
from derive.handouts.figure.drawing import Drawing, Label, LabelRun, Path, label_runs, label_width
from derive.handouts.figure.writers import PREAMBLE, SUFFIXES, drawing_bytes, latex_drawing, svg_drawing
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import DataPrinter
from derive.robot.description import Convention
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses
from tests.handouts.latex_runner import overfull, run_latex

NAMES = ("scara-perugia", "puma560-corke", "human-body", "spherical-arm")


def _drawing(name: str, title: str = "an arm") -> Drawing:
    robot = Robot.load(name)
    poses = RobotPoses(robot)
    return arm_drawing(robot, DataPrinter(robot, Notation.of(robot)), poses.frames(poses.zero), title)


def test_latex_needs_no_package_and_fits_the_page(tmp_path: File) -> None:
    drawings = [*map(_drawing, NAMES), *map(convention_drawing, Convention)]
    body = "\n\n".join(rf"\noindent {latex_drawing(drawing)}" for drawing in drawings)
    head = f"\\documentclass{{article}}\n{PREAMBLE}\\setlength{{\\textwidth}}{{{WIDTH}pt}}\n"
    document = f"{head}\\begin{{document}}\n{body}\n\\end{{document}}\n"
    log = run_latex(document, tmp_path)
    assert log.status == 0, log.errors
    assert overfull(log) == 0.0


def test_lines_of_latex_are_short_enough_for_any_tex() -> None:
    assert max(map(len, latex_drawing(_drawing("human-body")).splitlines())) < 900


def test_lengths_that_are_fractions_or_roots_are_drawn_as_the_symbols_of_their_cells() -> None:
    """Matplotlib sets no small fraction."""
    pytest.importorskip("matplotlib")
    rows = "[{type: revolute, a: 1/7, d: 2/3}, {type: revolute, a: sqrt(2)/3}]"
    robot = Robot.from_text(f"name: sevenths\nconvention: standard\njoints: {rows}\n")
    poses = RobotPoses(robot)
    drawing = arm_drawing(robot, DataPrinter(robot, Notation.of(robot)), poses.frames(poses.zero), "an arm")
    labels = {item.latex for item in drawing.items if isinstance(item, Label)}
    assert {"a_{1}", "d_{1}", "a_{2}"} <= labels
    assert drawing_bytes(drawing, ".svg").startswith(b"<?xml")


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_same_drawing_same_bytes(suffix: str) -> None:
    pytest.importorskip("matplotlib")
    drawing = _drawing("scara-perugia")
    first = drawing_bytes(drawing, suffix)
    assert first == drawing_bytes(drawing, suffix)
    assert first.startswith({".pdf": b"%PDF", ".svg": b"<?xml", ".png": b"\x89PNG"}[suffix])


def test_svg_is_well_formed_and_titled_whatever_the_title_holds() -> None:
    root = ElementTree.fromstring(svg_drawing(_drawing("scara-perugia", "a < b & \"c\" \x00 'd'")))
    title = root.find("{http://www.w3.org/2000/svg}title")
    assert title is not None
    assert title.text == "a < b & \"c\"   'd'"
    assert root.get("role") == "img"


def test_svg_holds_every_item() -> None:
    drawing = _drawing("puma560-corke")
    root = ElementTree.fromstring(svg_drawing(drawing))
    kinds = [child.tag.rpartition("}")[2] for child in root]
    assert kinds.count("path") == sum(isinstance(item, Path) for item in drawing.items)
    assert kinds.count("text") == sum(isinstance(item, Label) for item in drawing.items)


def test_black_follows_the_text_of_the_page() -> None:
    svg = svg_drawing(Drawing(10, 10, (Path(((0.0, 0.0), (5.0, 5.0))), Label((5.0, 5.0), "a_{1}"))))
    assert svg.count('"currentColor"') == 2


@pytest.mark.parametrize("convention", list(Convention))
def test_convention_shows_its_four_parameters(convention: Convention) -> None:
    labels = {item.latex for item in convention_drawing(convention).items if isinstance(item, Label)}
    index = "i" if convention is Convention.STANDARD else "i-1"
    assert labels == {
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
