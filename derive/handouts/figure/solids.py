"""The solid parts of an arm in page units: base, links, joints and hand as shaded faces in space."""

import math
from dataclasses import dataclass
from functools import cache
from itertools import pairwise, product

import numpy as np

from derive.arrays import Array
from derive.handouts.figure.drawing import Color
from derive.handouts.figure.scene import Hand, Scene

LIGHT = np.array((-0.35, 0.75, 0.56))  # direction of the light: right, up, towards the viewer
OUTLINE: Color = (0.25, 0.25, 0.28)
REVOLUTE: Color = (0.62, 0.72, 0.86)
PRISMATIC: Color = (0.93, 0.80, 0.58)
LINK: Color = (0.86, 0.86, 0.84)
BASE: Color = (0.66, 0.66, 0.66)
HAND: Color = (0.45, 0.45, 0.48)

_SHIFTS = (1.25, -1.25, 2.5, -2.5, 3.75)  # places of a joint along its axis, in lengths of a cylinder


class Sizes:
    """How large things are drawn [pt]."""

    def __init__(self, factor: float) -> None:
        self.factor = factor
        self.arrow = (30.0 * factor, 24.0 * factor, 34.0 * factor)  # x, y and z axes; on one line z is still seen
        self.cylinder = (7.0 * factor, 17.0 * factor)  # radius and length of a revolute joint
        self.box = (9.0 * factor, 20.0 * factor)  # half of the diagonal and length of a prismatic joint
        self.tube = 2.6 * factor  # radius of a link


@dataclass(frozen=True, eq=False)
class Faces:
    """Flat faces of one solid with as many corners each."""

    corners: Array  # (faces, k, 3)
    normals: Array | None  # unit vectors out of the solid, (faces, 3); None for faces that are seen from both sides
    color: Color  # before shading
    edge: bool = False  # whether borders are drawn as lines; else a border has the colour of its face


def shade(color: Color, normals: Array) -> list[Color]:
    """A colour as light falls on faces."""
    light = 0.62 + 0.45 * np.maximum(0.0, normals @ LIGHT)
    return list(map(tuple, np.minimum(1.0, np.round(light[:, None] * color, 3)).tolist()))


def prism(start: Array, end: Array, radius: float, color: Color, sides: int = 20) -> list[Faces]:
    """A prism with a regular base, round enough to be a cylinder."""
    axis = (end - start) / _length(end - start)
    ring = _ring(axis, radius, sides)
    ends = Faces(np.stack([start + ring, end + ring]), np.stack([-axis, axis]), color, edge=True)
    return [Faces(*_barrel(np.stack([start, end]), ring), color, edge=sides <= 4), ends]


def _ring(axis: Array, radius: float, sides: int) -> Array:
    """Corners of a regular polygon around an axis, (sides, 3)."""
    u, v = _perpendicular(axis)
    cosines, sines = _turns(sides)
    return radius * (cosines * u + sines * v)


@cache
def _turns(sides: int) -> tuple[Array, Array]:
    """Cosines and sines of the angles of the corners, (sides, 1) each."""
    angles = [2 * math.pi / sides * (k + 0.5) for k in range(sides)]
    return np.array([[math.cos(a)] for a in angles]), np.array([[math.sin(a)] for a in angles])


def _barrel(stops: Array, ring: Array) -> tuple[Array, Array]:
    """Corners and normals of the sides of a tube around a line with stops, (faces, 4, 3) and (faces, 3)."""
    # Side k lies between corners k and k + 1 of the ring at every stop; its normal points to the middle between them.
    following = np.concatenate([ring[1:], ring[:1]])
    around, count = stops[:, None], len(stops) - 1
    right, left = around + ring, around + following
    corners = np.stack([right[:-1], left[:-1], left[1:], right[1:]], axis=2)
    middles = ring + following
    normals = middles / np.sqrt((middles**2).sum(axis=1, keepdims=True))
    return corners.reshape(-1, 4, 3), np.concatenate([normals] * count)


def solid_faces(scene: Scene, scale: float, sizes: Sizes) -> tuple[list[Faces], list[Array]]:
    """All faces of an arm, and lines (k, 3) along its parts that labels should keep off [pt]."""
    faces: list[Faces] = []
    lines: list[Array] = []
    for segment in scene.segments:
        start, end = segment.start * scale, segment.end * scale
        faces += [_tube(start, end, sizes.tube, LINK), *(_ball(place, sizes.tube, LINK) for place in (start, end))]
        lines += _sides(start, end, sizes.tube, _perpendicular((end - start) / _length(end - start)))
    centers = joint_centers(scene, scale, sizes)
    for joint, center in zip(scene.joints, centers, strict=True):
        # A cylinder or a box, for a prismatic joint with the rod that slides in it; a tube to its origin if it is away.
        axis, anchor = joint.direction, joint.anchor * scale
        radius, length = sizes.cylinder if joint.revolute else sizes.box
        start, end = center - axis * length / 2, center + axis * length / 2
        if joint.revolute:
            faces += prism(start, end, radius, REVOLUTE)
        else:
            slide = _tube(center - axis * length, center + axis * length, 0.7 * sizes.tube, LINK)
            faces += [*prism(start, end, radius, PRISMATIC, sides=4), slide]
        if _length(center - anchor) > 1e-6:
            faces.append(_tube(anchor, center, 0.8 * sizes.tube, LINK))
        lines += [np.stack([start, end]), *_sides(start, end, radius, _perpendicular(axis))]
    for hand in (hand for hand in scene.hands if not hand.is_pin):
        parts, sides = _hand(hand, scale, sizes, centers[hand.joint])
        faces += parts
        lines += sides
    if scene.base_axis is not None:
        foot = scene.places[0] * scale - scene.base_axis * sizes.cylinder[1] * 0.55
        faces += prism(foot - scene.base_axis * 4.0 * sizes.factor, foot, 15.0 * sizes.factor, BASE, sides=28)
        rim = faces[-1].corners[1]
        lines.append(np.concatenate([rim, rim[:1]]))
    return faces, lines


