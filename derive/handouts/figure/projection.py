"""Orthographic views: the choice of the direction from which an arm is drawn, and its faces as areas on the page."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import repeat
from operator import itemgetter
from typing import Any

import numpy as np

from derive.arrays import Array
from derive.handouts.figure.drawing import Color, Path, Point
from derive.handouts.figure.scene import Scene
from derive.handouts.figure.solids import OUTLINE, Faces, shade

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
        second = np.cross(up, first)
        flat = math.cos(self.azimuth) * first + math.sin(self.azimuth) * second
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


def best_view(
    origins: Array, stars: Sequence[Array], segments: Sequence[Array], up: tuple[float, float, float]
) -> View:
    """The view in which axes, links and origins are told apart best; ties go to the usual directions.

    A star is the unit vectors of the axes that start at one place, (m, 3); a segment a link with a length, (2, 3).
    """
    views = [View(math.radians(a), math.radians(e), up) for e in ELEVATIONS for a in AZIMUTHS]
    costs = []
    for view in views:
        # Axes that crowd, links seen from their end, origins that nearly meet on the page, an unusual direction.
        axes = 0.0
        for star in stars:  # arrows from one point: small angles between them, and arrows that point at the reader
            x, y, _ = view.project(star).T
            angles = np.sort(np.arctan2(y, x))
            gaps = np.diff(np.append(angles, angles[0] + 2 * math.pi))
            short = float(np.sum(np.exp(-((np.hypot(x, y) / 0.3) ** 2))))
            close = float(np.sum(np.exp(-((gaps / _NARROW) ** 2)))) if len(star) > 1 else 0.0
            axes += short + close
        links = 0.0
        for start, end in segments:
            ratio = float(np.hypot(*view.project(end - start)[:2]) / np.linalg.norm(end - start))
            links += math.exp(-((ratio / 0.45) ** 2)) + 0.3 * (1.0 - ratio)
        meeting = 0.0
        if len(origins) > 1:
            size = float(np.max(np.linalg.norm(origins - origins[0], axis=1))) or 1.0
            flat = view.project(origins)[:, :2] / size
            apart = np.linalg.norm(flat[:, None] - flat[None, :], axis=-1)[np.triu_indices(len(origins), 1)]
            meeting = float(np.mean(np.exp(-((apart / 0.12) ** 2)))) * len(origins) / 3
        azimuth, elevation = math.degrees(view.azimuth), math.degrees(view.elevation)
        away = min(max(low - azimuth, azimuth - high, 0.0) for low, high in _LIKED_AZIMUTHS)
        unusual = 0.012 * min(away, 60.0) + 0.01 * abs(elevation - _LIKED_ELEVATION)
        cost = axes / max(1, len(stars)) + 2.0 * (links / max(1, len(segments))) + 1.5 * meeting + unusual
        costs.append(round(cost, 6))
    return views[int(np.argmin(costs))]


# -- planar arms, which are seen as they are: from a point far away on the normal of their plane


def plane_normal(scenes: Sequence[Scene]) -> Array | None:
    """The unit normal of the plane in which an arm moves; None where it moves in space, or along a line alone."""
    normals: list[Array] = []
    for scene in scenes:  # what all revolute joints turn about and no prismatic one goes along
        turning = [joint.direction for joint in scene.joints if joint.revolute]
        sliding = [joint.direction for joint in scene.joints if not joint.revolute]
        crossed = turning if turning else [np.cross(sliding[0], other) for other in sliding[1:]]
        longest = max(crossed, key=lambda vector: float(vector @ vector), default=np.zeros(3))
        size = float(np.linalg.norm(longest))
        if size < _SAME:
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
    height = float(normal @ np.array(up))
    if abs(height) > 0.99:
        return View(math.radians(-90.0), math.radians(_TOP), up)
    second, _, first = View(0.0, 0.0, up).rows  # horizontal, at azimuths of 90 and 0 degrees
    return View(math.atan2(float(normal @ second), float(normal @ first)), math.asin(height), up)


# -- faces on the page

# x and y of the corners on the page one after the other, the colour in between, and the faces of which it is one.
Area = tuple[list[float], Color, Faces]


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
