"""Paths between configurations on which an arm is never singular: looked for by way of random ones, then verified.

Source: Kavraki et al., Probabilistic roadmaps for path planning in high-dimensional configuration spaces, 1996.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import pairwise

import numpy as np

from derive.inverse.numeric.chain import Array, NumericChain

_NEIGHBOURS = 12
_STEPS = 48  # places on a straight piece of a path at which it is tried
_HALVINGS = 14
CLEAR = 1e-7  # of a configuration without a singularity det J is larger than this part of its largest value


@dataclass(frozen=True, eq=False)
class Crossing:
    """A path between two solutions of one pose on which the arm is never singular."""

    path: Array  # corners of the path, (k, n); straight pieces lie between them
    clearance: float  # the smallest amount of det J on the way, as a part of its largest value anywhere


class ScaledDeterminant:
    """det J in numbers, of the rows that decide its rank; in parts of its largest value.

    `basis` has orthonormal rows of what the joints move, None where they are not as many as the joints.
    """

    def __init__(self, chain: NumericChain) -> None:
        self._chain, self._scale = chain, 1.0
        self.basis: Array | None = None
        q = random_configurations(chain, 4000, 5)
        for columns_of in (self._twist, self._linear):
            columns = columns_of(q[:200])
            # Principal directions of all columns of J: the task space, where as many as joints are left.
            rows = columns.transpose(0, 2, 1).reshape(-1, columns.shape[1])
            values, vectors = np.linalg.eigh(rows.T @ rows / len(rows))
            kept = vectors[:, values > 1e-12 * max(values[-1], 1e-300)]
            if kept.shape[1] == chain.n:
                self.basis, self._columns = kept, columns_of
                self._scale = float(np.abs(self(q)).max()) or 1.0
                return

    def __call__(self, q: Array) -> Array:
        """Its value."""
        basis = np.eye(6) if self.basis is None else self.basis
        found: Array = np.linalg.det(basis.T @ self._columns(q)) / self._scale
        return found

    def _linear(self, q: Array) -> Array:
        """Velocities of the end effector's origin by each joint, (..., 3, n)."""
        _, slope = self._chain.pose_and_jacobian(q)
        return np.swapaxes(slope[..., :, 3], -1, -2) / self._chain.reach

    def _twist(self, q: Array) -> Array:
        """Twists about the world's origin by each joint, (..., 6, n)."""
        pose, slope = self._chain.pose_and_jacobian(q)
        # dR/dq R^T = [w]x, and v - w x p is the velocity of the world's origin.
        spin = slope[..., :3] @ np.swapaxes(pose[..., None, :3, :3], -1, -2)
        angular = np.stack([spin[..., 2, 1], spin[..., 0, 2], spin[..., 1, 0]], axis=-1)
        linear = slope[..., 3] - np.cross(angular, pose[..., None, :3, 3])
        return np.swapaxes(np.concatenate([linear / self._chain.reach, angular], axis=-1), -1, -2)


def random_configurations(chain: NumericChain, count: int, seed: int) -> Array:
    """Configurations of an arm without joint limits, (count, n): slides by as much as the arm reaches."""
    most = np.where(chain.revolute, math.pi, chain.reach)
    return np.random.default_rng(seed).uniform(-most, most, (count, chain.n))


