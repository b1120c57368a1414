"""The plot of a motion: positions, velocities, accelerations and torques in SI units, their peaks marked."""

from collections.abc import Sequence
from math import ceil
from typing import Any

import numpy as np

from derive.arrays import Array
from derive.handouts.figure.writers import POINTS_PER_INCH, STYLE, figure_bytes, require_matplotlib
from derive.handouts.notation.notation import Notation
from derive.motion.curves.limits import Bounds, Violation
from derive.motion.motion import Motion
from derive.motion.simulation.simulation import Run

WIDTH = 460.0  # width of the plot [pt]
ROW = 105.0  # height of a row of panels [pt]
PLACES = 2000  # times at which a line is drawn, however far samples are apart; more are not told apart
AXIS = 25.0  # room for the name of an axis, its ticks and what is between, without the numbers of a y axis [pt]
DIGIT = 5.1  # width of a digit beside an axis [pt]
LINE = 15.0  # height of a line of the legend, and of the names of points [pt]
GAP = 10.0  # between panels [pt]
SHORT = 4  # letters of a point's name of which half has room beside the panels
LEGEND = 8  # joints in a line of the legend
Mark = tuple[int, float, float]  # a joint, and the time and the value of its peak
Curves = tuple[Array, Array]  # times, and the values of all joints at them
LEAST = 0.02  # peaks below this part of the largest one are not marked
CONSTANT = 1e-6  # by which part of itself a curve without a peak varies at most
CLEAR = {"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.3}  # behind numbers that curves run over
SMALL = 1e-4  # largest number of a panel below which those beside its axis are written with powers of ten
LETTER, HEIGHT, BESIDE = 4.7, 7.0, 3.0  # of a number beside a peak: width of a letter, height, and distance [pt]
# Of joints, told apart with colour-blind eyes and on grey paper.
COLORS = ("#1b4f9c", "#c2571a", "#2d7d46", "#8a3a8f", "#a8861a", "#4d5560", "#b0304a", "#23808f")
BEYOND = "#b3121d"  # of a band along what exceeds a limit, and of a ring where it does so most
SETTINGS = {
    "font.size": 8.0,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.0,
    "legend.fontsize": 8.0,
    "path.simplify": True,  # a line of a thousand samples has few corners that are seen
}

# What is drawn from the top, with the units of revolute and of prismatic joints.
ROWS = (
    ("position", "rad", "m"),
    ("speed", "rad/s", "m/s"),
    ("acceleration", "rad/s$^2$", "m/s$^2$"),
    ("torque", "N m", "N"),
)
ERROR = ("error", "rad", "m")  # what happens less what is wanted, of simulations, which have no accelerations
REFERENCE: dict[str, Any] = {"linestyle": (0, (4, 2)), "linewidth": 0.7}  # of what is wanted beside what happens


def plot_bytes(motion: Motion, suffix: str, run: Run | None = None) -> bytes:
    """The plot as the contents of a file."""
    robot = motion.plan.robot
    kinds = [kind for kind in (True, False) if any(joint.is_revolute is kind for joint in robot.variables)]
    count = 4 if motion.has_torques else 3
    with require_matplotlib().rc_context({**STYLE, **SETTINGS}):
        from matplotlib.figure import Figure

        height = ROW * count + 40.0
        figure = Figure(figsize=(WIDTH / POINTS_PER_INCH, height / POINTS_PER_INCH))
        panels = figure.subplots(count, len(kinds), squeeze=False, sharex=True)
        rows, wanted = ROWS if run is None else (*ROWS[:2], ERROR, ROWS[3]), _wanted(motion)
        drawn = wanted if run is None else _happened(motion, run)
        violations = motion.violations if run is None else motion.violations_of(run)
        limits, marks = (motion.near_bounds(run), violations), {}
        for column, kind in enumerate(kinds):
            joints = [j for j in range(robot.dof) if robot.variables[j].is_revolute is kind]
            for row in range(count):
                axes, curves = panels[row][column], [(times, values[row]) for times, values in (drawn, wanted)]
                with_reference = run is not None and rows[row] is not ERROR
                _panel(axes, motion, rows[row], joints, curves[: 1 + with_reference], limits)
                marks[axes] = _peaks(motion, row, joints, curves[0], happened=run is not None)
            panels[-1][column].set_xlabel("time [s]")
            _name_points(panels[0][column], motion)
        lines = [line for axes in panels[0] for line in axes.get_lines() if not line.get_label().startswith("_")]
        lines.sort(key=lambda line: line.get_gid())
        if run is not None:
            lines += panels[0][0].plot([], [], color="0.3", label="reference", **REFERENCE)
        labels = [line.get_label() for line in lines]
        figure.legend(lines, labels, loc="lower center", ncols=min(LEGEND, len(labels)), frameon=False)
        _arrange(panels, height, below=AXIS + LINE * (0.5 + ceil(len(labels) / LEGEND)))
        for axes, found in marks.items():
            _mark(axes, found)
        return figure_bytes(figure, suffix, f"{robot.name}: {motion.plan.title or motion.plan.source}")


def _arrange(panels: Any, height: float, below: float) -> None:
    """Room for the labels of the axes, by the lengths of their numbers."""
    # The layout engines of matplotlib set every text twice over for that, which takes as long as all the rest.
    rows, columns = panels.shape
    figure = panels[0][0].figure
    figure.subplots_adjust(bottom=below / height, top=1 - LINE / height, hspace=GAP * rows / (height - below - LINE))
    lefts = []
    for column in panels.T:
        numbers = [""]  # beside the ticks that are seen
        for axis in (axes.yaxis for axes in column):
            low, high = sorted(axis.get_view_interval())
            places = [place for place in axis.get_majorticklocs() if low <= place <= high]
            numbers += axis.get_major_formatter().format_ticks(places)
        lefts.append(AXIS + DIGIT * max(map(len, numbers)))
    width = (WIDTH - sum(lefts)) / columns - GAP
    for k, column in enumerate(panels.T):
        left = sum(lefts[: k + 1]) + k * (width + GAP)
        for axes in column:
            place = axes.get_position()
            axes.set_position((left / WIDTH, place.y0, width / WIDTH, place.height))


def _wanted(motion: Motion) -> tuple[Array, list[Array]]:
    """Times, also on both sides of where segments meet, and q, qd, qdd and tau at them."""
    edges = [float(segment.start) for segment in motion.trajectory.segments[1:]] + list(motion.trajectory.jumps)
    times = np.unique(np.concatenate([np.linspace(0.0, motion.duration, PLACES), edges, np.nextafter(edges, 0.0)]))
    values = list(motion(times))
    return times, [*values, motion.torques(times)] if motion.has_torques else values


def _happened(motion: Motion, run: Run) -> tuple[Array, list[Array]]:
    """Times and q, qd, error and tau at them; between rows the error goes on by its rate, and what is held stays."""
    from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

    (q, qd, _), times = motion(run.t), run.t
    if not 1 < times.size < PLACES:
        return times, [run.q, run.qd, run.q - q, run.tau]
    times = np.union1d(times, np.linspace(times[0], times[-1], PLACES))
    error, (q, qd, _) = CubicHermiteSpline(run.t, run.q - q, run.qd - qd), motion(times)
    held = motion.plan.control.law == "none" or motion.plan.control.period is not None
    tau = run.tau[np.searchsorted(run.t, times)] if held else PchipInterpolator(run.t, run.tau)(times)
    return times, [q + error(times), qd + error(times, 1), error(times), tau]


def _panel(
    axes: Any,
    motion: Motion,
    quantity: tuple[str, str, str],
    joints: Sequence[int],
    curves: Sequence[Curves],
    limits: tuple[Bounds, Sequence[Violation]],
) -> None:
    """One quantity of the joints of one kind: what is wanted, or happens, and dashed what is wanted then."""
    robot = motion.plan.robot
    notation = Notation.of(robot, robot.handout.notation)
    name, of_angle, of_slide = quantity
    revolute = robot.variables[joints[0]].is_revolute
    axes.set_ylabel(f"{'force' if name == 'torque' and not revolute else name} [{of_angle if revolute else of_slide}]")
    marked = [item for item in limits[1] if item.what == name]
    (times, values), *references = curves
    for j in joints:
        latex = notation.glyph(robot.variables[j].variable).box.tex.strip()
        look: dict[str, Any] = {"color": COLORS[j % len(COLORS)]}
        for when, wanted in references:
            axes.plot(when, wanted[:, j], **REFERENCE, **look)
        axes.plot(times, values[:, j], label=f"${latex}$", gid=f"joint-{j + 1:02d}", **look)
        if not any(item.joint == j for item in marked):
            continue
        low, high = (bound[j] for bound in motion.bounds[name])
        beyond = np.where((values[:, j] > high) | (values[:, j] < low), values[:, j], np.nan)
        axes.plot(times, beyond, color=BEYOND, linewidth=5.0, alpha=0.3, zorder=1)
    for bound in limits[0].get(name, ()):  # dotted lines, for which the panel makes room
        for j in joints:
            if np.isfinite(bound[j]):
                axes.axhline(bound[j], color=COLORS[j % len(COLORS)], linestyle=(0, (1, 2)), linewidth=0.8, zorder=0.5)
    for item in marked:
        if item.joint in joints:
            axes.plot([item.time], [item.value], marker="o", markersize=7.0, fillstyle="none", color=BEYOND)
    for segment in motion.trajectory.segments[1:]:
        axes.axvline(float(segment.start), color="0.8", linewidth=0.5, zorder=0)
    axes.margins(x=0.01, y=0.2)
    if not SMALL <= max(map(abs, axes.get_ylim())) < 1 / SMALL:
        axes.yaxis.set_major_formatter("{x:.2g}")  # else a common power of ten stands above, in the next panel
    axes.grid(visible=True, axis="y", color="0.92", linewidth=0.4)
    axes.set_axisbelow(True)
    axes.tick_params(width=0.5, length=2.5)


def _mark(axes: Any, marks: Sequence[Mark]) -> None:
    """Dots at peaks, and numbers where these fit into the panel and cover no other; of what is next to nothing none."""
    largest = max((abs(value) for _, _, value in marks), default=0.0)
    seen = sorted((mark for mark in marks if abs(mark[2]) > LEAST * largest), key=lambda mark: -abs(mark[2]))
    scale = POINTS_PER_INCH / axes.figure.dpi  # points per pixel

    def _placed(places: Any) -> Array:
        return np.asarray((axes.transData.transform(places) - axes.bbox.min) * scale)

    curves = np.concatenate([_placed(line.get_xydata()) for line in axes.get_lines()])
    room, dots = np.array(axes.bbox.size) * scale, [_placed((time, value)) for _, time, value in seen]
    said: set[tuple[object, ...]] = set()
    taken = [(dot - 2.0, dot + 2.0) for dot in dots]
    for (j, time, value), dot in zip(seen, dots, strict=True):
        color, text = COLORS[j % len(COLORS)], f"{value:.4g}".replace("-", "\N{MINUS SIGN}")
        axes.plot([time], [value], marker="o", markersize=3.0, color=color)
        size, best = np.array([LETTER * len(text), HEIGHT]), np.inf
        ups = (BESIDE, -BESIDE - HEIGHT) if value > 0 else (-BESIDE - HEIGHT, BESIDE)
        for up in (*ups, -HEIGHT / 2):
            for right in (BESIDE, -BESIDE - size[0]):
                low = dot + np.array([right, up])
                high = low + size
                free = not any((low < b).all() and (a < high).all() for a, b in taken)
                crossed = int(((curves > low) & (curves < high)).all(axis=1).sum())
                if free and crossed < best and (low >= 1).all() and (high <= room - 1).all():
                    best, place = crossed, low
        if best < np.inf and (text, *dot.round()) not in said:
            said.add((text, *dot.round()))
            taken.append((place, place + size))
            look: dict[str, Any] = {"textcoords": "offset points", "fontsize": 7, "va": "bottom", "bbox": CLEAR}
            axes.annotate(text, (time, value), place - dot, color=color, **look)


def _peaks(motion: Motion, row: int, joints: Sequence[int], curves: Curves, *, happened: bool) -> list[Mark]:
    """Where joints have their largest magnitudes over the whole motion, exact where it is wanted and has them so."""
    times, values = curves
    marks = []
    for j in joints if row else ():
        track = values[:, j]
        at = int(np.abs(track).argmax())
        if np.ptp(track) <= CONSTANT * abs(track[at]):
            continue
        found = [(float(times[at]), float(track[at]))]
        if not happened and row == len(ROWS) - 1:
            found = [(peaks.loads[j].time, peaks.loads[j].peak) for peaks in motion.peaks]
        elif not happened:
            exact = [(peaks.speeds, peaks.accelerations)[row - 1][j] for peaks in motion.peaks]
            found = [(float(peak.time), float(peak.value)) for peak in exact]
        marks.append((j, *max(found, key=lambda pair: abs(pair[1]))))
    return marks


def _name_points(axes: Any, motion: Motion) -> None:
    segments = motion.trajectory.segments
    if motion.plan.curves:
        return
    names = [segments[0].name.split(" -> ")[0], *(segment.name.split(" -> ")[-1] for segment in segments)]
    above = axes.secondary_xaxis("top")
    above.set_xticks([*(float(segment.start) for segment in segments), motion.duration], names, fontsize=7)
    if len(names[-1]) > SHORT:  # within the figure
        above.get_xticklabels()[-1].set_horizontalalignment("right")
    above.tick_params(length=0, pad=1)
    above.spines["top"].set_visible(False)
