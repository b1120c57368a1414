"""The workspace of a robot: the places that its end effector reaches, and those that it reaches in every orientation.

What is reachable, and what is dexterous: Siciliano et al., Robotics: Modelling, Planning and Control, sec. 2.10;
Kumar and Waldron, The workspaces of a mechanical manipulator, 1981.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial

import numpy as np

from derive.arrays import Array
from derive.workspace import region as areas
from derive.workspace.point import TURN, ArmPoint, Picture, PlaneMap, Range, joint_ranges
from derive.workspace.poses import RobotPoses
from derive.workspace.postures import Postures
from derive.workspace.refinement import refined_area
from derive.workspace.region import Area, Measure, Region

_SAME = 1e-9
_PLACES = 2_500  # places in space for one estimate of a volume
_SEEDS = 8_000  # configurations among which those are chosen from which it is tried to reach a place in space
_ESTIMATES = 8  # estimates of a volume; their spread is its error


@dataclass(frozen=True, slots=True)
class Wrist:
    """The last joints, which turn the hand about one point."""

    centre: tuple[float, float, float]  # the point in the axes of the end effector [m]
    hand: float  # its distance from the end effector's origin [m]
    joints: tuple[int, ...]  # its joints, from 0
    complete: bool  # whether its joints turn the hand into every orientation
    planar: bool  # whether it is one joint, and all orientations are those about the axis


@dataclass(frozen=True, eq=False)
class WorkspaceView:
    """A picture of the workspace."""

    picture: Picture  # section, top view or side view
    reachable: Area  # the area that is reached
    dexterous: Area | None  # the area that is reached in every orientation; None where that is not known
    exact: bool  # whether the boundary follows the exact critical curves
    path: Array  # (k, 2) positions where these are but a line or a point [m]
    by_number: tuple[tuple[int, Region], ...] = ()  # its parts by the number of postures, the fewest first, where known
    by_formula: bool = False  # whether the boundary is that of formulas, the square roots of the inverse kinematics


@dataclass(frozen=True, eq=False)
class Workspace:
    """The workspace of the origin of the end effector's frame."""

    views: tuple[WorkspaceView, ...]  # section, without symmetry side view, and top view; of a flat one this alone
    volume: Measure | None  # of what is reached; None for a flat workspace
    dexterous_volume: Measure | None  # of what is dexterous; None where that is not known
    wrist: Wrist | None  # the last joints, where they turn the hand about one point
    ranges: tuple[Range, ...]  # of the joints that move it, and of a wrist that is complete

    @property
    def assumed(self) -> tuple[Range, ...]:
        """Limits that the file does not give."""
        return tuple(way for way in self.ranges if way.assumed)


def find_workspace(poses: RobotPoses, tell: Callable[[str], None] | None = None) -> Workspace:
    """The workspace of a robot."""
    point = ArmPoint(poses, joint_ranges(poses))
    wrist = find_wrist(point)
    search = _Search(point, wrist, tell or (lambda stage: None))
    turned = wrist.joints if wrist is not None and wrist.complete else ()
    ranges = tuple(point.ranges[j] for j in sorted({*point.moving, *turned}))
    return Workspace(search.views, *search.volumes, wrist, ranges)


def find_wrist(point: ArmPoint) -> Wrist | None:
    """The wrist of an arm: three last joints whose axes meet, or the last one of an arm whose axes are parallel."""
    n, revolute = len(point.ranges), [j for j, way in enumerate(point.ranges) if way.revolute]
    q = point.random(4, range(len(point.ranges)), seed=3)  # at which it is seen whether axes meet
    joints: tuple[int, ...]
    frames = [point.poses.joint_frames(list(column)) for column in q.T]
    axes = np.array([[[row[2] for row in frame.rotation] for frame in arm[:-1]] for arm in frames], dtype=float)
    origins = np.array([[frame.position for frame in arm] for arm in frames], dtype=float)
    hands = np.array([arm[-1].rotation for arm in frames], dtype=float)
    # Parallel axes: the foot of the last axis beside the end effector, in its own axes.
    if len(revolute) > 1 and np.abs(np.cross(axes[:, revolute], axes[:, revolute[:1]])).max() < _SAME:
        last = revolute[-1]
        lever = origins[:, last] - origins[:, -1]
        lever = lever - axes[:, last] * np.sum(lever * axes[:, last], axis=1)[:, None]
        joints, misses = (last,), [0.0]
    elif n >= 3 and revolute[-3:] == [n - 3, n - 2, n - 1]:
        # Three last axes through one point: the nearest to them, by least squares of (1 - z z^T) (c - o) = 0.
        joints, misses, centres = (n - 3, n - 2, n - 1), [], []
        for arm, axis in zip(origins[:, -4:-1], axes[:, -3:], strict=True):
            across = np.eye(3) - axis[:, :, None] * axis[:, None, :]
            right = np.einsum("kij,kj->ki", across, arm).ravel()
            centres.append(np.linalg.lstsq(across.reshape(-1, 3), right, rcond=None)[0])
            misses.append(float(np.abs(np.einsum("kij,kj->ki", across, centres[-1] - arm)).max()))
        lever = np.array(centres) - origins[:, -1]
    else:
        return None
    # It stands still in the axes of the end effector, unless a joint that slides makes the hand longer and shorter.
    places = np.einsum("nji,nj->ni", hands, lever)
    if max(misses) > 1e-7 * point.size or np.ptp(places, axis=0).max() > 1e-7 * point.size:
        return None
    planar = len(joints) == 1
    complete = point.ranges[joints[0]].full if planar else _turns_everywhere(point)
    centre = np.where(np.abs(places[0]) < _SAME * point.size, 0.0, places[0])
    x, y, z = (float(part) for part in centre)
    return Wrist((x, y, z), float(np.linalg.norm(centre)), joints, complete, planar)


