"""Analytic Jacobians: velocity of the end effector and rates of its orientation angles.

Both kinds of angles begin with a turn about the world's z axis, and the direction u = (x, y, z) that their second turn
tilts, column 1 of R for roll, pitch, yaw and column 3 for Euler ZYZ, says it all: with omega the angular velocity,

    about = (x omega_x + y omega_y) / (x^2 + y^2),    across = (x omega_y - y omega_x) / sqrt(x^2 + y^2),

the rates are (roll, pitch, yaw) = (about, across, omega_z - z about) and (phi, theta, psi) = (omega_z - z about,
across, about). Where x = y = 0 the angles are singular and their rates infinite or not a number (Siciliano et al.,
Robotics, section 3.6).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, Self, TypeVar

from derive.mechanics.forward_dynamics import Field
from derive.mechanics.vectors import Vector


class RootField(Field, Protocol):
    """A scalar that can divide and has square roots."""

    def __rtruediv__(self, other: Any, /) -> Self:
        """Other over self."""

    def sqrt(self) -> Self:
        """The square root."""


R = TypeVar("R", bound=RootField)

RPY, ZYZ = "rpy", "zyz"
TILTED = {RPY: 0, ZYZ: 2}
"""Column of R that the second turn tilts."""


def analytic_jacobian(kind: str, tilted: Vector[R], jacobian: Sequence[Sequence[R]]) -> list[list[R]]:
    """J_A(q), 6xn: rows of velocity, then of the rates of the angles, roll, pitch, yaw or phi, theta, psi.

    Args:
        kind: `RPY` or `ZYZ`.
        tilted: Column ``TILTED[kind]`` of the end effector's rotation; its first two entries are not both zero.
        jacobian: The geometric Jacobian, 6xn, world frame.
    """
    x, y, z = tilted
    square = x * x + y * y
    inverse, inverse_root = 1 / square, 1 / square.sqrt()
    along, aside = (inverse * x, inverse * y), (inverse_root * x, inverse_root * y)
    rates: list[list[R]] = []
    for wx, wy, wz in zip(*jacobian[3:], strict=True):
        about = along[0] * wx + along[1] * wy
        across = aside[0] * wy - aside[1] * wx
        turn = wz - z * about
        rates.append([about, across, turn] if kind == RPY else [turn, across, about])
    return [*(list(row) for row in jacobian[:3]), *(list(row) for row in zip(*rates, strict=True))]
