"""The solid parts of an arm in page units: base, links, joints and hand as shaded faces in space."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from derive.handouts.figure.drawing import Array, Color
from derive.handouts.figure.scene import JointAxis, Scene

LIGHT = np.array((-0.35, 0.75, 0.56))
"""Direction of the light: right, up, towards the viewer."""

OUTLINE: Color = (0.25, 0.25, 0.28)
REVOLUTE: Color = (0.62, 0.72, 0.86)
PRISMATIC: Color = (0.93, 0.80, 0.58)
LINK: Color = (0.86, 0.86, 0.84)
BASE: Color = (0.66, 0.66, 0.66)
HAND: Color = (0.45, 0.45, 0.48)

_SHIFTS = (1.25, -1.25, 2.5, -2.5, 3.75)
"""Places of a joint along its axis, in lengths of a cylinder."""


class Sizes:
    """How large things are drawn [pt].

    Args:
        factor: 1, or less where places are close.

    Attributes:
        factor: As given.
        arrow: Lengths of x, y and z axes: z the longest, so that axes on one line can be told apart.
        cylinder: Radius and length of a revolute joint.
        box: Half of the diagonal and length of a prismatic joint.
        tube: Radius of a link.
    """

    def __init__(self, factor: float) -> None:
        self.factor = factor
        self.arrow = (30.0 * factor, 24.0 * factor, 34.0 * factor)
        self.cylinder = (7.0 * factor, 17.0 * factor)
        self.box = (9.0 * factor, 20.0 * factor)
        self.tube = 2.6 * factor


@dataclass(frozen=True, eq=False)
class Face:
    """A flat face.

    Attributes:
        corners: (k, 3).
        normal: Unit vector out of the solid; None for a face that is seen from both sides.
        color: Before shading.
        edge: Whether its border is drawn as a line; else the border has the colour of the face.
    """

    corners: Array
    normal: Array | None
    color: Color
    edge: bool = False


def shade(color: Color, normal: Array | None) -> Color:
    """A colour as light falls on it.

    Args:
        color: Of the material.
        normal: In the axes of the view: right, up, towards the viewer; None for a face without a side.
    """
    if normal is None:
        return color
    strength = 0.62 + 0.45 * max(0.0, float(normal @ LIGHT))
    red, green, blue = (min(1.0, round(part * strength, 3)) for part in color)
    return red, green, blue


def prism(start: Array, end: Array, radius: float, color: Color, sides: int = 20, caps: bool = True) -> Iterator[Face]:
    """A prism with a regular base, round enough to be a cylinder.

    Args:
        start: Centre of one end.
        end: Centre of the other end.
        radius: Of the circle around the base.
        color: Of all its faces.
        sides: Corners of the base.
        caps: Whether it has faces at the ends.
    """
    axis = (end - start) / np.linalg.norm(end - start)
    u, v = _perpendicular(axis)
    turn = 2 * math.pi / sides
    ring = [math.cos(turn * (k + 0.5)) * u + math.sin(turn * (k + 0.5)) * v for k in range(sides)]
    flat = sides <= 4
    for k in range(sides):
        a, b = radius * ring[k], radius * ring[(k + 1) % sides]
        middle = a + b
        corners = np.stack([start + a, start + b, end + b, end + a])
        yield Face(corners, middle / np.linalg.norm(middle), color, edge=flat)
    if caps:
        yield Face(np.stack([start + radius * r for r in ring]), -axis, color, edge=True)
        yield Face(np.stack([end + radius * r for r in ring]), axis, color, edge=True)


def solid_faces(scene: Scene, scale: float, sizes: Sizes) -> tuple[list[Face], list[Array]]:
    """All faces of an arm, and the lines that labels should keep off.

    Args:
        scene: The arm.
        scale: Points per metre.
        sizes: How large things are drawn.

    Returns:
        Faces, and lines (k, 3) along the parts, in points.
    """
    faces: list[Face] = []
    lines: list[Array] = []
    for segment in scene.segments:
        start, end = segment.start * scale, segment.end * scale
        faces += [*_tube(start, end, sizes.tube, LINK), *_ball(start, sizes.tube, LINK), *_ball(end, sizes.tube, LINK)]
        lines += _sides(start, end, sizes.tube, _perpendicular((end - start) / np.linalg.norm(end - start)))
    centers = joint_centers(scene, scale, sizes)
    for joint, center in zip(scene.joints, centers, strict=True):
        solid, along = _joint(joint, center, joint.anchor * scale, sizes)
        faces += solid
        lines += along
    hand, hand_lines = _hand(scene, scale, sizes, centers[-1])
    foot = scene.places[0] * scale - scene.base_axis * sizes.cylinder[1] * 0.55
    thick = scene.base_axis * 4.0 * sizes.factor
    pedestal = list(prism(foot - thick, foot, 15.0 * sizes.factor, BASE, sides=28))
    rim = pedestal[-1].corners
    return [*faces, *hand, *pedestal], [*lines, *hand_lines, np.concatenate([rim, rim[:1]])]


def joint_centers(scene: Scene, scale: float, sizes: Sizes) -> list[Array]:
    """Where each joint is drawn on its axis: at its origin, else on its offset, else beside; off the others.

    Args:
        scene: The arm.
        scale: Points per metre.
        sizes: How large things are drawn.

    Returns:
        The centre of each joint, (3,) in points.
    """
    length = sizes.cylinder[1]
    centers: list[Array] = []
    for joint in scene.joints:
        start, end = joint.anchor * scale, joint.offset_end * scale
        options = [start]
        if float(np.linalg.norm(end - start)) > 2.5 * length:
            options.append((start + end) / 2)
        options += [start + joint.direction * shift * length for shift in _SHIFTS]
        gaps = [min((float(np.linalg.norm(o - c)) for c in centers), default=1e9) for o in options]
        free = [k for k, gap in enumerate(gaps) if gap > 1.05 * length]
        centers.append(options[free[0] if free else int(np.argmax(np.round(gaps, 6)))])
    return centers


def _joint(joint: JointAxis, center: Array, anchor: Array, sizes: Sizes) -> tuple[list[Face], list[Array]]:
    """A cylinder or a box, for a prismatic joint with the rod that slides in it; a tube to its origin if it is away."""
    axis = joint.direction
    radius, length = sizes.cylinder if joint.revolute else sizes.box
    start, end = center - axis * length / 2, center + axis * length / 2
    if joint.revolute:
        faces = list(prism(start, end, radius, REVOLUTE))
    else:
        faces = list(prism(start, end, radius, PRISMATIC, sides=4))
        rod = axis * length
        faces += _tube(center - rod, center + rod, 0.7 * sizes.tube, LINK)
    if float(np.linalg.norm(center - anchor)) > 1e-6:
        faces += _tube(anchor, center, 0.8 * sizes.tube, LINK)
    return faces, [np.stack([start, end]), *_sides(start, end, radius, _perpendicular(axis))]


def _hand(scene: Scene, scale: float, sizes: Sizes, last: Array) -> tuple[list[Face], list[Array]]:
    """Two fingers on a palm ahead of the end effector's origin, and ahead of a last joint that is drawn there."""
    k = sizes.factor
    end, along, across = scene.end * scale, scene.approach, scene.opening
    ahead = float((last - end) @ along)
    beside = float(np.linalg.norm(last - end - ahead * along))
    covered = ahead + sizes.cylinder[1] / 2 if ahead > 0 and beside < 1.0 else 0.0
    palm = end + (covered + 5.0 * k) * along
    tips = end + (covered + 17.0 * k) * along
    lines = [np.stack([end, palm])]
    for side in (-1.0, 1.0):
        shoulder = palm + side * 7.0 * k * across
        lines += [np.stack([palm, shoulder]), np.stack([shoulder, tips + side * 7.0 * k * across])]
    faces: list[Face] = []
    for line in lines:
        faces += [*_tube(line[0], line[1], 1.5 * k, HAND), *_ball(line[1], 1.5 * k, HAND)]
    return faces, lines


