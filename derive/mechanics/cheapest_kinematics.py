"""Pose and Jacobian of the end effector from the cheapest combination of ways to their vectors.

Every column has options: turned inward from where it is known, built from the base outwards, a cross product of two
others, a sum of vectors that other columns need. `derive.algebra.tape_choice` takes the combination that shares most.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from typing import NamedTuple

from derive.algebra.tape_choice import choose
from derive.algebra.tape_value import Value
from derive.mechanics.stations import Stations
from derive.mechanics.vectors import Frame, Vector, add, column, cross, multiply, scale, transpose

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
    """J, 6xn, rows first: as `derive.mechanics.jacobian.jacobian`."""
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
