"""A point of an arm as a function of the joint variables, seen from the axis about which the workspace is symmetric.

The pictures of a workspace are maps of joint variables into a plane: a section (distance from the axis and height), a
top view or a side view. Each map has positions and derivatives at many configurations at once, and finds the
configurations that bring the point nearest to given places of the plane.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np

from derive.arrays import Array
from derive.workspace.poses import RobotPoses

TURN = 2.0 * math.pi

_DEPENDS = 1e-9  # a joint that moves the point less than this part of the arm's size does not move it
_PROBES = 12  # random configurations at which it is seen which joints move the point
_STEPS = 60  # most steps of the search for the nearest configuration
_SETTLED = 1e-8  # a step that makes the squared distance smaller by less than this part is the last one
_SOFT, _STIFF = 1e-12, 1e3  # least damping, and that with which a step is too short, in squares of the arm's size


# What a map shows: distance from the axis of symmetry and height along it, what is seen along the axis, or across it,
# for an arm without symmetry, or all three coordinates.
Picture = StrEnum("Picture", {"SECTION": "section", "TOP": "top view", "SIDE": "side view", "SPACE": "space"})


_ROWS = {Picture.TOP: [0, 1], Picture.SIDE: [0, 2], Picture.SPACE: [0, 1, 2]}  # coordinates that are shown as they are


@dataclass(frozen=True, slots=True)
class Range:
    """The way of a joint."""

    variable: str  # its variable
    lower: float  # lower limit [rad or m]
    upper: float  # upper limit [rad or m]
    revolute: bool  # whether it turns
    assumed: bool = False  # whether the file gives no limits

    @property
    def full(self) -> bool:
        """Whether it turns all around."""
        return self.revolute and self.upper - self.lower >= TURN - 1e-9

    @property
    def interval(self) -> str:
        """Its limits in words."""
        return f"from {self.lower:.4g} to {self.upper:.4g} {'rad' if self.revolute else 'm'}"


def joint_ranges(poses: RobotPoses) -> tuple[Range, ...]:
    """The way of every joint; without limits a joint turns from -pi to pi, or slides from 0 to the longest length."""
    found = []
    for joint, limits in zip(poses.robot.joints, poses.limits, strict=True):
        free = (-math.pi, math.pi) if joint.is_revolute else (0.0, poses.longest)
        found.append(Range(joint.variable, *(limits or free), joint.is_revolute, limits is None))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class ArmPoint:
    """A point that is fixed in the end effector, and the axis from which it is seen."""

    poses: RobotPoses  # the robot in numbers
    ranges: tuple[Range, ...]  # the way of every joint
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)  # the point in the axes of the end effector [m]

    @cached_property
    def axis(self) -> tuple[Array, Array]:
        """Rotation and origin in the world of a frame whose z is the axis of symmetry: the first joint that turns."""
        frame = self.poses.frame_of_axis(next((i for i, way in enumerate(self.ranges) if way.revolute), 0))
        return np.array(frame.rotation, dtype=float), np.array(frame.position, dtype=float)

    @cached_property
    def turn(self) -> int | None:
        """The joint that turns the workspace as a whole about the axis; None if a joint before it shifts the axis."""
        for index, way in enumerate(self.ranges):
            if way.revolute:
                return index
            # A slide before it that is parallel to the axis leaves the axis in place.
            along = self.poses.frame_of_axis(index).rotation
            if abs(sum(along[k][2] * self.axis[0][k, 2] for k in range(3))) < 1.0 - _DEPENDS:
                return None
        return None

    @cached_property
    def size(self) -> float:
        """How far the point is from the axis frame at most, of some configurations [m]; 1 for a point that rests."""
        everything = tuple(range(len(self.ranges)))
        return float(np.linalg.norm(self.motion(self.random(256, everything), everything)[0], axis=0).max()) or 1.0

    @cached_property
    def moving(self) -> tuple[int, ...]:
        """The joints that move the point at all."""
        everything = tuple(range(len(self.ranges)))
        _, columns = self.motion(self.random(_PROBES, everything), everything)
        # Of all derivatives at random configurations none but rounding: the joint does not move the point.
        return tuple(int(k) for k in np.flatnonzero(np.abs(columns).max(axis=(0, 2)) > _DEPENDS * self.size))

    def random(self, count: int, joints: Sequence[int], seed: int = 0, limits: float = 0.0) -> Array:
        """Configurations between the limits, the same for the same seed, (joints, count) [rad or m]."""
        rng = np.random.default_rng(seed)
        rows = []
        for way in (self.ranges[j] for j in joints):
            values = rng.uniform(way.lower, way.upper, count)
            if limits:
                ends = np.where(rng.random(count) < 0.5, way.lower, way.upper)
                values = np.where(rng.random(count) < limits, ends, values)
            rows.append(values)
        return np.reshape(rows, (len(rows), count))

    def position(self, q: Array, joints: Sequence[int]) -> Array:
        """Where the point is in the frame of the axis, (3, samples) [m]; joints that are not given are at zero."""
        return self.motion(q, joints, ())[0]

    def motion(self, q: Array, joints: Sequence[int], by: Sequence[int] | None = None) -> tuple[Array, Array]:
        """Positions (3, samples) as `position` has them, and derivatives (3, joints, samples); None by all of them."""
        by = joints if by is None else by
        (rotation, origin), count = self.axis, q.shape[1]
        values: list[float | Array] = [0.0] * len(self.ranges)
        for row, joint in enumerate(joints):
            values[joint] = q[row]
        found = np.empty((3, 1 + len(by), count))  # the point in the world, then its derivatives
        for k, vector in enumerate(self.poses.end_point(values, self.place, by)):
            for row, entry in enumerate(vector):
                found[row, k] = entry
        point, slopes = found[:, 0], found[:, 1:]
        turned = rotation.T @ slopes.reshape(3, -1)
        return np.asarray(rotation.T @ (point - origin[:, None])), turned.reshape(slopes.shape)


@dataclass(frozen=True, eq=False)
class PlaneMap:
    """A picture of the workspace as a map of joint variables into a plane."""

    point: ArmPoint  # the point of the arm
    picture: Picture  # what is shown
    joints: tuple[int, ...]  # the joints that are variables of the map

    @classmethod
    def of(cls, point: ArmPoint, picture: Picture) -> PlaneMap:
        """The map with the joints that change a picture."""
        joints = tuple(j for j in point.moving if picture is not Picture.SECTION or j != point.turn)
        slopes = cls(point, picture, joints).values(point.random(_PROBES, joints))[1]
        strong = np.abs(slopes).max(axis=(0, 2), initial=0.0) > _DEPENDS * point.size
        return cls(point, picture, tuple(j for j, moves in zip(joints, strong, strict=True) if moves))

    @property
    def has_exact_curves(self) -> bool:
        """Whether its critical curves are those of a map of two variables, besides a joint that turns the picture."""
        return len([j for j in self.joints if self.picture is not Picture.TOP or j != self.point.turn]) <= 2

    @property
    def ranges(self) -> tuple[Range, ...]:
        """The ways of the map's joints."""
        return tuple(self.point.ranges[j] for j in self.joints)

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Lower and upper limits, (joints, 1) each."""
        low, high = ([getattr(way, end) for way in self.ranges] for end in ("lower", "upper"))
        return np.array(low, dtype=float)[:, None], np.array(high, dtype=float)[:, None]

    @cached_property
    def unit(self) -> Array:
        """What counts as much as a radian in each variable, (joints, 1): the arm's size for one that slides."""
        return np.array([1.0 if way.revolute else self.point.size for way in self.ranges])[:, None]

    def places(self, q: Array) -> Array:
        """Places in the plane alone, (2, samples) [m], in space three rows: a fraction of the time of `values`."""
        place = self.point.position(q, self.joints)
        if self.picture is Picture.SECTION:
            return np.stack([np.hypot(*place[:2]), place[2]])
        return place[_ROWS[self.picture]]

    def values(self, q: Array) -> tuple[Array, Array]:
        """Places in the plane, (2, samples) [m], and derivatives, (2, joints, samples), of q; three rows in space."""
        place, slopes = self.point.motion(q, self.joints)
        if self.picture is not Picture.SECTION:
            return place[_ROWS[self.picture]], slopes[_ROWS[self.picture]]
        (x, y, z), (dx, dy, dz) = place, slopes
        # rho = sqrt(x^2 + y^2), so that d rho = (x dx + y dy)/rho; on the axis rho has no derivative.
        rho = np.hypot(x, y)
        safe = np.maximum(rho, 1e-12 * self.point.size)
        return np.stack([rho, z]), np.stack([(x * dx + y * dy) / safe, dz])

    def inside(self, q: Array) -> Array:
        """Configurations brought into the limits; angles of joints that turn all around are free."""
        low, high = self.box
        return np.asarray(np.where(np.array([way.full for way in self.ranges])[:, None], q, np.clip(q, low, high)))

    def nearest(self, targets: Array, starts: Array) -> tuple[Array, Array, Array]:
        """Configurations within the limits that bring the point nearest to targets, each from a start nearby.

        A damped Gauss-Newton step in the joints that are not held by a limit, with the damping of Levenberg and
        Marquardt for each target (Nocedal and Wright, Numerical Optimization, sec. 10.3 and 18.5): configurations
        (joints, samples), places (2, samples) and distances (samples,) [m].
        """
        low, high = self.box
        free = np.array([way.full for way in self.ranges])[:, None]
        q = self.inside(starts)
        place, derivative = self.values(q)
        miss = targets - place
        error = np.sum(miss**2, axis=0)
        damping = np.full(q.shape[1], 1e-3 * self.point.size**2)
        active = np.arange(q.shape[1])
        for _ in range(_STEPS):
            far = error[active] > (1e-12 * self.point.size) ** 2
            active = active[far & (damping[active] < _STIFF * self.point.size**2)]
            if not len(active):
                break
            at, missing = q[:, active], miss[:, active]
            # The pull J^T miss towards the target; joints that it pulls beyond a limit are held (projected gradient).
            scaled = derivative[:, :, active] * self.unit
            pull = np.einsum("kjn,kn->jn", scaled, missing)
            held = ~free & (((at <= low) & (pull < 0)) | ((at >= high) & (pull > 0)))
            scaled = np.where(held, 0.0, scaled)
            # Levenberg and Marquardt: dq = J^T (J J^T + mu 1)^-1 miss, of two or three rows however many joints.
            step = self.unit * np.einsum("kjn,kn->jn", scaled, _solved(scaled, missing, damping[active]))
            tried = self.inside(at + step)
            there, slope = self.values(tried)
            left = targets[:, active] - there
            squared = np.sum(left**2, axis=0)
            # Steps that come nearer are taken and mu falls; else mu grows. What settles is left alone by infinite mu.
            better = squared < error[active]
            settled = better & (squared > (1.0 - _SETTLED) * error[active])
            chosen = active[better]
            q[:, chosen], place[:, chosen], miss[:, chosen] = tried[:, better], there[:, better], left[:, better]
            derivative[:, :, chosen], error[chosen] = slope[:, :, better], squared[better]
            damping[active] = np.maximum(damping[active] * np.where(better, 0.2, 8.0), _SOFT * self.point.size**2)
            damping[active[settled]] = np.inf
        return q, place, np.sqrt(error)


def _solved(columns: Array, right: Array, damping: Array) -> Array:
    """(J J^T + damping)^-1 right for many J of two or three rows at once: (rows, samples)."""
    if len(right) == 3:  # Cramer's rule
        first, second, third = np.einsum("ajn,bjn->abn", columns, columns) + damping * np.eye(3)[:, :, None]
        normal = np.cross(second, third, axis=0)
        parts = [normal, np.cross(third, first, axis=0), np.cross(first, second, axis=0)]
        inverse = np.sum([part * r for part, r in zip(parts, right, strict=True)], axis=0)
        return np.asarray(inverse / np.sum(first * normal, axis=0))
    a = np.sum(columns[0] ** 2, axis=0) + damping
    b = np.sum(columns[0] * columns[1], axis=0)
    c = np.sum(columns[1] ** 2, axis=0) + damping
    return np.asarray(np.stack([c * right[0] - b * right[1], a * right[1] - b * right[0]]) / (a * c - b * b))
