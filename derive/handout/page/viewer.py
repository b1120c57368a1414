"""The robot as a figure that the reader moves: a slider per joint, the frames, and the pose of the end effector.

The pose and the frames come from the JavaScript of the robot's own tapes; three.js, inlined, draws them.

Numbers that the figure needs: where each joint can go and starts, where the base stands, and where up is.

The LaTeX of a symbol as HTML: for controls and captions, where a whole formula would be too much.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from derive.handout.figure.drawing import Run, label_runs
from derive.handout.language import Text
from derive.handout.notation.notation import Notation
from derive.programs.program import Program
from derive.robot.description import Convention, Joint
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, names
from derive.robot.names import number_of
from derive.robot.robot import Robot
from derive.targets.escape import html_text
from derive.targets.javascript import javascript_body
from derive.targets.templating import render

_FALLBACK = 1.0
"""Drawn for a symbol of which nothing is known."""


@dataclass(frozen=True, slots=True)
class Travel:
    """The way of a joint.

    Attributes:
        revolute: Whether it turns.
        lower: Lowest value [rad or m].
        upper: Highest value [rad or m].
        start: Value at first [rad or m].
    """

    revolute: bool
    lower: float
    upper: float
    start: float

    def shown(self, value: float) -> float:
        """A value in the unit of the slider: degrees or metres."""
        return math.degrees(value) if self.revolute else value


def symbol_values(robot: Robot, parameters: Sequence[str], values: Mapping[str, float]) -> dict[str, float]:
    """A number for every symbol: the caller's, else the robot file's, else 1."""
    known = {name: evaluate(number, {}) for name, number in number_of(robot).items()}
    return dict.fromkeys((*_kinematic_names(robot), *parameters), _FALLBACK) | known | dict(values)


def travels(robot: Robot, numbers: Mapping[str, float], start: Sequence[float] | None) -> tuple[Travel, ...]:
    """The way of every joint: its limits where they are numbers in order, else a turn, or the longest link."""
    ranges = [_range(robot, joint, numbers) for joint in robot.joints]
    if start is None and robot.figure.q is not None:
        start = [evaluate(value, numbers) for value in robot.figure.q]
    return tuple(
        Travel(joint.is_revolute, low, high, _start(joint, low, high, None if start is None else start[i]))
        for i, (joint, (low, high)) in enumerate(zip(robot.joints, ranges, strict=True))
    )


def base_pose(robot: Robot, numbers: Mapping[str, float]) -> list[list[float]]:
    """The base frame in the world."""
    return [[evaluate(entry, numbers) for entry in row] for row in robot.base]


def upwards(robot: Robot, numbers: Mapping[str, float]) -> list[float]:
    """Against gravity; along z of the world where there is none."""
    pull = [evaluate(entry, numbers) for entry in robot.gravity or ()]
    size = math.hypot(*pull)
    return [-entry / size for entry in pull] if size > 0 else [0.0, 0.0, 1.0]


def _kinematic_names(robot: Robot) -> list[str]:
    cells = [cell for joint in robot.joints for cell in (joint.theta, joint.d, joint.a, joint.alpha)]
    cells += [cell for matrix in (robot.base, robot.tool) for row in matrix for cell in row]
    cells += [*(robot.gravity or ()), *(limit for joint in robot.joints for limit in joint.limits or ())]
    return [name for cell in cells for name in names(cell)]


def _range(robot: Robot, joint: Joint, numbers: Mapping[str, float]) -> tuple[float, float]:
    limits = joint.limits and _numbers(joint.limits, numbers)
    if limits and limits[0] < limits[1]:
        return limits
    return (-math.pi, math.pi) if joint.is_revolute else (0.0, _longest(robot, numbers))


def _numbers(limits: tuple[Expression, Expression], numbers: Mapping[str, float]) -> tuple[float, float] | None:
    try:
        return evaluate(limits[0], numbers), evaluate(limits[1], numbers)
    except ArithmeticError:
        return None


def _longest(robot: Robot, numbers: Mapping[str, float]) -> float:
    """The longest offset or link of the table [m]; 1 m if all are zero."""
    lengths = [abs(evaluate(cell, numbers)) for joint in robot.joints for cell in (joint.a, joint.d)]
    return float(f"{max(lengths) or 1.0:.2g}")


def _start(joint: Joint, low: float, high: float, wanted: float | None) -> float:
    if wanted is None:
        wanted = 0.0 if joint.is_revolute else (low + high) / 2
    return min(max(wanted, low), high)


_STYLES = {"italic": "i", "mono": "code"}
_SHIFTS = {-1: "sub", 1: "sup"}


def html_symbol(latex: str) -> str:
    r"""``\theta_{1}`` is an italic theta with index 1."""
    return "".join(_run(run) for run in label_runs(latex))


def _run(run: Run) -> str:
    body = html_text(run.text)
    for tag in (_STYLES.get(run.style), _SHIFTS.get(run.shift)):
        body = f"<{tag}>{body}</{tag}>" if tag else body
    return body


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
