"""``derive map``: which poses an arm reaches, in how many postures, how well."""

import argparse
import sys
from dataclasses import asdict
from functools import partial
from pathlib import Path

from derive.cli.terminal import add_shared, keywords, numbers, positive, print_json, progress

DESCRIPTION = """\
Map the workspace to a Zarr store: for each cell of a grid and each orientation the number of postures within the joint
limits, the best manipulability, and the margin to the limits. xarray.open_zarr opens it.

Orientations are directions of the end effector's z axis on a Fibonacci sphere and rolls about it; of planar arms and
SCARAs angles about z; of an arm without orientation in its task none. An interrupted map goes on with --resume.

  derive map ur5e.yaml --grid 0.025 -o reach.zarr
  derive map ur5e.yaml --box 0.2,0.6,-0.2,0.2,0,0.4 --plot slice.png -o reach.zarr
"""
_box = partial(numbers, wanted="a list of numbers such as 0.2,0.6")


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, the grid, where it is computed, and where to."""
    add = parser.add_argument
    add_shared(parser, "robot")
    add_shared(parser, "folder", metavar="STORE", required=True, help="Zarr store to write")
    add("--grid", metavar="METRES", type=float, default=0.05, help="side of a cell (default 0.05)")
    add("--orientations", metavar="N", type=positive, default=64, help="directions, or angles (default 64)")
    add("--rolls", metavar="N", type=positive, default=12, help="turns about each direction (default 12)")
    add("--box", metavar="X0,X1,...", type=_box, help="lower and upper ends of what is mapped, in metres")
    add("--conditioning", action="store_true", help="add the condition of the Jacobian")
    add("--workers", metavar="N", type=positive, help="threads (default: one for each core)")
    add("--scheduler", metavar="ADDRESS", help="compute on a Dask cluster, such as tcp://127.0.0.1:8786")
    add("--resume", action="store_true", help="go on with a store that was begun")
    add("--plot", metavar="FILE", type=Path, help="draw a slice: .pdf, .svg or .png")
    add("--yes", action="store_true", help="compute more than 10^10 poses")
    add_shared(parser, "force", "quiet", "json")


def run(arguments: argparse.Namespace) -> None:
    """Compute the blocks that are missing, and report what is reached."""
    from derive.api.map import write_map

    names = ("grid", "orientations", "rolls", "box", "conditioning", "workers", "scheduler", "resume", "force")
    how = keywords(arguments, *names) | {"large": arguments.yes, "picture": arguments.plot}
    with progress(1, quiet=arguments.quiet or arguments.json) as tell:
        try:
            found = write_map(arguments.robot, arguments.out, **how, progress=tell)
        except KeyboardInterrupt:
            print(f"derive: finished blocks are kept; go on with: --resume -o {arguments.out}", file=sys.stderr)
            raise
    if arguments.json:
        print_json({**asdict(found), "path": str(found.path)})
    elif not arguments.quiet:
        done = f", {found.computed} of {found.blocks} blocks computed now" if arguments.resume else ""
        print(f"{found.path}: {found.cells} cells, {found.poses} poses{done}")
        print(f"reached: {found.reached} cells, {found.everywhere} of them in every orientation")
        print(*found.remarks, sep="\n", end="\n" if found.remarks else "")
