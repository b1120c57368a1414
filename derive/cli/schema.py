"""``derive schema``: the JSON Schema of the robot file or the motion plan, for editors."""

import argparse

from derive.cli.terminal import add_shared, print_json

DESCRIPTION = """\
Print the JSON Schema of the robot file, or of the motion plan, which lets an editor complete and check it while you
type.

  derive schema > robot.schema.json
  derive schema --plan > plan.schema.json
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Which file."""
    parser.add_argument("--plan", action="store_true", help="of the motion plan that derive move reads")
    add_shared(parser, "json")


def run(arguments: argparse.Namespace) -> None:
    """Print the schema."""
    if arguments.plan:
        from derive.plans.schema import plan_json_schema as schema
    else:
        from derive.robot.reading.schema import json_schema as schema
    print_json(schema())
