"""The robot as a figure that the reader moves: a slider per joint, the frames, and the pose of the end effector.

The pose and the frames come from the JavaScript of the robot's own tapes; three.js, inlined, draws them. What the
figure needs of the robot are numbers: where each joint can go and starts, where the base stands, and where up is.
"""

import json
import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from functools import cache
from importlib.resources import files

import numpy as np

from derive.arrays import Array
from derive.handouts.figure.drawing import label_runs
from derive.handouts.figure.projection import view_along
from derive.handouts.figure.scene import arm_scene, upwards
from derive.handouts.notation.notation import Notation
from derive.handouts.page.player import Playback, html_messages, player_texts
from derive.handouts.parts.inverse_words import branch_name
from derive.handouts.sheet.language import Text
from derive.inverse.closed.solve import solve
from derive.inverse.words.postures import postures
from derive.mechanics.chain import build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.forward_kinematics import jacobian
from derive.programs.program import Program
from derive.robot import tree
from derive.robot.description import BASE, Convention, FixedRow, Joint
from derive.robot.evaluate import evaluate
from derive.robot.names import file_symbols
from derive.robot.options.inverse import POSE, InverseOptions
from derive.robot.robot import Robot
from derive.targets.escape import html_text
from derive.targets.javascript import camel_case, javascript_body
from derive.targets.templating import render
from derive.workspace.poses import RobotPoses

FUNCTIONS = ("forward_kinematics", "link_transforms")  # what the figure needs of a robot's program
FUNCTIONS_OF_TREES = ("link_transforms",)  # and of a tree's, whose ends stand still in frames of rows
_SMALL = 1e-7  # singular values below it, of a matrix whose largest one is 1, are zero
_FALLBACK = 1.0  # drawn for a symbol of which nothing is known
_STYLES = {"italic": "i", "mono": "code"}
_SHIFTS = {-1: "sub", 1: "sup"}


@dataclass(frozen=True, slots=True)
class Travel:
    """The way of a joint."""

    revolute: bool  # whether it turns
    lower: float  # lowest value [rad or m]
    upper: float  # highest value [rad or m]
    start: float  # value at first [rad or m]

    def shown(self, value: float) -> float:
        """A value in the unit of the slider."""
        return math.degrees(value) if self.revolute else value


@dataclass(frozen=True, slots=True)
class Viewer:
    """The figure, in the three languages of a page."""

    html: str  # an element
    css: str  # its style sheet; uses the page's colours where there are any
    script: str  # a classic script, to run after the element; holds no end of a script element


@dataclass(frozen=True, slots=True)
class Dragging:
    """What of an arm's end effector is dragged."""

    task: InverseOptions  # what the inverse kinematics is asked for
    normal: tuple[float, float, float] | None  # the direction in which the target cannot go; None for none


def viewer(
    robot: Robot,
    program: Program,
    values: Mapping[str, float],
    text: Text,
    *,
    notation: Notation | None = None,  # how symbols are written; None for the robot file's way
    dragged: Dragging | None = None,  # how its end effector is dragged, by the inverse kinematics of the program
    playback: Playback | None = None,  # a motion that is played
    normal: Array | None = None,  # of the plane in which the arm moves, towards the viewer; None in space
) -> Viewer:
    """The figure of a robot, in which symbols without a number have one of ``values`` [m, rad], else 1."""
    numbers = symbol_values(robot, program.parameters, values)
    ways = travels(robot, numbers)
    if playback is not None:
        spans = zip(ways, playback.ranges, strict=True)
        ways = tuple(replace(way, lower=min(way.lower, a), upper=max(way.upper, b)) for way, (a, b) in spans)
    inverse = program.inverse if dragged else None
    functions = (*(FUNCTIONS_OF_TREES if robot.is_tree else FUNCTIONS), *(playback.functions if playback else ()))
    needed = Program(tuple(program[name] for name in functions), program.parameters, inverse)
    notation = notation or Notation.of(robot, robot.handout.notation)
    target = None
    if dragged is not None and inverse is not None:
        target = _target(dragged, postures(robot, solve(robot, dragged.task.task, inverse.given)).names, text, notation)
    script = render(
        "page/viewer.js.jinja",
        model=javascript_body(robot, needed),
        tree=robot.is_tree,
        loops=bool(robot.loops),
        configuration=_configuration(
            robot, program, numbers, ways, dragged if target else None, playback, normal, comma=text.comma
        ),
        target=target is not None,
        player=playback is not None,
        functions=tuple(map(camel_case, playback.functions)) if playback else (),
        base_torques=playback.base_torques if playback else (),
    )
    symbols = ((html_symbol(notation.glyph(name).box.tex), value) for name, value in values.items())
    rows = _rows(robot, notation, ways)
    html = render(
        "page/viewer/viewer.html.jinja",
        rows=rows,
        _=html_messages(text),
        assumed=text.listing(f"{symbol} = {text.number(f'{value:.4g}')}" for symbol, value in symbols),
        entries=range(4),
        ends=[end.name for end in robot.ends],
        has_ends=len(robot.ends) > 1,
        loops=bool(robot.loops),
        target=target,
        player=player_texts(playback, robot, rows, text) if playback else None,
    )
    css = render("page/viewer/viewer.css.jinja") + (render("page/player/player.css.jinja") if playback else "")
    return Viewer(html, css, f"{three()}\n{script}")


