"""Three-vectors, and the step from one joint axis to the next."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from bench.byhand.axis_arm import Axis, Vector


def plus(u: Vector, v: Vector) -> Vector:
    """u + v."""
    return u[0] + v[0], u[1] + v[1], u[2] + v[2]


def times(k: Any, v: Vector) -> Vector:
    """k v."""
    return k * v[0], k * v[1], k * v[2]


def cross(u: Vector, v: Vector) -> Vector:
    """The vector product of u and v."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def dot(u: Vector, v: Vector) -> Any:
    """The scalar product of u and v."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@dataclass(frozen=True)
class Step:
    """From frame i-1 to frame i.

    Attributes:
        cos_alpha: Of the twist.
        sin_alpha: Of the twist.
        cos: Of the joint's angle.
        sin: Of the joint's angle.
        place: Origin of frame i in frame i-1.
    """

    cos_alpha: Any
    sin_alpha: Any
    cos: Any
    sin: Any
    place: Vector

    def outwards(self, v: Vector) -> Vector:
        """A vector of frame i-1 in the axes of frame i."""
        y = self.cos_alpha * v[1] + self.sin_alpha * v[2]
        z = self.cos_alpha * v[2] - self.sin_alpha * v[1]
        return self.cos * v[0] + self.sin * y, self.cos * y - self.sin * v[0], z

    def inwards(self, v: Vector) -> Vector:
        """A vector of frame i in the axes of frame i-1."""
        x = self.cos * v[0] - self.sin * v[1]
        y = self.sin * v[0] + self.cos * v[1]
        return x, self.cos_alpha * y - self.sin_alpha * v[2], self.sin_alpha * y + self.cos_alpha * v[2]


def step_of(axis: Axis, cos: Any, sin: Any, d: Any) -> Step:
    """The step of a joint at its angle and offset."""
    place = (axis.a, -axis.sin_alpha * d, axis.cos_alpha * d)
    return Step(axis.cos_alpha, axis.sin_alpha, cos, sin, place)
