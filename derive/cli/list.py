"""``derive list``: the robots that come with derive."""

from __future__ import annotations

import argparse

from derive.cli.terminal import one_line, print_columns, print_json

DESCRIPTION = """\
List the built-in robots: name, joints (R revolute, P prismatic), convention, dynamics, title; or the built-in plans of
`derive move`.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """What is listed, and the form of the output.

    Args:
        parser: Where the arguments are added.
    """
    parser.add_argument("--plans", action="store_true", help="motion plans instead: name, robot, segments, title")
    parser.add_argument("--json", action="store_true", help="machine-readable output")


def run(arguments: argparse.Namespace) -> int:
    """Print the catalogue.

    Args:
        arguments: As parsed.

    Returns:
        The exit status.
    """
    from derive.api.robots import catalogue, load

    if arguments.plans:
        return _list_plans(as_json=arguments.json)
    robots = [load(name, remarks_on_bodies=False) for name in catalogue()]
    joints = ["".join("R" if joint.is_revolute else "P" for joint in robot.joints) for robot in robots]
    if arguments.json:
        keys = ("name", "joints", "convention", "dynamics", "title")
        values = ((r.name, j, r.convention.value, r.has_dynamics, r.title) for r, j in zip(robots, joints, strict=True))
        print_json([dict(zip(keys, row, strict=True)) for row in values])
        return 0
    rows = [
        (
            robot.name,
            letters if robot.n <= 8 else f"{robot.n} joints",
            robot.convention.value,
            "yes" if robot.has_dynamics else "-",
            one_line(robot.title),
        )
        for robot, letters in zip(robots, joints, strict=True)
    ]
    print_columns(rows, ("name", "joints", "convention", "dynamics", "title"))
    return 0


def _list_plans(*, as_json: bool) -> int:
    from derive.motion.catalogue import plan_names
    from derive.motion.plan import load_plan

    header = ("name", "robot", "segments", "title")
    plans = [(name, load_plan(name)) for name in plan_names()]
    rows = [(name, plan.robot.name, len(plan.steps) or 1, plan.title) for name, plan in plans]
    if as_json:
        print_json([dict(zip(header, row, strict=True)) for row in rows])
    else:
        print_columns([tuple(one_line(str(cell)) for cell in row) for row in rows], header)
    return 0
