"""Many arms and many poses, judged cheaply: ``python -m tests.inverse.mass arms | poses | general``.

A pose is made of random joint variables, and these must be among its solutions: where a share of all solutions is lost,
that share of them is missing. Each branch reproduces its pose, none repeats another, there are at most as many as the
graph says, and by complex conjugation an even number less.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

from derive.verification.oracle.frames import forward_kinematics
from tests.inverse import truth
from tests.inverse.arms import CLASSES, PUBLISHED, ArmCase, random_arm
from tests.inverse.coverage import brief
from tests.inverse.solvers import Refused, generated_solver, solver_of, unbuilt_solver
from tests.inverse.trial import DUPLICATE, FOUND, REGULAR, Trial

FOUR = ("puma560", "ur5", "stanford", "kr5-arc")
"""Arms of which a million poses are tried."""

GENERAL = tuple([("6R-general", number) for number in range(10)] + [("5R1P-general", number) for number in range(3)])
BATCH = 20_000


@dataclass
class Tally:
    poses: int = 0
    solutions: int = 0  # true solutions that were asked for
    lost: int = 0  # those of them that are not among the branches
    spurious: int = 0  # branches that miss their pose by more than the bar
    repeated: int = 0  # poses at which one solution is there twice
    wrong: int = 0  # poses with more solutions than the graph says, or an odd number of them lost
    residual: float = 0.0  # worst error of a branch's pose, lengths relative to the reach or one metre
    examples: list[str] = field(default_factory=list)  # joint variables and what is wrong at their pose

    def __iadd__(self, other: Tally) -> Tally:
        for name in ("poses", "solutions", "lost", "spurious", "repeated", "wrong"):
            setattr(self, name, getattr(self, name) + getattr(other, name))
        self.residual = max(self.residual, other.residual)
        self.examples = (self.examples + other.examples)[:20]
        return self

    @property
    def is_clean(self) -> bool:
        """Whether there is nothing to complain about."""
        return not (self.lost or self.spurious or self.repeated or self.wrong)

    def __str__(self) -> str:
        share = f"{1 - self.lost / max(self.solutions, 1):.5%}"
        return (
            f"{self.poses} poses, {self.solutions - self.lost}/{self.solutions} solutions ({share}), "
            f"{self.spurious} spurious, {self.repeated} repeated, {self.wrong} counts wrong, "
            f"residual {self.residual:.0e}"
        )


def tally(case: ArmCase, q: np.ndarray, branches: np.ndarray, count: int = 0, bar: float = 1e-10, true=None) -> Tally:
    """Judge the branches of poses that were made of known joint variables."""
    trial = Trial(case)
    chain = trial.chain
    exists = np.isfinite(branches).all(axis=-1)
    error = _errors(trial, branches, forward_kinematics(trial.arm, q))
    error[~exists] = 0.0
    asked = [row[None] for row in q] if true is None else true
    owner = np.repeat(np.arange(len(q)), [len(one) for one in asked])
    wanted = np.concatenate(asked)
    away = np.where(exists[owner], chain.distance(np.nan_to_num(branches)[owner], wanted[:, None]), np.inf)
    missing = np.flatnonzero(away.min(axis=1, initial=np.inf) > FOUND)
    if missing.size:
        missing = missing[truth.smallest_singular_value(chain, wanted[missing]) > REGULAR]
    pairs = [(i, j) for j in range(branches.shape[1]) for i in range(j)]
    repeated = np.zeros(len(q), dtype=bool)
    for i, j in pairs:
        two = np.flatnonzero(exists[:, i] & exists[:, j])
        repeated[two] |= chain.distance(branches[two, i], branches[two, j]) < DUPLICATE
    number = exists.sum(axis=1)
    wrong = _wrong_counts(chain, branches, exists, number, count) if count else np.zeros(len(q), dtype=bool)
    result = Tally(len(q), len(wanted), len(missing), int((error > bar).sum()), int(repeated.sum()), int(wrong.sum()))
    result.residual = float(error.max(initial=0.0))
    result.examples = [
        f"{what} at q = {np.array2string(q[k], precision=17, separator=', ', max_line_width=10000)}"
        for what, where in (
            ("lost", np.unique(owner[missing])),
            ("spurious", np.flatnonzero((error > bar).any(axis=1))),
            ("repeated", np.flatnonzero(repeated)),
            ("wrong count", np.flatnonzero(wrong)),
        )
        for k in where[:3]
    ]
    return result


def _errors(trial: Trial, branches: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """(m, b) the largest error of the task's entries, lengths relative to the reach or one metre."""
    rows, columns = trial.chain.rows, trial.chain.columns
    reached = forward_kinematics(trial.arm, np.nan_to_num(branches))[..., rows, columns]
    scale = np.where(np.array(columns) == 3, max(1.0, trial.chain.unit), 1.0)
    return (np.abs(reached - poses[:, None, rows, columns]) / scale).max(axis=-1, initial=0.0)


