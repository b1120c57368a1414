"""``derive check``: printed formulas against derived ones."""

from __future__ import annotations

import argparse

SUMMARY = "compare printed formulas with derived ones"
DESCRIPTION = """\
Read corpus files (a block `robot:` and a list `expected:` of printed quantities) and say for each printed entry whether
it equals the derived one. Equality is decided exactly; what is wrong is shown with the right expression and a
numeric counter-example.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The files and the form of the output."""
    parser.add_argument("files", metavar="FILE", nargs="+", help="corpus file: a robot and its printed formulas")
    parser.add_argument("--json", action="store_true", help="machine-readable output")


def run(arguments: argparse.Namespace) -> int:
    """Check every file."""
    raise NotImplementedError(arguments)
