"""``derive verify``: generated functions against an independent recursion."""

from __future__ import annotations

import argparse
from pathlib import Path

from derive.cli.terminal import positive
from derive.errors import OutputError

SUMMARY = "compare generated functions with an independent recursion"
DESCRIPTION = """\
Import the models in DIR/<robot>/ and compare each function with an independent recursion in plain floats, at random
configurations and parameters. Prints the worst relative error of each function; above 1e-9 it is a failure.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, its folder and how many samples."""
    parser.add_argument("robot", metavar="ROBOT", help="robot file or catalogue name")
    parser.add_argument(
        "--out", metavar="DIR", type=Path, default=Path("generated"), help="parent folder (default: generated)"
    )
    parser.add_argument("--samples", type=positive, default=24, metavar="N", help="random configurations (default 24)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="seed of the random numbers (default 0)")
    parser.add_argument("--json", action="store_true", help="machine-readable output")


def run(arguments: argparse.Namespace) -> int:
    """Verify the folder and print the worst errors."""
    from derive.cli.terminal import print_columns, print_json
    from derive.robot.robot import Robot
    from derive.verify.verify import verify

    robot = Robot.load(arguments.robot)
    folder = arguments.out / robot.name.replace("-", "_")
    if not folder.is_dir():
        raise OutputError(f"no folder {folder}", remedy=f"run: derive build {arguments.robot} --out {arguments.out}")
    report = verify(robot, folder, samples=arguments.samples, seed=arguments.seed)
    if arguments.json:
        print_json(report.as_dict())
        return 0
    header = ("target", "function", "samples", "worst error")
    rows = [(row.target, row.function, str(row.samples), f"{row.worst:.1e}") for row in report.rows]
    print_columns(rows, header)
    for file in report.left_out:
        print(f"{file}: not verified, there is no C compiler")
    return 0
