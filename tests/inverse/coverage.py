"""How much of the inverse kinematics is solved, class by class: ``python -m tests.inverse.coverage``.

Arms of books and random ones, poses with all their true solutions, singular, boundary and unreachable poses; one line
a class, and the failures of the smallest arms first where a file is named for them.
"""

from __future__ import annotations

import argparse
import sys
import time
import traceback
from collections import defaultdict
from pathlib import Path

from tests.inverse.arms import CLASSES, HARD, PUBLISHED, ArmCase, random_arm
from tests.inverse.solvers import Refused, generated_solver, numeric_solver, solver_of
from tests.inverse.trial import Trial, Verdict


def main(arguments: list[str] | None = None) -> int:
    """Run, print, and return 1 where something failed."""
    options = _options(arguments)
    kinds = options.kinds or sorted({case.kind for case in PUBLISHED + HARD} | set(CLASSES), key=_order)
    head = f"{'class':<24} {'arms':>9} {'poses':>11} {'solutions':>13} {'singular':>9} {'bound.':>7} {'unreach.':>8}"
    print(f"{head} {'residual':>8} {'spur.':>5} {'dupl.':>5} {'empty':>5} {'derive s':>8} {'us/pose':>8}")
    failures: list[tuple[int, str]] = []
    for kind in kinds:
        cases = [case for case in PUBLISHED + HARD if case.kind == kind] if not options.random_only else []
        if kind in CLASSES:
            cases += [random_arm(kind, i) for i in range(options.first, options.first + options.arms)]
        if options.arm:
            cases = [case for case in cases if case.name in options.arm]
        if cases:
            failures += _one_class(kind, cases, options)
    if options.failures:
        lines = [line for _, line in sorted(failures)]
        options.failures.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return int(bool(failures))


def _options(arguments):
    parser = argparse.ArgumentParser(prog="python -m tests.inverse.coverage", description=__doc__)
    parser.add_argument("--class", dest="kinds", action="append", metavar="CLASS", help="only this class; repeat")
    parser.add_argument("--arm", action="append", metavar="NAME", help="only this arm; repeat")
    parser.add_argument("--arms", type=int, default=10, help="random arms of each class")
    parser.add_argument("--first", type=int, default=0, help="number of the first random arm")
    parser.add_argument("--poses", type=int, default=10, help="regular poses of each arm")
    parser.add_argument("--random-only", action="store_true", help="no published arms")
    parser.add_argument("--numeric", action="store_true", help="the numeric solver instead of the closed form")
    parser.add_argument("--generated", action="store_true", help="the generated NumPy module")
    parser.add_argument("--cache", type=Path, help="folder that keeps true solutions")
    parser.add_argument("--failures", type=Path, metavar="FILE", help="where failures are listed")
    parser.add_argument("--robots", type=Path, metavar="FOLDER", help="where robot files of failures are written")
    parser.add_argument("--verbose", action="store_true")
    return parser.parse_args(arguments)


def _solver(options):
    return numeric_solver if options.numeric else generated_solver if options.generated else solver_of


def _order(kind):
    names = list(CLASSES)
    return (names.index(kind) if kind in names else -1, kind)


def _one_class(kind, cases, options):
    totals: dict[str, Verdict] = defaultdict(Verdict)
    failures, solved, worst_derivation, reasons = [], 0, 0.0, []
    for case in cases:
        begin = time.perf_counter()
        try:
            solver = _solver(options)(case)
        except Refused as error:
            reasons.append(f"    {case.name}: {error}")
            failures.append(_failure(case, options, f"no closed form: {error}"))
            continue
        except Exception as error:
            failures.append(_failure(case, options, f"derivation raises {brief(error)}"))
            continue
        worst_derivation = max(worst_derivation, time.perf_counter() - begin)
        solved += 1
        trial = Trial(case, options.poses, cache=options.cache)
        for make in (trial.regular, trial.special, trial.boundary, trial.unreachable):
            poses = make()
            try:
                verdict = trial.judge(poses, solver)
            except Exception as error:
                failures.append(_failure(case, options, f"{poses.kind}: solver raises {brief(error)}"))
                continue
            totals[poses.kind] += verdict
            if verdict.missing:
                what = f"{verdict.missing[0]}; {len(verdict.missing)} of {verdict.poses} such poses"
                failures.append(_failure(case, options, what))
    _print_class(kind, len(cases), solved, totals, worst_derivation)
    if options.verbose:
        print("\n".join([*reasons, *(f"    {line}" for _, line in failures)]))
    return failures


def _print_class(kind, arms, solved, totals, derivation):
    regular, singular, boundary, away = (totals[k] for k in ("regular", "singular", "boundary", "unreachable"))
    every = regular + singular + boundary + away
    line = f"{kind:<24} {f'{solved}/{arms}':>9} {f'{regular.complete}/{regular.poses}':>11}"
    line += f" {f'{regular.found}/{regular.true}':>13} {f'{singular.complete - singular.empty}/{singular.poses}':>9}"
    line += (
        f" {f'{boundary.poses - boundary.empty}/{boundary.poses}':>7} {f'{away.poses - away.claims}/{away.poses}':>8}"
    )
    line += f" {every.residual:>8.0e} {every.spurious:>5} {every.repeated:>5} {every.empty:>5} {derivation:>8.2f}"
    print(f"{line} {1e6 * regular.seconds / max(regular.poses, 1):>8.0f}", flush=True)


def _failure(case: ArmCase, options, what):
    place = case.name
    if options.robots:
        options.robots.mkdir(parents=True, exist_ok=True)
        path = options.robots / f"{case.name}.yaml"
        path.write_text(case.text, encoding="utf-8")
        place = str(path)
    extra = f" values {case.values}" if case.values else ""
    chosen = f" task {case.task}" * (case.task != "pose") + f" given {case.given_names}" * bool(case.given)
    return (len(case.rows), f"{place}{chosen}{extra}: {what}")


def brief(error):
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__}: {str(error)[:120]} ({Path(frame.filename).name}:{frame.lineno})"


if __name__ == "__main__":
    sys.exit(main())
