"""A motion that the page plays: time slider, path of the end effector, plots and values, in step with the arm.

The page computes the motion from the same pieces as everything else does: polynomials by what holds at both ends,
cosines, and formulas of time as trees of numbers; torques come from the JavaScript of the robot's own tapes.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from derive.handouts.sheet.language import Text
from derive.robot.robot import Robot
from derive.targets.escape import html_text

Formula = float | str | list[Any]  # a number, the letter ``t``, or an operation and its operands
SQUARED = "\N{SUPERSCRIPT TWO}"
SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0)  # how fast a motion is played
CURVES = 8  # colours and dashes of curves; further joints begin anew
QUANTITIES = ("position", "speed", "acceleration", "torque")  # what is shown of each joint of a motion as it is wanted
FEWEST = 4  # polynomials that follow each other and are told to the script together
TORQUE, REGRESSOR = "inverse_dynamics", "regressor"  # for torques; the second where the tool carries something


@dataclass(frozen=True, slots=True)
class PlayedPiece:
    """A joint on an interval of time."""

    kind: str  # ``hermite``, ``cosine`` or ``curve``
    start: float  # time of its first end [s]
    duration: float  # its length [s]
    # Position, velocity, ... at the first end, then at the second; of a curve these three as trees in t.
    values: tuple[Formula, ...]


# The way from one point to the next: its name ``rest -> A``, when it begins [s], columns of the regressor with the
# parameters of the payload that belong to them, and which of `Playback.base_torques` is what a base that moves adds.
PlayedSegment = tuple[str, float, tuple[tuple[int, float], ...], int]


@dataclass(frozen=True, slots=True)
class PlayedRun:
    """A simulation, which the page plays instead of what is wanted."""

    times: tuple[float, ...]  # of its rows [s]
    q: tuple[tuple[float, ...], ...]  # positions, (rows, n)
    qd: tuple[tuple[float, ...], ...]  # velocities, (rows, n)
    tau: tuple[tuple[float, ...], ...]  # torques of the motors, (rows, n)
    law: str  # of the control
    friction: str  # how friction is simulated
    reached: bool  # whether it reached the end of the motion


@dataclass(frozen=True, slots=True)
class Playback:
    """A motion as the page plays it."""

    tracks: tuple[tuple[PlayedPiece, ...], ...]  # the pieces of each joint
    segments: tuple[PlayedSegment, ...]  # one after the other
    # By the number of values at each end, coefficients of what `PlayedPiece.values` weigh, from the constant on.
    basis: Mapping[int, Sequence[Sequence[int]]]
    duration: float  # how long it lasts [s]
    sample: float  # time between two rows of its table [s]
    ranges: tuple[tuple[float, float], ...]  # lowest and highest value of each joint [rad or m]
    functions: tuple[str, ...]  # what of the robot's program it needs besides what the figure needs
    base: tuple[tuple[Formula, ...], ...] = ()  # transform of a base that moves, 4 x 4; nothing where it stands
    base_rates: tuple[tuple[tuple[Formula, ...], ...], ...] = ()  # both its derivatives, where torques are known
    # What its motion adds to the torques, for each thing that the tool carries, as JavaScript: statements in ``q``,
    # ``qd`` and ``base``, upper rows of the transform, of its rate and second derivative; then a result for each joint.
    base_torques: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...] = ()
    # By the names of `QUANTITIES` the lowest and the highest value allowed to each joint; None for none.
    bounds: Mapping[str, Sequence[tuple[float | None, float | None]]] = field(default_factory=dict)
    # Limits that are exceeded, where they are so most: which of `QUANTITIES`, index of the joint, when [s], the value.
    exceeded: tuple[tuple[str, int, float, float], ...] = ()
    run: PlayedRun | None = None  # a simulation, which is played instead; None for the motion as it is wanted
    places: int = 0  # of a motion that is too long for a page, how many of its places the pieces join; 0 for all

    @property
    def quantities(self) -> tuple[str, ...]:
        """What is shown of each joint, in the order in which the script computes it."""
        if self.run is not None:
            return "position", "speed", "torque", "error"
        return QUANTITIES if TORQUE in self.functions else QUANTITIES[:3]

    @property
    def configuration(self) -> dict[str, object]:
        """What the script knows of it, as plain data."""
        grids: list[_Grid] = []
        return {
            "tracks": [_joined(track, grids) for track in self.tracks],
            "grids": grids,
            "segments": self.segments,
            "basis": {str(k): rows for k, rows in self.basis.items()},
            "duration": self.duration,
            "sample": self.sample,
            "base": self.base or None,
            "baseRates": self.base_rates or None,
            "bounds": [self.bounds.get(name) for name in self.quantities],
            "exceeded": [[self.quantities.index(quantity), *where] for quantity, *where in self.exceeded],
            "run": [self.run.times, self.run.q, self.run.qd, self.run.tau] if self.run else None,
        }


_Grid = tuple[list[float], list[float] | None]


def _joined(track: Sequence[PlayedPiece], grids: list[_Grid]) -> list[list[Any]]:
    """The pieces of a joint as plain data: polynomials that follow each other without a gap as one entry."""
    entries: list[list[Any]] = []
    runs: list[list[PlayedPiece]] = []
    for piece in track:
        before, k = runs[-1][-1] if runs else piece, len(piece.values) // 2
        alike = before.kind == piece.kind == "hermite" and len(before.values) == len(piece.values)
        if runs and alike and before.values[k:] == piece.values[:k]:  # the same values where they meet
            runs[-1].append(piece)
        else:
            runs.append([piece])
    for run in runs:
        if len(run) < FEWEST:
            entries += ([piece.kind, piece.start, piece.duration, *piece.values] for piece in run)
            continue
        times = [*(piece.start for piece in run), run[-1].start + run[-1].duration]
        lengths = [piece.duration for piece in run]
        grid = (times, None if lengths == [b - a for a, b in pairwise(times)] else lengths)
        grids += [grid] if grid not in grids else []
        k = len(run[0].values) // 2
        values = [*run[0].values[:k], *(value for piece in run for value in piece.values[k:])]
        entries.append(["chain", grids.index(grid), *values])
    return entries


def html_messages(text: Text) -> Callable[..., str]:
    """What translates the messages of a template, for HTML."""
    return lambda message, **values: html_text(text(message, **values))


def player_texts(playback: Playback, robot: Robot, rows: Sequence[Mapping[str, object]], text: Text) -> dict[str, Any]:
    """Everything that the template of the player asks for."""
    kinds = {joint.is_revolute for joint in robot.variables}
    quantities = [_quantities(text)[name] for name in playback.quantities]
    exceeded = []  # of which quantity, of which kind of joints, and in words
    for quantity, j, time, _ in playback.exceeded:
        joint, when = robot.variables[j], text.number(f"{time:.4g}")
        words = text("%(joint)s beyond its limit at %(time)s s", joint=joint.variable, time=when)
        exceeded.append((quantity, joint.is_revolute, html_text(words)))
    plots = [
        {
            "order": order,
            "revolute": revolute,
            "title": html_text(f"{title} [{unit}]"),
            "exceeded": [words for *of, words in exceeded if of == [playback.quantities[order], revolute]],
        }
        for order, (_, of_kind) in enumerate(quantities)
        for revolute, (title, unit) in of_kind.items()
        if revolute in kinds
    ]
    joints = [
        {
            "label": row["label"],
            "name": row["name"],
            "curve": j % CURVES,
            "units": [html_text(of_kind[joint.is_revolute][1]) for _, of_kind in quantities],
        }
        for j, (row, joint) in enumerate(zip(rows, robot.variables, strict=True))
    ]
    return {
        "segments": [html_text(name.replace("->", "\N{RIGHTWARDS ARROW}")) for name, *_ in playback.segments],
        "speeds": [(speed, html_text(text.number(f"{speed:g}")), speed == 1.0) for speed in SPEEDS],
        "duration": repr(playback.duration),
        "plots": plots,
        "columns": [html_text(title) for title, _ in quantities],
        "joints": joints,
        "notes": html_text(" ".join(_notes(text, playback))),
    }


def _quantities(_: Text) -> dict[str, tuple[str, dict[bool, tuple[str, str]]]]:
    """What is plotted: a name, and for joints that turn and those that slide a title and a unit."""
    position, velocity, acceleration, error = _("Position"), _("Velocity"), _("Acceleration"), _("Error")
    return {
        "position": (position, {True: (_("Angles"), "rad"), False: (_("Displacements"), "m")}),
        "speed": (velocity, {True: (velocity, "rad/s"), False: (velocity, "m/s")}),
        "acceleration": (
            acceleration,
            {True: (acceleration, f"rad/s{SQUARED}"), False: (acceleration, f"m/s{SQUARED}")},
        ),
        "torque": (_("Torque or force"), {True: (_("Torque"), "N m"), False: (_("Force"), "N")}),
        "error": (error, {True: (error, "rad"), False: (error, "m")}),
    }


def _notes(_: Text, playback: Playback) -> Iterator[str]:
    """What is said about a simulation and about limits."""
    if run := playback.run:
        yield _("Simulated: control law %(law)s, friction %(friction)s.", law=run.law, friction=run.friction)
        yield _(
            "Narrow lines show the simulated motion, broad lines the desired one; the error is desired minus simulated."
        )
        if not run.reached:
            yield _("The simulation diverges after %(time)s s.", time=_.number(f"{run.times[-1]:.4g}"))
    if playback.places:
        yield _("The page joins %(count)s places of this long motion by cubic polynomials.", count=playback.places)
    if playback.bounds:
        yield _("Dotted lines are limits; they stand where the motion comes near them.")
