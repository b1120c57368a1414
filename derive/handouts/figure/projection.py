"""Orthographic views: the choice of the direction from which an arm is drawn, and its faces as areas on the page."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise, product, repeat
from operator import itemgetter
from typing import Any

import numpy as np

from derive.arrays import Array
from derive.handouts.figure.drawing import Color, Path, Point
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
        faces += [_tube(anchor, center, 0.8 * sizes.tube, LINK)] if _length(center - anchor) > 1e-6 else []
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
    around = [((low, left), (low, right), (high, right), (high, left)) for (low, high), (left, right) in patches]
    corners = [[_on_sphere(*place) for place in places] for places in around]
    normals = [_on_sphere((low + high) / 2, (left + right) / 2) for (low, high), (left, right) in patches]
    return np.array(corners), np.array(normals)


def _on_sphere(polar: float, azimuth: float) -> tuple[float, float, float]:
    return math.sin(polar) * math.cos(azimuth), math.sin(polar) * math.sin(azimuth), math.cos(polar)


# -- orthographic views

ELEVATIONS = (20, 28, 36)  # candidate heights of the viewer above the horizon [degrees]
AZIMUTHS = tuple(range(-170, 190, 10))  # candidate directions of the viewer around the vertical [degrees]
_LIKED_AZIMUTHS = ((-75, -30), (20, 65))
_LIKED_ELEVATION = 24
_NARROW = math.radians(16.0)  # axes nearer to each other on the page are hard to tell apart
_GRAZING = 1e-6  # a face whose normal points less towards the viewer is not seen
_SAME = 1e-6  # difference of two unit vectors below which they are one, and of heights relative to the arm's size
_TOP = 89.999  # elevation from which an arm in a horizontal plane is seen, x to the right [degrees]


@dataclass(frozen=True, eq=False)
class View:
    """A direction to look from; parallel lines stay parallel."""

    azimuth: float  # of the viewer around ``up``, from the world's x axis [rad]
    elevation: float  # of the viewer above the plane normal to ``up`` [rad]
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)  # unit vector that points up on the page

    @cached_property
    def rows(self) -> Array:
        """Unit vectors to the right, upwards on the page and towards the viewer, (3, 3)."""
        up = np.array(self.up)
        first = np.array((1.0, 0.0, 0.0)) if abs(up[0]) < 0.9 else np.array((0.0, 1.0, 0.0))
        first = first - up * (first @ up)
        first = first / np.linalg.norm(first)
        flat = math.cos(self.azimuth) * first + math.sin(self.azimuth) * np.cross(up, first)
        toward = math.cos(self.elevation) * flat + math.sin(self.elevation) * up
        right = np.cross(up, toward)
        right = right / np.linalg.norm(right)
        return np.stack([right, np.cross(toward, right), toward])

    def project(self, points: Any) -> Array:
        """Right, up and depth (larger is nearer) of points or directions."""
        return np.asarray(np.asarray(points, dtype=float) @ self.rows.T)

    def flat(self, point: Array) -> Point:
        """Where a point is on the page."""
        x, y, _ = self.project(point)
        return float(x), float(y)


def best_view(places: Array, stars: Sequence[Array], segments: Sequence[Array], up: tuple[float, float, float]) -> View:
    """The view in which axes, links and places are told apart best; ties go to the usual directions.

    A star is the unit vectors of the axes that start at one place, (m, 3); a segment a link with a length, (2, 3).
    """
    views = [View(math.radians(a), math.radians(e), up) for e in ELEVATIONS for a in AZIMUTHS]
    page = np.stack([view.rows[:2].T for view in views])  # to the right and upwards, (views, 3, 2)
    # Axes that crowd, links seen from their end, origins that nearly meet on the page, an unusual direction.
    axes, links, meeting = np.zeros(len(views)), np.zeros(len(views)), np.zeros(len(views))
    for star in stars:  # arrows from one point: small angles between them, and arrows that point at the reader
        x, y = np.moveaxis(star @ page, -1, 0)
        angles = np.sort(np.arctan2(y, x), axis=-1)
        gaps = np.diff(angles, append=angles[:, :1] + 2 * math.pi)
        axes += np.exp(-((np.hypot(x, y) / 0.3) ** 2)).sum(axis=-1)
        axes += np.exp(-((gaps / _NARROW) ** 2)).sum(axis=-1) if len(star) > 1 else 0.0
    for start, end in segments:
        ratio = np.hypot(*((end - start) @ page).T) / np.linalg.norm(end - start)
        links += np.exp(-((ratio / 0.45) ** 2)) + 0.3 * (1.0 - ratio)
    if len(places) > 1:
        size = float(np.max(np.linalg.norm(places - places[0], axis=1))) or 1.0
        one, other = np.triu_indices(len(places), 1)
        apart = np.linalg.norm((places[one] - places[other]) @ page, axis=-1) / size
        meeting = np.exp(-((apart / 0.12) ** 2)).mean(axis=-1) * len(places) / 3
    azimuth, elevation = np.degrees([(view.azimuth, view.elevation) for view in views]).T
    away = np.min([np.maximum(np.maximum(low - azimuth, azimuth - high), 0.0) for low, high in _LIKED_AZIMUTHS], axis=0)
    unusual = 0.012 * np.minimum(away, 60.0) + 0.01 * np.abs(elevation - _LIKED_ELEVATION)
    cost = axes / max(1, len(stars)) + 2.0 * (links / max(1, len(segments))) + 1.5 * meeting + unusual
    return views[int(np.argmin(cost.round(6)))]


# -- planar arms, which are seen as they are: from a point far away on the normal of their plane


def plane_normal(scenes: Sequence[Scene]) -> Array | None:
    """The unit normal of the plane in which an arm moves; None where it moves in space, or along a line alone."""
    normals: list[Array] = []
    for scene in scenes:  # what all revolute joints turn about and no prismatic one goes along
        turning = [joint.direction for joint in scene.joints if joint.revolute]
        sliding = [joint.direction for joint in scene.joints if not joint.revolute]
        crossed = turning if turning else [np.cross(sliding[0], other) for other in sliding[1:]]
        longest = max(crossed, key=lambda vector: float(vector @ vector), default=np.zeros(3))
        if (size := float(np.linalg.norm(longest))) < _SAME:
            return None
        normals.append(longest / size)
        turns = all(np.linalg.norm(np.cross(normals[-1], axis)) < _SAME for axis in turning)
        if not turns or any(abs(normals[-1] @ axis) >= _SAME for axis in sliding):
            return None
    if any(np.linalg.norm(np.cross(normals[0], other)) > _SAME for other in normals):
        return None
    heights = np.concatenate([scene.places @ normals[0] for scene in scenes])
    return normals[0] if np.ptp(heights) <= _SAME * scenes[0].size else None


def view_along(normal: Array, up: tuple[float, float, float]) -> View:
    """A plane as it is."""
    if abs(height := float(normal @ np.array(up))) > 0.99:
        return View(math.radians(-90.0), math.radians(_TOP), up)
    second, _, first = View(0.0, 0.0, up).rows  # horizontal, at azimuths of 90 and 0 degrees
    return View(math.atan2(float(normal @ second), float(normal @ first)), math.asin(height), up)


# -- faces on the page

Area = tuple[list[float], Color, Faces]  # x, y of corners on the page in turn, the colour in between, where it is from


def seen(solids: Sequence[Faces], view: View, page: Array | None = None) -> list[Area]:
    """Faces on the page, which maps and shifts them (2, 3), from back to front; those seen from behind are left out."""
    found: list[tuple[float, Area]] = []
    for faces in solids:
        corners = view.project(faces.corners)
        colors = [faces.color] * len(corners)
        if faces.normals is not None:
            normals = view.project(faces.normals)
            towards = normals[:, 2] > _GRAZING
            corners, colors = corners[towards], shade(faces.color, normals[towards])
        depths = np.round(corners[..., 2].mean(axis=1), 4).tolist()
        places = corners[..., :2] if page is None else corners[..., :2] @ page[:, :2].T + page[:, 2]
        flat = places.reshape(len(places), 2 * places.shape[1]).tolist()
        found += zip(depths, zip(flat, colors, repeat(faces, len(flat)), strict=True), strict=True)
    return [area for _, area in sorted(found, key=itemgetter(0))]


def paint(solids: Sequence[Faces], view: View) -> Iterator[Path]:
    """Faces as areas from back to front, those seen from behind left out."""
    for places, color, faces in seen(solids, view):
        edge, width = (OUTLINE, 0.5) if faces.edge else (color, 0.3)
        points = tuple(zip(places[::2], places[1::2], strict=True))
        yield Path(points, closed=True, stroke=edge, fill=color, width=width)
