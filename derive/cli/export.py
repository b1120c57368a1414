"""``derive export``: a robot in the formats of other programs."""

from __future__ import annotations

import argparse
from pathlib import Path

from derive.cli.terminal import DONE, print_json

DESCRIPTION = """\
Write a robot for another program, for instance

  derive export kuka-kr5 --to urdf -o kr5.urdf
  derive export puma560-corke --to mjcf --inertia possible -o puma.xml
  derive export anthropomorphic-arm --to rtb --values a2=0.4,a3=0.35 -o arm.py

urdf: ROS and others; mjcf: MuJoCo; rtb: a Python script for roboticstoolbox (DHRobot); corke: a MATLAB function for
SerialLink; rigidbodytree: a MATLAB function for the Robotics System Toolbox; csv: the table and the links as numbers.
What a format cannot say is remarked on standard error and stands in the file's first comment.
"""

STDOUT = Path("-")
FORMATS = ("urdf", "mjcf", "rtb", "corke", "rigidbodytree", "csv")


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, the format and the file.

    Args:
        parser: Where the arguments are added.
    """
    add = parser.add_argument
    add("robot", metavar="ROBOT", help="robot file or catalogue name")
    add("--to", metavar="FORMAT", required=True, choices=FORMATS, help=", ".join(FORMATS))
    add("-o", "--out", metavar="FILE", type=Path, help="file to write (default: standard output)")
    add("--inertia", choices=("given", "possible"), default="given", help="bodies as given, or the nearest that exist")
    add("--values", metavar="NAME=VALUE,...", action="append", default=[], help="numbers of symbols, in SI units")
    add("--force", action="store_true", help="overwrite the file if it exists")
    add("--json", action="store_true", help="machine-readable report")


def run(arguments: argparse.Namespace) -> int:
    """Write the file, or print it.

    Args:
        arguments: As parsed.

    Returns:
        The exit status.

    Raises:
        DeriveError: Values that are no ``name=value``, or options that do not belong together.
    """
    from derive.api.export import export_file
    from derive.api.robots import load
    from derive.errors import DeriveError, quoted
    from derive.exchange.possible import wants_possible

    out = None if arguments.out == STDOUT else arguments.out
    if out is None and (arguments.force or arguments.json):
        raise DeriveError(f"--{'force' if arguments.force else 'json'} without -o", remedy="add -o FILE")
    values = {}
    for cell in ",".join(arguments.values).split(",") if arguments.values else []:
        name, equals, value = (part.strip() for part in cell.partition("="))
        if not (name and equals and value):
            raise DeriveError(f"{quoted(cell)} in --values", allowed="allowed: name=value,name=value")
        if name in values:
            raise DeriveError(f"{quoted(name)[1:-1]} twice in --values", remedy="leave one of them out")
        values[name] = value
    robot = load(arguments.robot, remarks_on_bodies=not wants_possible(arguments.inertia))
    found = export_file(robot, arguments.to, out, inertia=arguments.inertia, values=values, force=arguments.force)
    if out is None:
        print(found.text, end="")
    elif arguments.json:
        report = {"file": str(out), "format": arguments.to, "report": list(found.remarks)}
        print_json(report | {"remarks": robot.remarks_as_dicts})
    else:
        print(out)
    return DONE
