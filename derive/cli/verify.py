"""``derive verify``: generated functions against an independent recursion."""

from __future__ import annotations

import argparse
from pathlib import Path

from derive.cli.terminal import positive, print_columns, print_json

DESCRIPTION = """\
Import the models in DIR/<robot>/ and compare each function with an independent recursion in plain floats, at random
configurations and parameters. Prints the worst relative error of each function; above 1e-9 it is a failure.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, its folder and how many samples.

    Args:
        parser: Where the arguments are added.
    """
    add = parser.add_argument
    add("robot", metavar="ROBOT", help="robot file or catalogue name")
    add("--out", metavar="DIR", type=Path, default=Path("generated"), help="parent folder (default: generated)")
    add("--samples", type=positive, default=24, metavar="N", help="random configurations (default 24)")
    add("--seed", type=int, default=0, metavar="S", help="seed of the random numbers (default 0)")
    add("--json", action="store_true", help="machine-readable output")


def run(arguments: argparse.Namespace) -> int:
    """Verify the folder and print the worst errors.

    Args:
        arguments: As parsed.

    Returns:
        The exit status.
    """
    from derive.api.build import verify
    from derive.api.robots import load

    robot = load(arguments.robot)
    report = verify(robot, arguments.out, samples=arguments.samples, seed=arguments.seed)
    if arguments.json:
        print_json(report.as_dict() | {"remarks": robot.remarks_as_dicts})
        return 0
    rows = [(row.target, row.function, str(row.samples), f"{row.worst:.1e}") for row in report.rows]
    print_columns(rows, ("target", "function", "samples", "worst error"))
    for file in report.left_out:
        print(f"{file}: not verified, there is no C compiler")
    return 0
