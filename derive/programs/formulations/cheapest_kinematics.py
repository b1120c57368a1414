"""Poses and Jacobian of an arm from the cheapest combination of ways in which its vectors come to the world frame.

*Station* r is where run r of parallel axes begins: its frame has the run's z axis and turns with the run before; the
first one stands still, and the last one is the end effector. A vector known at station r comes to the world by turning
it about one z axis after another (four multiplications and two additions each, half of that for a vector in a
coordinate plane), or at once by the rotation of a station on the way, built from the base outwards. Which costs less
depends on what else is needed, so all ways are offered, beside cross products of two other columns and sums of vectors
that other columns need; `derive.programs.formulations.choice` takes the combination that shares most.
"""

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import product
from typing import NamedTuple

from derive.mechanics.chain import Chain
from derive.mechanics.forward_kinematics import joint_poses
from derive.mechanics.joint_motion import turn_vector
from derive.mechanics.vectors import (
    Frame,
    Matrix,
    Vector,
    add,
    column,
    cross,
    identity,
    matmul,
    multiply,
    scale,
    subtract,
    transpose,
)
from derive.programs.formulations.choice import choose
from derive.programs.formulations.frame_choice import ParallelRun, Placement
from derive.programs.optimise.search_policy import POLICY
from derive.programs.tape.graph import Ref
from derive.programs.tape.value import Value

Ways = list[Vector[Value]]


class Stations:
    """Stations 0 to ``last`` of an arm with exact base and tool; ``few``: all ways over them can be tried."""

    def __init__(self, chain: Chain[Value], runs: tuple[ParallelRun, ...]) -> None:
        self.chain = chain
        self.runs = runs
        self.last = len(runs)
        self.few = self.last <= POLICY.most_stations and chain.n <= POLICY.most_joints_all_ways
        self._fixed = [*(run.fixed for run in runs), chain.tool]
        self.axes = identity(chain.zero, chain.one)  # the axes of each station in itself

    @cached_property
    def rotations(self) -> list[Matrix[Value]]:
        """The axes of each station in the world, built outwards."""
        # R_0 = base K_0; R_{r+1} = R_r Rot(z, phi_r) C_{r+1}, phi_r the sum of the angles of run r.
        found = [matmul(self.chain.base.rotation, self._fixed[0].rotation)]
        for r, run in enumerate(self.runs):
            found.append(matmul(_turned_about_z(found[r], run.last), self.constants[r + 1]))
        return found

    @cached_property
    def constants(self) -> list[Matrix[Value]]:
        """Between what the run before turns and the axes of each station; constant."""
        befores = [run.last.constant for run in self.runs]
        later = (matmul(constant, fixed.rotation) for constant, fixed in zip(befores, self._fixed[1:], strict=True))
        return [self._fixed[0].rotation, *later]

    @cached_property
    def entries(self) -> list[Vector[Value]]:
        """From the last joint of the run before (or frame 0) to each station, in the station's axes; constant."""
        return [multiply(transpose(fixed.rotation), fixed.position) for fixed in self._fixed]

    @cached_property
    def _beyond(self) -> list[Vector[Value]]:
        """From the last joint of each run to the end effector, in station axes."""
        # From the tip inward: a run's steps, what lies beyond it, and the way to its station, turned by the run before.
        found: list[Vector[Value]] = [(self.chain.zero,) * 3]
        for r in range(self.last, 0, -1):
            found.append(self.inward(r, add(self.entries[r], self._with_steps(r, -1, found[-1]))))
        return found[::-1]

    def turned(self, r: int, place: Placement) -> Matrix[Value]:
        """The axes of a station in the world, turned about z as far as a joint of its run is."""
        return _turned_about_z(self.rotations[r], place)

    def world(self, r: int, v: Vector[Value], meeting: int) -> Vector[Value]:
        """A vector of a station in the world."""
        # Inward about one z axis after another as far as the meeting, there at once by its rotation.
        while r > meeting:
            v, r = self.inward(r, v), r - 1
        return multiply(self.rotations[r], v)

    def inward(self, r: int, v: Vector[Value]) -> Vector[Value]:
        """A vector of a station in the axes of the one before."""
        last = self.runs[r - 1].last
        return turn_vector(last.cosine, last.sine, multiply(self.constants[r], v))

    def reach(self, r: int, joint: int = -1, *, beyond: bool) -> Vector[Value]:
        """From a joint of a run to the run's last joint, or on to the end effector."""
        return self._with_steps(r, joint, self._beyond[r] if beyond else (self.chain.zero,) * 3)

    def _with_steps(self, r: int, joint: int, total: Vector[Value]) -> Vector[Value]:
        for place in reversed(self.runs[r].placements[joint + 1 :] if r < self.last else ()):
            total = add(place.step, total)
        return total


def _turned_about_z(rotation: Matrix[Value], place: Placement) -> Matrix[Value]:
    c, s = place.cosine, place.sine
    x, y, z = ((c * x + s * y, c * y - s * x, z) for x, y, z in rotation)
    return (x, y, z)


