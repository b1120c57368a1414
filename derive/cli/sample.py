"""``derive sample``: functions of a robot over many configurations."""

from __future__ import annotations

import argparse
from itertools import product
from typing import TYPE_CHECKING, Any

from derive.cli.terminal import add_shared, keywords, positive, print_columns, print_json, progress
from derive.errors import quoted

if TYPE_CHECKING:
    from derive.api.sample import Sample
    from derive.sampling.sample import Sampled

DESCRIPTION = """\
Print the smallest, mean and largest value of every entry of generated functions over many configurations.

FUNCTION is a generated function or its symbol: tau, J, T, B, manipulability. Functions are compiled where there is a C
compiler. Memory is bounded, and neither workers nor chunks change a bit of the result. Bounds are in SI units, one
number for all joints or one for each.

  derive sample puma560-corke manipulability --number 1e6
  derive sample puma560-corke tau --number 1e7 --speed 2 --qdd 5 --reduce max,quantiles
  derive sample scara-bajd T J --over grid --number 1e5 --json
  derive sample puma560-corke T J --number 1e9 --scheduler tcp://10.0.0.1:8786
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, its functions, and where they are evaluated."""
    add = parser.add_argument
    add_shared(parser, "robot")
    add("functions", metavar="FUNCTION", nargs="+", help="such as tau, J or inertia_matrix")
    add("--over", metavar="WHERE", default="limits", help="limits: at random within them (default), or grid")
    add("--number", metavar="N", type=_number, default=10**6, help="configurations, such as 1e8 (default 1e6)")
    kinds = "of min, mean, max, quantiles (default min,mean,max)"
    add("--reduce", metavar="KINDS", type=lambda text: text.split(","), default=("min", "mean", "max"), help=kinds)
    add("--speed", metavar="V", type=_bounds, help="largest joint speeds (default: those of the robot file)")
    add("--qdd", metavar="A", type=_bounds, help="largest joint accelerations")
    add("--tau", metavar="M", type=_bounds, help="largest joint torques, as an argument (default: the robot file's)")
    add("--wrench", metavar="H", type=_bounds, help="largest force and moment on the end effector")
    add("--seed", metavar="N", type=_number, default=0, help="of the random numbers (default 0)")
    add("--chunk", metavar="N", type=positive, default=100_000, help="configurations of a piece of work (default 1e5)")
    add("--workers", metavar="N", type=positive, help="threads (default: one for each processor)")
    add("--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers do it instead: tcp://HOST:PORT")
    add_shared(parser, "quiet", "json")


def run(arguments: argparse.Namespace) -> None:
    """Evaluate, reduce and print."""
    from derive.api.sample import sample

    bounds = keywords(arguments, "speed", "qdd", "tau", "wrench")
    how = keywords(arguments, "over", "number", "reduce", "seed", "chunk", "workers", "scheduler")
    with progress(1, quiet=arguments.quiet) as tell:
        found = sample(arguments.robot, arguments.functions, **bounds, **how, progress=tell)
    if arguments.json:
        functions = {name: _as_dict(one) for name, one in found.functions.items()}
        head = {"robot": found.robot, "over": found.over, "number": found.number, "remarks": [*found.remarks]}
        print_json(head | {"functions": functions})
    elif not arguments.quiet:
        _print(found)


def _as_dict(found: Sampled) -> dict[str, Any]:
    where = {kind: {name: value.tolist() for name, value in at.items()} for kind, at in found.where.items()}
    reductions = {kind: values.tolist() for kind, values in found.reductions.items()}
    return {"shape": [*found.shape], "lacking": found.lacking, **reductions, "where": where}


def _print(found: Sample) -> None:
    """A table with a row for each entry, and what is to be said of them."""
    from derive.sampling.reductions import QUANTILES

    place = "on a grid" if found.over == "grid" else "at random"
    print(f"{found.robot}: {found.number} configurations {place} within the limits")
    rows, header = [], [""]
    for name, one in found.functions.items():
        columns: dict[str, Any] = {}
        for kind, values in one.reductions.items():
            many = kind == "quantiles"
            columns |= (
                {f"{share:.0%}": part for share, part in zip(QUANTILES, values, strict=True)}
                if many
                else {kind: values}
            )
        header = ["", *columns]
        for entry in product(*map(range, one.shape)):
            label = f"{name}[{','.join(str(k + 1) for k in entry)}]" if entry else name
            rows.append([label, *(f"{values[entry]: .6g}" for values in columns.values())])
    print_columns(rows, header)
    print(*found.remarks, sep="\n", end="\n" * bool(found.remarks))
    for name, one in found.functions.items():
        if one.lacking:
            print(f"{name} has no finite value in {one.lacking} configurations, which are left out")


def _number(text: str) -> int:
    """A whole number, 1e8 for instance."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value <= 1e15 or value != int(value):
        raise argparse.ArgumentTypeError(f"{quoted(text)} is not a whole number such as 1e6")
    return int(value)


def _bounds(text: str) -> list[float]:
    """One number, or several with commas between."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"{quoted(text)} is not a number, nor numbers with commas between") from None
