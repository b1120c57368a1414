"""``derive new``: a commented robot file to start from."""

from __future__ import annotations

import argparse
from pathlib import Path

from derive.cli.terminal import positive
from derive.errors import OutputError

SUMMARY = "write a commented robot file to start from"
DESCRIPTION = "Write NAME.yaml, a commented robot file that builds as it is. An existing file is never overwritten."


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot's name and its number of joints."""
    parser.add_argument("name", metavar="NAME", help="name of the robot, [a-z0-9-]+; the file is NAME.yaml")
    parser.add_argument("--joints", type=positive, default=2, metavar="N", help="number of joints (default 2)")


def run(arguments: argparse.Namespace) -> int:
    """Write the file and say where."""
    from derive.robot.skeleton import new_robot_text

    text = new_robot_text(arguments.name, joints=arguments.joints)
    path = Path(f"{arguments.name}.yaml")
    _write_new(path, text)
    print(path)
    return 0


def _write_new(path: Path, text: str) -> None:
    try:
        with path.open("x", encoding="utf-8", newline="\n") as file:
            file.write(text)
    except FileExistsError:
        raise OutputError(
            f"{path} exists already", allowed="a name that is not taken", remedy="choose another name or move the file"
        ) from None
