"""``derive plot``: a figure of the arm, or of its workspace."""

import argparse
from pathlib import Path

from derive.cli.terminal import add_shared, keywords, magnification, print_json, progress

DESCRIPTION = """\
Draw the arm with its joints, links, Denavit-Hartenberg frames and lengths.

--workspace draws the true boundary, from critical curves and joint limits, and what is reached in every orientation.
Without --at, the configuration of the robot file's block figure is drawn, or the zero configuration. Symbols without a
number are drawn with a length that is reported.

  derive plot scara-perugia --at 0.5,0.6,0.3,0 -o scara.pdf
  derive plot puma560-corke --workspace -o reach.png
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, what to draw and where to."""
    add = parser.add_argument
    add_shared(parser, "robot")
    add_shared(parser, "out", type=Path, required=True, help="figure to write: .pdf, .svg or .png")
    add_shared(parser, "at", help="joint values, in the units of the robot file (default rad and m)")
    add("--workspace", action="store_true", help="draw the workspace of the end effector, with its size")
    add("--size", metavar="FACTOR", type=magnification, default=1.0, help="enlarge the figure (default 1)")
    add_shared(parser, "force", "quiet", "json")


def run(arguments: argparse.Namespace) -> None:
    """Draw, write the file as a whole, and report what was assumed."""
    from derive.api.plot import plot

    with progress(1, quiet=arguments.quiet or arguments.json) as tell:
        how = keywords(arguments, "workspace", "size", "force")
        q = ",".join(arguments.at).split(",") if arguments.at else None
        result = plot(arguments.robot, arguments.out, q=q, **how, progress=tell)
    if arguments.json:
        print_json({"robot": result.robot, "file": str(result.path), "report": result.remarks})
    elif not arguments.quiet:
        print(f"{result.path}: {result.remarks}")