def cheapest_pose(stations: Stations) -> Frame[Value]:
    """T: the end effector in the world frame, tool included."""
    end = stations.last
    # Each column of R by its own ways, and as the cross product of the other two.
    axes = [[stations.world(end, stations.axes[k], m) for m in _meetings(stations, end)] for k in range(3)]
    crossed = [[cross(a, b) for a, b in product(axes[(k + 1) % 3], axes[(k + 2) % 3])] for k in range(3)]
    base = stations.chain.base.position
    # The origin as a sum of one vector for each run, by all routes.
    position = [add(base, _reach(stations, 0, -1, route)) for route in _routes(stations, 0)]
    x, y, z, origin = _chosen([*(axes[k] + crossed[k] for k in range(3)), position])
    return Frame(transpose((x, y, z)), origin)


def cheapest_jacobian(stations: Stations) -> list[list[Value]]:
    """J, the geometric Jacobian in the world frame."""
    groups: list[Ways] = []
    for r, run in enumerate(stations.runs):
        # One axis for the whole run, and a linear column for each of its joints.
        groups.append([stations.world(r, stations.axes[2], meeting) for meeting in _meetings(stations, r)])
        groups += [_linear_ways(stations, r, k) for k in range(len(run.placements))]
    return [list(row) for row in zip(*_columns(stations, groups, 1), strict=True)]


def _columns(stations: Stations, groups: Sequence[Ways], sense: int) -> list[list[Value]]:
    """Columns of a Jacobian from the cheapest ways; ``sense`` is -1 where the joints are seen from their other side."""
    # In the order in which the groups were offered: axis, linear columns, next run.
    chosen = iter(_chosen(groups))
    columns: list[list[Value]] = []
    for run in stations.runs:
        z = next(chosen)
        for place, joint in zip(run.placements, stations.chain.joints[run.first :], strict=False):
            # An axis may be opposed to the run's, and a variable counted the other way.
            direction = sense * joint.sign * (place.direction if joint.revolute else 1)
            spin = scale(direction, z) if joint.revolute else (stations.chain.zero,) * 3
            columns.append([*scale(direction, next(chosen)), *spin])
    return columns


def cheapest_end_jacobian(stations: Stations) -> list[list[Value]]:
    """J, the geometric Jacobian of the end effector in its own axes."""
    chain, zero = stations.chain, stations.chain.zero
    groups: list[Ways] = []
    poses = iter(joint_poses(chain))
    # `arm` leads from the first frame of the inverted arm, the end effector, to each station, in the station's axes.
    arm = multiply(transpose(chain.base.rotation), chain.base.position)
    for r, run in enumerate(stations.runs):
        start = add(multiply(transpose(stations.constants[r]), arm), stations.entries[r])
        arm = turn_vector(run.last.cosine, -run.last.sine, add(start, run.last.origin))
        meetings = _meetings(stations, r)
        axes = [stations.world(r, stations.axes[2], meeting) for meeting in meetings]
        groups.append(axes)
        for place, joint, pose in zip(run.placements, chain.joints[run.first :], poses, strict=False):
            x, y, _ = add(start, place.origin)
            # z x (-r), r being the way from the end effector: (y, -x, 0) in the run's axes.
            own = (y, -x, zero) if joint.revolute else place.axis()
            ways = [stations.world(r, own, meeting) for meeting in meetings]
            crossed = [cross(pose.position, z) for z in axes] if joint.revolute else []
            groups.append(ways + crossed)
    return [list(row) for row in zip(*reversed(_columns(stations, groups, -1)), strict=True)]


def cheapest_links(stations: Stations) -> list[Frame[Value]]:
    """DH frames 1..n in the world frame, without the tool: first all rotations, then all origins."""
    chain = stations.chain
    places = [(r, place) for r, run in enumerate(stations.runs) for place in run.placements]
    # Frame by frame: each takes the way that adds least to what the frames before it need.
    needed: list[Ref] = []

    def _cheapest(options: Sequence[Sequence[Value]]) -> int:
        """The option that adds least to what the frames so far need."""
        outputs = [[v.ref for v in option] for option in options]
        taken = choose(chain.zero.graph, [[needed], outputs])[1]
        needed.extend(outputs[taken])
        return taken

    joints: list[Matrix[Value]] = []
    rotations: list[Matrix[Value]] = []
    for i, (r, place) in enumerate(places):
        joint = chain.joints[i]
        before = rotations[i - 1] if i else chain.base.rotation
        if i == 0 or joint.fixed is not chain.ends[i - 1]:  # else the DH frame has the twist in it
            before = matmul(before, joint.fixed.rotation)
        onward = matmul(before, joint.motion(chain.zero, chain.one).rotation)
        # The rotation from the frame before, or from the station by the sum of the run's angles.
        options = [onward, matmul(stations.turned(r, place), place.constant)]
        frames = [matmul(option, chain.ends[i].rotation) for option in options]
        taken = _cheapest([[v for row in frame for v in row] for frame in frames])
        joints.append(options[taken])
        rotations.append(frames[taken])

    origins: list[Vector[Value]] = []
    starts: list[Vector[Value]] = []
    for i, (r, place) in enumerate(places):
        fixed = chain.joints[i].fixed.position
        # A point on the axis of joint i: from the origin before, less what leads to its DH frame.
        if i == 0:
            axis = add(chain.base.position, multiply(chain.base.rotation, fixed))
        else:
            axis = add(origins[-1], multiply(joints[i - 1], subtract(fixed, chain.ends[i - 1].position)))
        if r == len(starts):
            starts.append(axis)
        ways = list(_origin_ways(stations, i, (r, place), joints[i], axis, starts))
        origins.append(ways[_cheapest(ways)])
    return [Frame(rotation, origin) for rotation, origin in zip(rotations, origins, strict=True)]


