"""Which elimination serves an arm best: every regular one is listed, and they are tried at random poses.

What an elimination costs is the size of its eigenvalue problem; what it is worth shows in how close its candidates are
to solutions before Newton's method has had any luck with them. The node of the arm takes the best one for each hidden
joint, so that where one leaves a doubt the next is asked.
"""

import math
import random
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from derive.inverse.general.closure import Closure, Loop, closures
from derive.inverse.general.count import count_solutions, finish_forms
from derive.inverse.general.elimination import POLICY, EigenProblem, Elimination, Reduction, left_null
from derive.inverse.general.rigid_motion import Array, pose_features
from derive.inverse.general.search import FULL, GeneralFormula, GeneralSolution, free_loop, scaled
from derive.inverse.numeric.chain import POSE, Entries, NumericChain
from derive.robot.names import free_symbols
from derive.robot.robot import Robot

# How many solutions an elimination found at the trials, and how it compares with others that found as many.
Result = tuple[int, tuple[bool, int, int, int], Elimination]
_SHARES = (0.97, 0.4)
# Errors of candidates above which others are better; far from usual ones, so that no processor's rounding decides.
_INEXACT = (1e-6, 1e-3)
_FOUND = 1e-3  # without units: so near is a configuration that was found, however close to a singular one


def eliminations(loop: Loop, pose: Array, start: int = 0) -> Iterator[Elimination]:
    """Every way to make a regular eigenvalue problem of a loop, at a generic pose, (1, 4, 4)."""
    ways = closures(loop)
    groups: dict[tuple[int, ...], list[Closure]] = {}
    for way in ways:
        groups.setdefault(way.unknowns, []).append(way)
    for unknowns, group in groups.items():
        # Of the ways around with the same unknowns the one from which the eliminated joints follow best.
        worth = [1.0 if loop.tip else np.linalg.svd(finish_forms(loop, way))[1].min() for way in group]
        rounded = [float(f"{value:.3g}") for value in worth]  # equal ones differ by rounding
        finish = group[rounded.index(max(rounded))]
        for hidden in unknowns:
            straight = tuple(joint for joint in unknowns if _is_straight(loop, pose, group, joint))
            reductions = [_reduction(loop, way, hidden, straight) for way in group]
            # Ways on which the hidden joint is next to the eliminated ones have rows of lower degree.
            reductions.sort(key=lambda each: each.closure.aligned != hidden)
            choices = [(each,) for each in reductions] + ([tuple(reductions)] if len(reductions) > 1 else [])
            others = [joint for joint in unknowns if joint != hidden]
            for chosen in choices:
                for multiplied in (None, *others):
                    trial = Elimination(chosen, hidden, multiplied, (0, 0, 0), finish, start, straight)
                    rows = _rows(loop, pose, trial)
                    if rows is not None:
                        yield replace(trial, rows=rows)


def _rank(matrix: Array) -> int:
    sizes = np.linalg.svd(matrix, compute_uv=False)
    return int((sizes > POLICY.rank * sizes.max(initial=1e-3)).sum())


def _is_straight(loop: Loop, pose: Array, group: Sequence[Closure], joint: int) -> bool:
    """Whether a joint is a slide whose square occurs in no equation."""
    if loop.revolute[joint]:
        return False
    for way in group:
        part, forms = way.eliminated_part(loop), way.unknown_part(loop, pose_features(pose))
        left = left_null(part, part.shape[-2] - _rank(part.reshape(part.shape[-2:])))
        squares = forms.take(2, axis=2 + way.unknowns.index(joint)).reshape(*forms.shape[:2], -1)
        if np.abs(left @ squares).max(initial=0.0) > POLICY.rank:
            return False
    return True


def _reduction(loop: Loop, way: Closure, hidden: int, straight: tuple[int, ...]) -> Reduction:
    part = way.eliminated_part(loop)
    part = part[0] if part.ndim == 3 else part
    products = _rank(part)
    m = len(part) - products
    if way.aligned != hidden:
        return Reduction(way, m, 0, m if hidden in straight else 0)
    _, first, second = loop.joint_actions(loop.carried(way.dropped), hidden, way.direction)
    # Ranks of the parts tell how many combinations are free of the hidden joint, and of which z = exp(i q) is gone.
    constant = m + products - _rank(np.concatenate([part, first, second], axis=1))
    top = first - 1j * second if loop.revolute[hidden] else second
    linear = m + products - _rank(np.concatenate([part, top], axis=1)) - constant
    return Reduction(way, m, constant, linear)


