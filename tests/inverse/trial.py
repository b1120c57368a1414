"""One arm on trial: its poses, all their true solutions, and what a solver makes of them."""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from derive.verification.oracle.frames import forward_kinematics
from tests.inverse import truth
from tests.inverse.arms import ArmCase

ENTRIES = {"pose": truth.POSE, "position": truth.POSITION}

FOUND = 1e-5
"""A true solution is found where a branch is at most this far from it; double roots have their own."""

FOUND_DOUBLE = 2e-3
REGULAR = 1e-4
"""Smallest singular value from which on a solution counts as regular."""

REPRODUCED = 1e-9
"""Error of a branch's pose from which on it is spurious."""

DUPLICATE = 1e-7

Solver = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Poses (m, 4, 4), given joints (m, k) -> branches (m, b, n), NaN where there is none, and their status (m, b)."""


@dataclass(eq=False)
class Poses:
    """Poses of one arm with their true solutions."""

    q: np.ndarray  # (m, n) the configurations that they were made from; NaN for unreachable ones
    poses: np.ndarray  # (m, 4, 4)
    given: np.ndarray  # (m, k) values of the given joints
    true: list[np.ndarray]  # for each pose its regular true solutions (k, n)
    kind: str  # ``regular``, ``singular``, ``boundary`` or ``unreachable``


@dataclass
class Verdict:
    """What was found at the poses of one kind."""

    poses: int = 0  # how many poses
    complete: int = 0  # at how many of them every true solution was found
    true: int = 0
    found: int = 0  # those that were found
    spurious: int = 0  # branches that do not reproduce their pose
    duplicates: int = 0  # branches that repeat another one
    empty: int = 0  # reachable poses without any branch
    claims: int = 0  # unreachable poses with a branch
    residual: float = 0.0  # worst error of a branch's pose, lengths relative to the reach
    missing: list[tuple[int, str]] = field(default_factory=list)  # (pose number, what is missing)
    seconds: float = 0.0  # time of the solver

    def __add__(self, other: Verdict) -> Verdict:
        total = Verdict()
        for name in ("poses", "complete", "true", "found", "spurious", "duplicates", "empty", "claims", "seconds"):
            setattr(total, name, getattr(self, name) + getattr(other, name))
        total.residual = max(self.residual, other.residual)
        total.missing = self.missing + other.missing
        return total

    @property
    def is_clean(self) -> bool:
        """Whether there is nothing to complain about."""
        return self.complete == self.poses and not (self.spurious or self.duplicates or self.empty or self.claims)


@dataclass(eq=False)
class Trial:
    case: ArmCase
    count: int = 20
    seed: int = 0
    cache: Path | None = None

    def __post_init__(self):
        self.arm = self.case.arm
        self.chain = truth.Chain(self.arm, ENTRIES[self.case.task], self.case.given)
        self.random = np.random.default_rng([self.seed, len(self.case.rows)])

    def configurations(self, count):
        """Random ones: angles of 3 rad at most, slides of one reach."""
        wide = np.where(self.arm.revolute, 3.0, self.chain.unit)
        return self.random.uniform(-wide, wide, (count, self.arm.n))

    def regular(self):
        """Random reachable poses with all their solutions."""
        q = self.configurations(self.count)
        key = hashlib.sha256(f"3 {self.case.text} {self.case.values} {self.seed} {self.count}".encode()).hexdigest()
        kept = self.cache / f"{key[:20]}.npz" if self.cache else None
        if kept and kept.exists():
            data = np.load(kept)
            solutions = np.split(data["solutions"], data["ends"][:-1])
        else:
            solutions = self._all(q)
            if kept:
                kept.parent.mkdir(parents=True, exist_ok=True)
                np.savez(kept, solutions=np.concatenate(solutions), ends=np.cumsum([len(s) for s in solutions]))
        return self._poses(q, [self._regular_ones(s) for s in solutions], "regular")

    def _all(self, q):
        """By continuation, and by many starts: both must agree."""
        carried, _ = truth.AllSolutions(self.chain, self.seed).real(q)
        result = []
        for one, found in zip(q, carried, strict=True):
            extra = truth.by_many_starts(self.chain, one)
            kept = [*found, *(x for x in extra if not len(found) or self.chain.distance(found, x).min() > FOUND)]
            result.append(np.array(kept).reshape(-1, self.arm.n))
        return result

    def _regular_ones(self, solutions):
        if not len(solutions):
            return solutions
        return solutions[truth.smallest_singular_value(self.chain, solutions) > REGULAR]

    def _poses(self, q, true, kind):
        poses = forward_kinematics(self.arm, q)
        return Poses(q, poses, q[:, list(self.case.given)], true, kind)

    def special(self, count=8):
        """Poses of configurations with right and zero angles: many of them singular. Isolated solutions alone count."""
        q = self.configurations(count)
        angles = self.random.choice([0.0, math.pi / 2, -math.pi / 2, math.pi], q.shape)
        offsets = np.where(self.arm.revolute, -self.arm.sign * self.arm.theta, 0.0)
        chosen = self.random.random(q.shape) < self.random.choice([0.3, 0.6, 1.0], (count, 1))
        q = np.where(chosen & self.arm.revolute, angles + offsets * self.random.integers(0, 2, (count, 1)), q)
        true = [self._regular_ones(truth.by_many_starts(self.chain, one, starts=150)) for one in q]
        return self._poses(q, true, "singular")

    def boundary(self, count=4, beyond=0.0):
        """Poses at which the determinant of J changes its sign: double roots. Only reproduction is asked."""
        chain, found = self.chain, []
        if len(chain.free) not in (len(chain.entries), 6 if self.case.task == "pose" else 3):
            return self._poses(np.empty((0, self.arm.n)), [], "boundary")
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
        result = self._poses(q, [np.empty((0, self.arm.n))] * len(q), "boundary")
        if beyond:
            result.poses[:, :3, 3] += beyond * self.chain.unit * self.random.choice([-1, 1], (len(q), 3))
        return result

    def _determinant(self, q):
        pose, axes, points = self.chain.pose(q)
        linear = np.where(self.arm.revolute[:, None], np.cross(axes, pose[..., None, :3, 3] - points), axes)
        turning = np.where(self.arm.revolute[:, None], axes, 0.0)
        rows = linear if self.case.task == "position" else np.concatenate([linear, turning], axis=-1)
        return np.linalg.det(rows[..., list(self.chain.free), :])

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

    # -- what a solver makes of them

    def judge(self, poses: Poses, solver: Solver) -> Verdict:
        """Compare a solver's branches with the truth."""
        verdict = Verdict(poses=len(poses.poses))
        if not len(poses.poses):
            return verdict
        begin = time.perf_counter()
        branches, _ = solver(poses.poses, poses.given)
        verdict.seconds = time.perf_counter() - begin
        for k, (own, true) in enumerate(zip(branches, poses.true, strict=True)):
            own = own[np.isfinite(own).all(axis=-1)]
            bad = self._errors(own, poses.poses[k])
            verdict.residual = max(verdict.residual, bad.max(initial=0.0))
            spurious = int((bad > REPRODUCED).sum())
            verdict.spurious += spurious
            repeated = self._repeated(own)
            verdict.duplicates += repeated
            verdict.true += len(true)
            lost = [one for one in true if not len(own) or self.chain.distance(own, one).min() > FOUND]
            verdict.found += len(true) - len(lost)
            reachable = poses.kind != "unreachable"
            verdict.empty += reachable and not len(own)
            verdict.claims += not reachable and bool(len(own))
            verdict.complete += not lost
            said = [f"{len(lost)} of {len(true)} lost"] if lost else []
            said += [f"{spurious} spurious ({bad.max():.1e})"] if spurious else []
            said += [f"{repeated} repeated"] if repeated else []
            said += ["no branch at all"] if reachable and not len(own) else []
            said += ["claims an unreachable pose"] if not reachable and len(own) else []
            if said:
                verdict.missing.append((k, f"{poses.kind}: {', '.join(said)}"))
        return verdict

    def _errors(self, q, pose):
        reached = forward_kinematics(self.arm, q)[..., self.chain.rows, self.chain.columns]
        wanted = pose[self.chain.rows, self.chain.columns]
        far = np.abs(pose[:3, 3]).max()
        scale = np.where(np.array(self.chain.columns) == 3, max(1.0, self.chain.unit, far), 1.0)
        return (np.abs(reached - wanted) / scale).max(axis=-1, initial=0.0)

    def _repeated(self, q):
        return sum(self.chain.distance(q[:i], q[i]).min() < DUPLICATE for i in range(1, len(q)))


def _nearest(chain, pose, q):
    """The smallest error that damped Newton reaches from many starts."""
    random = np.random.default_rng(4)
    target = pose[chain.rows, chain.columns] * chain.weight
    wide = np.where(chain.arm.revolute, math.pi, 4.0) * chain.scale
    at = random.uniform(-wide, wide, (40, chain.arm.n))
    at[:, list(chain.given)] = q[list(chain.given)]
    return truth.descend(chain, at, target, 60)[1].min()
