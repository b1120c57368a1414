"""``derive export``: a robot in the formats of other programs."""

import argparse

from derive.cli.terminal import add_shared, keywords, named_values, print_written

DESCRIPTION = """\
Write a robot for another program.

urdf: ROS and others; mjcf: MuJoCo; rtb: a Python script for roboticstoolbox (DHRobot); corke: a MATLAB function for
SerialLink; rigidbodytree: a MATLAB function for the Robotics System Toolbox; csv: the table and the links as numbers.
Features that the format lacks are listed on standard error and in the file's first comment.

  derive export kuka-kr5 --format urdf -o kr5.urdf
  derive export puma560-corke --format mjcf --inertia possible -o puma.xml
  derive export anthropomorphic-arm --format rtb --values a2=0.4,a3=0.35 -o arm.py
"""
FORMATS = ("urdf", "mjcf", "rtb", "corke", "rigidbodytree", "csv")


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, the format and the file."""
    add = parser.add_argument
    add_shared(parser, "robot")
    add_shared(parser, "format", required=True, choices=FORMATS, help=", ".join(FORMATS))
    add_shared(parser, "out", "inertia")
    values = "numbers of symbols, as in the robot file"
    add("--values", metavar="NAME=VALUE,...", action="append", default=[], help=values)
    add_shared(parser, "force", "quiet", "json")


def run(arguments: argparse.Namespace) -> None:
    """Write the file, or print it."""
    from derive.api.convert import export_file
    from derive.api.robots import load
    from derive.errors import DeriveError, quoted
    from derive.model.identification.possible import wants_possible

    values = dict[str, str]()
    for name, value in named_values(arguments.values, "--values", "allowed: name=value,name=value"):
        if name in values:
            raise DeriveError(f"{quoted(name)[1:-1]} twice in --values", remedy="leave one of them out")
        values[name] = value
    robot = load(arguments.robot, remarks_on_bodies=not wants_possible(arguments.inertia))
    options = keywords(arguments, "inertia", "force")
    found = export_file(robot, arguments.format, arguments.out, values=values, **options)
    report = {"format": arguments.format, "report": list(found.remarks), "remarks": robot.remarks_as_dicts}
    print_written(arguments, found.text, report, [str(arguments.out)])
