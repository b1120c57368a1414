"""``derive list``: the robots that come with derive."""

import argparse
from typing import Any

from derive.cli.terminal import add_shared, one_line, print_columns, print_json

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


def run(arguments: argparse.Namespace) -> None:
    """Print the catalogue."""
    from derive.api.robots import catalogue, load

    if arguments.plans:
        from derive.plans.catalogue import plan_names
        from derive.plans.plan import load_plan

        plans = [(name, load_plan(name)) for name in plan_names()]
        keys: tuple[str, ...] = ("name", "robot", "segments", "title")
        rows: list[tuple[Any, ...]] = [(name, p.robot.name, len(p.steps) or 1, p.title) for name, p in plans]
    else:
        robots = [load(name, remarks_on_bodies=False) for name in catalogue()]
        joints = ["".join("R" if joint.is_revolute else "P" for joint in robot.joints) for robot in robots]
        keys = ("name", "joints", "convention", "dynamics", "title")
        rows = [(r.name, j, r.convention.value, r.has_dynamics, r.title) for r, j in zip(robots, joints, strict=True)]
    if arguments.json:
        print_json([dict(zip(keys, row, strict=True)) for row in rows])
        return
    if not arguments.plans:
        rows = [(n, j if len(j) <= 8 else f"{len(j)} joints", c, "yes" if d else "-", t) for n, j, c, d, t in rows]
    print_columns([[one_line(str(cell)) for cell in row] for row in rows], keys)
