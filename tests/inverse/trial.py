"""One arm on trial: its poses, all their true solutions, and what a solver makes of them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from itertools import combinations

import numpy as np

from derive.verification.oracle.frames import forward_kinematics, jacobian
from tests.inverse import truth
from tests.inverse.arms import ArmCase

ENTRIES = {"pose": truth.POSE, "position": truth.POSITION}

FOUND = 1e-5  # a true solution is found where a branch is at most this far from it
REGULAR = 1e-4  # smallest singular value from which on a solution must be found
REPRODUCED = 1e-9  # error of a branch's pose from which on it is spurious
DUPLICATE = 1e-7

Solver = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Poses (m, 4, 4), given joints (m, k) -> branches (m, b, n), NaN where there is none, and their status (m, b)."""


@dataclass(eq=False)
class Poses:
    """Poses of one arm with their true solutions."""

    q: np.ndarray  # (m, n) the configurations that they were made from; NaN for unreachable ones
    poses: np.ndarray  # (m, 4, 4)
    given: np.ndarray  # (m, k) values of the given joints
    true: list[np.ndarray]  # for each pose the true solutions (k, n) that are asked for; singular ones may be lost
    kind: str  # ``regular``, ``singular``, ``boundary`` or ``unreachable``


@dataclass
class Verdict:
    """What was found at some poses; verdicts are added."""

    poses: int = 0
    complete: int = 0  # at how many of them every true solution was found
    true: int = 0  # true solutions that were asked for
    found: int = 0  # those of them that were found
    spurious: int = 0  # branches that do not reproduce their pose
    repeated: int = 0  # poses at which one solution is there twice
    empty: int = 0  # reachable poses without any branch
    claims: int = 0  # unreachable poses with a branch
    wrong: int = 0  # poses with more solutions than the graph says, or an odd number of them lost
    residual: float = 0.0  # worst error of a branch's pose, lengths relative to the reach or one metre
    seconds: float = 0.0  # time of the solver
    missing: list[str] = field(default_factory=list)  # for each pose with a fault what it is, and the configuration

    def __add__(self, other: Verdict) -> Verdict:
        sums = {f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self)}
        return Verdict(**sums | {"residual": max(self.residual, other.residual)})

    @property
    def is_clean(self) -> bool:
        return not self.missing

    def __str__(self) -> str:
        return (
            f"{self.poses} poses, {self.found}/{self.true} solutions ({self.found / max(self.true, 1):.5%}), "
            f"{self.spurious} spurious, {self.repeated} repeated, {self.empty} empty, {self.claims} claimed, "
            f"{self.wrong} counts wrong, residual {self.residual:.0e}"
        )