def joint_centers(scene: Scene, scale: float, sizes: Sizes) -> list[Array]:
    """Where each joint is drawn, (3,) each [pt]: at its origin, else on its offset, else beside; off the others."""
    # The first option that is more than a cylinder away from all joints before it; else the farthest away.
    length = sizes.cylinder[1]
    centers: list[Array] = []
    for joint in scene.joints:
        start, end = joint.anchor * scale, joint.offset_end * scale
        middle = [(start + end) / 2] if _length(end - start) > 2.5 * length else []
        options = [start, *middle, *(start + joint.direction * shift * length for shift in _SHIFTS)]
        gaps = [min((_length(o - c) for c in centers), default=1e9) for o in options]
        free = [k for k, gap in enumerate(gaps) if gap > 1.05 * length]
        centers.append(options[free[0] if free else int(np.argmax(np.round(gaps, 6)))])
    return centers


def _hand(hand: Hand, scale: float, sizes: Sizes, last: Array) -> tuple[list[Faces], list[Array]]:
    """A ball, or two fingers on a palm ahead of the end, and ahead of a last joint that is drawn there."""
    # A last joint whose cylinder covers the origin of the end effector pushes the hand ahead of it.
    k = sizes.factor
    if hand.is_fixed:
        return [_ball(hand.end * scale, 9.0 * k, HAND)], []
    end, along, across = hand.end * scale, hand.approach, hand.opening
    ahead = float((last - end) @ along)
    covered = ahead + sizes.cylinder[1] / 2 if ahead > 0 and _length(last - end - ahead * along) < 1.0 else 0.0
    palm = end + (covered + 5.0 * k) * along
    tips = end + (covered + 17.0 * k) * along
    lines = [np.stack([end, palm])]
    for side in (-1.0, 1.0):
        shoulder = palm + side * 7.0 * k * across
        lines += [np.stack([palm, shoulder]), np.stack([shoulder, tips + side * 7.0 * k * across])]
    return [face for a, b in lines for face in (_tube(a, b, 1.5 * k, HAND), _ball(b, 1.5 * k, HAND))], lines


def _perpendicular(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors normal to a unit vector and to each other."""
    # e_i x axis for the axis i of the world to which it is most nearly normal, then axis x that
    x, y, z = axis.tolist()
    smallest = min(range(3), key=lambda i: abs(round((x, y, z)[i], 9)))
    first = np.array(((0.0, z, -y), (-z, 0.0, x), (y, -x, 0.0))[smallest])
    first = first / _length(first)
    a, b, c = first.tolist()
    return first, np.array((y * c - z * b, z * a - x * c, x * b - y * a))


def _length(vector: Array) -> float:
    return math.sqrt(vector @ vector)


def _sides(start: Array, end: Array, radius: float, across: tuple[Array, Array]) -> list[Array]:
    """Four lines along a cylinder."""
    u, v = across
    return [np.stack([start + side, end + side]) for side in (radius * u, -radius * u, radius * v, -radius * v)]


def _tube(start: Array, end: Array, radius: float, color: Color, piece: float = 8.0) -> Faces:
    """A thin cylinder in short pieces, so that each piece finds its place in depth."""
    length = _length(end - start)
    count = max(1, math.ceil(length / piece))
    stops = start + (end - start) * (np.arange(count + 1)[:, None] / count)
    return Faces(*_barrel(stops, _ring((end - start) / length, radius, 10)), color)


def _ball(center: Array, radius: float, color: Color) -> Faces:
    """A coarse sphere, for the corners of links."""
    corners, normals = _sphere()
    return Faces(center + radius * corners, normals, color)


@cache
def _sphere() -> tuple[Array, Array]:
    """Corners and normals of the faces of the unit sphere, (32, 4, 3) and (32, 3)."""
    # 4 rings of latitude, 8 of longitude; the normal of a patch is that at its middle
    rings = pairwise(math.pi * k / 4 for k in range(5))
    patches = list(product(rings, list(pairwise(2 * math.pi * k / 8 for k in range(9)))))
    corners = [
        [_on_sphere(low, left), _on_sphere(low, right), _on_sphere(high, right), _on_sphere(high, left)]
        for (low, high), (left, right) in patches
    ]
    normals = [_on_sphere((low + high) / 2, (left + right) / 2) for (low, high), (left, right) in patches]
    return np.array(corners), np.array(normals)


def _on_sphere(polar: float, azimuth: float) -> tuple[float, float, float]:
    return math.sin(polar) * math.cos(azimuth), math.sin(polar) * math.sin(azimuth), math.cos(polar)
