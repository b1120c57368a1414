"""``derive sample``: functions of a robot over many configurations."""

import argparse
from functools import partial
from itertools import product
from typing import Any

from derive.cli.terminal import add_shared, keywords, numbers, positive, print_columns, print_json, progress

DESCRIPTION = """\
Print the smallest, mean and largest value of every entry of generated functions over many configurations.

FUNCTION is a generated function or its symbol: tau, J, T, B, manipulability. Functions are compiled where there is a C
compiler. Memory is bounded, and neither workers nor chunks change a bit of the result. Bounds are in SI units, one
number for all entries or one for each.

  derive sample puma560-corke manipulability --number 1e6
  derive sample puma560-corke tau --number 1e7 --speed 2 --qdd 5 --reduce max,quantiles
  derive sample puma560-corke T J --over grid --number 1e7 --json
  derive sample puma560-corke T J --number 1e9 --scheduler tcp://10.0.0.1:8786
"""
_bounds = partial(numbers, wanted="a number, nor numbers with commas between")


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, its functions, and where they are evaluated."""
    add = parser.add_argument
    add_shared(parser, "robot")
    add("functions", metavar="FUNCTION", nargs="+", help="such as tau, J or inertia_matrix")
    add("--over", metavar="WHERE", default="limits", help="limits: at random within them (default), or grid")
    add("--number", metavar="N", type=float, default=1e6, help="configurations, such as 1e8 (default 1e6)")
    add("--reduce", metavar="KINDS", default="min,mean,max", help="of min, mean, max, quantiles (default min,mean,max)")
    add("--speed", metavar="V", type=_bounds, help="largest joint speeds (default: those of the robot file)")
    add("--qdd", metavar="A", type=_bounds, help="largest joint accelerations")
    add("--tau", metavar="M", type=_bounds, help="largest joint torques, as an argument (default: the robot file's)")
    add("--wrench", metavar="H", type=_bounds, help="largest force and moment on the end effector")
    add("--seed", metavar="N", type=int, default=0, help="of the random numbers (default 0)")
    add("--chunk", metavar="N", type=positive, default=100_000, help="configurations of a piece of work (default 1e5)")
    add("--workers", metavar="N", type=positive, help="threads (default: one for each processor)")
    add("--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers do it instead: tcp://HOST:PORT")
    add_shared(parser, "quiet", "json")


def run(arguments: argparse.Namespace) -> None:
    """Evaluate, reduce and print."""
    from derive.api.sample import sample
    from derive.sampling.sample import QUANTILES

    bounds = keywords(arguments, "speed", "qdd", "tau", "wrench")
    how = keywords(arguments, "over", "number", "seed", "chunk", "workers", "scheduler")
    kinds = arguments.reduce.split(",")
    with progress(1, quiet=arguments.quiet) as tell:
        found = sample(arguments.robot, arguments.functions, reduce=kinds, bounds=bounds, **how, progress=tell)
    if arguments.json:
        print_json({name: one.as_dict() for name, one in found.items()})
    elif not arguments.quiet:
        rows: list[list[str]] = []
        for name, one in found.items():
            columns: dict[str, Any] = dict(one.reductions)
            columns |= zip((f"{share:.0%}" for share in QUANTILES), columns.pop("quantiles", ()), strict=False)
            for entry in product(*map(range, one.shape)):
                label = f"{name}[{','.join(str(k + 1) for k in entry)}]" if entry else name
                rows.append([label, *(f"{values[entry]: .6g}" for values in columns.values())])
        print_columns(rows, [f"{one.number} configurations", *columns])
        for name, one in found.items():
            if one.lacking:
                print(f"{name} has no finite value in {one.lacking} of them, which are left out")
