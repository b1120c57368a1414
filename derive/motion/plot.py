"""The plot of a motion: positions, velocities, accelerations and torques in SI units, their peaks marked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil
from typing import Any

import numpy as np

from derive.handouts.figure.writers import POINTS_PER_INCH, STYLE, figure_bytes, require_matplotlib
from derive.handouts.notation.notation import Notation
from derive.motion.hermite import Array
from derive.motion.motion import Motion
from derive.motion.simulation import Run
from derive.motion.violations import Bounds, Violation

WIDTH = 460.0
"""Width of the plot [pt]."""

ROW = 105.0
"""Height of a row of panels [pt]."""

MOST_PLACES = 4000
"""Times at which a line is drawn; more are not told apart."""

AXIS = 25.0
"""Room for the name of an axis, its ticks, and the distances between them [pt]; the numbers of a y axis are beside."""

DIGIT = 5.1
"""Width of a digit beside an axis [pt]."""

LINE = 15.0
"""Height of a line of the legend, and of the names of points [pt]."""

GAP = 10.0
"""Between panels [pt]."""

SHORT = 4
"""Letters of a point's name of which half has room beside the panels."""

LEGEND = 8
"""Joints in a line of the legend."""

MARKED = 8
"""Joints up to which peaks have their numbers beside them."""

Mark = tuple[int, float, float]
"""A joint, and the time and the value of its peak."""

LEAST = 0.02
"""Peaks below this part of the largest one have no number beside them."""

COLORS = ("#1b4f9c", "#c2571a", "#2d7d46", "#8a3a8f", "#a8861a", "#4d5560", "#b0304a", "#23808f")
"""Of joints, told apart with colour-blind eyes and on grey paper."""

BEYOND = "#b3121d"
"""Of a band along what exceeds a limit, and of a ring where it does so most."""

SETTINGS = {
    "font.size": 8.0,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.0,
    "legend.fontsize": 8.0,
    "path.simplify": True,  # a line of a thousand samples has few corners that are seen
}

ROWS = (
    ("position", "rad", "m"),
    ("speed", "rad/s", "m/s"),
    ("acceleration", "rad/s$^2$", "m/s$^2$"),
    ("torque", "N m", "N"),
)
"""What is drawn from the top, with the units of revolute and of prismatic joints."""


def plot_bytes(motion: Motion, suffix: str, run: Run | None = None) -> bytes:
    """The plot as the contents of a file.

    Args:
        motion: The motion.
        suffix: ``.pdf``, ``.svg`` or ``.png``: the form.
        run: A simulation of it, drawn over what is wanted.

    Raises:
        DeriveError: Matplotlib is not installed.
    """
    matplotlib = require_matplotlib()
    robot = motion.plan.robot
    kinds = [kind for kind in (True, False) if any(joint.is_revolute is kind for joint in robot.joints)]
    count = 4 if motion.has_torques else 3
    with matplotlib.rc_context({**STYLE, **SETTINGS}):
        from matplotlib.figure import Figure

        height = ROW * count + 40.0
        figure = Figure(figsize=(WIDTH / POINTS_PER_INCH, height / POINTS_PER_INCH))
        panels = figure.subplots(count, len(kinds), squeeze=False, sharex=True)
        wanted, simulated = _wanted(motion), _simulated(run)
        violations = motion.violations if run is None else motion.violations_of(run)
        limits = motion.near_bounds(run), violations
        for column, kind in enumerate(kinds):
            joints = [j for j in range(robot.n) if robot.joints[j].is_revolute is kind]
            for row in range(count):
                _panel(panels[row][column], motion, row, joints, wanted, simulated, limits)
            panels[-1][column].set_xlabel("time [s]")
            _name_points(panels[0][column], motion)
        lines = [line for axes in panels[0] for line in axes.get_lines() if not line.get_label().startswith("_")]
        lines.sort(key=lambda line: line.get_gid())
        labels = [line.get_label() for line in lines]
        figure.legend(lines, labels, loc="lower center", ncols=min(LEGEND, len(labels)), frameon=False)
        _arrange(panels, height, below=AXIS + LINE * (0.5 + ceil(len(labels) / LEGEND)))
        title = f"{robot.name}: {motion.plan.title or motion.plan.source}"
        return figure_bytes(figure, suffix, title)


