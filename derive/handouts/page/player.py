"""A motion that the page plays: time slider, path of the end effector, plots and values, in step with the arm.

The page computes the motion from the same pieces as everything else does: polynomials by what holds at both ends,
cosines, and formulas of time as trees of numbers; torques come from the JavaScript of the robot's own tapes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from derive.handouts.language import Text
from derive.robot.robot import Robot
from derive.targets.escape import html_text
from derive.targets.javascript import camel_case

Formula = float | str | list[Any]
"""A number, the letter ``t``, or an operation and its operands."""

SQUARED = "\N{SUPERSCRIPT TWO}"

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0)
"""How fast a motion is played."""

CURVES = 8
"""Colours and dashes of curves; further joints begin anew."""

TORQUE, REGRESSOR = "inverse_dynamics", "regressor"
"""Generated functions that torques need; the second one where the tool carries something."""


@dataclass(frozen=True, slots=True)
class PlayedPiece:
    """A joint on an interval of time.

    Attributes:
        kind: ``hermite``, ``cosine`` or ``curve``.
        start: Time of its first end [s].
        duration: Its length [s].
        values: Position, velocity, ... at the first end, then at the second; nothing of a curve.
        formulas: Position, velocity and acceleration of a curve as trees in t; else nothing.
    """

    kind: str
    start: float
    duration: float
    values: tuple[float, ...] = ()
    formulas: tuple[Formula, ...] = ()


@dataclass(frozen=True, slots=True)
class PlayedSegment:
    """The way from one point to the next.

    Attributes:
        name: ``rest -> A``.
        start: When it begins [s].
        payload: Columns of the regressor, and the parameters of the payload that belong to them.
    """

    name: str
    start: float
    payload: tuple[tuple[int, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Playback:
    """A motion as the page plays it.

    Attributes:
        tracks: The pieces of each joint.
        segments: One after the other.
        basis: By the number of values at each end, the coefficients of the polynomials that `PlayedPiece.values`
            weigh, from the constant on.
        duration: How long it lasts [s].
        sample: Time between two rows of its table [s].
        ranges: Lowest and highest value of each joint [rad or m].
        functions: What of the robot's program it needs besides what the figure needs.
        base: Transform of a base that moves, 4 x 4 formulas; nothing where it stands.
    """

    tracks: tuple[tuple[PlayedPiece, ...], ...]
    segments: tuple[PlayedSegment, ...]
    basis: Mapping[int, Sequence[Sequence[int]]]
    duration: float
    sample: float
    ranges: tuple[tuple[float, float], ...]
    functions: tuple[str, ...]
    base: tuple[tuple[Formula, ...], ...] = ()

    @property
    def configuration(self) -> dict[str, object]:
        """What the script knows of it, as plain data."""
        return {
            "tracks": [
                [[piece.kind, piece.start, piece.duration, *(piece.values or piece.formulas)] for piece in track]
                for track in self.tracks
            ],
            "segments": [[segment.name, segment.start, segment.payload] for segment in self.segments],
            "basis": {str(k): rows for k, rows in self.basis.items()},
            "duration": self.duration,
            "sample": self.sample,
            "base": self.base or None,
        }


def player_texts(playback: Playback, robot: Robot, rows: Sequence[Mapping[str, object]], text: Text) -> dict[str, Any]:
    """Everything that the template of the player asks for.

    Args:
        playback: The motion.
        robot: The robot.
        rows: Label and name of each joint, as the sliders have them.
        text: Translates messages.
    """
    kinds = {joint.is_revolute for joint in robot.joints}
    quantities = _quantities(text, torques=TORQUE in playback.functions)
    plots = [
        {"order": order, "revolute": revolute, "title": html_text(f"{title} [{unit}]")}
        for order, (_, of_kind) in enumerate(quantities)
        for revolute, (title, unit) in of_kind.items()
        if revolute in kinds
    ]
    columns = [html_text(title) for title, _ in quantities]
    joints = [
        {
            "label": row["label"],
            "name": row["name"],
            "curve": j % CURVES,
            "units": [html_text(of_kind[joint.is_revolute][1]) for _, of_kind in quantities],
        }
        for j, (row, joint) in enumerate(zip(rows, robot.joints, strict=True))
    ]
    return {
        "words": {name: html_text(word) for name, word in _words(text).items()},
        "segments": [html_text(segment.name.replace("->", "\N{RIGHTWARDS ARROW}")) for segment in playback.segments],
        "speeds": [(speed, html_text(text.number(f"{speed:g}")), speed == 1.0) for speed in SPEEDS],
        "duration": repr(playback.duration),
        "plots": plots,
        "columns": columns,
        "joints": joints,
    }


def function_names(playback: Playback | None) -> tuple[str, ...]:
    """What the script calls the functions that torques need.

    Args:
        playback: The motion; None for none.
    """
    return tuple(camel_case(name) for name in playback.functions) if playback else ()


def _quantities(_: Text, *, torques: bool) -> list[tuple[str, dict[bool, tuple[str, str]]]]:
    """What is plotted: a name, and for joints that turn and those that slide a title and a unit."""
    position, velocity, acceleration = _("Position"), _("Velocity"), _("Acceleration")
    found = [
        (position, {True: (_("Angles"), "rad"), False: (_("Displacements"), "m")}),
        (velocity, {True: (velocity, "rad/s"), False: (velocity, "m/s")}),
        (acceleration, {True: (acceleration, f"rad/s{SQUARED}"), False: (acceleration, f"m/s{SQUARED}")}),
    ]
    if torques:
        found.append((_("Torque or force"), {True: (_("Torque"), "N m"), False: (_("Force"), "N")}))
    return found


def _words(_: Text) -> dict[str, str]:
    """Every other text of the player."""
    return {
        "player": _("The motion"),
        "play": _("Play"),
        "pause": _("Pause"),
        "time": _("Time"),
        "speed": _("Speed"),
        "repeat": _("Repeat"),
        "trace": _("Path of the end effector"),
        "segment": _("Segment"),
        "joint": _("Joint"),
        "moment": _("Values at this time"),
        "plots": _("Plots over time"),
        "range": _("from %(least)s to %(most)s", least="@least@", most="@most@"),
        "hint": _(
            "Arrow keys on the time slider move by one sample, with Shift by ten, Page Up and Page Down to the next "
            "point; a click into a plot goes to that time."
        ),
    }
