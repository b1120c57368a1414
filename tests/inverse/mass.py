"""Many arms and many poses: ``python -m tests.inverse.mass every | arms | poses | general``.

A pose is made of random joint variables, and these must be among its solutions: where a share of all solutions is lost,
that share of them is missing. Each branch reproduces its pose, none repeats another, there are at most as many as the
graph says, and by complex conjugation an even number less. With ``every`` a few poses are judged by all their true
solutions, and so are singular, boundary and unreachable ones.
"""

import argparse
import sys
import time
import traceback
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tests.inverse import truth
from tests.inverse.arms import CLASSES, HARD, PUBLISHED, ArmCase, random_arm
from tests.inverse.solvers import Refused, generated_solver, solver_of, unbuilt_solver
from tests.inverse.trial import Trial, Verdict

FOUR = ("puma560", "ur5", "stanford", "kr5-arc")  # arms of which a million poses are tried
GENERAL = [("6R-general", number) for number in range(10)] + [("5R1P-general", number) for number in range(3)]
BATCH = 20_000


def tried(case: ArmCase, solver, poses: int, seed: int, bar: float = 1e-10, second=None) -> Verdict:
    """Random poses of an arm through a solver; the configuration of each must be among its solutions."""
    trial, total, count = Trial(case, seed=seed), Verdict(), getattr(solver, "count", 0)
    for begin in range(0, poses, BATCH):
        asked = trial.poses(trial.configurations(min(BATCH, poses - begin)), "random")
        found = [each(asked.poses, asked.given) for each in (solver, second) if each]
        total += trial.judge(asked, lambda *_, found=found: found[0], bar, count)
        if second is not None:
            numbers = [np.isfinite(branches[..., 0]).sum(axis=1) for branches, *_ in found]
            differ = np.flatnonzero(numbers[0] != numbers[1])
            pairs = ((numbers[0][k], numbers[1][k], asked.q[k].tolist()) for k in differ)
            said = [f"{one} solutions, the second solver {other}, at q = {q}" for one, other, q in pairs]
            total += Verdict(wrong=len(differ), missing=said)
    return total


def run_poses(options) -> Verdict:
    """A million poses of four arms, generated NumPy beside the compiled module."""
    total = Verdict()
    for case in PUBLISHED:
        if case.name in FOUR:
            solver, second = generated_solver(case), generated_solver(case, "native") if options.native else None
            begin = time.perf_counter()
            found = tried(case, solver, options.poses or 1_000_000, options.seed, second=second)
            total += _reported(case.name, found, begin)
    return total


def run_general(options) -> Verdict:
    """Poses of general arms: the joint variables they were made of, then all true solutions of the first ones."""
    total = Verdict()
    for kind, number in GENERAL:
        case = random_arm(kind, options.first + number)
        solver = generated_solver(case, "native") if options.native else generated_solver(case)
        begin = time.perf_counter()
        found = tried(case, solver, options.poses or 10_000, options.seed, bar=1e-8)
        total += _reported(case.name, found, begin)
        begin = time.perf_counter()
        found, unsure = with_truth(case, solver, options.truth, options.seed + 1)
        total += _reported(f"{case.name}, every solution", found, begin)
        print(f"    the truth may lack some at {unsure} poses")
    return total


def with_truth(case: ArmCase, solver, poses: int, seed: int, bar: float = 1e-8) -> tuple[Verdict, int]:
    """Random poses of an arm with all their solutions, carried there from one complex pose."""
    trial, total, unsure = Trial(case, seed=seed), Verdict(), 0
    count = getattr(solver, "count", 0)
    for quiet in (3, 10, 30):
        every = truth.AllSolutions(trial.chain, seed, quiet)
        if every.count == count or not count:
            break
    if count and every.count != count:
        total += Verdict(wrong=1, missing=[f"{every.count} complex solutions, not {count}"])
    for begin in range(0, poses, 250):
        q = trial.configurations(min(250, poses - begin))
        true, sure = every.real(q)
        total += trial.judge(trial.poses(q, "random", true), solver, bar, count)
        unsure += int((~sure).sum())
    return total, unsure