def _arrange(panels: Any, height: float, below: float) -> None:
    """Room for the labels of the axes, by the lengths of their numbers.

    The layout engines of matplotlib set every text twice over for that, which takes as long as all the rest.

    Args:
        panels: The panels, (rows, columns).
        height: Of the figure [pt].
        below: What stands below the panels [pt].
    """
    rows, columns = panels.shape
    figure = panels[0][0].figure
    figure.subplots_adjust(bottom=below / height, top=1 - LINE / height, hspace=GAP * rows / (height - below - LINE))
    lefts = []
    for column in panels.T:
        numbers = [text for axes in column for text in _numbers_of(axes.yaxis)]
        lefts.append(AXIS + DIGIT * max(map(len, numbers)))
    width = (WIDTH - sum(lefts)) / columns - GAP
    for k, column in enumerate(panels.T):
        left = sum(lefts[: k + 1]) + k * (width + GAP)
        for axes in column:
            place = axes.get_position()
            axes.set_position((left / WIDTH, place.y0, width / WIDTH, place.height))


def _numbers_of(axis: Any) -> list[str]:
    """The numbers beside the ticks of an axis that are seen."""
    low, high = sorted(axis.get_view_interval())
    places = [place for place in axis.get_majorticklocs() if low <= place <= high]
    return list(axis.get_major_formatter().format_ticks(places)) or [""]


def _wanted(motion: Motion) -> tuple[Array, list[Array]]:
    """Times and q, qd, qdd and tau at them."""
    times = motion.times
    if times.size > MOST_PLACES:
        times = np.linspace(0.0, motion.duration, MOST_PLACES)
    values = list(motion(times))
    return times, [*values, motion.torques(times)] if motion.has_torques else values


