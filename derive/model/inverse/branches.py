"""All solutions of poses in floats, under one interface: by the solution graph, else by damped Newton.

Every leaf of the graph is a candidate. One that does not reproduce its pose to rounding is polished by Newton steps
with the exact Jacobian; what does not reproduce it then is no solution (at special poses the product of the branches
exceeds the number of solutions), and of candidates that coincide one is kept.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from derive.model.inverse.fields import FloatField
from derive.model.inverse.graph import Run, SolutionGraph
from derive.model.inverse.numeric import Array, Entries, NumericChain, Problem, Status, polish, solve
from derive.robot.evaluate import parameter_values
from derive.robot.robot import Robot

REPRODUCED = 1e-10
"""Largest error of the pose of a solution, lengths relative to the reach."""

ROUNDING = 1e-13
"""Below it a candidate is not polished."""

SAME = 1e-7
"""Candidates closer than this [rad, or lengths relative to the reach] are one solution."""

DOUBLE = 3e-5
"""Two candidates of a double root, each on the boundary, lie within this of each other."""


@dataclass(frozen=True, eq=False)
class Branches:
    """The solutions of a batch of poses.

    Attributes:
        q: (..., branches, n), NaN where a branch does not exist.
        status: (..., branches) a `Status` each.
    """

    q: Array
    status: Array


@dataclass(frozen=True, eq=False)
class InverseSolver:
    """Solves one arm.

    Attributes:
        graph: Its solution graph.
        chain: Its numbers.
        field: The floats that the graph is run over.
        entries: The entries of the pose that are wanted, rows and columns from 0.
    """

    graph: SolutionGraph
    chain: NumericChain
    field: FloatField
    entries: Entries

    @classmethod
    def of(cls, robot: Robot, graph: SolutionGraph, parameters: Mapping[str, float] | None = None) -> InverseSolver:
        """The solver of an arm.

        Args:
            robot: The arm as it was read.
            graph: Its graph.
            parameters: A number for every symbol that has none in the file; it may override those of the file.
        """
        entries = tuple(sorted(graph.places))
        numbers = parameter_values(robot, parameters)
        return cls(graph, NumericChain.of(robot, parameters), FloatField(numbers), entries)

    def solve(
        self, poses: npt.ArrayLike, given: npt.ArrayLike | None = None, near: Sequence[float] | None = None
    ) -> Branches:
        """All solutions of poses.

        Args:
            poses: (..., 4, 4).
            given: (..., k) variables of the given joints, in their order.
            near: (n,) what joints take that a singular pose leaves free; zero unless given.

        Returns:
            (..., branches, n) and their status; angles in (-pi, pi].
        """
        goal = np.asarray(poses, dtype=float)
        batch = goal.shape[:-2]
        flat = goal.reshape(-1, 4, 4)
        known = np.broadcast_to(np.zeros((0,)) if given is None else np.asarray(given, float), (*batch, self._given))
        values = known.reshape(len(flat), self._given)
        found = self._closed(flat, values, near) if self.graph.is_closed else self._numeric(flat, values, near)
        shape = (*batch, found.q.shape[1])
        return Branches(found.q.reshape(*shape, self.chain.n), found.status.reshape(shape))

    @property
    def _given(self) -> int:
        return len(self.graph.given)

    @property
    def _free(self) -> Array:
        return np.array([i not in self.graph.given for i in range(self.chain.n)])

    def _closed(self, poses: Array, given: Array, near: Sequence[float] | None) -> Branches:
        rows = [[poses[:, i, j] for j in range(4)] for i in range(3)]
        zero = np.zeros(len(poses))
        nearby = None if near is None else [zero + value for value in near]
        run = Run(self.graph, self.field, rows, [given[:, k] for k in range(self._given)], nearby)
        candidates, statuses = [], []
        for leaf in run.leaves():
            exists = leaf.exists & ~zero.astype(bool)
            free = np.any([zero.astype(bool) | mask for mask in leaf.free], axis=0)
            status = np.where(free, Status.SINGULAR, np.where(leaf.boundary, Status.BOUNDARY, Status.EXACT))
            q = np.stack([zero + value for value in run.angles(leaf)], axis=-1)
            statuses.append(np.where(exists & np.isfinite(q).all(axis=-1), status, Status.NONE))
            candidates.append(q)
        q, status = np.stack(candidates, axis=1), np.stack(statuses, axis=1).astype(np.int8)
        q, status = self._checked(poses, q, status)
        return Branches(np.where((status == Status.NONE)[..., None], np.nan, self._folded(q)), status)

    def _checked(self, poses: Array, q: Array, status: Array) -> tuple[Array, Array]:
        """Candidates polished, those dropped that do not reproduce their pose or repeat another one."""
        branches = q.shape[1]
        pose, row = np.nonzero(status != Status.NONE)
        problem = Problem(self.chain, poses[pose], self.entries, self._free)
        residual = problem.residual(q[pose, row])
        rough = np.flatnonzero(residual > ROUNDING)
        if rough.size:
            part = Problem(self.chain, poses[pose[rough]], self.entries, self._free)
            q[pose[rough], row[rough]], residual[rough] = polish(part, q[pose[rough], row[rough]])
        far = residual > REPRODUCED
        status[pose[far], row[far]] = Status.NONE
        scale = np.where(self.chain.revolute, 1.0, problem.unit)
        for later in range(1, branches):
            for before in range(later):
                both = (status[:, before] != Status.NONE) & (status[:, later] != Status.NONE)
                if not both.any():
                    continue
                apart = (q[:, later] - q[:, before]) / scale
                turns = np.where(self.chain.revolute, 2 * math.pi * np.round(apart / (2 * math.pi)), 0.0)
                distance = np.abs(apart - turns).max(axis=-1)
                edge = (status[:, before] == Status.BOUNDARY) & (status[:, later] == Status.BOUNDARY)
                same = both & (distance < np.where(edge, DOUBLE, SAME))
                status[same, later] = Status.NONE
        return q, status

    def _numeric(self, poses: Array, given: Array, near: Sequence[float] | None) -> Branches:
        found = [
            solve(
                self.chain, pose, entries=self.entries, given=dict(zip(self.graph.given, row, strict=True)), near=near
            )
            for pose, row in zip(poses, given, strict=True)
        ]
        width = max((len(one.q) for one in found), default=0)
        q = np.full((len(poses), width, self.chain.n), np.nan)
        status = np.zeros((len(poses), width), dtype=np.int8)
        for k, one in enumerate(found):
            q[k, : len(one.q)], status[k, : len(one.q)] = one.q, one.status
        return Branches(q, status)

    def _folded(self, q: Array) -> Array:
        turns = 2 * math.pi * np.ceil((q - math.pi) / (2 * math.pi))
        return q - np.where(self.chain.revolute & self._free, turns, 0.0)