def _turns_everywhere(point: ArmPoint) -> bool:
    """Whether the last three joints reach every orientation."""
    # (q4, q5, q6) and (q4 + pi, -q5, q6 + pi) are one orientation: the outer joints turn all around and the middle one
    # half, or the middle one and an outer one turn all around and the other one half.
    first, middle, last = range(len(point.ranges) - 3, len(point.ranges))
    low, high = point.ranges[middle].lower, point.ranges[middle].upper
    angles = []
    for value in np.append(np.linspace(low, min(high, low + TURN), 721), high):
        frames = point.poses.joint_frames([value if j == middle else 0.0 for j in range(len(point.ranges))])
        axes = [np.array([row[2] for row in frames[j].rotation], dtype=float) for j in (first, middle, last)]
        angles.append(float(axes[0] @ axes[2]))
        if abs(axes[0] @ axes[1]) > _SAME or abs(axes[1] @ axes[2]) > _SAME:
            return False
    # The outer axes, each perpendicular to the middle one, come to 0 and to pi apart: every orientation is there.
    outer = (point.ranges[first], point.ranges[last])
    if all(way.full for way in outer):
        return max(angles) > 1.0 - 1e-4 and min(angles) < 1e-4 - 1.0
    half = all(way.upper - way.lower >= math.pi - _SAME for way in outer)
    return half and point.ranges[middle].full and any(way.full for way in outer)