def _perpendicular(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors normal to a unit vector and to each other."""
    smallest = int(np.argmin(np.abs(np.round(axis, 9))))
    first = np.cross(axis, np.eye(3)[smallest])
    first = first / np.linalg.norm(first)
    return first, np.cross(axis, first)


def _sides(start: Array, end: Array, radius: float, across: tuple[Array, Array]) -> list[Array]:
    """Four lines along a cylinder."""
    u, v = across
    sides = (radius * u, -radius * u, radius * v, -radius * v)
    return [np.stack([start + side, end + side]) for side in sides]


def _tube(start: Array, end: Array, radius: float, color: Color, piece: float = 8.0) -> Iterator[Face]:
    """A thin cylinder in short pieces, so that each piece finds its place in depth."""
    length = float(np.linalg.norm(end - start))
    count = max(1, math.ceil(length / piece))
    for k in range(count):
        low, high = start + (end - start) * (k / count), start + (end - start) * ((k + 1) / count)
        yield from prism(low, high, radius, color, sides=10, caps=False)


def _ball(center: Array, radius: float, color: Color) -> Iterator[Face]:
    """A coarse sphere, for the corners of links."""
    rings = [math.pi * k / 4 for k in range(5)]
    turns = [2 * math.pi * k / 8 for k in range(9)]
    for low, high in pairwise(rings):
        for left, right in pairwise(turns):
            corners = [_on_sphere(low, left), _on_sphere(low, right), _on_sphere(high, right), _on_sphere(high, left)]
            normal = _on_sphere((low + high) / 2, (left + right) / 2)
            yield Face(center + radius * np.stack(corners), normal, color)


def _on_sphere(polar: float, azimuth: float) -> Array:
    return np.array((math.sin(polar) * math.cos(azimuth), math.sin(polar) * math.sin(azimuth), math.cos(polar)))
