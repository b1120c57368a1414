"""Solid shapes as shaded faces in space: cylinders, boxes, tubes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from derive.emit.figure.drawing import Color

Array = npt.NDArray[np.float64]

LIGHT = np.array((-0.35, 0.75, 0.56))
"""Direction of the light: right, up, towards the viewer."""

OUTLINE: Color = (0.25, 0.25, 0.28)


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


def perpendicular(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors normal to a unit vector and to each other."""
    smallest = int(np.argmin(np.abs(np.round(axis, 9))))
    first = np.cross(axis, np.eye(3)[smallest])
    first = first / np.linalg.norm(first)
    return first, np.cross(axis, first)


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
    u, v = perpendicular(axis)
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


def tube(start: Array, end: Array, radius: float, color: Color, piece: float = 8.0) -> Iterator[Face]:
    """A thin cylinder in short pieces, so that each piece finds its place in depth."""
    length = float(np.linalg.norm(end - start))
    count = max(1, math.ceil(length / piece))
    for k in range(count):
        low, high = start + (end - start) * (k / count), start + (end - start) * ((k + 1) / count)
        yield from prism(low, high, radius, color, sides=10, caps=False)


def ball(center: Array, radius: float, color: Color) -> Iterator[Face]:
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


def shade(color: Color, normal: Array | None) -> Color:
    """A colour as light falls on it.

    Args:
        color: Of the material.
        normal: In the axes of the view: right, up, towards the viewer.
    """
    if normal is None:
        return color
    light = max(0.0, float(normal @ LIGHT))
    strength = 0.62 + 0.45 * light
    red, green, blue = (min(1.0, round(part * strength, 3)) for part in color)
    return red, green, blue