@dataclass(eq=False)
class Trial:
    case: ArmCase
    count: int = 20
    seed: int = 0

    def __post_init__(self):
        self.arm = self.case.arm
        self.chain = truth.Chain(self.arm, ENTRIES[self.case.task], self.case.given)
        self.random = np.random.default_rng([self.seed, len(self.case.rows)])

    def configurations(self, count):
        """Random ones: angles of 3 rad at most, slides of one reach."""
        wide = np.where(self.arm.revolute, 3.0, self.chain.unit)
        return self.random.uniform(-wide, wide, (count, self.arm.n))

    def regular(self):
        q = self.configurations(self.count)
        return self.poses(q, "regular", self._all(q))

    def _all(self, q):
        """By continuation, and by many starts: both must agree."""
        carried, _ = truth.AllSolutions(self.chain, self.seed).real(q)
        result = []
        for one, found in zip(q, carried, strict=True):
            extra = truth.by_many_starts(self.chain, one)
            kept = [*found, *(x for x in extra if not len(found) or self.chain.distance(found, x).min() > FOUND)]
            result.append(np.array(kept).reshape(-1, self.arm.n))
        return result

    def poses(self, q, kind, true=None):
        """The poses of configurations, and these as their true solutions unless there are others."""
        true = [row[None] for row in q] if true is None else true
        return Poses(q, forward_kinematics(self.arm, q), q[:, list(self.case.given)], true, kind)

    def special(self, count=8):
        """Poses of configurations with right and zero angles: many of them singular. Isolated solutions alone count."""
        q = self.configurations(count)
        angles = self.random.choice([0.0, math.pi / 2, -math.pi / 2, math.pi], q.shape)
        offsets = np.where(self.arm.revolute, -self.arm.sign * self.arm.theta, 0.0)
        chosen = self.random.random(q.shape) < self.random.choice([0.3, 0.6, 1.0], (count, 1))
        q = np.where(chosen & self.arm.revolute, angles + offsets * self.random.integers(0, 2, (count, 1)), q)
        return self.poses(q, "singular", [truth.by_many_starts(self.chain, one, starts=150) for one in q])

    def boundary(self, count=4):
        """Poses at which the determinant of J changes its sign: double roots. Only reproduction is asked."""
        chain, found = self.chain, []
        if len(chain.free) not in (len(chain.entries), 6 if self.case.task == "pose" else 3):
            return self.poses(np.empty((0, self.arm.n)), "boundary")
        for _ in range(40 * count):
            ends = self.configurations(2)
            ends[1, list(chain.given)] = ends[0, list(chain.given)]
            low, high = 0.0, 1.0
            values = self._determinant(np.array([ends[0], ends[1]]))
            if values[0] * values[1] >= 0:
                continue
            for _ in range(60):
                middle = 0.5 * (low + high)
                value = self._determinant((ends[0] + middle * (ends[1] - ends[0]))[None])[0]
                low, high = (middle, high) if value * values[0] > 0 else (low, middle)
            found.append(ends[0] + low * (ends[1] - ends[0]))
            if len(found) == count:
                break
        q = np.array(found).reshape(-1, self.arm.n)
        return self.poses(q, "boundary", [np.empty((0, self.arm.n))] * len(q))

    def _determinant(self, q):
        return np.linalg.det(jacobian(self.arm, q)[..., : 3 if self.case.task == "position" else 6, self.chain.free])

    def unreachable(self, count=4):
        """Poses that are far from every configuration's, as many starts tell."""
        q = self.configurations(count)
        poses = forward_kinematics(self.arm, q)
        way = self.random.normal(size=(count, 3))
        poses[:, :3, 3] += 3 * self.chain.unit * way / np.linalg.norm(way, axis=1, keepdims=True)
        turned = forward_kinematics(self.arm, self.configurations(count))[:, :3, :3]
        angle = self.random.uniform(0.3, 1.0, count)
        tilt = np.array([[[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]] for a in angle])
        poses[:, :3, :3] = turned @ tilt
        given = q[:, list(self.case.given)]
        far = np.array([_nearest(self.chain, pose, one) > 1e-3 for pose, one in zip(poses, q, strict=True)], dtype=bool)
        nothing = [np.empty((0, self.arm.n))] * int(far.sum())
        return Poses(np.full_like(q[far], np.nan), poses[far], given[far], nothing, "unreachable")

    def judge(self, poses: Poses, solver: Solver, bar: float = REPRODUCED, count: int = 0) -> Verdict:
        """Compare a solver's branches with the truth; with a count their number, too."""
        if not len(poses.poses):
            return Verdict()
        begin = time.perf_counter()
        with np.errstate(all="ignore"):
            branches, _ = solver(poses.poses, poses.given)
        seconds = time.perf_counter() - begin
        exists = np.isfinite(branches).all(axis=-1)
        number, plain = exists.sum(axis=1), np.nan_to_num(branches)
        error = np.where(exists, self._errors(plain, poses.poses), 0.0)
        owner, wanted = np.repeat(np.arange(len(exists)), list(map(len, poses.true))), np.concatenate(poses.true)
        away = np.where(exists[owner], self.chain.distance(plain[owner], wanted[:, None]), np.inf)
        missing = np.flatnonzero(away.min(axis=1, initial=np.inf) > FOUND)
        if missing.size:
            missing = missing[truth.smallest_singular_value(self.chain, wanted[missing]) > REGULAR]
        lost = np.bincount(owner[missing], minlength=len(exists))
        twice = np.zeros(len(exists), dtype=bool)
        for i, j in combinations(range(branches.shape[1]), 2):
            twice |= exists[:, i] & exists[:, j] & (self.chain.distance(plain[:, i], plain[:, j]) < DUPLICATE)
        reachable = poses.kind != "unreachable"
        faults = {
            "lost": lost,
            "spurious": (error > bar).sum(axis=1),
            "repeated": twice,
            "no branch at all": (number == 0) & reachable,
            "claims an unreachable pose": (number > 0) & (not reachable),
            "wrong count": self._wrong_counts(branches, exists, count) if count else np.zeros_like(twice),
        }
        said = []
        for k in np.flatnonzero(np.any(list(faults.values()), axis=0)):
            own = [what if rows.dtype == bool else f"{rows[k]} {what}" for what, rows in faults.items() if rows[k]]
            q = np.array2string(poses.q[k], precision=17, separator=", ", max_line_width=10000)
            said.append(f"{poses.kind}: {', '.join(own)} at q = {q}")
        some = [int(rows.sum()) for rows in faults.values()]
        complete, found = int((lost == 0).sum()), len(wanted) - some[0]
        worst = float(error.max(initial=0.0))
        return Verdict(len(exists), complete, len(wanted), found, *some[1:], worst, seconds, said)

    def _errors(self, q, poses):
        """(m, b) the largest error of the task's entries, lengths relative to the reach or one metre."""
        rows, columns = self.chain.rows, self.chain.columns
        far = np.abs(poses[:, None, :3, 3]).max(axis=-1, keepdims=True)
        scale = np.where(np.array(columns) == 3, np.maximum(far, max(1.0, self.chain.unit)), 1.0)
        apart = np.abs(forward_kinematics(self.arm, q)[..., rows, columns] - poses[:, None, rows, columns])
        return (apart / scale).max(axis=-1, initial=0.0)

    def _wrong_counts(self, branches, exists, count):
        """Whether there are too many solutions, or an odd number is missing while none is singular."""
        number = exists.sum(axis=1)
        wrong = number > count
        for k in np.flatnonzero((count - number) % 2 == 1):
            own = branches[k, exists[k]]
            wrong[k] |= not len(own) or truth.smallest_singular_value(self.chain, own).min() > 1e-3
        return wrong


def _nearest(chain, pose, q):
    """The smallest error that damped Newton reaches from many starts."""
    random = np.random.default_rng(4)
    target = pose[chain.rows, chain.columns] * chain.weight
    wide = np.where(chain.arm.revolute, math.pi, 4.0) * chain.scale
    at = random.uniform(-wide, wide, (40, chain.arm.n))
    at[:, list(chain.given)] = q[list(chain.given)]
    return truth.descend(chain, at, target, 60)[1].min()
