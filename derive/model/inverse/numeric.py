"""Inverse kinematics in numbers: damped Newton from many starts, for arms or poses without a closed form.

The unknowns are fitted to the wanted entries of the pose by Levenberg's and Marquardt's method with exact derivatives,
from starts that fill the joint space, until no new solution has appeared for long enough. A solution at which the
Jacobian loses rank is either isolated, a double root at the boundary of the workspace, or one of infinitely many; then
the free joints take the values of ``near`` and the others follow.

Sources: J. More, The Levenberg-Marquardt algorithm, 1978; A. Chao, Nonparametric estimation of the number of classes,
1984 (when to stop); B. Siciliano et al., Robotics, section 3.7 (inverse kinematics algorithms).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.mechanics.chain import build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.vectors import Frame
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.robot import Robot

Array = npt.NDArray[Any]

Entries = tuple[tuple[int, int], ...]
"""Rows and columns of T, from 0, that a task prescribes."""

POSE: Entries = tuple((i, j) for i in range(3) for j in range(4))
POSITION: Entries = ((0, 3), (1, 3), (2, 3))


class Status(IntEnum):
    """What a branch of the inverse kinematics is at one pose."""

    NONE = 0
    EXACT = 1
    BOUNDARY = 2
    SINGULAR = 3


@dataclass(frozen=True, slots=True)
class SolverPolicy:
    """Every threshold of the numeric solver; lengths are divided by the arm's reach.

    Attributes:
        residual: Largest error of an entry of a solution's pose: a pose farther out has no solution.
        converged: Below it a start has arrived.
        rank: Singular values of the Jacobian, relative to the largest, that count as zero.
        apart: Solutions closer than this are one.
        steps: Most steps of one start.
        starts: Starts of one round.
        rounds: Most rounds.
        arrivals: Solutions seen again, for each one known, since the last new one, before the search ends.
        polish: Most Newton steps of a candidate of a closed form.
    """

    residual: float = 1e-10
    converged: float = 3e-15
    rank: float = 1e-6
    apart: float = 1e-7
    steps: int = 120
    starts: int = 64
    rounds: int = 40
    arrivals: int = 8
    polish: int = 2


POLICY = SolverPolicy()


@dataclass(frozen=True, eq=False)
class NumericChain:
    """An arm of numbers: T = C_1 M_1 C_2 M_2 ... C_n M_n tool, M_i turning about z or sliding along it.

    Attributes:
        revolute: (n,) whether joint i turns.
        sign: (n,) +1 or -1, the factor of the variable.
        fixed: (n, 4, 4) C_i, the base in the first one.
        tool: (4, 4) what follows the last joint.
        limits: (n, 2) joint limits, infinite where the file gives none.
    """

    revolute: Array
    sign: Array
    fixed: Array
    tool: Array
    limits: Array

    @classmethod
    def of(cls, robot: Robot, parameters: Mapping[str, float] | None = None) -> NumericChain:
        """The numbers of a robot.

        Args:
            robot: The robot.
            parameters: A number for every symbol that has none in the file; it may override those of the file.

        Raises:
            ExpressionError: A symbol has no number, or a cell has no finite value.
        """
        values = parameter_values(robot, parameters)
        chain = build_chain(replace(robot, links=(), gravity=None), FloatDomain(robot, [0.0] * robot.n, values))
        fixed = [_matrix(joint.fixed @ joint.motion(0.0, 1.0)) for joint in chain.joints]
        fixed[0] = _matrix(chain.base) @ fixed[0]
        unbounded = (-math.inf, math.inf)
        limits = [[to_float(x, values) for x in joint.limits] if joint.limits else unbounded for joint in robot.joints]
        return cls(
            revolute=np.array([joint.revolute for joint in chain.joints]),
            sign=np.array([float(joint.sign) for joint in chain.joints]),
            fixed=np.array(fixed),
            tool=_matrix(chain.tool),
            limits=np.array(limits, dtype=float),
        )

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.sign)

    @cached_property
    def reach(self) -> float:
        """The sum of all constant distances [m], 1 where there is none: the arm's unit of length."""
        links = np.linalg.norm(self.fixed[1:, :3, 3], axis=-1).sum() + np.linalg.norm(self.tool[:3, 3])
        return float(links) or 1.0

    def pose_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """T and its derivatives by the joint variables, along the recursion.

        Args:
            q: (..., n) configurations [rad, m].

        Returns:
            T (..., 4, 4) and dT/dq_j (..., n, 3, 4).
        """
        pose = np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))
        axes, places = [], []
        for i in range(self.n):
            pose = pose @ self.fixed[i]
            axis, place = pose[..., :3, 2].copy(), pose[..., :3, 3].copy()
            moved = self.sign[i] * q[..., i, None]
            if self.revolute[i]:
                x, y = pose[..., :3, 0].copy(), pose[..., :3, 1].copy()
                cosine, sine = np.cos(moved), np.sin(moved)
                pose[..., :3, 0], pose[..., :3, 1] = cosine * x + sine * y, cosine * y - sine * x
            else:
                pose[..., :3, 3] += moved * axis
            axes.append(self.sign[i] * axis)
            places.append(place)
        pose = pose @ self.tool
        z, o = np.stack(axes, axis=-2), np.stack(places, axis=-2)
        turning = self.revolute[:, None]
        rotation = _cross_matrix(z * turning) @ pose[..., None, :3, :3]
        shift = np.where(turning, np.cross(z, pose[..., None, :3, 3] - o), z)
        slope = np.concatenate([rotation, shift[..., None]], axis=-1)
        return pose, slope


