"""``derive style``: how a book writes its formulas, found from some of them."""

import argparse
from pathlib import Path

from derive.cli.terminal import FAILED, add_shared, one_line, print_json

DESCRIPTION = """\
Find the `style:` block with which derive prints most of the given formulas as they are printed; comments list those
that differ, and why. The formulas are those of corpus files (a block `robot:` and a list `expected:`), all of
one book, or are given one by one, in the shorthand of lecture notes or as LaTeX.

A formula with a single term carries no information about the style.
Exit status: 0 found, 1 a formula is wrong, 2 a formula cannot be read.

  derive style notes.yaml
  derive style planar-2r-perugia --example 'B[1,2] = Il2 + ml2*l2**2 + ml2*a1*l2*c2 + kr2*Im2'
  derive style planar-2r-perugia --example 'b_{12} = I_{l2} + m_{l2} l_2^2 + m_{l2} a_1 l_2 c_2 + k_{r2} I_{m2}'
"""

FILES = (".tex", ".yaml", ".yml")  # examples that end so are files


def configure(parser: argparse.ArgumentParser) -> None:
    """The files or the robot, and its formulas."""
    add = parser.add_argument
    add("sources", metavar="ROBOT_OR_CORPUS", nargs="+", help="corpus files; or a robot file or catalogue name")
    formula = "a printed formula of the robot, 'tau[1] = ...', or a .tex file; repeatable"
    add("--example", metavar="E", action="append", help=formula)
    add_shared(parser, "json")


def run(arguments: argparse.Namespace) -> int:
    """Find the style and print it."""
    from derive.api.style import find_style

    given = [Path(text) if text.endswith(FILES) else text for text in arguments.example or ()]
    found = find_style(*arguments.sources, examples=given)
    if arguments.json:
        print_json(found.as_dict())
    else:
        print("\n".join(one_line(line) for line in str(found).splitlines()))
    return 0 if found.passed else FAILED
