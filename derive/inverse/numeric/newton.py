"""Inverse kinematics in numbers: damped Newton from many starts, for arms or poses without a closed form.

The unknowns are fitted to the wanted entries of the pose by Levenberg's and Marquardt's method with exact derivatives,
from starts that fill the joint space, until no new solution has appeared for long enough. A solution at which the
Jacobian loses rank is either isolated, a double root at the boundary of the workspace, or one of infinitely many; then
the free joints take the values of ``near`` and the others follow.

Sources: J. More, The Levenberg-Marquardt algorithm, 1978; A. Chao, Nonparametric estimation of the number of classes,
1984 (when to stop); B. Siciliano et al., Robotics, section 3.7 (inverse kinematics algorithms).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from derive.inverse.numeric.chain import POSE, Array, Entries, NumericChain, Problem
from derive.robot.options.solution_policy import POLICY as STALLED


class Status(IntEnum):
    """The status of a branch of inverse kinematics at a pose."""

    NONE = 0  # it does not exist
    EXACT = 1  # a solution like any other
    BOUNDARY = 2  # two branches coincide: the pose is on the boundary of what the arm reaches, and only one is listed
    # A solution in which some joints are free: they are where the caller has them, and others follow from them.
    SINGULAR = 3


@dataclass(frozen=True, slots=True)
class SolverPolicy:
    """Every threshold of the numeric solver; lengths are divided by the arm's reach."""

    residual: float = 1e-10  # largest error of an entry of a solution's pose: a pose farther out has no solution
    converged: float = 3e-15  # below it a start has arrived
    rank: float = 1e-6  # singular values of the Jacobian, relative to the largest, that count as zero
    apart: float = 1e-7  # solutions closer than this are one
    steps: int = 120  # most steps of one start
    starts: int = 64  # starts of one round
    rounds: int = 40  # most rounds
    arrivals: int = 8  # solutions seen again, for each one known, since the last new one, before the search ends
    polish: int = 2  # most Newton steps of a candidate of a closed form


POLICY = SolverPolicy()


@dataclass(frozen=True, slots=True, eq=False)
class NumericSolutions:
    """All configurations that were found for one pose."""

    q: Array  # (branches, n), angles in (-pi, pi] unless limits ask for a full turn more
    status: Array  # (branches,) a `Status` each
    residual: Array  # (branches,) largest error of an entry of the pose, lengths relative to the reach
    free: Array  # (branches, n) the joints that can move while the pose stays; they have the values of ``near``


def polish(problem: Problem, q: Array, steps: int = POLICY.polish) -> tuple[Array, Array]:
    """Newton steps with the exact Jacobian, each kept only where the pose's error shrinks."""
    known: Array = np.asarray(np.isfinite(q).all(axis=-1))
    q = np.where(known[..., None], q, 0.0)
    error, slope = problem.errors(q)
    best = np.linalg.norm(error, axis=-1)
    for _ in range(steps):
        # Gauss and Newton by the pseudoinverse: the shortest step where the Jacobian loses rank.
        step = -np.einsum("...ij,...j->...i", np.linalg.pinv(slope, rcond=POLICY.rank), error)
        candidate = problem.moved(q, step)
        new_error, new_slope = problem.errors(candidate)
        better: Array = np.linalg.norm(new_error, axis=-1) < best
        if not better.any():
            break
        q = np.where(better[..., None], candidate, q)
        error = np.where(better[..., None], new_error, error)
        slope = np.where(better[..., None, None], new_slope, slope)
        best = np.linalg.norm(error, axis=-1)
    worst = np.abs(error).max(axis=-1)
    return np.where(known[..., None], q, np.nan), np.where(known, worst, np.inf)