def _simulated(run: Run | None) -> tuple[Array, list[Array | None]]:
    """Times and q, qd, nothing and tau at them."""
    if run is None:
        return np.zeros(0), [None] * len(ROWS)
    some = slice(None, None, 1 + run.t.size // MOST_PLACES)
    return run.t[some], [run.q[some], run.qd[some], None, run.tau[some]]


def _panel(
    axes: Any,
    motion: Motion,
    row: int,
    joints: Sequence[int],
    wanted: tuple[Array, list[Array]],
    simulated: tuple[Array, list[Array | None]],
    limits: tuple[Bounds, Sequence[Violation]],
) -> None:
    """One quantity of the joints of one kind."""
    robot = motion.plan.robot
    notation = Notation.of(robot, robot.handout.notation)
    name, of_angle, of_slide = ROWS[row]
    revolute = robot.joints[joints[0]].is_revolute
    axes.set_ylabel(f"{'force' if name == 'torque' and not revolute else name} [{of_angle if revolute else of_slide}]")
    marked = [item for item in limits[1] if item.what == name]
    for j in joints:
        latex = notation.glyph(robot.joints[j].variable).box.tex.strip()
        times, values = wanted[0], wanted[1][row]
        look: dict[str, Any] = {"color": COLORS[j % len(COLORS)]}
        if (happened := simulated[1][row]) is not None:
            axes.plot(times, values[:, j], linestyle=(0, (4, 2)), linewidth=0.7, **look)
            times, values = simulated[0], happened
        axes.plot(times, values[:, j], label=f"${latex}$", gid=f"joint-{j + 1:02d}", **look)
        low, high = (bound[j] for bound in motion.bounds[name])
        if (beyond := (values[:, j] > high) | (values[:, j] < low)).any() and any(item.joint == j for item in marked):
            axes.plot(times, np.where(beyond, values[:, j], np.nan), color=BEYOND, linewidth=5.0, alpha=0.3, zorder=1)
    _draw_limits(axes, limits[0], name, joints)
    for item in marked:
        if item.joint in joints:
            axes.plot([item.time], [item.value], marker="o", markersize=7.0, fillstyle="none", color=BEYOND)
    for segment in motion.trajectory.segments[1:]:
        axes.axvline(float(segment.start), color="0.8", linewidth=0.5, zorder=0)
    if row:
        marks = _wanted_peaks(motion, row, joints) if simulated[1][row] is None else _peaks(simulated, row, joints)
        _mark(axes, motion.duration, [mark for mark in marks if mark[2]], told=len(joints) <= MARKED)
    axes.margins(x=0.01, y=0.18)
    axes.grid(visible=True, axis="y", color="0.92", linewidth=0.4)
    axes.set_axisbelow(True)
    axes.tick_params(width=0.5, length=2.5)


def _draw_limits(axes: Any, near: Bounds, name: str, joints: Sequence[int]) -> None:
    """Dotted lines; the panel makes room for them."""
    for bound in near.get(name, ()):
        for j in joints:
            if np.isfinite(bound[j]):
                axes.axhline(bound[j], color=COLORS[j % len(COLORS)], linestyle=(0, (1, 2)), linewidth=0.8, zorder=0.5)


def _mark(axes: Any, duration: float, marks: Sequence[Mark], *, told: bool) -> None:
    """Dots at peaks, and their numbers where these do not cover each other; none at what is next to nothing."""
    largest = max((abs(value) for _, _, value in marks), default=0.0)
    taken: list[tuple[float, float]] = []
    for j, time, value in sorted(marks, key=lambda mark: -abs(mark[2])):
        color = COLORS[j % len(COLORS)]
        axes.plot([time], [value], marker="o", markersize=3.0, color=color)
        at = time / duration, value / largest
        if not told or abs(value) < LEAST * largest or at in taken:
            continue
        crowded = any(abs(at[0] - x) < 0.25 and abs(at[1] - y) < 0.3 for x, y in taken)
        taken.append(at)
        left, up = at[0] > 0.8 or (crowded and at[0] > 0.2), value > 0
        axes.annotate(
            f"{value:.4g}".replace("-", "\N{MINUS SIGN}"),
            (time, value),
            (-4 if left else 4, 3 if up else -3),
            textcoords="offset points",
            ha="right" if left else "left",
            va="bottom" if up else "top",
            fontsize=7,
            color=color,
        )


def _wanted_peaks(motion: Motion, row: int, joints: Sequence[int]) -> Iterator[Mark]:
    """The largest magnitudes over the whole motion, exact where the motion has them so."""
    for j in joints:
        found = []
        for peaks in motion.peaks:
            if row == len(ROWS) - 1:
                found.append((peaks.loads[j].time, peaks.loads[j].peak))
            else:
                peak = (peaks.speeds, peaks.accelerations)[row - 1][j]
                found.append((float(peak.time), float(peak.value)))
        yield (j, *max(found, key=lambda pair: abs(pair[1])))


def _peaks(simulated: tuple[Array, list[Array | None]], row: int, joints: Sequence[int]) -> Iterator[Mark]:
    """The largest magnitudes of what happened."""
    values = simulated[1][row]
    assert values is not None
    for j in joints:
        at = int(np.abs(values[:, j]).argmax())
        yield j, float(simulated[0][at]), float(values[at, j])


def _name_points(axes: Any, motion: Motion) -> None:
    """The names of the points above the times at which they are reached."""
    segments = motion.trajectory.segments
    if motion.plan.curves:
        return
    places = [float(segment.start) for segment in segments] + [motion.duration]
    names = [segments[0].name.split(" -> ")[0], *(segment.name.split(" -> ")[-1] for segment in segments)]
    above = axes.secondary_xaxis("top")
    above.set_xticks(places, names, fontsize=7)
    if len(names[-1]) > SHORT:  # within the figure
        above.get_xticklabels()[-1].set_horizontalalignment("right")
    above.tick_params(length=0, pad=1)
    above.spines["top"].set_visible(False)
