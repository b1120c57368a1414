"""``derive list``: the robots that come with derive."""

import argparse

from derive.cli.options import add_shared
from derive.cli.terminal import one_line, print_columns, print_json

DESCRIPTION = """\
List the built-in robots: name, joints (R revolute, P prismatic), convention, dynamics, title; or the built-in plans of
`derive move`.

  derive list
  derive list --plans
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """What is listed, and the form of the output."""
    parser.add_argument("--plans", action="store_true", help="motion plans instead: name, robot, segments, title")
    add_shared(parser, "json")


def run(arguments: argparse.Namespace) -> int:
    """Print the catalogue."""
    from derive.api.robots import catalogue, load

    if arguments.plans:
        from derive.plans.catalogue import plan_names
        from derive.plans.plan import load_plan

        header = ("name", "robot", "segments", "title")
        plans = [(name, load_plan(name)) for name in plan_names()]
        found = [(name, plan.robot.name, len(plan.steps) or 1, plan.title) for name, plan in plans]
        if arguments.json:
            print_json([dict(zip(header, row, strict=True)) for row in found])
        else:
            print_columns([tuple(one_line(str(cell)) for cell in row) for row in found], header)
        return 0
    robots = [load(name, remarks_on_bodies=False) for name in catalogue()]
    joints = ["".join("R" if joint.is_revolute else "P" for joint in robot.joints) for robot in robots]
    keys = ("name", "joints", "convention", "dynamics", "title")
    rows = [(r.name, j, r.convention.value, r.has_dynamics, r.title) for r, j in zip(robots, joints, strict=True)]
    if arguments.json:
        print_json([dict(zip(keys, row, strict=True)) for row in rows])
        return 0
    shown = [
        (name, j if len(j) <= 8 else f"{len(j)} joints", convention, "yes" if dynamics else "-", one_line(title))
        for name, j, convention, dynamics, title in rows
    ]
    print_columns(shown, keys)
    return 0