def fit(problem: Problem, q: Array, steps: int = POLICY.steps) -> tuple[Array, Array]:
    """Levenberg's and Marquardt's method from many starts at once."""
    q = q.copy()
    error, slope = problem.errors(q)
    cost = (error**2).sum(axis=-1)
    damping = np.full(len(q), 1e-2)
    resting = np.zeros(len(q), dtype=int)
    unit = np.eye(slope.shape[-1])
    for _ in range(steps):
        moving = np.flatnonzero((np.sqrt(cost) > POLICY.converged) & (resting < 11))
        if not moving.size:
            break
        part = problem if problem.poses.ndim == 2 else replace(problem, poses=problem.poses[moving])
        # (J^T J + damping 1) step = -J^T e for all starts that have not arrived.
        at = np.swapaxes(slope[moving], -1, -2)
        normal = at @ slope[moving] + damping[moving, None, None] * unit
        step = -np.linalg.solve(normal, at @ error[moving, :, None])[..., 0]
        candidate = part.moved(q[moving], step)
        new_error, new_slope = part.errors(candidate)
        new_cost = (new_error**2).sum(axis=-1)
        better = new_cost < cost[moving]
        resting[moving] = np.where(better, 0, resting[moving] + 1)
        # Less damping after a success; after failures in a row more, faster and faster.
        damping[moving] = np.clip(damping[moving] * np.where(better, 0.15, 2.0 ** resting[moving]), 1e-13, 1e6)
        kept = moving[better]
        q[kept], error[kept], slope[kept], cost[kept] = (
            candidate[better],
            new_error[better],
            new_slope[better],
            new_cost[better],
        )
    return q, np.abs(error).max(axis=-1)


def follow(problem: Problem, q: Array, residual: Array) -> tuple[Array, Array]:
    """Where damped steps stall at (starts, n) beside a singular pose: from there along the bottom of a valley."""
    # Beside a pose with a self-motion the error is small on all of its curve, and zero at single points. A step along
    # the curve leaves it by the square of its length, which costs more than it gains; steps across, damped so that they
    # do not go along it, bring it back before the errors are compared.
    at = np.flatnonzero((residual > POLICY.residual) & (residual < STALLED.stalled))
    part, x = replace(problem, poses=problem.poses[at]), q[at]
    damping, refused = np.full(len(at), STALLED.along), np.zeros(len(at), dtype=int)
    error, slope = part.errors(x)
    for _ in range(STALLED.valley if at.size else 0):
        step = _damped_step(error, slope, damping)
        moved = part.moved(x, step / np.maximum(2.0 * np.abs(step).max(axis=-1, keepdims=True), 1.0))
        for _ in range(4):
            moved = part.moved(moved, _damped_step(*part.errors(moved), np.full(len(at), STALLED.across)))
        new_error, new_slope = part.errors(moved)
        better = ((new_error**2).sum(axis=-1) < (error**2).sum(axis=-1)) & (refused < 6)
        x, error = np.where(better[:, None], moved, x), np.where(better[:, None], new_error, error)
        slope = np.where(better[:, None, None], new_slope, slope)
        damping, refused = damping * np.where(better, 0.1, 10.0), np.where(better, 0, refused + 1)
        if (refused >= 6).all() or np.abs(error).max() <= POLICY.converged:
            break
    q, residual = q.copy(), residual.copy()
    q[at], residual[at] = x, np.abs(error).max(axis=-1)
    return q, residual


def _damped_step(error: Array, slope: Array, damping: Array) -> Array:
    """-(J^T J + damping)^-1 J^T e by singular values, of which no digits are lost."""
    left, sizes, right = np.linalg.svd(slope, full_matrices=False)
    along = np.einsum("...ij,...i->...j", left, error) * sizes / (sizes**2 + damping[..., None])
    step: Array = -np.einsum("...ji,...j->...i", right, along)
    return step