def symbol_values(robot: Robot, parameters: Sequence[str], values: Mapping[str, float]) -> dict[str, float]:
    """A number for every symbol [m, rad]: the caller's, else the robot file's, else 1."""
    symbols = file_symbols(replace(robot, links=(), fixed=tree.massless(robot.fixed)))
    known = {name: evaluate(number, {}) for name, number in robot.parameters}
    return dict.fromkeys((*symbols, *parameters), _FALLBACK) | known | dict(values)


def travels(robot: Robot, numbers: Mapping[str, float]) -> tuple[Travel, ...]:
    """The way of every joint: its limits where they are numbers in order, else a turn, or the longest link."""
    given = RobotPoses(robot).start_cells if robot.loops else robot.figure.q or (None,) * robot.dof
    lengths = [abs(evaluate(cell, numbers)) for joint in robot.joints for cell in (joint.a, joint.d)]
    longest = float(f"{max(lengths) or 1.0:.2g}")
    ways, rooted = [], robot.root.variables if robot.root else ()
    for joint, cell in zip(robot.variables, given, strict=True):
        low, high = (-math.pi, math.pi) if joint.is_revolute else (0.0, longest)
        low = -longest if joint.variable in rooted and not joint.is_revolute else low
        with suppress(ArithmeticError):  # limits that are no numbers do not count
            lower, upper = (evaluate(limit, numbers) for limit in joint.limits) if joint.limits else (low, high)
            low, high = (lower, upper) if lower < upper else (low, high)
        # It starts at the configuration of the figure, else at zero or half way out.
        wanted = 0.0 if joint.is_revolute and low <= 0.0 <= high else (low + high) / 2
        wanted = wanted if cell is None else evaluate(cell, numbers)
        ways.append(Travel(joint.is_revolute, low, high, min(max(wanted, low), high)))
    return tuple(ways)


@cache
def three() -> str:
    """What the figure uses of three.js, as a script that defines the global ``deriveThree``."""
    return files("derive").joinpath("assets/three/three.bundle.min.js").read_text(encoding="utf-8").rstrip()


def html_symbol(latex: str) -> str:
    r"""A symbol as HTML, where a whole formula would be too much: ``\theta_{1}`` is an italic theta with index 1."""
    parts = []
    for run in label_runs(latex):
        body = html_text(run.text)
        for tag in (_STYLES.get(run.style), _SHIFTS.get(run.shift)):
            body = f"<{tag}>{body}</{tag}>" if tag else body
        parts.append(body)
    return "".join(parts)


def _target(dragged: Dragging, names: Sequence[str], text: Text, notation: Notation) -> dict[str, object]:
    """Texts of the controls of the target: its coordinates, those that stay, and the branches."""
    across = (0.0, 0.0, 0.0) if dragged.normal is None else dragged.normal
    axes = [{"name": axis, "fixed": bool(abs(part) > 1.0 - 1e-9)} for axis, part in zip("xyz", across, strict=True)]
    plain = lambda tex: "".join(run.text for run in label_runs(tex)).strip()  # noqa: E731
    words = (html_text(branch_name(text, notation, name, plain)) for name in names)
    return {"axes": axes, "branches": [{"index": k, "name": word} for k, word in enumerate(words) if word]}


def _configuration(
    robot: Robot,
    program: Program,
    numbers: Mapping[str, float],
    ways: Sequence[Travel],
    dragged: Dragging | None,
    playback: Playback | None,
    normal: Array | None,
    *,
    comma: bool,
) -> str:
    """What the script knows of the robot, as JSON that is inert in a script element."""
    value: dict[str, object] = {
        "modified": robot.convention is Convention.MODIFIED,
        "joints": [
            {"revolute": way.revolute, **({} if robot.coupled else {"a": evaluate(joint.a, numbers)}), **asdict(way)}
            for joint, way in zip(robot.joints, ways, strict=not robot.coupled)
        ],
        "params": {name: numbers[name] for name in program.parameters},
        "base": [[evaluate(entry, numbers) for entry in row] for row in robot.base],
        "up": upwards(robot, numbers),
        "facing": None if normal is None else view_along(normal, upwards(robot, numbers)).rows[2].tolist(),
        "comma": comma,
    }
    if robot.is_tree:
        value |= _tree(robot, numbers)
    if dragged is not None and program.inverse is not None:
        lengths = [abs(evaluate(cell, numbers)) for joint in robot.joints for cell in (joint.a, joint.d)]
        step = float(f"{0.01 * (sum(lengths) or 1.0):.1g}")
        value["target"] = {"given": list(program.inverse.given), "normal": dragged.normal, "step": step}
    if playback is not None:
        value["playback"] = playback.configuration
    return json.dumps(value, allow_nan=False).replace("<", "\\u003c")