class _Search:
    """The search for the workspace of a point, by way of the wrist's centre where that is simpler."""

    def __init__(self, point: ArmPoint, wrist: Wrist | None, tell: Callable[[str], None]) -> None:
        self.point, self.wrist, self.tell = point, wrist, tell
        self.centre = point if wrist is None else replace(point, place=wrist.centre)
        self.plane, self.area, self.solved = cache(PlaneMap.of), cache(self._area), cache(Postures.of)

    @property
    def pictures(self) -> tuple[Picture, ...]:
        """What is drawn of the arm; a flat workspace is seen along its axis alone."""
        _, _, height = self.point.motion(self.point.random(64, self.point.moving), self.point.moving)[0]
        if np.ptp(height) < 1e-9 * self.point.size:
            return (Picture.TOP,)
        return (Picture.SIDE if self.point.turn is None else Picture.SECTION, Picture.TOP)

    @cached_property
    def views(self) -> tuple[WorkspaceView, ...]:
        found = []
        for picture in self.pictures:
            self.tell(str(picture))
            plane = self.plane(self.point, picture)
            reachable, exact = self._reachable(picture)
            if reachable.region.is_empty:
                low, high = plane.box  # of a workspace that is a line: along the ranges of all joints
                line = low + (high - low) * np.linspace(0.0, 1.0, 721)
                found.append(WorkspaceView(picture, reachable, None, exact, plane.values(line)[0].T))
                continue
            postures, numbers = self._postures(plane), tuple[tuple[int, Region], ...]()
            if reachable.cells and postures is not None and postures.are_counted:
                numbers = areas.by_number(reachable, partial(postures.number, plane), self.point.size)
            dexterous = self._dexterous(picture, reachable)
            by_formula = bool(reachable.cells) and self._with_formulas(plane) is not None
            found.append(WorkspaceView(picture, reachable, dexterous, exact, np.zeros((0, 2)), numbers, by_formula))
        return tuple(found)

    @property
    def revolves(self) -> bool:
        """Whether the workspace is a solid of revolution."""
        return self.point.turn is not None and self.point.ranges[self.point.turn].full

    def _postures(self, plane: PlaneMap) -> Postures | None:
        """In how many postures places of a picture are reached; None where it does not show places of the point."""
        shows = self.revolves if plane.picture is Picture.SECTION else self.pictures == (Picture.TOP,)
        return self.solved(plane.point) if shows else None

    def _with_formulas(self, plane: PlaneMap) -> Postures | None:
        """The postures of places in a picture, where the bounds of the inverse kinematics are its boundary."""
        postures = self._postures(plane) if plane.has_exact_curves else None
        return postures if postures is not None and postures.has_formulas else None

    def _area(self, plane: PlaneMap) -> Area:
        """What a map covers: by formulas, where they say it, by critical curves, or by search."""
        if postures := self._with_formulas(plane):
            return areas.formula_area(plane, partial(postures.curves, plane), partial(postures.within, plane))
        return areas.exact_area(plane) if plane.has_exact_curves else refined_area(plane)

    def _reachable(self, picture: Picture) -> tuple[Area, bool]:
        """What is reached in a picture, and whether its boundary is exact."""
        plane, wrist = self.plane(self.point, picture), self.wrist
        if plane.has_exact_curves:
            return self.area(plane), True
        turns = wrist is not None and wrist.complete and not wrist.planar
        centre = self.plane(self.centre, picture) if turns else plane
        exact = centre.has_exact_curves
        if picture is Picture.TOP and not exact and self.revolves and Picture.SECTION in self.pictures:
            return self._reachable(Picture.SECTION)[0].changed(_seen_along_axis), False
        if wrist is None or not turns:
            return self.area(plane), False
        # What the centre reaches, enlarged by the hand, since the wrist turns it into every direction.
        hand, in_space = wrist.hand, picture is Picture.SECTION
        return self.area(centre).changed(lambda region: areas.enlarged(region, hand, in_space)), exact

    def _dexterous(self, picture: Picture, reachable: Area) -> Area | None:
        """What is dexterous in a picture; None where it is not known."""
        if (wrist := self.wrist) is None or not wrist.complete:
            return None
        if wrist.hand == 0.0:
            return reachable
        if picture is not Picture.TOP if wrist.planar else not self.revolves:
            return None
        hand, in_space = wrist.hand, not wrist.planar
        around = self.area(self.plane(self.centre, Picture.SECTION if in_space else Picture.TOP))
        found = around.changed(lambda area: areas.dexterous(area, hand, in_space))
        return found.changed(_seen_along_axis) if in_space and picture is not Picture.SECTION else found

    @cached_property
    def volumes(self) -> tuple[Measure | None, Measure | None]:
        """Of what is reached, and of what is dexterous."""
        if len(self.views) < 2:
            return None, None
        first = self.views[0]
        if self.revolves:
            return first.reachable.volume, None if first.dexterous is None else first.dexterous.volume
        if any(view.reachable.region.is_empty for view in self.views):
            return Measure(0.0, 0.0), None
        self.tell("volume")
        # The places of a box that are reached, spread evenly (Kronecker's sequence), several times.
        package, top = areas.shapely(), self.views[1]
        left, near, right, far = top.reachable.region.bounds
        _, low, _, high = first.reachable.region.bounds
        corner, sides = np.array([[left], [near], [low]]), np.array([[right - left], [far - near], [high - low]])
        steps = np.array([[0.8191725133961645], [0.6710436067037893], [0.5497004779019703]])  # powers of 1/1.2207440846
        space = PlaneMap(self.point, Picture.SPACE, self.point.moving)
        shares: list[float] = []
        for k in range(_ESTIMATES):
            shift = np.random.default_rng(k).random((3, 1))
            places = corner + sides * ((shift + steps * np.arange(1, _PLACES + 1)) % 1.0)
            x, y, z = places
            across = np.hypot(x, y) if first.picture is Picture.SECTION else x
            inside = package.contains_xy(first.reachable.region, across, z)
            inside &= package.contains_xy(top.reachable.region, x, y)
            shares.append(float(np.sum(areas.is_reached(space, places[:, inside], _SEEDS))) / _PLACES)
        # Twice the standard error of the mean of the estimates.
        box = float(np.prod(sides))
        whole = Measure(box * float(np.mean(shares)), 2.0 * box * float(np.std(shares)) / (_ESTIMATES - 1) ** 0.5)
        return whole, whole if first.dexterous is first.reachable else None


def _seen_along_axis(section: Region) -> Region:
    """The rings that a solid of revolution covers, seen along its axis."""
    package = areas.shapely()
    disc = partial(package.Point(0.0, 0.0).buffer, quad_segs=512)
    bounds = (part.bounds for part in package.get_parts(section) if not part.is_empty)
    return package.unary_union([disc(outer).difference(disc(inner)) for inner, _, outer, _ in bounds])
