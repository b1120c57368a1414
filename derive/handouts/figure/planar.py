"""Planar arms, which are seen as they are: from a point far away on the normal of their plane."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from derive.arrays import Array
from derive.handouts.figure.projection import View
from derive.handouts.figure.scene import Scene

_SAME = 1e-6  # difference of two unit vectors below which they are one, and of heights relative to the arm's size
_TOP = 89.999  # elevation from which an arm in a horizontal plane is seen, x to the right [degrees]


def plane_normal(scenes: Sequence[Scene]) -> Array | None:
    """The unit normal of the plane in which an arm moves; None where it moves in space, or along a line alone."""
    normals = [normal for normal in map(_normal, scenes) if normal is not None]
    if len(normals) < len(scenes) or any(np.linalg.norm(np.cross(normals[0], other)) > _SAME for other in normals):
        return None
    heights = np.concatenate([scene.places @ normals[0] for scene in scenes])
    return normals[0] if np.ptp(heights) <= _SAME * scenes[0].size else None


def _normal(scene: Scene) -> Array | None:
    """What all revolute joints turn about and no prismatic one goes along."""
    turning = [joint.direction for joint in scene.joints if joint.revolute]
    sliding = [joint.direction for joint in scene.joints if not joint.revolute]
    crossed = turning if turning else [np.cross(sliding[0], other) for other in sliding[1:]]
    normal = max(crossed, key=lambda vector: float(vector @ vector), default=np.zeros(3))
    size = float(np.linalg.norm(normal))
    if size < _SAME:
        return None
    normal = normal / size
    turns = all(np.linalg.norm(np.cross(normal, axis)) < _SAME for axis in turning)
    return normal if turns and all(abs(normal @ axis) < _SAME for axis in sliding) else None


def view_along(normal: Array, up: tuple[float, float, float]) -> View:
    """A plane as it is."""
    above = np.array(up)
    height = float(normal @ above)
    if abs(height) > 0.99:
        return View(math.radians(-90.0), math.radians(_TOP), up)
    first = np.array((1.0, 0.0, 0.0)) if abs(above[0]) < 0.9 else np.array((0.0, 1.0, 0.0))
    first = first - above * (first @ above)
    second = np.cross(above, first)
    return View(math.atan2(float(normal @ second), float(normal @ first)), math.asin(height), up)