def _wrong_counts(chain, branches, exists, number, count):
    """Whether there are too many solutions, or an odd number is missing while none is singular."""
    suspects = np.flatnonzero((number > count) | ((count - number) % 2 == 1))
    wrong = np.zeros(len(branches), dtype=bool)
    for k in suspects:
        own = branches[k, exists[k]]
        regular = not len(own) or truth.smallest_singular_value(chain, own).min() > 1e-3
        wrong[k] = number[k] > count or regular
    return wrong


def tried(case: ArmCase, solver, poses: int, seed: int, bar: float = 1e-10, second=None) -> Tally:
    """Random poses of an arm through a solver."""
    trial, total = Trial(case, seed=seed), Tally()
    for begin in range(0, poses, BATCH):
        q = trial.configurations(min(BATCH, poses - begin))
        goal, given = forward_kinematics(trial.arm, q), q[:, list(case.given)]
        with np.errstate(all="ignore"):
            branches = solver(goal, given)[0]
        total += tally(case, q, branches, getattr(solver, "count", 0), bar)
        if second is not None:
            total += _compared(trial, q, branches, second(goal, given)[0])
    return total


def _compared(trial: Trial, q: np.ndarray, one: np.ndarray, other: np.ndarray) -> Tally:
    numbers = [np.isfinite(branches).all(axis=-1).sum(axis=1) for branches in (one, other)]
    differ = np.flatnonzero(numbers[0] != numbers[1])
    result = Tally(wrong=len(differ))
    result.examples = [
        f"{numbers[0][k]} solutions, the second solver {numbers[1][k]}, at q = {q[k].tolist()}" for k in differ[:3]
    ]
    return result


# -- the three bars


def run_poses(options) -> Tally:
    """A million poses of four arms, generated NumPy beside the compiled module."""
    total = Tally()
    for case in PUBLISHED:
        if case.name in FOUR:
            solver, second = generated_solver(case), generated_solver(case, "native") if options.native else None
            begin = time.perf_counter()
            found = tried(case, solver, options.poses or 1_000_000, options.seed, second=second)
            _report(case.name, found, time.perf_counter() - begin)
            total += found
    return total


def run_general(options) -> Tally:
    """Poses of general arms: the joint variables they were made of, then all true solutions of the first ones."""
    total = Tally()
    for kind, number in GENERAL:
        case = random_arm(kind, options.first + number)
        solver = generated_solver(case, "native") if options.native else generated_solver(case)
        begin = time.perf_counter()
        found = tried(case, solver, options.poses or 10_000, options.seed, bar=1e-8)
        _report(case.name, found, time.perf_counter() - begin)
        total += found
        begin = time.perf_counter()
        found, unsure = with_truth(case, solver, options.truth, options.seed + 1)
        _report(f"{case.name}, every solution", found, time.perf_counter() - begin)
        print(f"    the truth may lack some at {unsure} poses")
        total += found
    return total


