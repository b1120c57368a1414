"""All solutions of poses in floats, under one interface: by the solution graph, else by damped Newton.

Every leaf of the graph is a candidate. One that does not reproduce its pose to rounding is polished by Newton steps
with the exact Jacobian; what does not reproduce it then is no solution (at special poses the product of the branches
exceeds the number of solutions), and of candidates that coincide one is kept.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import numpy.typing as npt

from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import GraphWalk, SolutionGraph
from derive.inverse.general.rigid_motion import BESIDE, beside
from derive.inverse.numeric.chain import Array, Entries, NumericChain, Problem
from derive.inverse.numeric.newton import Status, fit, follow, polish, solve
from derive.robot.evaluate import parameter_values
from derive.robot.options.solution_policy import POLICY
from derive.robot.robot import Robot

REPRODUCED = 1e-10  # largest error of the pose of a solution, lengths relative to the reach
RESCUED = 60  # most steps of damped Newton from the leaves of a pose at which none is a solution
STARTS = 24  # configurations from which solutions of arms with few joints, and no poses beside, are looked for
NEIGHBOURS = 40  # most steps of damped Newton from a solution of a pose beside, or from such a configuration
ALONE = 1e-5  # smallest singular value of the derivatives at a solution that is none of a continuum


@dataclass(frozen=True, eq=False)
class Branches:
    """The solutions of a batch of poses."""

    q: Array  # (..., branches, n), NaN where a branch does not exist
    status: Array  # (..., branches) a `Status` each


@dataclass(frozen=True, eq=False)
class InverseSolver:
    """Solves one arm."""

    graph: SolutionGraph  # its solution graph
    chain: NumericChain  # its numbers
    field: FloatField  # the floats that the graph is run over
    entries: Entries  # the entries of the pose that are wanted, rows and columns from 0

    @classmethod
    def of(cls, robot: Robot, graph: SolutionGraph, parameters: Mapping[str, float] | None = None) -> InverseSolver:
        """The solver of an arm; parameters without a number in the file need one, others may have another."""
        numbers = parameter_values(robot, parameters)
        return cls(graph, NumericChain.of(robot, parameters), FloatField(numbers), tuple(sorted(graph.places)))

    def solve(
        self,
        poses: npt.ArrayLike,
        given: npt.ArrayLike | None = None,
        near: Sequence[float] | None = None,
        tolerance: float = POLICY.orthogonal,
    ) -> Branches:
        """All solutions of poses (..., 4, 4): (..., branches, n) and their status, angles in (-pi, pi].

        The variables of given joints are (..., k), in their order; ``near`` (n,) has what joints take that a singular
        pose leaves free, else zero; R^T R may differ from 1 by the tolerance, and the nearest rotation is taken.
        """
        goal = self._poses(poses, tolerance)
        batch, count = goal.shape[:-2], len(self.graph.given)
        values = _real_numbers("given", np.zeros((*batch, 0)) if given is None else given)
        if values.shape[-1:] != (count,) or not np.isfinite(values).all():
            raise ValueError(f"given must be finite numbers of shape (..., {count}); got shape {values.shape}")
        if values.shape[:-1] not in ((), (1,), batch):
            raise ValueError(f"given has the batch shape {values.shape[:-1]}, but the poses have {batch}")
        nearby = None if near is None else _real_numbers("near", near)
        if nearby is not None and (nearby.shape != (self.chain.n,) or not np.isfinite(nearby).all()):
            raise ValueError(f"near must be finite numbers of shape ({self.chain.n},); got shape {nearby.shape}")
        flat = goal.reshape(-1, 4, 4)
        row = np.broadcast_to(values, (*batch, count)).reshape(len(flat), count)
        found = self._closed(flat, row, nearby) if self.graph.is_closed else self._numeric(flat, row, nearby)
        shape = (*batch, found.q.shape[1])
        return Branches(found.q.reshape(*shape, self.chain.n), found.status.reshape(shape))

    def _poses(self, poses: npt.ArrayLike, tolerance: float) -> Array:
        goal = _real_numbers("poses", poses)
        if goal.shape[-2:] != (4, 4):
            raise ValueError(f"poses must have shape (4, 4) or (..., 4, 4); got {goal.shape}")
        if not np.isfinite(goal).all():
            raise ValueError("poses must have finite entries")
        if np.abs(goal[..., 3]).max(initial=0.0) > POLICY.far:
            far = f"{np.abs(goal[..., 3]).max():.0e} m away (allowed: {POLICY.far:.0e})"
            raise ValueError(f"not a valid pose: its position is {far}")
        if np.abs(goal[..., 3, :] - (0.0, 0.0, 0.0, 1.0)).max(initial=0.0) > POLICY.orthogonal:
            raise ValueError("not a valid pose: its last row is not [0, 0, 0, 1]")
        turn = goal[..., :3, :3]
        away = np.abs(np.swapaxes(turn, -1, -2) @ turn - np.eye(3)).max(initial=0.0)
        turns = any(j < 3 for _, j in self.entries)
        if turns and away > tolerance:
            found = f"not a valid pose: its rotation is not orthonormal (error {away:.1e} > {tolerance:g})"
            raise ValueError(f"{found}; give more digits, or a tolerance= to use the nearest rotation")
        if turns and (np.linalg.det(turn) < 0).any():
            raise ValueError("not a valid pose: its rotation is a reflection (determinant -1)")
        if turns and away > POLICY.orthogonal:
            left, _, right = np.linalg.svd(turn)
            goal = goal.copy()
            goal[..., :3, :3] = left @ right  # of all rotations the nearest in the sum of squares
        return goal

    @property
    def _free(self) -> Array:
        return np.array([i not in self.graph.given for i in range(self.chain.n)])

    def _closed(self, poses: Array, given: Array, near: Array | None) -> Branches:
        q, status, doubt, free = self._leaves(poses, given, near)
        settled = np.zeros_like(free)
        suspect = doubt | free
        q, status = self._checked(poses, q, status, doubt, free, settled)
        for place in POLICY.elsewhere:
            stuck = np.flatnonzero((free & (status == Status.NONE)).any(axis=1))
            if not stuck.size:
                break
            lacking = free[stuck] & (status[stuck] == Status.NONE)
            there = self._leaves(poses[stuck], given[stuck], [place] * self.chain.n)
            tried = np.where(lacking[..., None], there[0], q[stuck]), np.where(lacking, there[1], status[stuck])
            still, known = free[stuck], settled[stuck]
            q[stuck], status[stuck] = self._checked(poses[stuck], *tried, lacking & there[2], still, known)
            free[stuck] = still
        unsure = np.flatnonzero((suspect & ((status == Status.NONE) | (status == Status.SINGULAR))).any(axis=1))
        if unsure.size:
            # The leaves of poses a little beside, at which nothing is special.
            unit = Problem(self.chain, poses[unsure]).unit
            near_by = (beside(poses[unsure], k, unit) for k in range(len(BESIDE)))
            leaves = [self._leaves(there, given[unsure], None)[0] for there in near_by]
            self._add_from(poses, q, status, unsure, np.concatenate(leaves, axis=1))
            # Configurations that fill the joint space evenly, joints that are given where they are.
            unsure = unsure[self.graph.is_short | (status[unsure] == Status.NONE).all(axis=1)]
            spread = starts(self.chain.n) * Problem(self.chain, poses[unsure]).scale[:, None]
            spread[..., self.chain.revolute] *= math.pi
            spread[..., ~self._free] = given[unsure, None]
            self._add_from(poses, q, status, unsure, spread)
        turns = 2 * math.pi * np.ceil((q - math.pi) / (2 * math.pi))
        folded = q - np.where(self.chain.revolute & self._free, turns, 0.0)  # into (-pi, pi]
        return Branches(np.where((status == Status.NONE)[..., None], np.nan, folded), status)

    def _leaves(
        self, poses: Array, given: Array, near: Sequence[float] | Array | None
    ) -> tuple[Array, Array, Array, Array]:
        """The leaves of the graph: joints, status (negative where a leaf does not exist), doubt, and freedom."""
        rows = [[poses[:, i, j] for j in range(4)] for i in range(3)]
        zero = np.zeros(len(poses))
        nearby = None if near is None else [zero + value for value in near]
        run = GraphWalk(self.graph, self.field, rows, list(given.T), nearby)
        no = zero.astype(bool)
        candidates, statuses, doubts, frees = [], [], [], []
        for leaf in run.leaves():
            exists = leaf.exists & ~no
            free = np.any([no | mask for mask in leaf.free], axis=0)
            doubts.append(no | leaf.doubt)
            frees.append(free)
            status = np.where(free, Status.SINGULAR, np.where(leaf.boundary, Status.BOUNDARY, Status.EXACT))
            q = np.stack([zero + value for value in run.angles(leaf)], axis=-1)
            statuses.append(np.where(np.isfinite(q).all(axis=-1), np.where(exists, status, -status), Status.NONE))
            candidates.append(np.where(np.isfinite(q), q, 0.0))
        for table, empty in ((candidates, np.zeros_like(candidates[0])), (statuses, zero), (doubts, no), (frees, no)):
            table += [empty] * self.graph.spare
        q, status, doubt, freedom = (np.stack(each, axis=1) for each in (candidates, statuses, doubts, frees))
        return q, status.astype(np.int8), doubt, freedom

    def _checked(
        self, poses: Array, q: Array, status: Array, doubt: Array, free: Array, settled: Array
    ) -> tuple[Array, Array]:
        """Candidates polished, those dropped that do not reproduce their pose or repeat another one.

        A negative status is that of a leaf that does not exist by its nodes. From those that are in doubt, and from all
        where no leaf that exists is a solution, damped Newton goes on. Leaves whose free joints may be where they are
        get settled; another posture with these elsewhere is not listed.
        """
        pose, row = np.nonzero(status != Status.NONE)
        refined = q[pose, row]
        residual = Problem(self.chain, poses[pose], self.entries, self._free).residual(refined)
        # 1. Leaves that exist and do not close: Newton's method.
        rough = np.flatnonzero((residual > POLICY.rounding) & (status[pose, row] > 0))
        part = Problem(self.chain, poses[pose[rough]], self.entries, self._free)
        refined[rough], residual[rough] = polish(part, refined[rough])
        residual[status[pose, row] < 0] = math.inf
        # 2. Poses without any solution, and leaves in doubt: damped steps from all leaves.
        solved = np.zeros(len(poses), dtype=bool)
        solved[pose[residual <= REPRODUCED]] = True
        settled[pose, row] |= free[pose, row] & (residual <= POLICY.rounding)
        lost = np.flatnonzero(~solved[pose] | (doubt[pose, row] & (residual > REPRODUCED)))
        part = Problem(self.chain, poses[pose[lost]], self.entries, self._free)
        refined[lost], residual[lost] = follow(part, *fit(part, q[pose[lost], row[lost]], RESCUED))
        status[pose[lost], row[lost]] = Status.SINGULAR
        rescued = np.zeros_like(free)
        rescued[pose[lost], row[lost]] = True
        q[pose, row] = refined
        status[pose, row] = np.where(residual <= REPRODUCED, np.abs(status[pose, row]), Status.NONE)
        return q, self._once(poses, q, status, rescued, free, settled)

    def _add_from(self, poses: Array, q: Array, status: Array, rows: Array, starts: Array) -> None:
        """Add solutions to which damped steps from (rows, k, n) configurations lead."""
        place, branch = (each.ravel() for each in np.indices(starts.shape[:2]))
        part = Problem(self.chain, poses[rows[place]], self.entries, self._free)
        found, residual = follow(part, *fit(part, starts.reshape(-1, self.chain.n), NEIGHBOURS))
        reached = np.flatnonzero(residual <= REPRODUCED)
        slopes = replace(part, poses=part.poses[reached]).errors(found[reached])[1]
        alone = np.linalg.svd(slopes, compute_uv=False)[..., -1] > ALONE
        for k, is_alone in zip(reached.tolist(), alone.tolist(), strict=True):
            row, home = rows[place[k]], branch[k] % q.shape[1]
            apart = (q[row] - found[k]) / Problem(self.chain, poses[row], self.entries, self._free).scale
            apart -= np.where(self.chain.revolute, 2 * math.pi * np.round(apart / (2 * math.pi)), 0.0)
            listed = status[row] != Status.NONE
            again = (listed & (np.abs(apart).max(axis=-1) < POLICY.double)).any() or listed.all()
            # What is not listed goes where its branch would be; one of a continuum only where there is nothing else.
            if not listed.any() or (is_alone and not again):
                home = home if not listed[home] else int(listed.argmin())
                q[row, home], status[row, home] = found[k], Status.EXACT if is_alone else Status.SINGULAR

    def _once(self, poses: Array, q: Array, status: Array, rescued: Array, free: Array, settled: Array) -> Array:
        """The status of candidates, `Status.NONE` for those that repeat an earlier one."""
        scale = Problem(self.chain, poses, self.entries, self._free).scale
        for before, later in combinations(range(q.shape[1]), 2):
            both = (status[:, before] != Status.NONE) & (status[:, later] != Status.NONE)
            if both.any():
                apart = (q[:, later] - q[:, before]) / scale
                turns = np.where(self.chain.revolute, 2 * math.pi * np.round(apart / (2 * math.pi)), 0.0)
                edge = (status[:, before] != Status.EXACT) & (status[:, later] != Status.EXACT)
                distance = np.abs(apart - turns)
                near = distance.max(axis=-1) < np.where(edge, POLICY.double, POLICY.same)
                status[both & near, later] = Status.NONE
                # Of two postures that differ by joints about one axis only the settled one is listed.
                two = both & ~near & ((distance > POLICY.double).sum(axis=-1) <= 2)  # joints that turn about one axis
                for one, other in ((before, later), (later, before)):
                    elsewhere = two & settled[:, one] & rescued[:, other]
                    status[elsewhere, other], free[elsewhere, other] = Status.NONE, False
        return status

    def _numeric(self, poses: Array, given: Array, near: Array | None) -> Branches:
        start = None if near is None else near.tolist()
        pairs = zip(poses, (dict(zip(self.graph.given, row, strict=True)) for row in given), strict=True)
        found = [solve(self.chain, pose, entries=self.entries, given=own, near=start) for pose, own in pairs]
        width = max((len(one.q) for one in found), default=0)
        q = np.full((len(poses), width, self.chain.n), np.nan)
        status = np.zeros((len(poses), width), dtype=np.int8)
        for k, one in enumerate(found):
            q[k, : len(one.q)], status[k, : len(one.q)] = one.q, one.status
        return Branches(q, status)


def starts(joints: int) -> Array:
    """Configurations that fill the joint space evenly, in half turns and units of length (Roberts's sequence)."""
    # The root of x^(n+1) = x + 1, by iteration: its powers fill the cube evenly (Roberts 2018).
    ratio = 2.0
    for _ in range(60):
        ratio = (1.0 + ratio) ** (1.0 / (joints + 1))
    steps = np.outer(np.arange(1, STARTS + 1), ratio ** -np.arange(1.0, joints + 1.0))
    return np.round(2.0 * ((0.5 + steps) % 1.0) - 1.0, 3)


def _real_numbers(name: str, value: npt.ArrayLike) -> Array:
    try:
        found = np.asarray(value)
    except ValueError:
        raise ValueError(f"{name} must have rows of equal length") from None
    if found.dtype.kind not in "fiub":
        raise TypeError(f"{name} must be real numbers; got dtype {found.dtype}")
    return found.astype(np.float64, copy=False)
