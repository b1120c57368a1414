"""A base that moves by formulas of time, as the root of a skeleton does (document 001, slides 25 to 29)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from sympy import Expr, Integer, Matrix, cos, eye, sin

from derive.arrays import Array
from derive.plans.cells import PlanCells
from derive.plans.hermite import TIME
from derive.plans.profile import Curve
from derive.robot.expression import Expression
from derive.robot.reading.document import Document, KeyPath

KEPT = 8  # single times whose transforms are kept: plant and controller ask for the same
# Where a plan has the formulas of its position and its angles.
PATHS: dict[str, KeyPath] = {
    **{key: ("base", key) for key in ("x", "y", "z")},
    **{angle: ("base", "rpy", k) for k, angle in enumerate(("roll", "pitch", "yaw"))},
}


@dataclass(frozen=True, slots=True)
class MovingBase:
    """Where the base of the robot file stands in the world."""

    place: tuple[Expression, ...]  # x, y, z as formulas of t [m]
    angles: tuple[Expression, ...]  # roll, pitch, yaw as formulas of t [rad]: R = Rz(yaw) Ry(pitch) Rx(roll)


def read_base(document: Document, numbers: PlanCells) -> MovingBase | None:
    """The block ``base`` of a plan; None where the base stands still."""
    if document.find(("base",)) is None:
        return None
    lengths, angles = list(PATHS.values())[:3], list(PATHS.values())[3:]
    return MovingBase(
        tuple(numbers.formula(path, numbers.cells.length) for path in lengths),
        tuple(numbers.formula(path, numbers.cells.angle) for path in angles),
    )


@dataclass(frozen=True)
class BaseCurve:
    """The transform of a moving base and its derivatives, exact."""

    transform: Matrix  # from the base of the robot file to the world, (4, 4), in the symbol `TIME`

    @classmethod
    def of(cls, place: tuple[Expr, ...], angles: tuple[Expr, ...]) -> BaseCurve:
        """The transform of formulas."""
        (ca, sa), (cb, sb), (cc, sc) = ((cos(angle), sin(angle)) for angle in angles)
        roll = Matrix([[1, 0, 0], [0, ca, -sa], [0, sa, ca]])
        pitch = Matrix([[cb, 0, sb], [0, 1, 0], [-sb, 0, cb]])
        yaw = Matrix([[cc, -sc, 0], [sc, cc, 0], [0, 0, 1]])
        whole = eye(4)
        whole[:3, :3], whole[:3, 3] = yaw * pitch * roll, Matrix(place)
        return cls(whole)

    def __call__(self, t: Array, order: int) -> Array:
        """The transform, or a derivative of it by time."""
        return np.stack([curve.sampled(t, order) for curve in self._curves], axis=-1).reshape(-1, 4, 4)

    @cached_property
    def single(self) -> Callable[[float], tuple[list[list[float]], ...]]:
        """Transform, rate and second derivative at one time, as rows; what was asked last is kept."""
        return lru_cache(KEPT)(lambda t: tuple(self(np.array([t]), order)[0].tolist() for order in range(3)))

    @cached_property
    def _curves(self) -> list[Curve]:
        rates = [(entry, entry.diff(TIME)) for entry in self.transform]
        return [Curve(Integer(0), Integer(1), (entry, rate, rate.diff(TIME))) for entry, rate in rates]