def solve(
    chain: NumericChain,
    pose: npt.ArrayLike,
    *,
    entries: Entries = POSE,
    given: Mapping[int, float] | None = None,
    near: Sequence[float] | None = None,
    limits: bool = False,
    policy: SolverPolicy = POLICY,
) -> NumericSolutions:
    """All configurations that reach a pose, found from many starts; the same starts for the same arm.

    The search ends when solutions known have been met again so often that another one would have been seen. Free joints
    take at singular poses what they have in ``near``, else zero.
    """
    goal, given = np.asarray(pose, dtype=float), dict(given or {})
    if goal.shape != (4, 4) or not np.isfinite(goal).all():
        raise ValueError(f"a pose must be a finite (4, 4) matrix; got shape {goal.shape}")
    if not set(given) <= set(range(chain.n)):
        raise ValueError(f"given joints must be indices from 0 to {chain.n - 1}; got {sorted(given)}")
    reference = np.zeros(chain.n) if near is None else np.asarray(near, dtype=float)
    free = np.array([i not in given for i in range(chain.n)])
    problem = Problem(chain, goal, entries, free)
    random = np.random.default_rng(20)
    low, high = _start_box(problem)
    found, seen_again, hopeless = _Found(problem), 0, 0
    for round_number in range(policy.rounds):
        q = random.uniform(low, high, (policy.starts, chain.n))
        if round_number == 0:
            q[0] = reference
        for i, value in given.items():
            q[:, i] = value
        ends, residuals = fit(problem, q)
        for end in ends[residuals <= policy.residual]:
            seen_again = 0 if found.add(end, reference) else seen_again + 1
        hopeless += not found.q
        if hopeless == 5 or (found.q and seen_again >= policy.arrivals * len(found.q) + policy.starts // 4):
            break
    return found.ordered(reference, limits)


def _start_box(problem: Problem) -> tuple[Array, Array]:
    """The range of the starts: a full turn, a slide's limits or twice the unit of length."""
    low, high = problem.chain.limits.T
    wide = 2.0 * float(problem.unit)
    bounded = np.isfinite(low) & np.isfinite(high) & ~problem.chain.revolute
    turn = problem.chain.revolute
    margin = np.where(bounded, 0.5 * (high - low), 0.0)
    return (
        np.where(turn, -math.pi, np.where(bounded, low - margin, -wide)),
        np.where(turn, math.pi, np.where(bounded, high + margin, wide)),
    )


def _brought_near(problem: Problem, q: Array, near: Array) -> tuple[Array, Status, Array]:
    """A solution with a singular Jacobian: its free joints set to ``near`` one after the other, the others following.

    A joint is free where a small step of it can be answered by the others; where none is, the solution is isolated.
    """
    moving = np.zeros(problem.chain.n, dtype=bool)
    while problem.free.any():
        _, slope = problem.errors(q)
        # Joints with a share in the null space of J may move while the pose stays; tried with a real step.
        null = _null_space(slope)
        share = np.linalg.norm(null, axis=1) if null.size else np.zeros(slope.shape[-1])
        tried = np.flatnonzero(problem.free)[share > 0.1 * share.max(initial=1e-3)]
        rests = [(i, replace(problem, free=problem.free & (np.arange(len(moving)) != i))) for i in map(int, tried)]
        able = [(i, rest) for i, rest in rests if _can_move(rest, q, i)]
        if not able:
            break
        ends = ((i, rest, _answered(rest, q, i, near[i] - q[i], math.inf)) for i, rest in able)
        joint, rest, end = next((each for each in ends if each[2] is not None), (*able[0], None))
        q, problem, moving[joint] = _as_near(rest, q, joint, near[joint]) if end is None else end, rest, True
    return q, Status.SINGULAR if moving.any() else Status.BOUNDARY, moving


def _null_space(slope: Array) -> Array:
    """(free joints, k) directions in which the wanted entries do not change."""
    _, values, rows = np.linalg.svd(slope)
    values = np.pad(values, (0, rows.shape[0] - len(values)))
    null: Array = rows[values <= 10 * POLICY.rank * max(values.max(initial=0.0), 1.0)].T
    return null


def _answered(rest: Problem, q: Array, joint: int, change: float, most: float) -> Array | None:
    """The solution after a step of one joint, if the others can compensate for it by changing ``most`` at most."""
    attempt = q.copy()
    attempt[joint] += change
    end, residual = fit(rest, attempt[None, :], 30)
    far = np.abs((end[0] - q) / rest.scale).max()
    return end[0] if residual[0] <= POLICY.residual and far <= most else None


def _can_move(rest: Problem, q: Array, joint: int) -> bool:
    """Whether the other joints can compensate for a small step of one, forwards or backwards."""
    small = 1e-2 * rest.scale[joint]
    return any(_answered(rest, q, joint, change, 0.5) is not None for change in (small, -small))


def _as_near(rest: Problem, q: Array, joint: int, goal: float) -> Array:
    """The solution with one joint as near to ``goal`` as the others allow, by steps."""
    way = goal - q[joint]
    if rest.chain.revolute[joint]:
        way = (way + math.pi) % (2 * math.pi) - math.pi
    end, step = q[joint] + way, 0.1 * way
    for _ in range(40):
        step = math.copysign(min(abs(step), abs(end - q[joint])), way)
        if abs(step) < 1e-4 * rest.scale[joint]:
            break
        moved = _answered(rest, q, joint, step, 1.0)
        q, step = (q, 0.5 * step) if moved is None else (moved, step)
    return q


def _distance(problem: Problem, a: Array, b: Array, joints: Array | slice = slice(None)) -> float:
    """The largest difference of a joint variable but for full turns, without units."""
    difference = a - b
    folded = (difference + math.pi) % (2 * math.pi) - math.pi
    apart = np.where(problem.chain.revolute, folded, difference) / problem.scale
    return float(np.abs(apart[joints]).max(initial=0.0))


class _Found:
    """Different solutions, each once."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.q: list[Array] = []
        self.status: list[Status] = []
        self.free: list[Array] = []
        self.ends: list[Array] = []

    def add(self, q: Array, near: Array) -> bool:
        """Whether a configuration leads to a new solution; known ones are not added.

        Double roots are known less exactly than others, and self-motions that do not reach ``near`` still less.
        """
        _, slope = self.problem.errors(q)
        values = np.linalg.svd(slope, compute_uv=False)
        full = slope.shape[0] >= slope.shape[1]
        smallest = float(values.min(initial=1.0)) if full else 0.0
        # Full column rank: the solution is isolated, and known to rounding over the smallest singular value.
        regular = smallest > POLICY.rank * max(1.0, values.max(initial=0.0))
        status, free, apart = Status.EXACT, np.zeros(len(q), dtype=bool), max(POLICY.apart, 1e-13 / max(smallest, 1e-8))
        if not regular:
            if any(_distance(self.problem, q, other) < 1e-4 for other in self.ends):
                return False
            self.ends.append(q)
            q, status, free = _brought_near(self.problem, q, near)
            reached = status is Status.BOUNDARY or _distance(self.problem, q, near, free) < 1e-9
            apart = 1e-5 if reached else 0.2
        if any(_distance(self.problem, q, other) < apart for other in self.q):
            return False
        self.q.append(q)
        self.status.append(status)
        self.free.append(free)
        return True

    def ordered(self, near: Array, limits: bool) -> NumericSolutions:
        """The solutions, nearest first, angles folded."""
        chain, problem = self.problem.chain, self.problem
        q = np.array(self.q).reshape(-1, chain.n)
        folded = math.pi - (math.pi - q) % (2 * math.pi)
        q = np.where(chain.revolute & problem.free, folded, q)
        keep = np.ones(len(q), dtype=bool)
        if limits:
            q = _within(chain, q, near)
            low, high = chain.limits.T
            keep = ((q >= low - 1e-9) & (q <= high + 1e-9)).all(axis=-1)
        order = sorted(np.flatnonzero(keep), key=lambda i: (_distance(problem, q[i], near), *q[i]))
        return NumericSolutions(
            q=q[order],
            status=np.array([self.status[i] for i in order], dtype=np.int8),
            residual=problem.residual(q[order]),
            free=np.array([self.free[i] for i in order], dtype=bool).reshape(-1, chain.n),
        )


def _within(chain: NumericChain, q: Array, near: Array) -> Array:
    """Angles with full turns added until they are within their limits, nearest to ``near`` where there is a choice."""
    turns = 2 * math.pi * np.arange(-3, 4)
    choices = q[..., None] + turns * chain.revolute[:, None]
    low, high = chain.limits.T
    outside = np.maximum(low[:, None] - choices, choices - high[:, None]).clip(min=0.0)
    away = np.where(outside > 1e-9, 1e6 + outside, np.abs(choices - near[:, None]))
    best: Array = np.take_along_axis(choices, away.argmin(axis=-1)[..., None], axis=-1)[..., 0]
    return best
