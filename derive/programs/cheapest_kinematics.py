"""Pose and Jacobian of the end effector from the cheapest combination of ways to their vectors.

Every column has options: turned inward from where it is known, built from the base outwards, a cross product of two
others, a sum of vectors that other columns need. `derive.programs.optimise.choice` takes the combination that shares
most.

The ways in which vectors of an arm come to the world frame.

*Station* r is where run r of parallel axes begins: its frame has the run's z axis and turns with the run before; the
first one stands still, and the last one is the end effector. A vector known at station r comes to the world by turning
it about one z axis after another (four multiplications and two additions each, half of that for a vector in a
coordinate plane), or at once by the rotation of a station on the way, built from the base outwards. Which costs less
depends on what else is needed, so all ways are offered.

Poses of all links in the world from sums of angles, every frame in the cheapest way beside those before it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import product
from typing import NamedTuple

from derive.mechanics.chain import Chain
from derive.mechanics.vectors import (
    Frame,
    Matrix,
    Vector,
    add,
    column,
    cross,
    matmul,
    multiply,
    scale,
    subtract,
    transpose,
)
from derive.programs.optimise.choice import choose
from derive.programs.parallel_axes import Placement, Run, about_z
from derive.programs.tape.graph import Ref
from derive.programs.tape.value import Value

_MOST_STATIONS, _MOST_JOINTS = 7, 12
"""Of longer arms only the ways over near stations are tried; the number of all grows with the cube."""


class Stations:
    """Stations 0 to ``last`` of one arm whose base and tool are exact rotations.

    Args:
        chain: The arm, one joint at least.
        runs: Its runs of parallel axes.

    Attributes:
        few: Whether all ways over them can be tried.
    """

    def __init__(self, chain: Chain[Value], runs: tuple[Run, ...]) -> None:
        self.chain = chain
        self.runs = runs
        self.last = len(runs)
        self.few = self.last <= _MOST_STATIONS and chain.n <= _MOST_JOINTS
        self._fixed = [*(run.fixed for run in runs), chain.tool]

    @cached_property
    def rotations(self) -> list[Matrix[Value]]:
        """The axes of each station in the world, built outwards."""
        found = [matmul(self.chain.base.rotation, self._fixed[0].rotation)]
        for r, run in enumerate(self.runs):
            found.append(matmul(_about_z(found[r], run.last), self._constants[r + 1]))
        return found

    def turned(self, r: int, place: Placement) -> Matrix[Value]:
        """The axes of station r in the world, turned about z as far as a joint of run r is."""
        return _about_z(self.rotations[r], place)

    @cached_property
    def _constants(self) -> list[Matrix[Value]]:
        """Between what the run before turns and the axes of each station; constant."""
        befores = [run.last.constant for run in self.runs]
        later = (matmul(constant, fixed.rotation) for constant, fixed in zip(befores, self._fixed[1:], strict=True))
        return [self._fixed[0].rotation, *later]

    @cached_property
    def entries(self) -> list[Vector[Value]]:
        """From the last joint of the run before (or frame 0) to each station, in the station's axes; constant."""
        return [multiply(transpose(fixed.rotation), fixed.position) for fixed in self._fixed]

    def world(self, r: int, v: Vector[Value], meeting: int) -> Vector[Value]:
        """A vector of station r in the world, turned inward as far as station ``meeting``, at most to r."""
        while r > meeting:
            v, r = self.inward(r, v), r - 1
        return multiply(self.rotations[r], v)

    def inward(self, r: int, v: Vector[Value]) -> Vector[Value]:
        """A vector of station r in the axes of station r-1."""
        last = self.runs[r - 1].last
        return about_z(last.cosine, last.sine, multiply(self._constants[r], v))

    def axis_beyond(self, r: int) -> Vector[Value]:
        """The axis of run r in the axes of station r+1; constant."""
        return self._constants[r + 1][2]

    def part(self, r: int, joint: int = -1) -> Vector[Value]:
        """From a joint of run r (counted in the run; -1: from its station) to the run's last joint, in station axes."""
        return self._with_steps(r, joint, (self.chain.zero,) * 3)

    def whole(self, r: int, joint: int = -1) -> Vector[Value]:
        """The same, to the end effector, summed from there inwards."""
        return self._with_steps(r, joint, self._beyond[r])

    def _with_steps(self, r: int, joint: int, total: Vector[Value]) -> Vector[Value]:
        for place in reversed(self.runs[r].placements[joint + 1 :] if r < self.last else ()):
            total = add(place.step, total)
        return total

    @cached_property
    def _beyond(self) -> list[Vector[Value]]:
        """From the last joint of each run to the end effector, in station axes."""
        found: list[Vector[Value]] = [(self.chain.zero,) * 3]
        for r in range(self.last, 0, -1):
            there = self._with_steps(r, -1, found[-1])
            found.append(self.inward(r, add(self.entries[r], there)))
        return found[::-1]


