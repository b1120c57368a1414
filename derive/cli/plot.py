"""``derive plot``: a figure of the arm, or of its workspace."""

from __future__ import annotations

import argparse
from pathlib import Path

from derive.cli.terminal import magnification, progress

DESCRIPTION = """\
Draw the arm with its joints, links, Denavit-Hartenberg frames and lengths, for instance

  derive plot scara-perugia -q 0.5,0.6,0.3,0 -o scara.pdf
  derive plot puma560-corke --workspace -o reach.png

--workspace draws the true boundary, from critical curves and joint limits, and what is reached in every orientation.
Without -q, the configuration of the robot file's block figure is drawn, or the zero configuration. Symbols without a
number are drawn with a length that is reported. Values that begin with a minus sign are written -q=-90,45.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, what to draw and where to.

    Args:
        parser: Where the arguments are added.
    """
    add = parser.add_argument
    add("robot", metavar="ROBOT", help="robot file or catalogue name")
    add("-o", "--out", metavar="FILE", type=Path, required=True, help="figure to write: .pdf, .svg or .png")
    add("-q", metavar="V1,V2,...", help="joint values, in the units of the robot file (default rad and m)")
    add("--workspace", action="store_true", help="draw where the end effector reaches, and its size")
    add("--size", metavar="FACTOR", type=magnification, default=1.0, help="enlarge the figure (default 1)")


def run(arguments: argparse.Namespace) -> int:
    """Draw, write the file as a whole, and report what was assumed.

    Args:
        arguments: As parsed.

    Returns:
        The exit status.
    """
    from derive.api.plot import plot

    with progress(1, quiet=False) as tell:
        result = plot(
            arguments.robot,
            arguments.out,
            q=None if arguments.q is None else arguments.q.split(","),
            workspace=arguments.workspace,
            size=arguments.size,
            progress=tell,
        )
    print(f"{arguments.out}: {result.remarks}")
    return 0
