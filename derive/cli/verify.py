"""``derive verify``: generated functions against an independent recursion."""

import argparse
from pathlib import Path

from derive.cli.terminal import add_shared, one_line, positive, print_columns, print_json

DESCRIPTION = """\
Import the models in DIR/<robot>/ and compare each function with an independent recursion in plain floats, at random
configurations and parameters. Prints the worst relative error of each function; above 1e-9 it is a failure. Of a robot
that `derive import` made the bound of its pose error is proven again, against the URDF that its file names; where
nothing is built yet, that alone.

  derive verify my-arm.yaml
  derive verify puma560-corke --samples 1000 --seed 7
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, its folder and how many samples."""
    add = parser.add_argument
    add_shared(parser, "robot")
    add_shared(parser, "folder", default=Path("generated"), help="parent folder (default: generated)")
    add("--samples", type=positive, default=24, metavar="N", help="random configurations (default 24)")
    add("--seed", type=int, default=0, metavar="S", help="seed of the random numbers (default 0)")
    add_shared(parser, "quiet", "json")


def run(arguments: argparse.Namespace) -> None:
    """Verify the folder and print the worst errors."""
    from derive.api.build import verify
    from derive.api.importing import verify_import
    from derive.api.robots import load
    from derive.publish.build import folder_of

    robot = load(arguments.robot)
    if (imported := verify_import(arguments.robot)) is not None and not (arguments.json or arguments.quiet):
        print(one_line(str(imported)))
    if imported is not None and imported.found is not None and not folder_of(robot, arguments.out).is_dir():
        if arguments.json:
            print_json({"robot": robot.name, "import": imported.as_dict(), "remarks": robot.remarks_as_dicts})
        return
    report = verify(robot, arguments.out, samples=arguments.samples, seed=arguments.seed)
    if arguments.json:
        further = {} if imported is None else {"import": imported.as_dict()}
        print_json(report.as_dict() | further | {"remarks": robot.remarks_as_dicts})
    elif not arguments.quiet:
        rows = [(row.target, row.function, str(row.samples), f"{row.worst:.1e}") for row in report.rows]
        print_columns(rows, ("target", "function", "samples", "worst error"))
        for reason in report.reasons:
            print(reason)
