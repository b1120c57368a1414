"""How much of the inverse kinematics is solved, class by class: ``python -m tests.inverse.coverage``.

Arms of books and random ones, poses with all their true solutions, singular, boundary and unreachable poses; one line
a class, and with ``--verbose`` every failure.
"""

from __future__ import annotations

import argparse
import sys
import time
import traceback
from pathlib import Path

from tests.inverse.arms import CLASSES, HARD, PUBLISHED, ArmCase, random_arm
from tests.inverse.solvers import Refused, generated_solver, numeric_solver, solver_of
from tests.inverse.trial import Trial, Verdict


def main(arguments: list[str] | None = None) -> int:
    options = _options(arguments)
    others = sorted({case.kind for case in PUBLISHED + HARD} - set(CLASSES))
    failed = False
    for kind in options.kinds or [*others, *CLASSES]:
        cases = [] if options.random_only else [case for case in PUBLISHED + HARD if case.kind == kind]
        if kind in CLASSES:
            cases += [random_arm(kind, i) for i in range(options.first, options.first + options.arms)]
        cases = [case for case in cases if not options.arm or case.name in options.arm]
        total, derived, failures = Verdict(), [], []
        for case in cases:
            begin = time.perf_counter()
            try:
                solver = options.solver(case)
            except Refused as error:
                failures.append(f"{_named(case)}: no closed form: {error}")
                continue
            except Exception as error:
                failures.append(f"{_named(case)}: derivation raises {brief(error)}")
                continue
            derived.append(time.perf_counter() - begin)
            found, said = _tried(case, solver, options)
            total, failures = total + found, failures + said
        if cases:
            each = f"{max(derived, default=0.0):.2f} s, {1e6 * total.seconds / max(total.poses, 1):.0f} us a pose"
            print(f"{kind:<24} {len(derived)}/{len(cases)} arms, {total}; {each}", flush=True)
            print(*(f"    {line}\n" for line in failures if options.verbose), sep="", end="", flush=True)
        failed |= bool(failures)
    return int(failed)


def _options(arguments):
    parser = argparse.ArgumentParser(prog="python -m tests.inverse.coverage", description=__doc__)
    parser.add_argument("--class", dest="kinds", action="append", metavar="CLASS", help="only this class; repeat")
    parser.add_argument("--arm", action="append", metavar="NAME", help="only this arm; repeat")
    parser.add_argument("--arms", type=int, default=10, help="random arms of each class")
    parser.add_argument("--first", type=int, default=0, help="number of the first random arm")
    parser.add_argument("--poses", type=int, default=10, help="regular poses of each arm")
    parser.add_argument("--random-only", action="store_true", help="no published arms")
    solvers = {"dest": "solver", "action": "store_const", "default": solver_of}
    parser.add_argument("--numeric", const=numeric_solver, help="Newton's method instead of the closed form", **solvers)
    parser.add_argument("--generated", const=generated_solver, help="the generated NumPy module", **solvers)
    parser.add_argument("--verbose", action="store_true", help="with every failure")
    return parser.parse_args(arguments)


def _tried(case: ArmCase, solver, options) -> tuple[Verdict, list[str]]:
    """Poses of every kind of an arm, and what fails at them."""
    trial, total, failures = Trial(case, options.poses), Verdict(), []
    for make in (trial.regular, trial.special, trial.boundary, trial.unreachable):
        poses = make()
        try:
            verdict = trial.judge(poses, solver)
        except Exception as error:
            failures.append(f"{_named(case)}: {poses.kind}: solver raises {brief(error)}")
            continue
        total += verdict
        if verdict.missing:
            share = f"{len(verdict.missing)} of {verdict.poses} such poses"
            failures.append(f"{_named(case)}: {verdict.missing[0]}; {share}")
    return total, failures


def _named(case: ArmCase) -> str:
    chosen = f" task {case.task}" * (case.task != "pose") + f" given {case.given_names}" * bool(case.given)
    return f"{case.name}{chosen}" + (f" values {case.values}" if case.values else "")


def brief(error: Exception) -> str:
    """An exception in a line, with its place."""
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__}: {str(error)[:120]} ({Path(frame.filename).name}:{frame.lineno})"


if __name__ == "__main__":
    sys.exit(main())
