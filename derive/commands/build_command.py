"""``derive build``: from robot files to verified models in a folder each."""

from __future__ import annotations

import argparse
from pathlib import Path

from derive.commands.arguments import positive

SUMMARY = "derive, generate and verify models; the main job"
DESCRIPTION = """\
Derive the equations of each ROBOT, write NumPy, CasADi and LaTeX files to DIR/<robot>/, and compare every generated
function with an independent recursion before the folder is put in place. Without ROBOT, the whole catalogue is built.

A folder is replaced as a whole or not at all. What has not changed is not built again.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robots, where to and how."""
    add = parser.add_argument
    add("robots", metavar="ROBOT", nargs="*", help="robot file or catalogue name (default: the whole catalogue)")
    add("--out", metavar="DIR", type=Path, default=Path("generated"), help="parent folder (default: generated)")
    add("--target", metavar="NAME", action="append", help="only these targets; may be repeated or comma-separated")
    add("--jobs", metavar="N", type=positive, default=1, help="robots built at once (default 1)")
    add("--check", action="store_true", help="write nothing; list what is stale and exit with 1")
    add("--force", action="store_true", help="build even what has not changed")
    add("--quiet", action="store_true", help="no progress and no report")
    add("--json", action="store_true", help="machine-readable report")


def run(arguments: argparse.Namespace) -> int:
    """Build or check, report, and say by the status whether all went well."""
    raise NotImplementedError(arguments)
