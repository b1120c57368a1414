"""Poses of all links in the world from sums of angles, every origin in the cheapest way beside those before it."""

from __future__ import annotations

from collections.abc import Iterator

from derive.algebra.tape_choice import choose
from derive.algebra.tape_value import Value
from derive.mechanics.parallel_axes import Placement
from derive.mechanics.stations import Stations
from derive.mechanics.vectors import Frame, Matrix, Vector, add, column, matmul, multiply, scale, subtract

_MOST_STATIONS = 7
"""Longer arms are summed link after link."""


def cheapest_links(stations: Stations) -> list[Frame[Value]]:
    """DH frames 1..n in the world frame, without the tool: as `derive.mechanics.forward_kinematics.link_transforms`."""
    return _Links(stations).frames()


class _Links:
    def __init__(self, stations: Stations) -> None:
        self.stations = stations
        self.chain = stations.chain
        self.places = [(r, place) for r, run in enumerate(stations.runs) for place in run.placements]
        self.joints = [self._joint(r, place) for r, place in self.places]
        self.origins: list[Vector[Value]] = []
        self.starts: list[Vector[Value]] = []

    def frames(self) -> list[Frame[Value]]:
        rotations = [matmul(joint, end.rotation) for joint, end in zip(self.joints, self.chain.ends, strict=True)]
        needed = [v.ref for rotation in rotations for row in rotation for v in row]
        for i, (r, _) in enumerate(self.places):
            if r == len(self.starts):
                self.starts.append(add(self._before(i), self._gap(i)))
            ways = list(self._ways(i))
            groups = [[needed], [[v.ref for v in way] for way in ways]]
            self.origins.append(ways[choose(self.stations.chain.zero.graph, groups)[1]])
            needed += [v.ref for v in self.origins[-1]]
        return [Frame(rotation, origin) for rotation, origin in zip(rotations, self.origins, strict=True)]

    def _joint(self, r: int, place: Placement) -> Matrix[Value]:
        """The axes of a joint frame in the world."""
        c, s = place.cosine, place.sine
        x, y, z = ((c * x + s * y, c * y - s * x, z) for x, y, z in self.stations.rotations[r])
        return matmul((x, y, z), place.constant)

    def _before(self, i: int) -> Vector[Value]:
        return self.origins[i - 1] if i else self.chain.base.position

    def _gap(self, i: int) -> Vector[Value]:
        """From the origin of DH frame i-1 to the axis of joint i, in the world; nothing in the standard convention."""
        fixed = self.chain.joints[i].fixed.position
        if i == 0:
            return multiply(self.chain.base.rotation, fixed)
        return multiply(self.joints[i - 1], subtract(fixed, self.chain.ends[i - 1].position))

    def _ways(self, i: int) -> Iterator[Vector[Value]]:
        """The origin of DH frame i: a step from the one before, or a vector from a station."""
        (r, place), end, joint = self.places[i], self.chain.ends[i].position, self.chain.joints[i]
        slide = add(scale(joint.offset, column(self.joints[i], 2)), multiply(self.joints[i], end))
        yield add(add(self._before(i), self._gap(i)), slide)
        v = add(place.origin, place.turned(end))
        for k in range(r, -1, -1) if self.stations.last <= _MOST_STATIONS else ():
            yield add(self.starts[k], self.stations.world(k, v, k))
            if k:
                v = self.stations.inward(k, add(self.stations.entries[k], v))
                v = add(self.stations.runs[k - 1].last.origin, v)
