"""``derive list``: the robots that come with derive."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from derive.cli.terminal import one_line

if TYPE_CHECKING:
    from derive.robot.robot import Robot


SUMMARY = "list the built-in robots"
DESCRIPTION = "List the built-in robots: name, joints (R revolute, P prismatic), convention, dynamics, title."


def configure(parser: argparse.ArgumentParser) -> None:
    """Only the form of the output."""
    parser.add_argument("--json", action="store_true", help="machine-readable output")


def run(arguments: argparse.Namespace) -> int:
    """Print the catalogue."""
    from derive.cli.terminal import print_columns, print_json
    from derive.robot.catalogue import catalogue_names
    from derive.robot.robot import Robot

    rows = [_row(Robot.load(name)) for name in catalogue_names()]
    if arguments.json:
        print_json(rows)
        return 0
    header = ("name", "joints", "convention", "dynamics", "title")
    print_columns([_cells(row) for row in rows], header)
    return 0


def _row(robot: Robot) -> dict[str, Any]:
    return {
        "name": robot.name,
        "joints": "".join("R" if joint.is_revolute else "P" for joint in robot.joints),
        "convention": robot.convention.value,
        "dynamics": robot.has_dynamics,
        "title": robot.title,
    }


def _cells(row: dict[str, Any]) -> list[str]:
    joints = row["joints"]
    shown = joints if len(joints) <= 8 else f"{len(joints)} joints"
    return [row["name"], shown, row["convention"], "yes" if row["dynamics"] else "-", one_line(row["title"])]
