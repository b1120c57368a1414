"""Figures from Python: the arm with its frames, or its workspace."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from derive.api.robots import RobotLike, configuration, load
from derive.errors import DeriveError
from derive.handouts.figure.arm import arm_drawing
from derive.handouts.figure.poses import RobotPoses
from derive.handouts.figure.workspace import sample_workspace, workspace_bytes
from derive.handouts.figure.writers import drawing_bytes, require_matplotlib
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import DataPrinter
from derive.publish.atomic_folder import write_files
from derive.robot.robot import Robot

SUFFIXES = (".pdf", ".svg", ".png")
"""Forms of a figure, by the ending of its file."""

SAMPLES = 20000
"""Points of a workspace unless asked otherwise."""


@dataclass(frozen=True, slots=True)
class Plot:
    """A figure that was written.

    Attributes:
        robot: Name of the robot.
        path: The file.
        remarks: What is drawn, and what was assumed for symbols and limits without a number.
    """

    robot: str
    path: Path
    remarks: str


def plot(
    robot: RobotLike,
    path: str | Path,
    *,
    q: Sequence[float | str] | None = None,
    workspace: bool = False,
    samples: int = SAMPLES,
    seed: int = 0,
    size: float = 1.0,
) -> Plot:
    """Draw the arm with its Denavit-Hartenberg frames, or its workspace, as ``derive plot`` does.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        path: The file, ending in .pdf, .svg or .png; it is overwritten.
        q: Joint values in the units of the robot file; None for those of its block ``figure:``, or zeros.
        workspace: Whether the positions that the end effector reaches are drawn instead.
        samples: Points of the workspace.
        seed: Seed of their choice.
        size: Factor by which the figure is enlarged.

    Returns:
        The file, and what was assumed.

    Raises:
        DeriveError: Another ending, or joint values beside a workspace.
        RobotFileError: The file does not describe a robot.
        TargetError: Matplotlib is missing.
        OutputError: The file cannot be written.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise DeriveError(f"a figure cannot be written as {path.name!r}", allowed=f"allowed: {', '.join(SUFFIXES)}")
    if workspace and q is not None:
        raise DeriveError("-q beside --workspace", remedy="leave one of them out")
    require_matplotlib()
    chosen = load(robot)
    if workspace:
        data, remarks = _workspace(chosen, samples, seed, suffix, size)
    else:
        data, remarks = _arm(chosen, q, suffix, size)
    write_files({path.name: data}, path.parent, force=True)
    return Plot(chosen.name, path, remarks)


def _arm(robot: Robot, q: Sequence[float | str] | None, suffix: str, size: float) -> tuple[bytes, str]:
    """The figure of the arm, and what it shows."""
    poses = RobotPoses(robot)
    drawn = (poses.configuration or poses.zero) if q is None else poses.numbers(configuration(robot, q))
    pairs = zip(robot.joints, drawn, strict=True)
    values = ", ".join(
        f"{joint.variable} = {value:.4g} {'rad' if joint.is_revolute else 'm'}" for joint, value in pairs
    )
    remarks = f"{robot.name} at {values if any(drawn) else 'the zero configuration'}{_assumed(poses)}"
    printer = DataPrinter(robot, Notation.of(robot, robot.handout.notation))
    return drawing_bytes(arm_drawing(robot, printer, poses.frames(drawn), remarks), suffix, size), remarks


def _workspace(robot: Robot, samples: int, seed: int, suffix: str, size: float) -> tuple[bytes, str]:
    """The figure of the workspace, and what it shows."""
    poses = RobotPoses(robot)
    sampled = sample_workspace(poses, samples, seed)
    ranges = [f"{a.variable} from {a.lower:.4g} to {a.upper:.4g} {a.unit}" for a in sampled.assumed]
    limits = f"; limits assumed: {', '.join(ranges)}" if ranges else ""
    remarks = f"workspace of {robot.name}, {samples} points, seed {seed}{limits}{_assumed(poses)}"
    return workspace_bytes(sampled.points, suffix, remarks, size), remarks


def _assumed(poses: RobotPoses) -> str:
    values = [f"{name} = {value:.4g} {unit}" for name, value, unit in poses.assumed]
    return f"; assumed for the drawing: {', '.join(values)}" if values else ""
