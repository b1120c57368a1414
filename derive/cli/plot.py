"""``derive plot``: a figure of the arm, or of its workspace."""

from __future__ import annotations

import argparse
from pathlib import Path

from derive.cli.terminal import magnification, natural, sample_count

SUMMARY = "draw the arm with its frames, or its workspace"
DESCRIPTION = """\
Draw the arm with its joints, links, Denavit-Hartenberg frames and lengths, for instance

  derive plot scara-perugia -q 0.5,0.6,0.3,0 -o scara.pdf
  derive plot puma560-corke --workspace -o reach.png

Without -q, the configuration of the robot file's block figure is drawn, or the zero configuration. Symbols without a
number are drawn with a length that is reported. Values that begin with a minus sign are written -q=-90,45.
"""
SAMPLES = 20000
"""Points of a workspace, as in `derive.api.plot`, which is not imported for ``--help``."""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, what to draw and where to.

    Args:
        parser: Where the arguments are added.
    """
    add = parser.add_argument
    add("robot", metavar="ROBOT", help="robot file or catalogue name")
    add("-o", "--out", metavar="FILE", type=Path, required=True, help="figure to write: .pdf, .svg or .png")
    add("-q", metavar="V1,V2,...", help="joint values, in the units of the robot file (default rad and m)")
    add("--workspace", action="store_true", help="draw the positions that the end effector reaches")
    points = f"points of the workspace (default {SAMPLES})"
    add("--samples", metavar="N", type=sample_count, default=SAMPLES, help=points)
    add("--seed", metavar="S", type=natural, default=0, help="of the points of the workspace (default 0)")
    add("--size", metavar="FACTOR", type=magnification, default=1.0, help="enlarge the figure (default 1)")


def run(arguments: argparse.Namespace) -> int:
    """Draw, write the file as a whole, and report what was assumed.

    Args:
        arguments: As parsed.

    Returns:
        The exit status.
    """
    from derive.api.plot import plot

    result = plot(
        arguments.robot,
        arguments.out,
        q=None if arguments.q is None else arguments.q.split(","),
        workspace=arguments.workspace,
        samples=arguments.samples,
        seed=arguments.seed,
        size=arguments.size,
    )
    print(f"{arguments.out}: {result.remarks}")
    return 0
