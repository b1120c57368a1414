"""A motion of all joints: from a plan to position, velocity and acceleration at any time."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from sympy import Expr, Integer

from derive.arrays import Array, Indices
from derive.plans.hermite import Piece, power_coefficients, sampled
from derive.plans.profile import AnyPiece, Cosine, Curve
from derive.plans.segments import Joints, Segment

Corner = tuple[Expr, ...]  # joint variables at a point
ONE = Integer(1)

JUMP = 1e-6  # of the largest acceleration of a joint: what is a jump, and no rounding


@dataclass(frozen=True)
class Trajectory:
    """Joint variables as functions of time."""

    segments: tuple[Segment, ...]  # one after the other

    @classmethod
    def of(cls, joints: Joints, duration: Expr = ONE) -> Trajectory:
        """One segment from time 0 on [s]."""
        return cls((Segment("", Integer(0), duration, joints),))

    @property
    def duration(self) -> Expr:
        """How long it lasts [s]."""
        return self.segments[-1].start + self.segments[-1].duration

    def segment_at(self, times: Array) -> Indices:
        """Which segment the arm is in."""
        starts = [float(segment.start) for segment in self.segments]
        return np.asarray(np.clip(np.searchsorted(starts, times, side="right") - 1, 0, len(self.segments) - 1))

    def __call__(self, t: float | Array) -> tuple[Array, Array, Array]:
        """q, qd, qdd, (..., n) each, at times t [s], (...); before the start and after the end the arm stands."""
        times = np.asarray(t, dtype=float)
        if times.ndim == 0:
            q, qd, qdd = np.array([track.at(float(times)) for track in self._tracks]).T
            return q, qd, qdd
        found = np.stack([track(times.reshape(-1)) for track in self._tracks], axis=-1)
        q, qd, qdd = found.reshape(3, *times.shape, len(self._tracks))
        return q, qd, qdd

    @cached_property
    def jumps(self) -> tuple[float, ...]:
        """Times between start and end at which an acceleration jumps [s], by more than `JUMP` of the largest."""
        starts = np.unique(np.concatenate([track.starts for track in self._tracks]))
        inner = starts[(starts > starts[0]) & (starts < float(self.duration))]
        after = self(inner)[2]
        gaps = np.abs(after - self(np.nextafter(inner, -np.inf))[2])
        largest = np.abs(after).max(axis=0, initial=0) + gaps.max(axis=0, initial=0)
        return tuple(inner[(gaps > JUMP * largest).any(axis=1)].tolist())

    @cached_property
    def _tracks(self) -> tuple[_Track, ...]:
        joints = len(self.segments[0].joints)
        return tuple(_Track([piece for s in self.segments for piece in s.joints[j]]) for j in range(joints))


_COSINE, _CURVE = 0, -1


class _Track:
    def __init__(self, pieces: Sequence[AnyPiece]) -> None:
        self.starts = np.array([float(piece.start) for piece in pieces])
        self._start_list = [float(start) for start in self.starts]
        self.end = float(pieces[-1].end)
        self.durations = np.array([float(piece.duration) for piece in pieces])
        self.pieces = pieces
        # How a piece is computed: a polynomial by its number of values at each end; a formula is alone in its motion.
        kinds = {Cosine: _COSINE, Curve: _CURVE}
        self.kinds = np.array([piece.k if isinstance(piece, Piece) else kinds[type(piece)] for piece in pieces])
        values = [getattr(piece, "values", ()) for piece in pieces]  # none of a formula
        self.numbers = [np.array([float(value) for end in ends for value in end]) for ends in values]
        self.rows: dict[int, Array] = {}  # the numbers of all pieces of each kind, and zeros of others
        for kind in set(self.kinds.tolist()):
            places = np.flatnonzero(self.kinds == kind)
            self.rows[kind] = np.zeros((len(pieces), max(self.numbers[i].size for i in places)))
            for i in places:
                self.rows[kind][i] = self.numbers[i]

    @cached_property
    def _powers(self) -> list[list[float]]:
        """Coefficients of each polynomial by powers of unit time, the highest first."""
        return [
            list(power_coefficients(numbers, int(kind), length)) if kind > 0 else []
            for numbers, kind, length in zip(self.numbers, self.kinds, self.durations, strict=True)
        ]

    def at(self, t: float) -> tuple[float, float, float]:
        """Position, velocity, acceleration at one time, without the cost of arrays."""
        index = max(bisect_right(self._start_list, t) - 1, 0)
        if self.kinds[index] <= 0 or not self._start_list[0] <= t <= self.end:
            q, qd, qdd = self(np.array([t]))[:, 0]
            return float(q), float(qd), float(qdd)
        length = float(self.durations[index])
        u = (t - self._start_list[index]) / length
        q = qd = qdd = 0.0
        # Horner's rule with both derivatives: q'' = q'' u + 2 q', q' = q' u + q, q = q u + c.
        for coefficient in self._powers[index]:
            qdd = qdd * u + 2 * qd
            qd = qd * u + q
            q = q * u + coefficient
        return q, qd / length, qdd / length**2

    def __call__(self, t: Array) -> Array:
        """Position, velocity, acceleration, (3, points)."""
        inside = np.clip(t, self.starts[0], self.end)
        index = np.clip(np.searchsorted(self.starts, inside, side="right") - 1, 0, len(self.starts) - 1)
        following = np.append(self.starts[1:], self.end)
        length = self.durations[index]
        u = np.where(inside >= following[index], 1.0, (inside - self.starts[index]) / length)
        found = np.zeros((3, t.size))
        for kind in sorted(set(self.kinds[index].tolist())):  # np.unique would import numpy.ma
            here = self.kinds[index] == kind
            numbers = self.rows[kind][index[here]]
            for order in range(3):
                if kind > 0:
                    found[order, here] = sampled(numbers, kind, u[here], length[here], order)
                elif kind == _COSINE:
                    found[order, here] = _cosine(numbers, u[here], length[here], order)
                else:
                    found[order, here] = self.pieces[index[here][0]].sampled(inside[here], order)
        found[1:, (t < self.starts[0]) | (t > self.end)] = 0
        return found


def _cosine(numbers: Array, u: Array, length: Array, order: int) -> Array:
    """A harmonic piece; symmetric about its middle, so that nothing is rounded at its ends."""
    q0, way, near = numbers[:, 0], numbers[:, 1] - numbers[:, 0], np.minimum(u, 1 - u)
    if order == 1:
        return np.asarray(way / 2 * np.pi / length * np.sin(np.pi * near))
    wave = np.where(u <= 0.5, np.cos(np.pi * near), -np.cos(np.pi * near))
    if order == 2:
        return np.asarray(way / 2 * (np.pi / length) ** 2 * wave)
    return np.asarray(np.where(u <= 0.5, q0 + way * (1 - wave) / 2, numbers[:, 1] - way * (1 + wave) / 2))