class Roadmap:
    """Straight pieces between random configurations with the same signs, (k, n), on which det J is not zero."""

    def __init__(
        self, chain: NumericChain, determinant: ScaledDeterminant, places: Array, active: Sequence[int]
    ) -> None:
        self._chain, self._determinant, self._active = chain, determinant, list(active)
        self._places = places
        pairs = {(min(i, j), max(i, j)) for i, near in enumerate(self._near(places)) for j in near if i != j}
        self._pairs = sorted(pairs)
        self._clear = self._clearances(places[[i for i, _ in self._pairs]], places[[j for _, j in self._pairs]])

    def _way(self, start: Array, end: Array) -> Array:
        """The shortest way, around by the other side where angles are nearer there."""
        way = end - start
        found: Array = np.where(self._chain.revolute, way - 2.0 * math.pi * np.round(way / (2.0 * math.pi)), way)
        return found

    def _near(self, q: Array) -> list[list[int]]:
        found = []
        for own in q:
            way = self._way(own, self._places)[:, self._active]
            found.append(np.argsort(np.sum(way**2, axis=-1), kind="stable")[: _NEIGHBOURS + 1].tolist())
        return found

    def _clearances(self, starts: Array, ends: Array) -> Array:
        """The smallest amount of det J on straight pieces; 0 where it changes its sign."""
        share = np.linspace(0.0, 1.0, _STEPS)[:, None, None]
        values = self._determinant(starts + share * self._way(starts, ends))
        same = (np.sign(values) == np.sign(values[0])).all(axis=0)
        return np.where(same, np.abs(values).min(axis=0, initial=np.inf), 0.0)

    def path(self, start: Array, end: Array) -> Crossing | None:
        """The path that stays clearest of singularities."""
        places = np.concatenate([self._places, start[None], end[None]])
        pairs, clear = list(self._pairs), list(self._clear)
        for own, near in zip((len(places) - 2, len(places) - 1), self._near(places[-2:]), strict=True):
            pairs += [(j, own) for j in near]
            clear += list(self._clearances(places[near], np.broadcast_to(places[own], (len(near), self._chain.n))))
        pairs.append((len(places) - 2, len(places) - 1))
        clear += list(self._clearances(start[None], end[None]))
        way = _widest(len(places) - 2, len(places) - 1, pairs, clear)
        if way is None:
            return None
        # Corners are left out where straight pieces without them are nearly as clear of singularities.
        corners, path, at = places[way], [start], 0
        enough = self._clearances(corners[:-1], corners[1:]).min() / 2.0
        while at < len(corners) - 1:
            ahead = self._clearances(np.broadcast_to(corners[at], corners[at + 1 :].shape), corners[at + 1 :])
            at += 1 + int(np.flatnonzero(ahead >= enough).max(initial=0))
            path.append(path[-1] + self._way(path[-1], corners[at]))
        return self._verified(np.array(path))

    def _verified(self, path: Array) -> Crossing | None:
        """The path, where det J keeps its sign between places so near that it changes by less than half of itself."""
        share = np.linspace(0.0, 1.0, _STEPS)[:, None]
        q = np.concatenate([a + share * (b - a) for a, b in pairwise(path)])
        for _ in range(_HALVINGS):
            values = self._determinant(q)
            if np.abs(values).min() <= CLEAR or np.ptp(np.sign(values)) > 0.0:
                return None
            small = np.minimum(np.abs(values[:-1]), np.abs(values[1:]))
            # Where det J changes by more than half of itself it could be zero in between: such pieces are halved.
            rough = np.flatnonzero(np.abs(np.diff(values)) > small / 2.0)
            if not len(rough):
                return Crossing(path, float(np.abs(values).min()))
            q = np.insert(q, rough + 1, (q[rough] + q[rough + 1]) / 2.0, axis=0)
        return None


def _widest(start: int, end: int, pairs: Sequence[tuple[int, int]], clear: Sequence[float]) -> list[int] | None:
    """The places on the way between two of them, by pairs whose clearances are as large as they can be."""
    roads = dict[int, list[tuple[float, int]]]()
    for (i, j), clearance in zip(pairs, clear, strict=True):
        for one, other in ((i, j), (j, i)) if clearance > CLEAR else ():
            roads.setdefault(one, []).append((-clearance, other))
    # Prim's maximum spanning tree: its path between two places has the widest clearance of all.
    before, front = dict[int, int](), [(0.0, start, start)]
    while front and end not in before:
        _, place, last = heappop(front)
        if place not in before:
            before[place] = last
            for clearance, beside in roads.get(place, ()):
                heappush(front, (clearance, beside, place))
    found = [end]
    while found[-1] != start and end in before:
        found.append(before[found[-1]])
    return found[::-1] if end in before else None