@dataclass(frozen=True, eq=False)
class Problem:
    """Which joints reach wanted entries of the pose, the others being given.

    Attributes:
        chain: The arm.
        poses: (4, 4), or one for each configuration that is tried.
        entries: The entries of T that are wanted.
        free: (n,) the joints that are solved for.
    """

    chain: NumericChain
    poses: Array
    entries: Entries = POSE
    free: Array = field(default_factory=lambda: np.array([], dtype=bool))

    @cached_property
    def unit(self) -> Array:
        """Unit of length of each pose [m]: the reach, or how far the goal is."""
        far = np.abs(self.poses[..., :3, 3]).max(axis=-1)
        return np.maximum(self.chain.reach, np.where(np.isfinite(far), far, 0.0))

    @cached_property
    def scale(self) -> Array:
        """(..., n) unit of each joint variable: 1 rad, or the unit of length."""
        return np.where(self.chain.revolute, 1.0, self.unit[..., None])

    def errors(self, q: Array) -> tuple[Array, Array]:
        """How far the wanted entries are from the goal, and the derivatives by the free joints, without units.

        Args:
            q: (..., n) configurations.

        Returns:
            (..., rows) and (..., rows, free joints), lengths divided by the unit, slides counted in it.
        """
        pose, slope = self.chain.pose_and_jacobian(q)
        rows, columns = (list(index) for index in zip(*self.entries, strict=True))
        weight = np.where(np.array(columns) == 3, 1.0 / self.unit[..., None], 1.0)
        difference: Array = pose - self.poses
        error = difference[..., rows, columns] * weight
        by_joint = slope[..., rows, columns] * weight[..., None, :] * self.scale[..., :, None]
        return error, np.swapaxes(by_joint[..., self.free, :], -1, -2)

    def moved(self, q: Array, step: Array) -> Array:
        """Configurations after a step of the free joints.

        Args:
            q: (..., n) configurations.
            step: (..., free joints), without units.
        """
        result = q.copy()
        result[..., self.free] += step * self.scale[..., self.free]
        return result

    def residual(self, q: Array) -> Array:
        """The largest error of an entry, without units.

        Args:
            q: (..., n) configurations.
        """
        worst: Array = np.abs(self.errors(q)[0]).max(axis=-1)
        return worst


@dataclass(frozen=True, slots=True, eq=False)
class NumericSolutions:
    """All configurations that were found for one pose.

    Attributes:
        q: (branches, n), angles in (-pi, pi] unless limits ask for a full turn more.
        status: (branches,) a `Status` each.
        residual: (branches,) largest error of an entry of the pose, lengths relative to the reach.
        free: (branches, n) the joints that can move while the pose stays; they have the values of ``near``.
    """

    q: Array
    status: Array
    residual: Array
    free: Array


