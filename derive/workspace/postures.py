"""In how many postures an arm reaches a place, and what its square roots say about the boundary.

The inverse kinematics is asked for poses whose point (the origin of the end effector, or the centre of a wrist) is
at the place, with one orientation. Whether that orientation matters is tried at random configurations, not supposed.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from derive.arrays import Array
from derive.errors import DeriveError
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.numeric.chain import NumericChain
from derive.inverse.words.reach import Reach, find_reach
from derive.inverse.words.solutions import inverse_kinematics
from derive.robot.options.inverse import POSE, InverseOptions
from derive.workspace.critical import zeros
from derive.workspace.point import TURN, ArmPoint, Picture, PlaneMap

_TRIED = 24  # random configurations at which it is tried whether a formula or a count holds
_SAME = 1e-6  # angles closer than this are one [rad]; lengths in parts of the arm's size
_BEYOND = 1.5  # how far formulas are followed, in arm's sizes


@dataclass(frozen=True, eq=False)
class Postures:
    """How an arm reaches places with a point."""

    point: ArmPoint  # the point, which at most three joints move
    reach: Reach  # the bounds of the inverse kinematics, and itself

    @classmethod
    def of(cls, point: ArmPoint) -> Self | None:
        """The postures of an arm; None where more than three joints move the point, or some joint is given."""
        robot = replace(point.poses.robot, inverse=InverseOptions(POSE))
        if not 0 < len(point.moving) <= 3:
            return None
        try:
            reach = find_reach(robot, robot.style, inverse_kinematics(robot, robot.style))
        except DeriveError:
            return None
        return cls(point, reach) if reach.inverse.graph.is_closed and not reach.inverse.graph.given else None

    @cached_property
    def _values(self) -> dict[str, float]:
        return {name: float(value) for name, value in self.point.poses.values.items()}

    @cached_property
    def _tried(self) -> Array:
        """Random configurations, (samples, n)."""
        return self.point.random(_TRIED, range(len(self.point.ranges)), seed=11).T

    @cached_property
    def _poses_tried(self) -> Array:
        return NumericChain.of(self.reach.inverse.robot, self._values).pose_and_jacobian(self._tried)[0]

    def poses(self, places: Array) -> Array:
        """Poses whose point is at places (3, k) in the frame of the axis [m], all of one orientation."""
        rotation, origin = self.point.axis
        # p_e = p - R r for the point r in the end effector's axes, in the world.
        turn = self._poses_tried[0, :3, :3]
        found = np.tile(np.eye(4), (places.shape[1], 1, 1))
        found[:, :3, :3] = turn
        found[:, :3, 3] = (rotation @ places + origin[:, None]).T - turn @ np.array(self.point.place)
        return found

    @cached_property
    def _places_tried(self) -> Array:
        return self.point.position(self._tried.T, range(len(self.point.ranges)))

    @cached_property
    def has_formulas(self) -> bool:
        """Whether the bounds say all about the point, in any orientation, and no joint has limits."""
        moving = [self.point.ranges[j] for j in self.point.moving]
        if not (self.reach.is_whole and self.reach.bounds and all(way.full for way in moving)):
            return False
        # Other orientations, the same places: where bounds differ, they are not about the point alone.
        own = self.reach.margins(self._poses_tried, self._values)
        other = self.reach.margins(self.poses(self._places_tried), self._values)
        return bool(np.allclose(own, other, rtol=0.0, atol=1e-9 * self.point.size**2, equal_nan=True))

    def _in_space(self, plane: PlaneMap, places: Array) -> Array:
        """Places of a section, or of a flat arm from above, in the frame of the axis."""
        first, second = places
        if plane.picture is Picture.SECTION:
            return np.stack([first, 0.0 * first, second])
        return np.stack([first, second, np.full_like(first, self._places_tried[2, 0])])

    def within(self, plane: PlaneMap, places: Array) -> Array:
        """Whether the bounds hold at places of a picture."""
        ways = self.reach.margins(self.poses(self._in_space(plane, places)), self._values)
        return np.asarray(np.any([np.all([margin >= 0.0 for margin in way], axis=0) for way in ways], axis=0))

    def curves(self, plane: PlaneMap, parts: int) -> Array:
        """Segments along which a bound is reached, (segments, 2 ends, 2) [m]."""
        far = _BEYOND * plane.point.size
        # Uneven, so that no line of the grid runs along a curve at zero.
        sides = [np.linspace(-1.0137 * far, far, parts + 1), np.linspace(-1.0071 * far, far, parts + 1)]
        if plane.picture is Picture.SECTION:
            sides[0] = sides[0][sides[0] > -0.02 * far]
        found = [np.zeros((0, 2, 2))]
        for way, margins in enumerate(self.reach.margins(self._poses_tried, self._values)):
            for side in range(len(margins)):

                def _margin(u: Array, v: Array, way: int = way, side: int = side) -> Array:
                    grid = np.broadcast_arrays(u, v)
                    flat = self._in_space(plane, np.stack([part.ravel() for part in grid]))
                    values = self.reach.margins(self.poses(flat), self._values)[way][side]
                    return np.nan_to_num(values, nan=-1.0).reshape(grid[0].shape)

                found.append(zeros(_margin, sides[0], sides[1]).transpose(1, 2, 0))
        segments = np.concatenate(found)
        if plane.picture is Picture.SECTION:
            segments = segments[np.any(segments[..., 0] > 0.0, axis=1)]
            (u, v), (s, t) = segments[:, 0].T, segments[:, 1].T
            on_axis = v + (t - v) * np.where(u * s < 0.0, u / np.where(u == s, 1.0, u - s), 0.0)
            for end in range(2):
                outside = segments[:, end, 0] < 0.0
                segments[outside, end] = np.stack([0.0 * on_axis, on_axis], axis=-1)[outside]
        return segments

    def number(self, plane: PlaneMap, places: Array) -> Array:
        """In how many postures places of a picture are reached within the limits."""
        return np.asarray(np.isfinite(self._solutions(self._in_space(plane, places))[..., 0]).sum(axis=-1))

    @cached_property
    def are_counted(self) -> bool:
        """Whether postures are found again that places were made of."""
        # Places are made of random postures, and each has to be among those that are found.
        wanted = self._tried[:, list(self.point.moving)]
        apart = np.abs(self._turned(self._solutions(self._places_tried) - wanted[:, None]))
        return bool((np.where(np.isnan(apart), np.inf, apart).max(axis=-1).min(axis=-1) < _SAME).all())

    def _turned(self, q: Array) -> Array:
        """Differences of the moving joints' variables without full turns."""
        turns = np.array([self.point.ranges[j].revolute for j in self.point.moving])
        return np.where(turns, q - TURN * np.round(q / TURN), q / self.point.size)

    def _solutions(self, places: Array) -> Array:
        """The moving joints of all postures within the limits, each once: (k, postures, joints), NaN for none."""
        solver = InverseSolver.of(self.reach.inverse.robot, self.reach.inverse.graph, self._values)
        q = solver.solve(self.poses(places)).q[..., list(self.point.moving)]
        for k, way in enumerate(self.point.ranges[j] for j in self.point.moving):
            value = q[..., k]
            # The first full turn at or above the lower limit.
            if way.revolute and not way.full:
                value = value + TURN * np.ceil((way.lower - _SAME - value) / TURN)
            if not way.full:
                q[(value < way.lower - _SAME) | (value > way.upper + _SAME)] = np.nan
        # Solutions that coincide, as in singular configurations, count once.
        for later in range(1, q.shape[1]):
            apart = np.abs(self._turned(q[:, :later] - q[:, later : later + 1])).max(axis=-1)
            q[np.any(apart < _SAME, axis=1), later] = np.nan
        return q
