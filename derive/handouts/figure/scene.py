"""What there is to draw of an arm: axes of frames, joints, links and lengths, in space and still without a view."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from derive.arrays import Array
from derive.robot.description import Convention
from derive.robot.evaluate import evaluate
from derive.robot.expression import names
from derive.robot.robot import Robot

LETTERS = "xyz"

SAME_PLACE = 1e-3  # origins nearer to each other than this part of the arm's size are one place
_SAME_DIRECTION = 0.9998


@dataclass(frozen=True, eq=False)
class FrameAxis:
    """Axes of frames that start at one place, with one direction and one letter."""

    origin: Array  # where they start
    direction: Array  # unit vector
    letter: int  # 0, 1 or 2 for x, y or z
    frames: tuple[int, ...]  # indices of the frames; -1 for an end effector with a frame of its own


@dataclass(frozen=True, eq=False)
class LinkSegment:
    """A straight part of a link."""

    start: Array  # its first point
    end: Array  # its last point
    row: int  # row of the table, from 0; n for the tool
    cell: str  # ``d``, ``a`` or ``tool``

    @property
    def length(self) -> float:
        """Its length."""
        return float(np.linalg.norm(self.end - self.start))


@dataclass(frozen=True, eq=False)
class JointAxis:
    """Where a joint is."""

    anchor: Array  # a point on its axis: o_{i-1} (standard) or the foot of the common normal (modified)
    offset_end: Array  # the other end of its offset d
    direction: Array  # unit vector of z
    revolute: bool  # whether it turns


@dataclass(frozen=True, eq=False)
class Scene:
    """An arm in space."""

    axes: tuple[FrameAxis, ...]  # axes of all frames
    joints: tuple[JointAxis, ...]  # the joints from the base outwards
    segments: tuple[LinkSegment, ...]  # links with a length
    places: Array  # (k, 3) distinct origins and corners of links
    up: tuple[float, float, float]  # what points up
    approach: Array  # direction in which the hand points
    opening: Array  # direction in which the hand opens
    end: Array  # where the hand is
    base_axis: Array  # direction of z of frame 0, along which the pedestal stands

    @property
    def size(self) -> float:
        """Largest distance from the base, 1 for an arm without lengths."""
        return float(np.max(np.linalg.norm(self.places - self.places[0], axis=1))) or 1.0


def arm_scene(robot: Robot, frames: Sequence[Sequence[Sequence[float]]]) -> Scene:
    """The scene of a robot whose frames are known."""
    poses = np.array(frames, dtype=float)
    joints, parts = _links(robot, poses)
    points = np.concatenate([poses[:, :3, 3], np.stack([joint.offset_end for joint in joints])])
    size = float(np.max(np.linalg.norm(points - points[0], axis=1))) or 1.0
    segments = tuple(s for s in parts if s.length > SAME_PLACE * size)
    places: list[Array] = []
    for point in points:
        if all(np.linalg.norm(point - other) > SAME_PLACE * size for other in places):
            places.append(point)
    # The hand continues the last link along an axis of the end effector, or points along z; it opens along y or x.
    end = poses[-1, :3, :3]
    approach = end[:, 2]
    if last := [s for s in segments if s.row >= robot.n - 1]:
        components = end.T @ ((last[-1].end - last[-1].start) / last[-1].length)
        best = int(np.argmax(np.abs(np.round(components, 9))))
        if abs(components[best]) > _SAME_DIRECTION:
            approach = end[:, best] * np.sign(components[best])
    opening = end[:, 1] if abs(approach @ end[:, 1]) < 0.5 else end[:, 0]
    return Scene(
        axes=_axes(poses, SAME_PLACE * size),
        joints=tuple(joints),
        segments=segments,
        places=np.stack(places),
        up=upwards(robot),
        approach=approach,
        opening=opening,
        end=poses[-1, :3, 3],
        base_axis=poses[0, :3, 2],
    )


def upwards(robot: Robot, values: Mapping[str, float] | None = None) -> tuple[float, float, float]:
    """Against gravity where it has a direction, else the world's z axis."""
    vertical = (0.0, 0.0, 1.0)
    cells = robot.gravity or ()
    known = {name: 1.0 for cell in cells for name in names(cell)}
    known |= {name: evaluate(value, {}) for name, value in robot.parameters}
    try:
        gravity = np.array([evaluate(cell, known | dict(values or {})) for cell in cells])
    except ArithmeticError:
        return vertical
    size = float(np.linalg.norm(gravity))
    if size < 1e-9:
        return vertical
    x, y, z = (float(-part / size) for part in gravity)
    return (x, y, z)


def _links(robot: Robot, poses: Array) -> tuple[list[JointAxis], list[LinkSegment]]:
    """Joints and parts of links, from the frames alone: the offset d is what lies along z between two of them."""
    # A link leads along z by d, then along x by a (standard); along x by a, then along z by d (modified).
    joints, parts = [], []
    is_standard = robot.convention is Convention.STANDARD
    for row, joint in enumerate(robot.joints):
        start, end, z = poses[row][:3, 3], poses[row + 1][:3, 3], poses[row if is_standard else row + 1][:3, 2]
        offset = z * (z @ (end - start))
        corner = start + offset if is_standard else end - offset
        joints.append(JointAxis(*((start, corner) if is_standard else (corner, end)), z, joint.is_revolute))
        first, second = "da" if is_standard else "ad"
        parts += [LinkSegment(start, corner, row, first), LinkSegment(corner, end, row, second)]
    return joints, [*parts, LinkSegment(poses[-2, :3, 3], poses[-1, :3, 3], robot.n, "tool")]


def _axes(poses: Array, near: float) -> tuple[FrameAxis, ...]:
    """Axes that would cover each other are one axis with several names."""
    own_end = not np.allclose(poses[-1], poses[-2], atol=1e-9)
    numbered = [*enumerate(poses[:-1]), *([(-1, poses[-1])] if own_end else [])]
    found: list[FrameAxis] = []
    for index, pose in numbered:
        for letter in range(3):
            origin, direction = pose[:3, 3], pose[:3, letter]
            for k, old in enumerate(found):
                along = old.letter == letter and float(old.direction @ direction) > _SAME_DIRECTION
                if along and float(np.linalg.norm(old.origin - origin)) <= near:
                    found[k] = FrameAxis(old.origin, old.direction, letter, (*old.frames, index))
                    break
            else:
                found.append(FrameAxis(origin, direction, letter, (index,)))
    return tuple(found)