def _rows(loop: Loop, pose: Array, elimination: Elimination) -> tuple[int, int, int] | None:
    """How many rows of each degree a square regular system takes; None where there is none."""
    hidden, factor = elimination.hidden, 1 if elimination.multiplied is None else 2
    zero, one, two = (factor * count for count in elimination.available(loop))
    trial = EigenProblem.of(loop, replace(elimination, rows=(zero, one, two)))
    turn = np.array([0.37 * loop.revolute[hidden]])
    columns = math.prod(trial.shape)
    kept: list[int] = []
    stacked = np.zeros((0, columns))
    for part in trial.matrices(trial.forms(pose), turn):
        # M at one place t: rows of low degree are preferred, for each adds fewer eigenvalues.
        values = (part[0] * 0.83 ** np.arange(part.shape[2])[:, None]).sum(axis=1)
        size = np.linalg.norm(values, axis=1, keepdims=True)
        stacked = np.concatenate([stacked, values / np.where(size > POLICY.rank, size, np.inf)])
        kept.append(_rank(stacked) - sum(kept) if len(stacked) else 0)
    return (kept[0], kept[1], kept[2]) if sum(kept) == columns and kept[0] < columns else None


def find_general(chain: NumericChain, given: Sequence[int] = (), entries: Entries = POSE) -> tuple[Elimination, ...]:
    """The eliminations that find all solutions of an arm, compared at random poses."""
    draw = np.random.default_rng(7)
    span = np.where(chain.revolute, math.pi, chain.reach)
    # Poses of random configurations, so that it is known which solutions there are.
    q = draw.uniform(-span, span, (POLICY.trials, chain.n))
    poses, values = chain.pose_and_jacobian(q)[0], q[:, list(given)] if given else None
    loop, free = free_loop(chain, given, None if values is None else values[:1], entries)
    pose, results = scaled(poses[:1], chain.reach), []
    if not 3 <= len(free) <= FULL[entries] or (entries == POSE and len(free) == 3):
        return ()
    for start in (0,) if loop.tip else range(0, loop.n, 3):
        turned, goal = loop.rotated(start, pose) if start else (loop, pose)
        options = sorted(eliminations(turned, goal, start), key=lambda each: each.eigenvalues)
        for option in options[: POLICY.options]:
            with np.errstate(over="ignore", invalid="ignore"):  # joints that are nowhere near a solution
                found = GeneralSolution(tuple(given), entries, (option,)).attempt(0, chain, poses, values)
            # Certain: close before Newton's method; then few doubts, small eigenvalue problems, exact candidates.
            doubts = int(found.doubtful.sum()) > POLICY.trials // 10
            inexact = sum(found.error > bound for bound in _INEXACT)
            results.append((found.certain, (doubts, option.eigenvalues, len(option.reductions), inexact), option))
        ranked = _ranked(results)
        if ranked and not ranked[0][1][0]:
            break
    best: dict[tuple[int, int], Elimination] = {}
    for _, _, option in _ranked(results):
        best.setdefault((option.start, option.hidden), option)
    solution = GeneralSolution(tuple(given), entries, tuple(best.values()))
    if not best:
        return ()
    # The configurations that poses were made of have to be among their solutions.
    with np.errstate(all="ignore"):
        apart = np.abs(solution.solve(chain, poses, values) - q[:, None])
    apart = np.where(chain.revolute, np.abs((apart + math.pi) % (2.0 * math.pi) - math.pi), apart / chain.reach)
    found_all = (np.nan_to_num(apart.max(axis=-1), nan=np.inf).min(axis=1, initial=np.inf) < _FOUND).all()
    return solution.eliminations if found_all else ()


def _ranked(results: Sequence[Result]) -> list[Result]:
    """The best first: what finds nearly all solutions that any does, then what finds many; the rest is rounding."""
    most = max((certain for certain, _, _ in results), default=0)
    return sorted(results, key=lambda each: (sum(each[0] < share * most for share in _SHARES), each[1]))


def general_formula(
    robot: Robot, specimen: Robot, given: Sequence[int], generators: Sequence[tuple[str, ...]], entries: Entries = POSE
) -> GeneralFormula | None:
    """The general node of an arm; None where there is no elimination."""
    draw = random.Random(5)
    chain = NumericChain.of(robot, {name: draw.uniform(0.3, 1.1) for name in sorted(set(free_symbols(specimen)))})
    found = find_general(chain, given, entries)
    if not found:
        return None
    counts = (count_solutions(specimen, each, given, tip=entries != POSE) for each in found)
    count = next((number for number in counts if number), 0)
    return GeneralFormula(robot, GeneralSolution(tuple(given), entries, found, count), tuple(generators))
