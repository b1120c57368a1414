"""How far an arm reaches: a box and a ball that hold every position of its end effector."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from derive.arrays import Array
from derive.inverse.numeric.chain import NumericChain
from derive.workspace.point import TURN, Range

_STARTS = 64  # random configurations from which the farthest ones are looked for
_SWEEPS = 200  # most times that every joint is moved to its best place
_SETTLED = 1e-12  # a sweep that gains less than this part of the arm's size, or its square, is the last one
_BEYOND = 1e-9  # by which box and ball are larger than what was found, in parts of the ball
_THIRDS = TURN / 3.0 * np.arange(3.0)


@dataclass(frozen=True, slots=True)
class Extent:
    """A box and a ball around all positions [m]."""

    low: tuple[float, ...]  # a corner of the box
    high: tuple[float, ...]  # the opposite one
    radius: float  # of the ball about the box's middle

    @classmethod
    def of(cls, chain: NumericChain, ranges: Sequence[Range], axes: Sequence[int]) -> Extent:
        """The extent along some axes of the world, counted from 0; a ball of two axes is a circle."""
        sides = np.concatenate([np.eye(3)[axes], -np.eye(3)[axes]])
        most = _most(chain, ranges, lambda p: np.einsum("gkx,gx->gk", p, sides), len(sides))
        high, low = most[: len(axes)], -most[len(axes) :]
        middle = (low + high) / 2.0
        (square,) = _most(chain, ranges, lambda p: np.sum((p[..., axes] - middle) ** 2, axis=-1), 1)
        radius = float(square**0.5)
        room = _BEYOND * (radius or 1.0)
        return cls(tuple((low - room).tolist()), tuple((high + room).tolist()), radius + room)

    @property
    def middle(self) -> Array:
        """The middle of box and ball [m]."""
        return (np.array(self.low) + self.high) / 2.0


def _most(chain: NumericChain, ranges: Sequence[Range], value: Callable[[Array], Array], groups: int) -> Array:
    """The largest values (groups,) that functions of positions (groups, k, 3) -> (groups, k) take within the ranges.

    One joint after the other goes to its best place: coordinates and squared distances are a + b cos(q) + c sin(q) of
    a joint that turns, and largest at an end of one that slides.
    """
    lower, upper = np.array([[way.lower, way.upper] for way in ranges]).T

    def _values(q: Array) -> Array:  # of configurations (groups, starts, places, n)
        return value(_positions(chain, q).reshape(groups, -1, 3)).reshape(q.shape[:-1])

    def _tried(q: Array, joint: int, places: Array) -> Array:
        tried = np.repeat(q[..., None, :], places.shape[-1], axis=-2)
        tried[..., joint] = places
        return tried

    q = np.random.default_rng(0).uniform(lower, upper, (groups, _STARTS, len(ranges)))
    found = _values(q[..., None, :])[..., 0]
    for _ in range(_SWEEPS):
        before = found.max(axis=-1)
        for joint, way in enumerate(ranges):
            places = np.stack(np.broadcast_arrays(q[..., joint], way.lower, way.upper), axis=-1)
            if way.revolute:
                samples = _values(_tried(q, joint, np.broadcast_to(_THIRDS, (*q.shape[:-1], 3))))
                top = np.arctan2(samples @ np.sin(_THIRDS), samples @ np.cos(_THIRDS))
                top = way.lower + (top - way.lower) % TURN
                places = np.concatenate([places, np.where(top > way.upper, way.lower, top)[..., None]], axis=-1)
            tried = _tried(q, joint, places)
            values = _values(tried)
            best = values.argmax(axis=-1)[..., None]
            found = np.take_along_axis(values, best, axis=-1)[..., 0]
            q = np.take_along_axis(tried, best[..., None], axis=-2)[..., 0, :]
        if np.all(found.max(axis=-1) - before <= _SETTLED * max(chain.reach, 1.0) ** 2):
            break
    return np.asarray(found.max(axis=-1))


def _positions(chain: NumericChain, q: Array) -> Array:
    """Of the end effector (..., 3) [m] at configurations (..., n): from the tip to the base, without orientations."""
    x, y, z = (np.broadcast_to(value, q.shape[:-1]) for value in chain.tool[:3, 3])
    for i in reversed(range(chain.n)):
        moved = chain.sign[i] * q[..., i]
        if chain.revolute[i]:
            cosine, sine = np.cos(moved), np.sin(moved)
            x, y = cosine * x - sine * y, sine * x + cosine * y
        else:
            z = z + moved
        x, y, z = (row[0] * x + row[1] * y + row[2] * z + row[3] for row in chain.fixed[i, :3])
    return np.stack([x, y, z], axis=-1)