def _origin_ways(
    stations: Stations,
    i: int,
    where: tuple[int, Placement],
    rotation: Matrix[Value],
    axis: Vector[Value],
    starts: Sequence[Vector[Value]],
) -> Iterator[Vector[Value]]:
    """The origin of DH frame i: a step along and from the axis of its joint, or a vector from a station."""
    r, place = where
    end, joint = stations.chain.ends[i].position, stations.chain.joints[i]
    yield add(axis, add(scale(joint.offset, column(rotation, 2)), multiply(rotation, end)))
    v = add(place.origin, place.turned(end))
    # Or as one vector from any station before, in whose axes it is turned.
    for k in range(r, -1, -1) if stations.few else ():
        yield add(starts[k], stations.world(k, v, k))
        if k:
            v = add(stations.runs[k - 1].last.origin, stations.inward(k, add(stations.entries[k], v)))


def _chosen(groups: Sequence[Ways]) -> list[Vector[Value]]:
    graph = groups[0][0][0].graph
    distinct = [_distinct(ways) for ways in groups]
    places = choose(graph, [[[v.ref for v in way] for way in ways] for ways in distinct])
    return [ways[place] for ways, place in zip(distinct, places, strict=True)]


def _distinct(ways: Iterable[Vector[Value]]) -> Ways:
    return list({tuple(v.ref for v in way): way for way in ways}.values())


def _meetings(stations: Stations, r: int) -> Sequence[int]:
    """Stations at which a vector of station r may meet a rotation from the base."""
    return range(r, -1 if stations.few else max(r - POLICY.near_stations, -1), -1)


def _linear_ways(stations: Stations, r: int, k: int) -> Ways:
    """Velocity of the end effector per unit rate of a joint about the run's axis, or along its own slide."""
    place = stations.runs[r].placements[k]
    joint = stations.chain.joints[stations.runs[r].first + k]
    meetings = _meetings(stations, r)
    # A slide moves the end effector along its own axis.
    if not joint.revolute:
        outward = multiply(stations.turned(r, place), column(place.constant, 2))
        return [outward, *(stations.world(r, place.axis(), meeting) for meeting in meetings)]
    # A turn moves it by z x r: (-y, x, 0) in the run's axes, or as a cross product in the world.
    x, y, _ = stations.reach(r, k, beyond=True)
    ways = [stations.world(r, (-y, x, stations.chain.zero), meeting) for meeting in meetings]
    if place is stations.runs[r].last:  # in the axes of the next station, where the arm may lie in a plane
        arm = add(stations.entries[r + 1], stations.reach(r + 1, beyond=True))
        velocity = cross(stations.constants[r + 1][2], arm)
        ways += [stations.world(r + 1, velocity, meeting) for meeting in _meetings(stations, r + 1)]
    axes = [stations.world(r, stations.axes[2], meeting) for meeting in meetings]
    arms = _distinct(_reach(stations, r, k, route) for route in _routes(stations, r))
    return ways + [cross(z, arm) for z, arm in product(axes, arms)]


class _Route(NamedTuple):
    """A way from a joint to the end effector, in the world."""

    end: int  # from this station on it is one vector; before, there is one for each run
    meeting: int  # where these meet the rotation from the base, at the latest
    # Whether a vector along an axis of its station is a multiple of the axis, which other columns may need.
    scaled: bool


def _routes(stations: Stations, r: int) -> Iterator[_Route]:
    last, near = stations.last, POLICY.near_stations
    yield _Route(last, last, True)
    for meeting in range(last if stations.few else r, -1 if stations.few else max(r - near, -1), -1):
        for end in range(r, last + 1 if stations.few else min(r + near, last + 1)):
            yield _Route(end, meeting, False)
            yield _Route(end, meeting, True)


def _reach(stations: Stations, r: int, joint: int, route: _Route) -> Vector[Value]:
    """From a joint to the end effector in the world."""
    total: Vector[Value] | None = None
    for k in range(route.end, r - 1, -1):
        start = joint if k == r else -1
        x, y, z = stations.reach(k, start, beyond=k == route.end)
        v = (x, y, stations.chain.zero) if start >= 0 else add(stations.entries[k], (x, y, z))
        meeting = min(k, route.meeting)
        along = [axis for axis in range(3) if v[axis]]
        if route.scaled and len(along) == 1:
            # A multiple of an axis, which other columns may have turned already.
            way = scale(v[along[0]], stations.world(k, stations.axes[along[0]], meeting))
        else:
            way = stations.world(k, v, meeting)
        total = way if total is None else add(way, total)
    assert total is not None
    return total