def _about_z(rotation: Matrix[Value], place: Placement) -> Matrix[Value]:
    c, s = place.cosine, place.sine
    x, y, z = ((c * x + s * y, c * y - s * x, z) for x, y, z in rotation)
    return (x, y, z)


_NEAR = 3
"""How many stations away the ways of an arm with many lead."""

Ways = list[Vector[Value]]


def cheapest_pose(stations: Stations) -> Frame[Value]:
    """T: the end effector in the world frame, tool included."""
    axes = [_axis_ways(stations, k) for k in range(3)]
    crossed = [[cross(a, b) for a, b in product(axes[(k + 1) % 3], axes[(k + 2) % 3])] for k in range(3)]
    base = stations.chain.base.position
    position = [add(base, _reach(stations, 0, -1, route)) for route in _routes(stations, 0)]
    x, y, z, origin = _chosen([*(axes[k] + crossed[k] for k in range(3)), position])
    return Frame(transpose((x, y, z)), origin)


def cheapest_jacobian(stations: Stations) -> list[list[Value]]:
    """J, 6xn, rows first: as `derive.mechanics.forward_kinematics.jacobian`."""
    chain = stations.chain
    groups: list[Ways] = []
    for r, run in enumerate(stations.runs):
        groups.append([stations.world(r, _unit(stations, 2), meeting) for meeting in _meetings(stations, r)])
        for k in range(len(run.placements)):
            groups.append(_linear_ways(stations, r, k))
    chosen = iter(_chosen(groups))
    columns: list[list[Value]] = []
    for run in stations.runs:
        z = next(chosen)
        for place, joint in zip(run.placements, chain.joints[run.first :], strict=False):
            linear = next(chosen)
            direction = joint.sign * place.direction if joint.revolute else joint.sign
            spin = scale(direction, z) if joint.revolute else (chain.zero,) * 3
            columns.append([*scale(direction, linear), *spin])
    return [[column[row] for column in columns] for row in range(6)]


def _chosen(groups: Sequence[Ways]) -> list[Vector[Value]]:
    graph = groups[0][0][0].graph
    distinct = [_distinct(ways) for ways in groups]
    places = choose(graph, [[[v.ref for v in way] for way in ways] for ways in distinct])
    return [ways[place] for ways, place in zip(distinct, places, strict=True)]


def _distinct(ways: Iterable[Vector[Value]]) -> Ways:
    return list({tuple(v.ref for v in way): way for way in ways}.values())


def _meetings(stations: Stations, r: int) -> Sequence[int]:
    """Stations at which a vector of station r may meet a rotation from the base."""
    return range(r, -1 if stations.few else max(r - _NEAR, -1), -1)


def _unit(stations: Stations, k: int) -> Vector[Value]:
    zero, one = stations.chain.zero, stations.chain.one
    return (one if k == 0 else zero, one if k == 1 else zero, one if k == 2 else zero)


