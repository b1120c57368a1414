"""Figures from Python: the arm with its frames, or its workspace."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from derive.api.robots import RobotLike, load
from derive.errors import DeriveError
from derive.handouts.figure.arm import arm_drawing
from derive.handouts.figure.workspace_plot import workspace_bytes
from derive.handouts.figure.writers import SUFFIXES, drawing_bytes, require_matplotlib
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import DataPrinter
from derive.inverse.loops import without_parallelograms
from derive.publish.atomic_folder import ending_of, refuse_taken, write_files
from derive.robot.cells import joint_values
from derive.robot.tree import require_chain
from derive.workspace.poses import RobotPoses
from derive.workspace.region import Measure
from derive.workspace.views import Workspace, WorkspaceView, find_workspace


@dataclass(frozen=True, slots=True)
class Plot:
    """A figure that was written.

    Attributes:
        robot: Name of the robot.
        path: The file.
        remarks: What is drawn, and what was assumed for symbols and limits without a number.
        workspace: The workspace that is drawn, with its areas and volumes; None for a figure of the arm.
    """

    robot: str
    path: Path
    remarks: str
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
        data = workspace_bytes(found.views, suffix, remarks, size)
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
