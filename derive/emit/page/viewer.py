"""The robot as a figure that the reader moves: a slider per joint, the frames, and the pose of the end effector.

The pose and the frames come from the JavaScript of the robot's own tapes; three.js, inlined, draws them.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from derive.algebra.program import Program
from derive.emit.escape import html_text
from derive.emit.handout.text import Text
from derive.emit.javascript_target import javascript_body
from derive.emit.latex.notation import Notation
from derive.emit.page.html_symbol import html_symbol
from derive.emit.page.travel import Travel, base_pose, symbol_values, travels, upwards
from derive.emit.templating import render
from derive.robot.evaluate import evaluate
from derive.robot.robot import Convention, Robot

FUNCTIONS = ("forward_kinematics", "link_transforms")
"""What the figure needs of a robot's program."""


@dataclass(frozen=True, slots=True)
class Viewer:
    """The figure, in the three languages of a page.

    Attributes:
        html: An element.
        css: Its style sheet; uses the page's colours where there are any.
        script: A classic script, to run after the element; holds no end of a script element.
    """

    html: str
    css: str
    script: str


@dataclass(frozen=True, slots=True)
class _Row:
    """One slider: texts for the template, numbers in degrees or metres."""

    place: int
    label: str
    name: str
    unit: str
    lower: str
    upper: str
    start: str


def viewer(
    robot: Robot,
    program: Program,
    values: Mapping[str, float],
    text: Text,
    *,
    start: Sequence[float] | None = None,
    notation: Notation | None = None,
) -> Viewer:
    """The figure of a robot.

    Args:
        robot: The robot.
        program: Its functions as tapes.
        values: Numbers to draw for symbols that have none [m, rad]; 1 for those that are missing here, too.
        text: Translates messages.
        start: Configuration at first [rad, m]; None for the robot's figure configuration, else zero, prismatic joints
            half way out.
        notation: How symbols are written; None for the robot file's way.
    """
    numbers = symbol_values(robot, program.parameters, values)
    rows = travels(robot, numbers, start)
    written = notation or Notation.of(robot, robot.handout.notation)
    return Viewer(
        html=render("page/viewer/viewer.html.jinja", **_content(rows, written, robot, values, text)),
        css=render("page/viewer/viewer.css.jinja"),
        script="\n".join((three(), _script(robot, program, numbers, rows))),
    )


@cache
def three() -> str:
    """What the figure uses of three.js, as a script that defines the global ``deriveThree``."""
    return files("derive").joinpath("assets/three/three.bundle.min.js").read_text(encoding="utf-8").rstrip()


def _script(robot: Robot, program: Program, numbers: Mapping[str, float], rows: Sequence[Travel]) -> str:
    needed = Program(tuple(program[name] for name in FUNCTIONS), program.parameters)
    return render(
        "page/viewer.js.jinja",
        model=javascript_body(robot, needed),
        configuration=_json(_configuration(robot, program.parameters, numbers, rows)),
    )


def _configuration(
    robot: Robot, parameters: Sequence[str], numbers: Mapping[str, float], rows: Sequence[Travel]
) -> dict[str, object]:
    """What the script knows of the robot."""
    return {
        "modified": robot.convention is Convention.MODIFIED,
        "joints": [
            {
                "revolute": joint.is_revolute,
                "a": evaluate(joint.a, numbers),
                "lower": row.lower,
                "upper": row.upper,
                "start": row.start,
            }
            for joint, row in zip(robot.joints, rows, strict=True)
        ],
        "params": {name: numbers[name] for name in parameters},
        "base": base_pose(robot, numbers),
        "up": upwards(robot, numbers),
    }


def _json(value: object) -> str:
    """JSON that is inert in a script element."""
    return json.dumps(value, allow_nan=False).replace("<", "\\u003c")


def _content(
    rows: Sequence[Travel], notation: Notation, robot: Robot, values: Mapping[str, float], text: Text
) -> dict[str, object]:
    """What the element's template asks for."""
    names = [joint.variable for joint in robot.joints]
    return {
        "rows": [
            _row(place, name, _symbol(name, notation), travel)
            for place, (name, travel) in enumerate(zip(names, rows, strict=True))
        ],
        "words": {name: html_text(word) for name, word in _words(text).items()},
        "assumed": _assumed(values, notation, text),
        "entries": range(4),
    }


def _symbol(name: str, notation: Notation) -> str:
    return html_symbol(notation.glyph(name).box.tex)


def _row(place: int, name: str, label: str, travel: Travel) -> _Row:
    lower, upper, start = (f"{travel.shown(value):.12g}" for value in (travel.lower, travel.upper, travel.start))
    return _Row(place, label, html_text(name), "deg" if travel.revolute else "m", lower, upper, start)


def _assumed(values: Mapping[str, float], notation: Notation, text: Text) -> str:
    """States what is drawn for symbols without a number, as HTML; empty if there are none."""
    if not values:
        return ""
    pairs = ", ".join(f"{_symbol(name, notation)} = {value:.4g}" for name, value in values.items())
    message = text("Symbols without a number are drawn with %(values)s (metres, radians).", values="@values@")
    return html_text(message).replace("@values@", pairs)


def _words(_: Text) -> dict[str, str]:
    """Every text of the figure."""
    return {
        "canvas": _("The robot in three dimensions, in the configuration of the sliders"),
        "hint": _("Drag to turn, right button to shift; click, then scroll to zoom. Arrow keys, + and - work too."),
        "missing": _("This browser cannot draw in three dimensions (WebGL); sliders and pose work all the same."),
        "joints": _("Joint variables"),
        "exact": _("value"),
        "reset": _("Reset joints"),
        "view": _("Reset view"),
        "frames": _("Frames"),
        "labels": _("Labels"),
        "pose": _("Pose of the end effector"),
        "matrix": _("Homogeneous transform in the world frame"),
        "position": _("Position"),
        "angles": _("Roll, pitch, yaw"),
        "legend": _("Axes x red, y green, z blue."),
    }