def polish(problem: Problem, q: Array, steps: int = POLICY.polish) -> tuple[Array, Array]:
    """Newton steps with the exact Jacobian, each kept only where the pose's error shrinks.

    Args:
        problem: The goal; its poses broadcast with the configurations.
        q: (..., n) candidates; those with NaN stay as they are.
        steps: Most steps.

    Returns:
        (..., n) and the residuals (...), infinite for candidates with NaN.
    """
    known: Array = np.asarray(np.isfinite(q).all(axis=-1))
    q = np.where(known[..., None], q, 0.0)
    error, slope = problem.errors(q)
    best = np.linalg.norm(error, axis=-1)
    for _ in range(steps):
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
    """Levenberg's and Marquardt's method from many starts at once.

    Args:
        problem: The goal.
        q: (starts, n) where to begin; given joints keep their values.
        steps: Most steps of a start.

    Returns:
        (starts, n) where each start ended, and the residuals there (starts,).
    """
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
        at = np.swapaxes(slope[moving], -1, -2)
        normal = at @ slope[moving] + damping[moving, None, None] * unit
        step = -np.linalg.solve(normal, at @ error[moving, :, None])[..., 0]
        candidate = part.moved(q[moving], step)
        new_error, new_slope = part.errors(candidate)
        new_cost = (new_error**2).sum(axis=-1)
        better = new_cost < cost[moving]
        resting[moving] = np.where(better, 0, resting[moving] + 1)
        damping[moving] = np.clip(damping[moving] * np.where(better, 0.15, 2.0 ** resting[moving]), 1e-13, 1e6)
        kept = moving[better]
        q[kept], error[kept], slope[kept], cost[kept] = (
            candidate[better],
            new_error[better],
            new_slope[better],
            new_cost[better],
        )
    return q, np.abs(error).max(axis=-1)


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

    The search ends when solutions known have been met again so often that another one would have been seen.

    Args:
        chain: The arm.
        pose: (4, 4) the goal.
        entries: The entries of the pose that are wanted.
        given: Values of joints that are not solved for, by index from 0.
        near: (n,) what free joints take at singular poses; zero unless given.
        limits: Whether solutions must keep to the joint limits; angles are then turned fully where that helps.
        policy: Thresholds.

    Returns:
        The solutions, those nearest to ``near`` first; none where the pose is out of reach.

    Raises:
        ValueError: The pose has another shape or is not finite, or a given joint does not exist.
    """
    goal, given = np.asarray(pose, dtype=float), dict(given or {})
    if goal.shape != (4, 4) or not np.isfinite(goal).all():
        raise ValueError(f"a pose is a finite (4, 4) matrix, not of shape {goal.shape}")
    if not set(given) <= set(range(chain.n)):
        raise ValueError(f"given joints are 0 to {chain.n - 1}, not {sorted(given)}")
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
    """Between which values starts are drawn: a full turn, a slide's limits or twice the unit of length."""
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
    """The solution after a step of one joint, if the others can answer it by changing ``most`` at the most."""
    attempt = q.copy()
    attempt[joint] += change
    end, residual = fit(rest, attempt[None, :], 30)
    far = np.abs((end[0] - q) / rest.scale).max()
    return end[0] if residual[0] <= POLICY.residual and far <= most else None


def _can_move(rest: Problem, q: Array, joint: int) -> bool:
    """Whether the other joints can answer a small step of one, forwards or backwards."""
    small = 1e-2 * rest.scale[joint]
    return any(_answered(rest, q, joint, change, 0.5) is not None for change in (small, -small))


def _as_near(rest: Problem, q: Array, joint: int, goal: float) -> Array:
    """The solution with one joint as near to ``goal`` as the others let it come, by steps."""
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
        """Whether where a start ended leads to a solution that is new; known ones are not added.

        Double roots are known less exactly than others, and self-motions that do not reach ``near`` still less.
        """
        _, slope = self.problem.errors(q)
        values = np.linalg.svd(slope, compute_uv=False)
        full = slope.shape[0] >= slope.shape[1]
        smallest = float(values.min(initial=1.0)) if full else 0.0
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
    """Angles turned fully until they are within their limits, nearest to ``near`` where there is a choice."""
    turns = 2 * math.pi * np.arange(-3, 4)
    choices = q[..., None] + turns * chain.revolute[:, None]
    low, high = chain.limits.T
    outside = np.maximum(low[:, None] - choices, choices - high[:, None]).clip(min=0.0)
    away = np.where(outside > 1e-9, 1e6 + outside, np.abs(choices - near[:, None]))
    best: Array = np.take_along_axis(choices, away.argmin(axis=-1)[..., None], axis=-1)[..., 0]
    return best


def _cross_matrix(v: Array) -> Array:
    """(..., 3, 3) the matrix S with S u = v x u."""
    matrix: Array = np.cross(np.eye(3), v[..., None, :])
    return matrix


def _matrix(frame: Frame[float]) -> Array:
    """A frame as a (4, 4) matrix."""
    return np.array([[float(entry) for entry in row] for row in frame.rows(0.0, 1.0)])