def with_truth(case: ArmCase, solver, poses: int, seed: int, bar: float = 1e-8) -> tuple[Tally, int]:
    """Random poses of an arm with all their solutions, carried there from one complex pose."""
    trial, total, unsure = Trial(case, seed=seed), Tally(), 0
    count = getattr(solver, "count", 0)
    for quiet in (3, 10, 30):
        every = truth.AllSolutions(trial.chain, seed, quiet)
        if every.count == count or not count:
            break
    if count and every.count != count:
        total += Tally(wrong=1, examples=[f"{every.count} complex solutions, not {count}"])
    for begin in range(0, poses, 250):
        q = trial.configurations(min(250, poses - begin))
        true, sure = every.real(q)
        with np.errstate(all="ignore"):
            branches = solver(forward_kinematics(trial.arm, q), q[:, list(case.given)])[0]
        total += tally(case, q, branches, count, bar, true)
        unsure += int((~sure).sum())
    return total, unsure


def run_arms(options) -> Tally:
    """Random arms of every class in turn until the time is over."""
    end = time.monotonic() + options.seconds if options.seconds else np.inf
    total, by_class, arms, failed = Tally(), defaultdict(Tally), defaultdict(int), defaultdict(int)
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


def _arm(kind: str, number: int, options) -> Tally:
    """One random arm; one that raises has lost everything."""
    case, begin = random_arm(kind, number), time.perf_counter()
    bar, poses = (1e-8, 100) if "general" in kind or "offset" in kind else (1e-10, 1000)
    try:
        solver = (solver_of if options.walk else generated_solver if options.build else unbuilt_solver)(case)
        found = tried(case, solver, options.poses or poses, options.seed, bar)
        if options.truth:
            found += with_truth(case, solver, options.truth, options.seed + 1, bar)[0]
    except Refused as error:
        found = Tally(wrong=1, examples=[f"refused: {error}"])
    except Exception as error:
        found = Tally(wrong=1, examples=[f"raises {brief(error)}"])
    if options.verbose or not found.is_clean:
        _report(f"{case.name} {'symbols' * bool(case.values)}", found, time.perf_counter() - begin)
    return found


def _report(name: str, found: Tally, seconds: float) -> None:
    print(f"{name}: {found}; {seconds:.1f} s", flush=True)
    for example in found.examples:
        print(f"    {example}", flush=True)


def main(arguments: list[str] | None = None) -> int:
    """Run, print, and return 1 where something failed."""
    parser = argparse.ArgumentParser(prog="python -m tests.inverse.mass", description=__doc__)
    parser.add_argument("what", choices=["arms", "poses", "general"])
    parser.add_argument("--class", dest="kinds", action="append", metavar="CLASS", help="arms: only this class; repeat")
    parser.add_argument("--arms", type=int, default=1000, help="arms: of each class")
    parser.add_argument("--first", type=int, default=0, help="number of the first random arm")
    parser.add_argument("--poses", type=int, help="of each arm; by default 1,000 (general: 100), 1,000,000, 10,000")
    parser.add_argument("--truth", type=int, default=0, help="at how many poses more all solutions are asked for")
    parser.add_argument("--seconds", type=float, help="arms: when to stop")
    parser.add_argument("--seed", type=int, default=0, help="of the poses")
    parser.add_argument("--build", action="store_true", help="arms: by `derive build`, all functions, verified")
    parser.add_argument("--walk", action="store_true", help="arms: `InverseSolver`, nothing is generated")
    parser.add_argument("--native", action="store_true", help="poses, general: the compiled module, too")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args(arguments)
    total = {"arms": run_arms, "poses": run_poses, "general": run_general}[options.what](options)
    print(f"together: {total}")
    return int(not total.is_clean)


if __name__ == "__main__":
    sys.exit(main())
