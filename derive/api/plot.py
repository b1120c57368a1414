"""Figures from Python: the arm with its frames, or its workspace."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np

from derive.api.robots import RobotLike, load
from derive.errors import DeriveError
from derive.handouts.figure.arm import arm_drawing
from derive.handouts.figure.writers import (
    POINTS_PER_INCH,
    STYLE,
    SUFFIXES,
    drawing_bytes,
    figure_bytes,
    require_matplotlib,
)
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import DataPrinter
from derive.inverse.loops import without_parallelograms
from derive.publish.atomic_folder import ending_of, refuse_taken, write_files
from derive.robot.cells import joint_values
from derive.robot.tree import require_chain
from derive.workspace.point import Picture
from derive.workspace.poses import RobotPoses
from derive.workspace.region import Measure, Region, shapely
from derive.workspace.views import Workspace, WorkspaceView, find_workspace


@dataclass(frozen=True, slots=True)
class Plot:
    """A figure that was written."""

    robot: str  #: name of the robot
    path: Path  #: the file
    remarks: str  #: what is drawn, and what was assumed for symbols and limits without a number
    #: the workspace that is drawn, with its areas and volumes; None for a figure of the arm
    workspace: Workspace | None = None


def plot(
    robot: RobotLike,
    path: str | Path,
    *,
    q: Sequence[float | str] | None = None,
    workspace: bool = False,
    size: float = 1.0,
    progress: Callable[[str, str], None] | None = None,
    force: bool = False,
) -> Plot:
    """Draw the arm with its Denavit-Hartenberg frames, or its workspace, as ``derive plot`` does.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        path: The file, ending in .pdf, .svg or .png.
        q: Joint values in the units of the robot file; None for those of its block ``figure:``, or zeros.
        workspace: Whether the positions that the end effector reaches are drawn instead.
        size: Factor by which the figure is enlarged.
        progress: Called with the robot's name and what of its workspace is looked for.
        force: Whether a file that exists is overwritten.

    Returns:
        The file, and what was assumed.

    Raises:
        DeriveError: Another ending, or joint values beside a workspace.
        RobotFileError: The file does not describe a robot.
        TargetError: Matplotlib is missing.
        OutputError: There is such a file or folder already, or it cannot be written.
    """
    path = Path(path)
    suffix = ending_of(path, SUFFIXES)
    if workspace and q is not None:
        raise DeriveError("--at beside --workspace", remedy="leave one of them out")
    refuse_taken([path], force=force)
    require_matplotlib()
    chosen = without_parallelograms(load(robot, remarks_on_bodies=False))
    if workspace:
        require_chain(chosen, "the workspace")
    poses, found = RobotPoses(chosen), None
    if workspace:
        found = find_workspace(poses, None if progress is None else partial(progress, chosen.name))
        remarks = f"workspace of {chosen.name}: {_summary(found)}{_assumed(poses)}"
        data = _workspace_bytes(found.views, suffix, remarks, size)
    else:
        drawn = (poses.configuration or poses.zero) if q is None else poses.numbers(joint_values(chosen, q))
        units = ("rad" if joint.is_revolute else "m" for joint in chosen.variables)
        shown = zip((joint.variable for joint in chosen.variables), drawn, units, strict=True)
        values = ", ".join(f"{variable} = {value:.4g} {unit}" for variable, value, unit in shown)
        remarks = f"{chosen.name} at {values if any(drawn) else 'the zero configuration'}{_assumed(poses)}"
        printer = DataPrinter(chosen, Notation.of(chosen, chosen.handout.notation))
        data = drawing_bytes(arm_drawing(chosen, printer, poses.frames(drawn), remarks), suffix, size)
    write_files({path: data}, force=force)
    return Plot(chosen.name, path, remarks, found)


def _summary(found: Workspace) -> str:
    """A workspace in words: what was measured, how exactly, and what was assumed."""
    parts = []
    for view in found.views:
        text = f"{view.picture} {_measured(view.reachable.size, 'm2')}{_postures(view)}"
        parts.append(text + (f", dexterous {_measured(view.dexterous.size, 'm2')}" if view.dexterous else ""))
    if found.volume is not None:
        dexterous = f", dexterous {_measured(found.dexterous_volume, 'm3')}" if found.dexterous_volume else ""
        parts.append(f"volume {_measured(found.volume, 'm3')}{dexterous}")
    boundary = "along critical curves" if all(view.exact for view in found.views) else "to 0.5 % of the reach"
    if found.views[0].by_formula:
        boundary = "where the square roots of the inverse kinematics are zero"
    parts.append(f"origin of the end effector, boundary {boundary}")
    if found.wrist is None and any(view.dexterous is None for view in found.views):
        parts.append("no wrist whose axes meet, so no dexterous part is looked for")
    elif found.wrist and not found.wrist.complete and any(view.dexterous is None for view in found.views):
        parts.append(
            "within its limits the wrist does not reach every orientation from one posture of the arm, so no dexterous "
            "part is looked for"
        )
    if found.assumed:
        ways: dict[str, list[str]] = {way.interval: [] for way in found.assumed}
        for way in found.assumed:
            ways[way.interval].append(way.variable)
        parts.append("limits assumed: " + ", ".join(f"{' '.join(names)} {way}" for way, names in ways.items()))
    return "; ".join(part for part in parts if part)


def _postures(view: WorkspaceView) -> str:
    """How many postures reach places: `` (2 postures on 22.66 m2, 4 postures on 2.591 m2)``."""
    words = [(f"{number} posture{'s' if number > 1 else ''}", region.area) for number, region in view.by_number]
    if len(words) == 1:
        return f" ({words[0][0]})"
    return f" ({', '.join(f'{text} on {area:.4g} m2' for text, area in words)})" if words else ""


def _measured(measure: Measure, unit: str) -> str:
    """A number with as many digits as its error leaves: ``0.8269 +- 0.0001 m2``."""
    if measure.error <= 1e-7 * measure.value:
        return f"{measure.value:.6g} {unit}"
    digits = max(0, 1 - math.floor(math.log10(measure.error)))
    return f"{measure.value:.{digits}f} +- {measure.error:.{digits}f} {unit}"


def _assumed(poses: RobotPoses) -> str:
    values = [f"{name} = {value:.4g} {unit}" for name, value, unit in poses.assumed]
    return f"; assumed for the drawing: {', '.join(values)}" if values else ""


# -- the picture of a workspace: each of its views with what is reached and what is dexterous

_WIDTH = 380.0  # width of the plot [pt]
_REACHABLE = (0.80, 0.86, 0.94)
# For parts that are reached in different numbers of postures, the fewest first.
_MORE = ((0.72, 0.88, 0.76), (0.98, 0.90, 0.66), (0.95, 0.78, 0.72), (0.85, 0.77, 0.90))
_DEXTEROUS = (0.56, 0.69, 0.88)
_EDGE = (0.10, 0.22, 0.55)
_INNER_EDGE = (0.20, 0.36, 0.68)
_SETTINGS = {"font.size": 8.0, "axes.linewidth": 0.6, "lines.linewidth": 0.9}
_AXES = {Picture.SECTION: ("r", "z"), Picture.TOP: ("x", "y"), Picture.SIDE: ("x", "z")}

_MARGIN = 0.06
_ONE_POINT = 1e-9  # a workspace smaller than this is a point, which gives a plot no scale; a metre is shown then [m]


def _workspace_bytes(views: Sequence[WorkspaceView], suffix: str, title: str, scale: float = 1.0) -> bytes:
    """The plot as the contents of a file."""
    with require_matplotlib().rc_context({**STYLE, **_SETTINGS}):
        from matplotlib.figure import Figure

        width = scale * _WIDTH / POINTS_PER_INCH
        figure = Figure(figsize=(width, (0.56 if len(views) > 1 else 0.8) * width), layout="constrained")
        panels = figure.subplots(1, len(views), squeeze=False)[0]
        for axes, view in zip(panels, views, strict=True):
            _panel(axes, view)
        if any(view.dexterous is not None or len(view.by_number) > 1 for view in views):
            handles, names = panels[0].get_legend_handles_labels()
            figure.legend(handles, names, loc="outside lower center", ncols=len(names), frameon=False)
        return figure_bytes(figure, suffix, title)


def _panel(axes: Any, view: WorkspaceView) -> None:
    if len(view.by_number) > 1:
        for (number, part), color in zip(view.by_number, cycle(_MORE), strict=False):
            _fill(axes, part, view.picture, color, _EDGE, f"{number} posture{'s' if number > 1 else ''}")
    else:
        _fill(axes, view.reachable.region, view.picture, _REACHABLE, _EDGE, "reachable")
    if view.dexterous is not None and not view.dexterous.region.is_empty:
        _fill(axes, view.dexterous.region, view.picture, _DEXTEROUS, _INNER_EDGE, "dexterous")
    if len(view.path):
        axes.plot(*view.path.T, color=_EDGE, marker="." if np.ptp(view.path, axis=0).max() < _ONE_POINT else "")
    # The same scale on both axes; the axis of symmetry of a section where the workspace is near it.
    bounds = view.reachable.region.bounds if not len(view.path) else (*view.path.min(axis=0), *view.path.max(axis=0))
    left, low, right, high = bounds
    margin = _MARGIN * max(right - left, high - low)
    margin = margin if margin >= _ONE_POINT else 0.5
    if view.picture is Picture.SECTION and left < 0.5 * right:
        axes.axvline(0.0, color="0.35", linewidth=0.5, linestyle=(0, (8, 2, 1.5, 2)))
        left = 0.0
    axes.set(xlim=(left - margin, right + margin), ylim=(low - margin, high + margin))
    axes.set_aspect("equal", adjustable="box")
    across, up = _AXES[view.picture]
    axes.set(xlabel=f"${across}$ [m]", ylabel=f"${up}$ [m]")
    axes.set_title(str(view.picture), fontsize=9.0)
    axes.grid(visible=True, color="0.9", linewidth=0.4)
    axes.set_axisbelow(True)
    axes.tick_params(width=0.5, length=2.5)


def _fill(axes: Any, region: Region, picture: Picture, color: Any, edge: Any, name: str) -> None:
    """An area with its holes; its border is drawn but for the axis of a section, which lies inside of the workspace."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    package = shapely()
    parts = [part for part in package.get_parts(region) if not part.is_empty]
    rings = [ring for part in parts for ring in (part.exterior, *part.interiors)]
    if not rings:
        return
    corners = [np.asarray(ring.coords) for ring in rings]
    codes = [np.r_[Path.MOVETO, np.full(len(ring) - 2, Path.LINETO), Path.CLOSEPOLY] for ring in corners]
    area = Path(np.concatenate(corners), np.concatenate(codes))
    axes.add_patch(PathPatch(area, facecolor=color, edgecolor="none", label=name))
    _, low, right, high = region.bounds
    strip = package.box(-right, low - right, 1e-4 * right, high + right) if picture is Picture.SECTION else None
    for ring in rings:
        for line in package.get_parts(ring if strip is None else ring.difference(strip)):
            axes.plot(*np.asarray(line.coords).T, color=edge, solid_joinstyle="round")
