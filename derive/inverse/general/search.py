"""Joints that no order of one-joint equations yields: up to sixteen solutions from one eigenvalue problem.

Every candidate that an elimination gives (`candidates`) is refined by Newton's method on the whole
pose; what does not reach the pose is dropped. Double roots appear as pairs of nearly real eigenvalues and are refined
like the others. Where an elimination leaves a doubt, the next one is asked.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from derive.inverse.general.candidates import candidates, finished
from derive.inverse.general.closure import Loop
from derive.inverse.general.elimination import POLICY, EigenProblem, Elimination
from derive.inverse.general.rigid_motion import BESIDE, Array, beside, motion_by
from derive.inverse.numeric.chain import POSE, POSITION, Entries, NumericChain, Problem
from derive.inverse.numeric.newton import fit
from derive.robot.robot import Robot

# With as many joints as a task has dimensions the number of real solutions is even at regular poses.
FULL = {POSE: 6, POSITION: 3}
SPECIAL = 4  # solutions that special poses of arms with few joints have (`derive.inverse.closed.graph.SPECIAL`)


@dataclass(frozen=True, eq=False)
class GeneralSolution:
    """All solutions of an arm by elimination."""

    given: tuple[int, ...]  # indices of the joints that are arguments
    entries: Entries  # the entries of T that are wanted, `POSE` or `POSITION`
    eliminations: tuple[Elimination, ...]  # the best first; the next ones are asked where those before leave a doubt
    count: int = 0  # number of complex solutions of a generic pose; 0 where it is not known

    @property
    def branches(self) -> int:
        """The largest number of solutions that a regular pose can have, with room for those of special ones."""
        if self.count and self.entries == POSE and self.eliminations[0].finish.joints < FULL[POSE]:
            return max(self.count, SPECIAL)
        return self.count or 2 * self.eliminations[0].eigenvalues  # two where the joints between are not unique

    def solve(self, chain: NumericChain, poses: Array, given: Array | None = None) -> Array:
        """Every real solution for each pose.

        (poses, k, n), those that exist first and NaN after them; k is the largest number of solutions met. Of given
        joints there are the variables, (poses, given joints).
        """
        # By eliminations; then from poses a little beside; where still none is found by damped steps from anywhere.
        q, open_ = self._eliminated(chain, poses, given)
        chosen = None if given is None else given[open_]
        for which in range(len(BESIDE)):
            if open_.size:
                more = self._from_beside(which, chain, poses[open_], chosen)
                q = _placed(q, open_, _distinct(np.concatenate([q[open_], more], axis=1), chain, self.given))
        empty = open_[~np.isfinite(q[open_, :, 0]).any(axis=1)]
        if empty.size:
            chosen = None if given is None else given[empty]
            q = _placed(q, empty, self._approached(chain, poses[empty], chosen))
        return self._limited(chain, poses, q)

    def _eliminated(self, chain: NumericChain, poses: Array, given: Array | None) -> tuple[Array, Array]:
        """The solutions by one elimination after the other, and the poses at which some may be missing."""
        q, open_ = np.full((len(poses), 0, chain.n), np.nan), np.arange(len(poses))
        for index in range(len(self.eliminations)):
            if open_.size:
                found = self.attempt(index, chain, poses[open_], None if given is None else given[open_])
                q = _placed(q, open_, _distinct(np.concatenate([q[open_], found.q], axis=1), chain, self.given))
                open_ = open_[found.doubtful]
        return q, open_

    def _from_beside(self, which: int, chain: NumericChain, poses: Array, given: Array | None) -> Array:
        """Isolated solutions, from those of neighbouring poses, at which no elimination fails."""
        goal = Problem(chain, poses)
        found, _ = self._eliminated(chain, beside(poses, which, goal.unit), given)
        place, branch = np.nonzero(np.isfinite(found[..., 0]))
        goal = Problem(chain, poses[place], self.entries, np.isin(np.arange(chain.n), self.given, invert=True))
        q, residual = _newton(goal, found[place, branch], POLICY.approach)
        # A solution stands alone where the Jacobian has full column rank; others are of a self-motion.
        alone = np.linalg.svd(goal.errors(q)[1], compute_uv=False)[..., -1] > POLICY.alone
        good = alone & (residual <= POLICY.residual)
        return _table(place[good], q[good], len(poses))

    def _limited(self, chain: NumericChain, poses: Array, q: Array) -> Array:
        """At most as many solutions as the arm has, isolated ones first: if more were found some form a continuum."""
        many = np.flatnonzero(np.isfinite(q[..., 0]).sum(axis=1) > self.branches)
        if not many.size:
            return q
        goal = Problem(chain, poses[many, None], self.entries, np.isin(np.arange(chain.n), self.given, invert=True))
        smallest = np.linalg.svd(goal.errors(np.nan_to_num(q[many]))[1], compute_uv=False)[..., -1]
        order = np.argsort(np.where(np.isfinite(q[many, :, 0]), -smallest, 1.0), axis=1)[:, : self.branches]
        result = q.copy()
        result[many] = np.nan
        result[many, : order.shape[1]] = np.take_along_axis(q[many], order[..., None], axis=1)
        return result

    def _approached(self, chain: NumericChain, poses: Array, given: Array | None) -> Array:
        """Solutions from all eigenvalues as starts of a damped method: at poses with infinitely many solutions."""
        place, q, goal, _ = self._starts(0, chain, poses, given, math.inf)
        q, residual = fit(goal, q, POLICY.approach)
        good = residual <= POLICY.residual
        return _distinct(_table(place[good], q[good], len(poses)), chain, self.given)

    def attempt(self, index: int, chain: NumericChain, poses: Array, given: Array | None) -> Attempt:
        """The solutions that one elimination finds."""
        place, q, goal, doubtful = self._starts(index, chain, poses, given, POLICY.real)
        first = goal.residual(q)
        q, residual = _refined(goal, q)
        good = residual <= POLICY.residual
        sure = good & (first < POLICY.rough)
        certain = int(np.isfinite(_distinct(_table(place[sure], q[sure], len(poses)), chain, self.given)[..., 0]).sum())
        distinct = _distinct(_table(place[good], q[good], len(poses)), chain, self.given)
        numbers = np.isfinite(distinct[..., 0]).sum(axis=1)
        doubtful |= numbers == 0
        # where a start was lucky M is inexact, and others may have had no luck
        doubtful[place[np.where(good, first >= POLICY.rough, first < POLICY.near)]] = True
        # Complex solutions come in conjugate pairs: an odd number of real ones says that one is missing.
        if goal.free.sum() == FULL[self.entries]:
            doubtful |= numbers % 2 == 1
        return Attempt(distinct, doubtful, certain, float(np.quantile(first[good], 0.9)) if good.any() else math.inf)

    def _starts(
        self, index: int, chain: NumericChain, poses: Array, given: Array | None, real: float
    ) -> tuple[Array, Array, Problem, Array]:
        """For each candidate its pose and configuration, the goal, and the poses at which some may be missing."""
        elimination, unit = self.eliminations[index], chain.reach
        loop, free = free_loop(chain, self.given, given, self.entries)
        pose = scaled(poses, unit)
        if elimination.start:
            loop, pose = loop.rotated(elimination.start, pose)
        constant = given is None and not elimination.start
        problem = (
            _constant_problem(chain, elimination, self.entries) if constant else EigenProblem.of(loop, elimination)
        )
        found = candidates(problem, pose, real)
        values = finished(problem, found, pose)
        q = np.empty((len(values.place), chain.n))
        # From the loop's order, sense and unit of length to those of the arm.
        own = np.roll(values.joints, elimination.start, axis=1)[:, : len(free)]
        q[:, free] = own * chain.sign[free] * np.where(chain.revolute[free], 1.0, unit)
        if given is not None:
            q[:, list(self.given)] = given[values.place]
        known = (np.abs(q) < POLICY.far * max(1.0, unit)).all(axis=1)
        place, q = values.place[known], q[known]
        goal = Problem(chain, poses[place], self.entries, np.isin(np.arange(chain.n), free))
        return place, q, goal, found.doubtful


@dataclass(frozen=True, eq=False)
class Attempt:
    """Solutions by one elimination."""

    q: Array  # (poses, k, n)
    doubtful: Array  # (poses,) where some may be missing
    certain: int  # how many of all were close before refinement: Newton's method had no luck with them
    error: float  # of most of them, before refinement


@lru_cache(maxsize=64)
def _constant_problem(chain: NumericChain, elimination: Elimination, entries: Entries) -> EigenProblem:
    """The eigenvalue problem of an arm that is the same for all poses, made once."""
    return EigenProblem.of(free_loop(chain, (), None, entries)[0], elimination)


def scaled(poses: Array, unit: float) -> Array:
    """Poses in another unit of length."""
    result = poses.copy()
    result[..., :3, 3] /= unit
    return result


def free_loop(
    chain: NumericChain, given: Sequence[int], values: Array | None, entries: Entries = POSE
) -> tuple[Loop, Array]:
    """The loop of the joints that are solved for, in units of the reach, and their indices."""
    gaps = tuple(scaled(gap, chain.reach) for gap in (*chain.fixed, chain.tool))
    loop = Loop(tuple(bool(turns) for turns in chain.revolute), gaps)
    free = np.array([i for i in range(chain.n) if i not in given])
    motions: list[Array | None] = [None] * chain.n
    for place, joint in enumerate(given):
        value = chain.sign[joint] * (np.zeros(1) if values is None else values[:, place])
        motions[joint] = motion_by(loop.revolute[joint], value if loop.revolute[joint] else value / chain.reach)
    left = loop.locked(motions)
    return left if entries == POSE else left.with_tip, free


def _refined(problem: Problem, q: Array) -> tuple[Array, Array]:
    """Newton steps on the whole pose: two for all, more for those that have not converged, most for near ones."""
    q, residual = _newton(problem, q, 2)
    for steps, most in ((POLICY.steps, 0.3), (POLICY.approach, 1e-8)):
        late = np.flatnonzero((residual > 1e-13) & (residual < most))
        if late.size:
            part = replace(problem, poses=problem.poses[late])
            q[late], residual[late] = _newton(part, q[late], steps)
    return q, residual


def _newton(problem: Problem, q: Array, steps: int) -> tuple[Array, Array]:
    """Damped steps, each kept where the error shrinks."""
    error, slope = problem.errors(q)
    cost = (error**2).sum(axis=-1)
    damping = np.zeros(len(q))
    unit = np.eye(slope.shape[-1])
    for _ in range(steps):
        at = np.swapaxes(slope, -1, -2)
        # Levenberg and Marquardt: (J^T J + w 1) step = -J^T e, with less damping the smaller the error is.
        weight = np.maximum(damping, 1e-13 + 1e-2 * np.minimum(cost, 1.0))
        step = -np.linalg.solve(at @ slope + weight[:, None, None] * unit, at @ error[..., None])[..., 0]
        tried = problem.moved(q, step)
        new_error, new_slope = problem.errors(tried)
        new_cost = (new_error**2).sum(axis=-1)
        better = new_cost < cost
        damping = np.where(better, 0.1 * damping, np.maximum(10.0 * weight, 1e-9))
        q = np.where(better[:, None], tried, q)
        error, slope = np.where(better[:, None], new_error, error), np.where(better[:, None, None], new_slope, slope)
        cost = np.where(better, new_cost, cost)
        if not better.any():
            break
    return q, np.abs(error).max(axis=-1, initial=0.0)


def _table(place: Array, q: Array, count: int) -> Array:
    """Candidates in rows of their poses, (poses, k, n), NaN where there are fewer."""
    order = np.argsort(place, kind="stable")
    place, q = place[order], q[order]
    rank = np.arange(len(place)) - np.searchsorted(place, place)
    result = np.full((count, int(rank.max(initial=-1)) + 1, q.shape[1]), np.nan)
    result[place, rank] = q
    return result


def _placed(table: Array, rows: Array, new: Array) -> Array:
    """A table (poses, k, n) with some of its poses replaced, wider where need be."""
    width = max(table.shape[1], new.shape[1])
    result = np.full((len(table), width, table.shape[2]), np.nan)
    result[:, : table.shape[1]] = table
    result[rows] = np.nan
    result[rows, : new.shape[1]] = new
    return result


def _distinct(table: Array, chain: NumericChain, given: tuple[int, ...]) -> Array:
    """Angles in (-pi, pi], but for those of joints that are given; each solution once, NaN after them."""
    turning = chain.revolute & ~np.isin(np.arange(chain.n), given)
    # Into (-pi, pi], then the largest difference of a joint, the short way around.
    turned = np.where(turning, table - 2.0 * math.pi * np.ceil((table - math.pi) / (2.0 * math.pi)), table)
    apart = np.abs(turned[:, :, None] - turned[:, None])
    apart = np.where(chain.revolute, np.minimum(apart, 2.0 * math.pi - apart), apart / chain.reach)
    same = np.tril((apart < POLICY.apart).all(axis=-1), -1).any(axis=2)
    exists = np.isfinite(table[..., 0]) & ~same
    width = int(exists.sum(axis=1).max(initial=0))
    order = np.argsort(~exists, axis=1, kind="stable")[:, :width]
    kept = np.where(np.take_along_axis(exists, order, axis=1)[..., None], 1.0, np.nan)
    return np.take_along_axis(turned, order[..., None], axis=1) * kept


@dataclass(frozen=True, eq=False)
class GeneralFormula:
    """What a general node solves (`derive.inverse.closed.nodes.NodeFormula.payload`): all joints that are not given."""

    robot: Robot  # the arm, its joint variables the unknowns of the graph
    solution: GeneralSolution  # its eliminations
    given: tuple[tuple[str, ...], ...]  # for each given joint the generators of its unknown

    @property
    def branches(self) -> int:
        """The number of values of the node."""
        return self.solution.branches

    @property
    def joints(self) -> tuple[int, tuple[int, ...], tuple[int, ...]]:
        """The joint that the eigenvalues give, those of the eigenvectors, and those that are eliminated, from 0."""
        elimination = self.solution.eliminations[0]
        free = [i for i in range(self.robot.n) if i not in self.solution.given]
        own = free[elimination.start :] + free[: elimination.start]
        hidden = own[elimination.hidden]
        between = {own[k] for k in elimination.unknowns}
        return hidden, tuple(sorted(between - {hidden})), tuple(i for i in free if i not in between)

    @property
    def order(self) -> tuple[int, ...]:
        """All joints that are not given, in the order in which they follow."""
        hidden, others, eliminated = self.joints
        return (hidden, *others, *eliminated)

    def solve(self, field: Any, values: Mapping[str, Any]) -> list[tuple[tuple[tuple[Any, ...], ...], Any]]:
        """The branches of the node over floats."""
        chain = _chain(self.robot, tuple(sorted((name, float(value)) for name, value in field.values.items())))
        entries = [values[f"T[{i},{j}]"] for i in (1, 2, 3) for j in (1, 2, 3, 4)]
        known = [values[name] for names in self.given for name in names]
        *flat, last = np.broadcast_arrays(*entries, *known, np.float64(0.0))
        poses = np.tile(np.eye(4), (last.size, 1, 1))
        poses[:, :3] = np.stack([part.ravel() for part in flat[:12]], axis=-1).reshape(-1, 3, 4)
        numbers, given = iter(part.ravel() for part in flat[12:]), []
        for names in self.given:
            first = next(numbers)
            given.append(np.arctan2(next(numbers), first) if len(names) > 1 else first)
        found = self.solution.solve(chain, poses, np.stack(given, axis=-1) if given else None)
        branches: list[tuple[tuple[tuple[Any, ...], ...], Any]] = []
        for k in range(self.branches):
            own = found[:, k] if k < found.shape[1] else np.full((len(found), chain.n), np.nan)
            angles = [(joint, np.nan_to_num(own[:, joint]).reshape(last.shape)) for joint in self.order]
            pairs = tuple((np.cos(x), np.sin(x)) if chain.revolute[joint] else (x,) for joint, x in angles)
            branches.append((pairs, np.isfinite(own[:, 0]).reshape(last.shape)))
        return branches


@lru_cache(maxsize=64)
def _chain(robot: Robot, values: tuple[tuple[str, float], ...]) -> NumericChain:
    return NumericChain.of(robot, dict(values))