def _tree(robot: Robot, numbers: Mapping[str, float]) -> dict[str, object]:
    """The rows with what is constant before each, the ends with their poses in the frames of rows, and names."""
    poses = RobotPoses(robot)
    frames = np.array(poses.frames(poses.zero if robot.loops else (0.0,) * robot.dof))
    scene, labels, before = arm_scene(robot, frames.tolist()), tree.labels(robot), tree.antecedents(robot)
    moving = len(robot.root.variables) if robot.root else 0

    def _within(frame: Array, label: str) -> object:
        return np.round(np.linalg.solve(frames[labels.index(label)], frame), 12).tolist()

    rows: list[dict[str, object]] = []
    own: tuple[Joint | FixedRow, ...] = (*robot.joints, *robot.fixed)
    for k, row in enumerate(own):
        drawn: dict[str, object] = {"hidden": k < moving or row.label == BASE, "fixed": isinstance(row, FixedRow)}
        drawn |= {"revolute": isinstance(row, Joint) and row.is_revolute, "a": evaluate(row.a, numbers)}
        after = before.get(row.label, "")
        rows.append(drawn | {"before": labels.index(after), "begin": _within(frames[len(labels) + k], after)})
        if isinstance(row, FixedRow):
            joint = tree.way_to(robot, row.name).joint + 1
            rows[-1] |= {"joint": joint, "pose": _within(frames[k + 1], labels[joint])}
    ends = []
    for end, pose, hand in zip(tree.ends(robot), frames[-len(tree.ends(robot)) :], scene.hands, strict=True):
        across = np.cross(hand.approach, hand.opening)
        grip = np.vstack([np.column_stack([hand.opening, across, hand.approach, hand.end]), [0.0, 0.0, 0.0, 1.0]])
        at = {"row": labels.index(end.after), "ball": hand.is_fixed or hand.is_pin}
        ends.append(at | {"pose": _within(pose, end.after), "hand": _within(grip, end.after)})
    names = [str(i) if i <= robot.n else label for i, label in enumerate(labels)]
    names += [end.name or "e" for end in tree.ends(robot)]
    return {"rows": rows, "ends": ends, "names": names, "stands": robot.root is None}


def _rows(robot: Robot, notation: Notation, ways: Sequence[Travel]) -> list[dict[str, object]]:
    """Texts of the sliders, numbers in degrees or metres."""
    return [
        {
            "place": place,
            "label": html_symbol(notation.glyph(joint.variable).box.tex),
            "name": html_text(joint.variable),
            "unit": "deg" if way.revolute else "m",
            **{name: f"{way.shown(getattr(way, name)):.12g}" for name in ("lower", "upper", "start")},
        }
        for place, (joint, way) in enumerate(zip(robot.variables, ways, strict=True))
    ]


# -- the target that the reader drags: the position with the orientation kept where that moves, else the position alone


def dragging(robot: Robot, numbers: Mapping[str, float]) -> Dragging | None:
    """How an end effector can be dragged; None where it moves neither in a plane nor in space. Numbers in m and rad."""
    if robot.is_tree:  # its inverse kinematics are those of serial arms, which no generated function has
        return None
    # The Jacobian at five generic configurations: ranks that all of them agree on are those of the arm.
    columns = [_jacobian(robot, numbers, q) for q in np.random.default_rng(7).uniform(0.2, 1.3, (robot.n, 5)).T]
    linear = np.hstack([own[:3] for own in columns])
    if (directions := _rank(linear)) < 2:
        return None
    normal = None
    if directions < 3:  # what is normal to all columns, which lie in a plane; its largest component is positive
        across = np.linalg.svd(linear)[0][:, 2]
        sign = 1.0 if max(across, key=abs) > 0 else -1.0
        x, y, z = (0.0 if abs(part) < _SMALL else float(sign * part) for part in across)  # without what rounding left
        normal = x, y, z
    if robot.inverse != InverseOptions():
        if len(axes := [axis for axis in "xyz" if axis in robot.inverse.task]) < 2:
            return None
        missing = next((k for k, axis in enumerate("xyz") if axis not in axes), None)
        x, y, z = (float(k == missing) for k in range(3))
        return Dragging(robot.inverse, normal if missing is None else (x, y, z))
    if min(_rank(own) - _rank(own[3:]) for own in columns) == directions:
        return Dragging(InverseOptions(POSE), normal)
    if min(_rank(own[:3]) for own in columns) < directions:
        return None
    if normal is None:
        return Dragging(InverseOptions(("x", "y", "z")), None)
    left_out = int(np.argmax(np.abs(normal)))
    return Dragging(InverseOptions(tuple(axis for k, axis in enumerate("xyz") if k != left_out)), normal)


def _jacobian(robot: Robot, numbers: Mapping[str, float], q: Array) -> Array:
    """(6, n), lengths in parts of the largest one."""
    bare = replace(robot, links=(), gravity=None)
    rows = np.array(jacobian(build_chain(bare, FloatDomain(bare, q.tolist(), numbers))))
    rows[:3] /= float(np.abs(rows[:3]).max()) or 1.0
    return rows


def _rank(matrix: Array) -> int:
    return int(np.linalg.matrix_rank(matrix, tol=_SMALL * max(1.0, float(np.abs(matrix).max(initial=0.0)))))
