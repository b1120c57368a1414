"""``derive plot``: a figure of the arm, or of its workspace."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from derive.cli.terminal import magnification, natural, sample_count

if TYPE_CHECKING:
    from collections.abc import Sequence

    from derive.handout.figure.poses import RobotPoses
    from derive.robot.robot import Robot


SUMMARY = "draw the arm with its frames, or its workspace"
DESCRIPTION = """\
Draw the arm with its joints, links, Denavit-Hartenberg frames and lengths, for instance

  derive plot scara-perugia -q 0.5,0.6,0.3,0 -o scara.pdf
  derive plot puma560-corke --workspace -o reach.png

Without -q, the configuration of the robot file's block figure is drawn, or the zero configuration. Symbols without a
number are drawn with a length that is reported. Values that begin with a minus sign are written -q=-90,45.
"""
SUFFIXES = (".pdf", ".svg", ".png")
SAMPLES = 20000


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, what to draw and where to."""
    add = parser.add_argument
    add("robot", metavar="ROBOT", help="robot file or catalogue name")
    add("-o", "--out", metavar="FILE", type=Path, required=True, help="figure to write: .pdf, .svg or .png")
    add("-q", metavar="V1,V2,...", help="joint values, in the units of the robot file (default rad and m)")
    add("--workspace", action="store_true", help="draw the positions that the end effector reaches")
    add(
        "--samples",
        metavar="N",
        type=sample_count,
        default=SAMPLES,
        help=f"points of the workspace (default {SAMPLES})",
    )
    add("--seed", metavar="S", type=natural, default=0, help="of the points of the workspace (default 0)")
    add("--size", metavar="FACTOR", type=magnification, default=1.0, help="enlarge the figure (default 1)")


def run(arguments: argparse.Namespace) -> int:
    """Draw, write the file as a whole, and report what was assumed."""
    from derive.errors import DeriveError

    suffix = arguments.out.suffix.lower()
    if suffix not in SUFFIXES:
        raise DeriveError(
            f"a figure cannot be written as {arguments.out.name!r}", allowed=f"allowed: {', '.join(SUFFIXES)}"
        )
    if arguments.workspace and arguments.q is not None:
        raise DeriveError("-q beside --workspace", remedy="leave one of them out")
    from derive.handout.figure.matplotlib_writer import require_matplotlib
    from derive.publish.publish import write_files
    from derive.robot.robot import Robot

    require_matplotlib()
    robot = Robot.load(arguments.robot)
    data, remarks = _workspace(robot, arguments, suffix) if arguments.workspace else _arm(robot, arguments, suffix)
    write_files({arguments.out.name: data}, arguments.out.parent, force=True)
    print(f"{arguments.out}: {remarks}")
    return 0


def _arm(robot: Robot, arguments: argparse.Namespace, suffix: str) -> tuple[bytes, str]:
    from derive.handout.data_printer import DataPrinter
    from derive.handout.figure.arm import arm_drawing
    from derive.handout.figure.matplotlib_writer import drawing_bytes
    from derive.handout.figure.poses import RobotPoses
    from derive.handout.notation.notation import Notation

    poses = RobotPoses(robot)
    q = _configuration(robot, poses, arguments)
    data = DataPrinter(robot, Notation.of(robot, robot.handout.notation))
    remarks = f"{robot.name} at {_values(robot, q)}{_assumed(poses)}"
    drawing = arm_drawing(robot, data, poses.frames(q), remarks)
    return drawing_bytes(drawing, suffix, arguments.size), remarks


def _configuration(robot: Robot, poses: RobotPoses, arguments: argparse.Namespace) -> tuple[float, ...]:
    if arguments.q is None:
        return poses.configuration or poses.zero
    from derive.robot.cells import joint_values

    return poses.numbers(joint_values(robot, arguments.q.split(",")))


def _workspace(robot: Robot, arguments: argparse.Namespace, suffix: str) -> tuple[bytes, str]:
    from derive.handout.figure.poses import RobotPoses
    from derive.handout.figure.workspace import sample_workspace, workspace_bytes

    poses = RobotPoses(robot)
    workspace = sample_workspace(poses, arguments.samples, arguments.seed)
    ranges = [f"{a.variable} from {a.lower:.4g} to {a.upper:.4g} {a.unit}" for a in workspace.assumed]
    limits = f"; limits assumed: {', '.join(ranges)}" if ranges else ""
    remarks = f"workspace of {robot.name}, {arguments.samples} points, seed {arguments.seed}{limits}{_assumed(poses)}"
    return workspace_bytes(workspace.points, suffix, remarks, arguments.size), remarks


def _values(robot: Robot, q: Sequence[float]) -> str:
    if not any(q):
        return "the zero configuration"
    joints = zip(robot.joints, q, strict=True)
    return ", ".join(f"{joint.variable} = {value:.4g} {'rad' if joint.is_revolute else 'm'}" for joint, value in joints)


def _assumed(poses: RobotPoses) -> str:
    values = [f"{name} = {value:.4g} {unit}" for name, value, unit in poses.assumed]
    return f"; assumed for the drawing: {', '.join(values)}" if values else ""
