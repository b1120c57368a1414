"""What each threshold of the search is worth: ``python -m tests.programs.thresholds [options] [ROBOT...]``.

Every threshold of `Policy` is halved and doubled, that of a margin its part above 1, and
all programs are searched with it: those of the built-in robots and of the benchmarks, or of the given files. Printed is
one line for each: the value, in how many functions operations were gained and lost, the change of all costs together,
and the processor time as a multiple of that with the policy as it is. ``--only`` names a threshold, ``--function`` a
generated function; each may be repeated. Three quarters of an hour on one core for all of them.

Where a threshold leaves an arm no formulation of a function, it shows as much cheaper: it has no value.
"""

import argparse
import multiprocessing
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, fields
from pathlib import Path

from derive.programs.optimise import search_policy
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot

BENCHES = Path(__file__).parents[2] / "bench" / "robots"

Costs = dict[tuple[str, str], int]
"""Cost of the body by robot and function."""


def values_tried(name: str) -> tuple[float, float]:
    """A threshold halved and doubled; of a margin the part above 1."""
    value = getattr(search_policy.Policy(), name)
    if not name.endswith("_margin"):
        return type(value)(value / 2), type(value)(value * 2)
    return 1 + (value - 1) / 2, 1 + (value - 1) * 2


def measured(policy: search_policy.Policy, robots: Sequence[str], functions: Sequence[str]) -> tuple[Costs, float]:
    """The costs of programs under a policy, and the seconds of processor time that they take; all, if none is named."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(_measure, (asdict(policy), robots, functions))


def _measure(thresholds: dict[str, float], robots: Sequence[str], functions: Sequence[str]) -> tuple[Costs, float]:
    assert "derive.programs.functions" not in sys.modules, "this process has taken the usual policy already"
    search_policy.POLICY = search_policy.Policy(**thresholds)  # type: ignore[arg-type]
    from derive.programs.build import build_program
    from derive.programs.functions import INTERFACES

    loaded = {name: Robot.load(name) for name in robots}
    started = time.process_time()
    programs = {name: build_program(robot, names=functions or INTERFACES) for name, robot in loaded.items()}
    seconds = time.process_time() - started
    return {(r, f.interface.name): f.tape.operations.cost for r, p in programs.items() for f in p.functions}, seconds


def report(names: Sequence[str], robots: Sequence[str], functions: Sequence[str] = ()) -> Iterator[str]:
    usual = search_policy.Policy()
    before, usual_seconds = measured(usual, robots, functions)
    yield f"{len(before)} functions of {len(robots)} robots, cost {sum(before.values())}, {usual_seconds:.1f} s"
    for name in names:
        for value in values_tried(name):
            after, seconds = measured(search_policy.Policy(**{**asdict(usual), name: value}), robots, functions)
            changes = {key: after[key] - before[key] for key in before if after[key] != before[key]}
            largest = sorted(changes.items(), key=lambda item: -abs(item[1]))[:3]
            yield (
                f"{name} {getattr(usual, name):g} -> {value:g}: {sum(c < 0 for c in changes.values())} cheaper, "
                f"{sum(c > 0 for c in changes.values())} dearer, cost {sum(changes.values()):+d}, time x "
                f"{seconds / usual_seconds:.2f}  {', '.join(f'{r} {f} {c:+d}' for (r, f), c in largest)}"
            )


def main() -> None:
    thresholds = [field.name for field in fields(search_policy.Policy)]
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", action="append", choices=thresholds)
    parser.add_argument("--function", action="append", default=[])
    parser.add_argument("robots", nargs="*", metavar="ROBOT")
    options = parser.parse_args()
    robots = options.robots or [*catalogue_names(), *map(str, sorted(BENCHES.glob("*.yaml")))]
    for line in report(options.only or thresholds, robots, options.function):
        print(line, flush=True)


if __name__ == "__main__":
    main()
