"""Poses of all links in the world from sums of angles, every frame in the cheapest way beside those before it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.algebra.tape_choice import choose
from derive.algebra.tape_graph import Ref
from derive.algebra.tape_value import Value
from derive.mechanics.parallel_axes import Placement
from derive.mechanics.stations import Stations
from derive.mechanics.vectors import Frame, Matrix, Vector, add, column, matmul, multiply, scale, subtract


def cheapest_links(stations: Stations) -> list[Frame[Value]]:
    """DH frames 1..n in the world frame, without the tool: as `derive.mechanics.forward_kinematics.link_transforms`."""
    links = _Links(stations)
    rotations = links.rotations()
    return [Frame(rotation, origin) for rotation, origin in zip(rotations, links.origins(), strict=True)]


class _Links:
    """Grows as its frames are chosen, first all rotations, then all origins.

    Attributes:
        needed: The entries chosen so far.
        joints: Rotations of joint frames in the world.
        ends: Origins of DH frames in the world.
        starts: Stations in the world.
    """

    def __init__(self, stations: Stations) -> None:
        self.stations = stations
        self.chain = stations.chain
        self.places = [(r, place) for r, run in enumerate(stations.runs) for place in run.placements]
        self.needed: list[Ref] = []
        self.joints: list[Matrix[Value]] = []
        self.ends: list[Vector[Value]] = []
        self.starts: list[Vector[Value]] = []

    def rotations(self) -> list[Matrix[Value]]:
        """Of DH frames."""
        found: list[Matrix[Value]] = []
        for i, (r, place) in enumerate(self.places):
            joints = [self._onward(i, found), matmul(self.stations.turned(r, place), place.constant)]
            rotations = [matmul(joint, self.chain.ends[i].rotation) for joint in joints]
            taken = self._taken([[v for row in rotation for v in row] for rotation in rotations])
            self.joints.append(joints[taken])
            found.append(rotations[taken])
        return found

    def origins(self) -> list[Vector[Value]]:
        """Of DH frames."""
        for i, (r, place) in enumerate(self.places):
            if r == len(self.starts):
                self.starts.append(add(self._before(i), self._gap(i)))
            ways = list(self._ways(i, r, place))
            self.ends.append(ways[self._taken(ways)])
        return self.ends

    def _taken(self, options: Sequence[Sequence[Value]]) -> int:
        """The option that adds least to what is needed."""
        outputs = [[v.ref for v in option] for option in options]
        taken = choose(self.chain.zero.graph, [[self.needed], outputs])[1]
        self.needed += outputs[taken]
        return taken

    def _onward(self, i: int, rotations: Sequence[Matrix[Value]]) -> Matrix[Value]:
        """The axes of joint frame i from those of DH frame i-1, which has the twist in it or before it."""
        joint = self.chain.joints[i]
        before = rotations[i - 1] if i else self.chain.base.rotation
        if i == 0 or joint.fixed is not self.chain.ends[i - 1]:
            before = matmul(before, joint.fixed.rotation)
        return matmul(before, joint.motion(self.chain.zero, self.chain.one).rotation)

    def _before(self, i: int) -> Vector[Value]:
        return self.ends[i - 1] if i else self.chain.base.position

    def _gap(self, i: int) -> Vector[Value]:
        """From the origin of DH frame i-1 to the axis of joint i, in the world; nothing in the standard convention."""
        fixed = self.chain.joints[i].fixed.position
        if i == 0:
            return multiply(self.chain.base.rotation, fixed)
        return multiply(self.joints[i - 1], subtract(fixed, self.chain.ends[i - 1].position))

    def _ways(self, i: int, r: int, place: Placement) -> Iterator[Vector[Value]]:
        """The origin of DH frame i: a step from the one before, or a vector from a station."""
        end, joint = self.chain.ends[i].position, self.chain.joints[i]
        slide = add(scale(joint.offset, column(self.joints[i], 2)), multiply(self.joints[i], end))
        yield add(add(self._before(i), self._gap(i)), slide)
        v = add(place.origin, place.turned(end))
        for k in range(r, -1, -1) if self.stations.few else ():
            yield add(self.starts[k], self.stations.world(k, v, k))
            if k:
                v = self.stations.inward(k, add(self.stations.entries[k], v))
                v = add(self.stations.runs[k - 1].last.origin, v)