def run_every(options) -> Verdict:
    """Arms of books, hard ones and random ones, class by class, at poses of every kind."""
    total = Verdict()
    for kind in options.kinds or sorted({*CLASSES, *(case.kind for case in PUBLISHED + HARD)}):
        begin, cases = time.perf_counter(), [case for case in PUBLISHED + HARD if case.kind == kind]
        numbers = range(options.first, options.first + options.arms) if kind in CLASSES else ()
        cases += [random_arm(kind, number) for number in numbers]
        found = [_judged(lambda case=case: _at_every_kind(case, options)) for case in cases]
        clean = sum(each.is_clean for each in found)
        total += _reported(f"{kind:<24} {clean}/{len(cases)} arms", sum(found, Verdict()), begin)
    return total


def _at_every_kind(case: ArmCase, options) -> Verdict:
    trial, solver = Trial(case, options.poses or 10), _solver(case, options)
    made = (trial.regular(), trial.special(), trial.boundary(), trial.unreachable())
    return sum((trial.judge(poses, solver) for poses in made), Verdict())


def _solver(case: ArmCase, options):
    return (solver_of if options.walk else generated_solver if options.build else unbuilt_solver)(case)


def _judged(judge: Callable[[], Verdict]) -> Verdict:
    """What is found of an arm; one that raises has lost everything."""
    try:
        return judge()
    except Refused as error:
        return Verdict(wrong=1, missing=[f"refused: {error}"])
    except Exception as error:
        frame = traceback.extract_tb(error.__traceback__)[-1]
        said = f"{type(error).__name__}: {str(error)[:120]} ({Path(frame.filename).name}:{frame.lineno})"
        return Verdict(wrong=1, missing=[f"raises {said}"])


def run_arms(options) -> Verdict:
    """Random arms of every class in turn until the time is over."""
    end = time.monotonic() + options.seconds if options.seconds else np.inf
    total, by_class, arms, failed = Verdict(), defaultdict(Verdict), defaultdict(int), defaultdict(int)
    for number in range(options.first, options.first + options.arms):
        for kind in options.kinds or CLASSES:
            if time.monotonic() > end:
                continue
            found = _arm(kind, number, options)
            arms[kind] += 1
            failed[kind] += not found.is_clean
            by_class[kind] += found
    for kind, found in by_class.items():
        print(f"{kind:<24} {arms[kind]} arms, {failed[kind]} failed; {found}")
        total += found
    return total


def _arm(kind: str, number: int, options) -> Verdict:
    case, begin = random_arm(kind, number), time.perf_counter()
    bar, poses = (1e-8, 100) if "general" in kind or "offset" in kind else (1e-10, 1000)

    def _found() -> Verdict:
        solver = _solver(case, options)
        found = tried(case, solver, options.poses or poses, options.seed, bar)
        return found + with_truth(case, solver, options.truth, options.seed + 1, bar)[0] if options.truth else found

    found = _judged(_found)
    if options.verbose or not found.is_clean:
        _reported(f"{case.name} {'symbols' * bool(case.values)}", found, begin)
    return found


def _reported(name: str, found: Verdict, begin: float) -> Verdict:
    print(f"{name}: {found}; {time.perf_counter() - begin:.1f} s", *found.missing[:20], sep="\n    ", flush=True)
    return found


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.inverse.mass", description=__doc__)
    parser.add_argument("what", choices=["every", "arms", "poses", "general"])
    parser.add_argument("--class", dest="kinds", action="append", metavar="CLASS", help="only this class; repeat")
    parser.add_argument("--arms", type=int, help="every, arms: random ones of each class; 10, 1,000")
    parser.add_argument("--first", type=int, default=0, help="number of the first random arm")
    parser.add_argument("--poses", type=int, help="of each arm; by default 10, 1,000 (general: 100), 1,000,000, 10,000")
    parser.add_argument("--truth", type=int, default=0, help="at how many poses more all solutions are asked for")
    parser.add_argument("--seconds", type=float, help="arms: when to stop")
    parser.add_argument("--seed", type=int, default=0, help="of the poses")
    parser.add_argument("--build", action="store_true", help="every, arms: by `derive build`, all functions, verified")
    parser.add_argument("--walk", action="store_true", help="every, arms: `InverseSolver`, nothing is generated")
    parser.add_argument("--native", action="store_true", help="poses, general: the compiled module, too")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args(arguments)
    options.arms = options.arms or (10 if options.what == "every" else 1000)
    total = {"every": run_every, "arms": run_arms, "poses": run_poses, "general": run_general}[options.what](options)
    print(f"together: {total}")
    return int(not total.is_clean)


if __name__ == "__main__":
    sys.exit(main())
