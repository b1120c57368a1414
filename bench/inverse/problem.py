"""Poses of some arms, and how many of their solutions a solver finds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec
from typing import Any

import numpy as np

from bench.peers.peer import Timed
from bench.robots import Array, Case
from derive.verification.oracle.frames import forward_kinematics

ARMS = ("puma560-numeric", "ur5-numeric", "kr5-numeric", "stanford-numeric")
ONE, C, BATCH = "one pose from Python", "one pose in C", "batch"
WAYS = (ONE, C, BATCH)

POSES = 100_000
SINGLE = 100
"""Poses of a pass that takes them one by one."""

CHECKED = 16
CLOSE = 1e-6
"""Largest error of the pose of what counts as a solution, in radians and relative to the arm's reach."""

APART = 1e-4
"""Solutions that are nearer to each other are one."""


@dataclass(frozen=True, eq=False)
class Problem:
    """An arm and the poses of random configurations; the same ones in every run.

    Attributes:
        case: The arm.
    """

    case: Case

    @cached_property
    def configurations(self) -> Array:
        """Where the poses come from, (N, n): angles within half a turn, slides from 0.2 to 1."""
        arm, rng = self.case.oracle.arm, np.random.default_rng(12)
        low, high = np.where(arm.revolute, -np.pi, 0.2), np.where(arm.revolute, np.pi, 1.0)
        return rng.uniform(low, high, (POSES, self.case.robot.n))

    @cached_property
    def poses(self) -> Array:
        """Poses of the end effector, (N, 4, 4), by the independent recursion."""
        return np.ascontiguousarray(forward_kinematics(self.case.oracle.arm, self.configurations))

    def solutions(self, found: Sequence[Array]) -> float:
        """Mean number of solutions.

        Args:
            found: Joint variables for each of the first poses, (k, n), rows that are none among them.

        Returns:
            How many different ones lead to their pose.

        Raises:
            ValueError: A configuration that a pose comes from is not among them.
        """
        counts = []
        for q, pose, rows in zip(self.configurations, self.poses, found, strict=False):
            right = self._leading_to(pose, rows[np.isfinite(rows).all(axis=1)])
            if not len(right) or self._distance(right, q).min() > APART:
                raise ValueError("misses the configuration that a pose comes from")
            counts.append(sum(self._distance(right[:k], row).min(initial=1.0) > APART for k, row in enumerate(right)))
        return float(np.mean(counts))

    def _leading_to(self, pose: Array, rows: Array) -> Array:
        if not len(rows):
            return rows
        reach = max(1.0, float(np.abs(pose[:3, 3]).max()))
        error = np.abs(forward_kinematics(self.case.oracle.arm, rows) - pose) / np.array([1.0, 1.0, 1.0, reach])
        chosen: Array = rows[error.max(axis=(1, 2)) < CLOSE]
        return chosen

    def _distance(self, rows: Array, q: Array) -> Array:
        """How far configurations are from one, modulo full turns."""
        difference = rows - q
        turned = np.abs((difference + np.pi) % (2 * np.pi) - np.pi)
        distance: Array = np.where(self.case.oracle.arm.revolute, turned, np.abs(difference)).max(axis=1, initial=0.0)
        return distance


@dataclass(frozen=True)
class Solver:
    """One cell of the tables before it is measured.

    Attributes:
        label: Name of its row.
        way: Which table, one of `WAYS`.
        prepare: Makes it ready for an arm; may raise, with the reason why it cannot.
        modules: What must be importable.
    """

    label: str
    way: str
    prepare: Callable[[Problem], Solving]
    modules: tuple[str, ...] = ()

    @property
    def missing(self) -> tuple[str, ...]:
        """Modules that are not installed."""
        return tuple(name for name in self.modules if find_spec(name) is None)


@dataclass(frozen=True)
class Solving:
    """A solver that is ready.

    Attributes:
        run: One pass over the first poses.
        count: How many poses a pass has.
        found: Joint variables of the first poses, called after a pass.
    """

    run: Callable[[], object]
    count: int
    found: Callable[[], Iterator[Array]]

    @property
    def timed(self) -> Timed:
        """For the stopwatch."""
        return Timed(self.run, self.count, lambda: np.concatenate(list(self.found())))


def one_by_one(
    solve: Callable[[Any], Any],
    rows: Callable[[Any], Array],
    poses: Array,
    as_taken: Callable[[Array], Any] = np.ascontiguousarray,
) -> Solving:
    """Calls with one pose each.

    Args:
        solve: Takes a pose.
        rows: What it returns as joint variables, (k, n).
        poses: (N, 4, 4).
        as_taken: Makes of a pose what it takes, beforehand.
    """
    taken = [as_taken(pose) for pose in poses[:SINGLE]]

    def _run() -> None:
        for pose in taken:
            solve(pose)

    return Solving(_run, len(taken), lambda: (rows(solve(pose)) for pose in taken[:CHECKED]))