def _axis_ways(stations: Stations, k: int) -> Ways:
    """Axis k of the end effector in the world."""
    end = stations.last
    return [stations.world(end, _unit(stations, k), meeting) for meeting in _meetings(stations, end)]


def _linear_ways(stations: Stations, r: int, k: int) -> Ways:
    """Velocity of the end effector per unit rate of a joint about the run's axis, or along its own slide."""
    place = stations.runs[r].placements[k]
    joint = stations.chain.joints[stations.runs[r].first + k]
    meetings = _meetings(stations, r)
    if not joint.revolute:
        outward = multiply(stations.turned(r, place), column(place.constant, 2))
        return [outward, *(stations.world(r, place.axis(), meeting) for meeting in meetings)]
    x, y, _ = stations.whole(r, k)
    turned = [stations.world(r, (-y, x, stations.chain.zero), meeting) for meeting in meetings]
    if place is stations.runs[r].last:
        turned += _linear_ways_beyond(stations, r)
    return turned + list(_crossed(stations, r, k))


def _crossed(stations: Stations, r: int, k: int) -> Iterator[Vector[Value]]:
    """Products of the axis and vectors to the end effector, in the world."""
    axes = [stations.world(r, _unit(stations, 2), meeting) for meeting in _meetings(stations, r)]
    reaches = _distinct(_reach(stations, r, k, route) for route in _routes(stations, r))
    yield from (cross(z, reach) for z, reach in product(axes, reaches))


def _linear_ways_beyond(stations: Stations, r: int) -> Ways:
    """The same for the last joint of a run, in the axes of the next station, where the arm may lie in a plane."""
    velocity = cross(stations.axis_beyond(r), add(stations.entries[r + 1], stations.whole(r + 1)))
    return [stations.world(r + 1, velocity, meeting) for meeting in _meetings(stations, r + 1)]


class _Route(NamedTuple):
    """A way from a joint to the end effector, in the world.

    Attributes:
        end: From this station on it is one vector; before, there is one for each run.
        meeting: Where these meet the rotation from the base, at the latest.
        scaled: Whether a vector along an axis of its station is a multiple of the axis, which other columns may need.
    """

    end: int
    meeting: int
    scaled: bool


def _routes(stations: Stations, r: int) -> Iterator[_Route]:
    last = stations.last
    yield _Route(last, last, True)
    for meeting in range(last if stations.few else r, -1 if stations.few else max(r - _NEAR, -1), -1):
        for end in range(r, last + 1 if stations.few else min(r + _NEAR, last + 1)):
            yield _Route(end, meeting, False)
            yield _Route(end, meeting, True)


def _reach(stations: Stations, r: int, joint: int, route: _Route) -> Vector[Value]:
    """From a joint to the end effector in the world.

    Args:
        stations: Of the arm.
        r: The joint's run.
        joint: Its place there; what is parallel to its axis in the run is left out. -1 means that the vector starts
            where the run before ends.
        route: The way.
    """
    total: Vector[Value] | None = None
    for k in range(route.end, r - 1, -1):
        start = joint if k == r else -1
        x, y, z = stations.whole(k, start) if k == route.end else stations.part(k, start)
        v = (x, y, stations.chain.zero) if start >= 0 else add(stations.entries[k], (x, y, z))
        way = _carried(stations, k, v, route)
        total = way if total is None else add(way, total)
    assert total is not None
    return total


def _carried(stations: Stations, r: int, v: Vector[Value], route: _Route) -> Vector[Value]:
    meeting = min(r, route.meeting)
    along = [k for k in range(3) if v[k].ref != stations.chain.zero.ref]
    if not route.scaled or len(along) != 1:
        return stations.world(r, v, meeting)
    return scale(v[along[0]], stations.world(r, _unit(stations, along[0]), meeting))


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
