"""What there is to draw of an arm or a tree: axes of frames, joints, links, lengths, in space and without a view."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from derive.arrays import Array
from derive.robot import tree
from derive.robot.description import BASE, Convention, FixedRow, Joining, Joint
from derive.robot.evaluate import evaluate
from derive.robot.expression import names
from derive.robot.robot import Robot

LETTERS = "xyz"
Frames = Sequence[Sequence[Sequence[float]]]  # 4x4 each, in the world [m]

SAME_PLACE = 1e-3  # origins nearer to each other than this part of the arm's size are one place
_SAME_DIRECTION = 0.9998


@dataclass(frozen=True, eq=False)
class FrameAxis:
    """Axes of frames that start at one place, with one direction and one letter."""

    origin: Array  # where they start
    direction: Array  # unit vector
    letter: int  # 0, 1 or 2 for x, y or z
    frames: tuple[int, ...]  # numbers of the frames; of ends with frames of their own from behind, the last one -1


@dataclass(frozen=True, eq=False)
class LinkSegment:
    """A straight part of a link."""

    start: Array  # its first point
    end: Array  # its last point
    row: int  # the joint, from 0, or a row without motion behind them; then the ends; of loops from their end, below 0
    cell: str  # ``d``, ``a``, ``mount``, ``tool`` or ``rod``

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
class Hand:
    """What is at an end."""

    end: Array  # where it is
    approach: Array  # direction in which it points
    opening: Array  # direction in which it opens
    joint: int  # the last joint before it, by its place in the scene
    is_fixed: bool  # whether it is one of several on a row without motion, as a head is, and drawn as a ball
    is_pin: bool  # whether a loop is closed where it is, and there is no hand


@dataclass(frozen=True, eq=False)
class Scene:
    """An arm or a tree in space."""

    axes: tuple[FrameAxis, ...]  # axes of all frames
    joints: tuple[JointAxis, ...]  # from the base outwards, but those of a root that moves; then those that close loops
    segments: tuple[LinkSegment, ...]  # links with a length
    places: Array  # (k, 3) distinct origins and corners of links
    up: tuple[float, float, float]  # what points up
    hands: tuple[Hand, ...]  # one at each end
    base_axis: Array | None  # direction of z of frame 0, along which the pedestal stands; None under a root that moves

    @property
    def size(self) -> float:
        """Largest distance from the base, 1 for an arm without lengths."""
        return float(np.max(np.linalg.norm(self.places - self.places[0], axis=1))) or 1.0


def arm_scene(robot: Robot, frames: Frames) -> Scene:
    """The scene of a robot whose frames are known."""
    poses = np.array(frames, dtype=float)
    joints, corners, parts = _links(robot, poses)
    shown = [*_numbers(robot), *range(-len(tree.ends(robot)), 0)]
    points = np.concatenate([poses[shown, :3, 3], np.stack(corners)])
    size = float(np.max(np.linalg.norm(points - points[0], axis=1))) or 1.0
    segments = tuple(s for s in parts if s.length > SAME_PLACE * size)
    places: list[Array] = []
    for point in points:
        if all(np.linalg.norm(point - other) > SAME_PLACE * size for other in places):
            places.append(point)
    return Scene(
        axes=_axes(robot, poses, SAME_PLACE * size),
        joints=tuple(joints),
        segments=segments,
        places=np.stack(places),
        up=upwards(robot),
        hands=tuple(_hands(robot, poses, segments)),
        base_axis=None if robot.root else poses[0, :3, 2],
    )


def _numbers(robot: Robot) -> list[int]:
    """The frames that are drawn, ends left out: none between the coordinates of a root that moves."""
    return [0, *range(len(robot.root.variables) + 1 if robot.root else 1, len(tree.labels(robot)))]


def _hands(robot: Robot, poses: Array, segments: Sequence[LinkSegment]) -> Iterator[Hand]:
    # A hand continues the last link along an axis of its end, or points along z; it opens along y or x.
    labels, ends = tree.labels(robot)[1:], tree.ends(robot)
    for k, end in enumerate(ends):
        frame = poses[k - len(ends), :3, :3]
        approach = frame[:, 2]
        if last := [s for s in segments if s.row in (labels.index(end.after), len(labels) + k)]:
            components = frame.T @ ((last[-1].end - last[-1].start) / last[-1].length)
            best = int(np.argmax(np.abs(np.round(components, 9))))
            if abs(components[best]) > _SAME_DIRECTION:
                approach = frame[:, best] * np.sign(components[best])
        opening = frame[:, 1] if abs(approach @ frame[:, 1]) < 0.5 else frame[:, 0]
        joint = tree.way_to(robot, end.after).joint - (len(robot.root.variables) if robot.root else 0)
        is_fixed = bool(end.name) and labels.index(end.after) >= robot.n
        place = poses[k - len(ends), :3, 3]
        is_pin = any(np.allclose(pin[:3, 3], place, atol=1e-9) for _, pin in _pins(robot, poses))
        yield Hand(place, approach, opening, joint, is_fixed, is_pin)


def _pins(robot: Robot, poses: Array, side: int = 0) -> Iterator[tuple[Joining, Array]]:
    """Where loops are closed, and by what."""
    frames = dict(zip(tree.labels(robot), poses, strict=False))
    return ((loop.by, frames.get(loop.join[side], poses[0])) for loop in robot.loops)


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
    if (size := float(np.linalg.norm(gravity))) < 1e-9:
        return vertical
    x, y, z = (float(-part / size) for part in gravity)
    return (x, y, z)


def _links(robot: Robot, poses: Array) -> tuple[list[JointAxis], list[Array], list[LinkSegment]]:
    """Joints, corners and parts of links, from frames alone: the offset d is what lies along z between two of them."""
    # A link leads along z by d, then along x by a (standard); along x by a, then along z by d (modified).
    joints, corners, parts = [], [], []
    is_standard, labels = robot.convention is Convention.STANDARD, tree.labels(robot)
    starts, before = poses[len(labels) :] if robot.is_tree else poses, tree.antecedents(robot)
    rows: tuple[Joint | FixedRow, ...] = (*robot.joints, *robot.fixed)
    for row in (number - 1 for number in _numbers(robot)[1:] if labels[number] != BASE):
        start, end = starts[row][:3, 3], poses[row + 1][:3, 3]
        z = (starts[row] if is_standard else poses[row + 1])[:3, 2]
        offset = z * (z @ (end - start))
        corner = start + offset if is_standard else end - offset
        corners.append(corner)
        if row < robot.n:
            offset_ends = (start, corner) if is_standard else (corner, end)
            joints.append(JointAxis(*offset_ends, z, robot.joints[row].is_revolute))
        first, second = "da" if is_standard else "ad"
        parts.append(LinkSegment(poses[labels.index(before[rows[row].label]), :3, 3], start, row, "mount"))
        parts += [LinkSegment(start, corner, row, first), LinkSegment(corner, end, row, second)]
    pins = (pin for by, pin in _pins(robot, poses) if by is Joining.REVOLUTE)
    joints += [JointAxis(pin[:3, 3], pin[:3, 3], pin[:3, 2], revolute=True) for pin in pins]
    sides = zip(_pins(robot, poses), _pins(robot, poses, 1), strict=True)
    for k, ((by, one), (_, other)) in enumerate(sides, -len(robot.loops)):
        parts += [LinkSegment(one[:3, 3], other[:3, 3], k, "rod")] if by is Joining.DISTANCE else []
    for k, tool in enumerate(tree.ends(robot)):
        tip = poses[k - len(tree.ends(robot)), :3, 3]
        parts.append(LinkSegment(poses[labels.index(tool.after), :3, 3], tip, len(rows) + k, "tool"))
    return joints, corners, parts


def _axes(robot: Robot, poses: Array, near: float) -> tuple[FrameAxis, ...]:
    """Axes that would cover each other are one axis with several names."""
    ends, labels = tree.ends(robot), tree.labels(robot)
    numbered = [(number, poses[number]) for number in _numbers(robot)]
    for k, end in enumerate(ends, -len(ends)):
        numbered += [] if np.allclose(poses[k], poses[labels.index(end.after)], atol=1e-9) else [(k, poses[k])]
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
