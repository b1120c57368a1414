"""``derive schema``: the JSON Schema of the robot file, for editors."""

from __future__ import annotations

import argparse

from derive.cli.terminal import print_json

SUMMARY = "print the JSON Schema of the robot file"
DESCRIPTION = "Print the JSON Schema of the robot file, which lets an editor complete and check it while you type."


def configure(parser: argparse.ArgumentParser) -> None:
    """No arguments.

    Args:
        parser: Stays as it is.
    """


def run(arguments: argparse.Namespace) -> int:
    """Print the schema.

    Args:
        arguments: None.

    Returns:
        The exit status.
    """
    from derive.robot.schema import json_schema

    print_json(json_schema())
    return 0
