"""A base that moves by formulas of time, as the root of a skeleton does (document 001, slides 25 to 29)."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from sympy import Expr, Integer, Matrix, cos, eye, sin

from derive.errors import near_miss
from derive.motion.hermite import TIME, Array
from derive.motion.profile import Curve
from derive.robot.cells import Cells
from derive.robot.document import Document, KeyPath
from derive.robot.expression import ZERO, Expression, names

PLACES = ("x", "y", "z")
"""Keys of its position."""

ANGLES = ("roll", "pitch", "yaw")
"""Names of its angles."""


@dataclass(frozen=True, slots=True)
class MovingBase:
    """Where the base of the robot file stands in the world.

    Attributes:
        place: x, y, z as formulas of t [m].
        angles: Roll, pitch, yaw as formulas of t [rad]: R = Rz(yaw) Ry(pitch) Rx(roll).
    """

    place: tuple[Expression, ...]
    angles: tuple[Expression, ...]


def read_base(document: Document, cells: Cells, known: Collection[str]) -> MovingBase | None:
    """The block ``base`` of a plan.

    Args:
        document: The plan.
        cells: Its cells.
        known: Symbols that formulas may have, t among them.

    Returns:
        The base; None where it stands still.

    Raises:
        RobotFileError: A formula has a symbol without a number.
    """

    def _formula(path: KeyPath, read: Callable[[KeyPath], Expression]) -> Expression:
        value = read(path) if document.scalar(path) else ZERO
        for name in names(value):
            if name not in known:
                remedy = near_miss(name, known) or f"write values: {{{name}: ...}}"
                raise document.error(path, f"the symbol '{name}' has no number", remedy=remedy)
        return value

    if document.find(("base",)) is None:
        return None
    place = tuple(_formula(("base", key), cells.length) for key in PLACES)
    return MovingBase(place, tuple(_formula(("base", "rpy", k), cells.angle) for k in range(3)))


@dataclass(frozen=True)
class BaseCurve:
    """The transform of a moving base and its derivatives, exact.

    Attributes:
        transform: From the base of the robot file to the world, (4, 4), in the symbol `TIME`.
    """

    transform: Matrix

    @classmethod
    def of(cls, place: tuple[Expr, ...], angles: tuple[Expr, ...]) -> BaseCurve:
        """The transform of formulas.

        Args:
            place: x, y, z.
            angles: Roll, pitch, yaw.
        """
        (ca, sa), (cb, sb), (cc, sc) = ((cos(angle), sin(angle)) for angle in angles)
        roll = Matrix([[1, 0, 0], [0, ca, -sa], [0, sa, ca]])
        pitch = Matrix([[cb, 0, sb], [0, 1, 0], [-sb, 0, cb]])
        yaw = Matrix([[cc, -sc, 0], [sc, cc, 0], [0, 0, 1]])
        whole = eye(4)
        whole[:3, :3], whole[:3, 3] = yaw * pitch * roll, Matrix(place)
        return cls(whole)

    def __call__(self, t: Array, order: int) -> Array:
        """The transform, or a derivative of it by time.

        Args:
            t: Times [s], (times,).
            order: 0, 1 or 2.

        Returns:
            (times, 4, 4).
        """
        return np.stack([curve.sampled(t, order) for curve in self._curves], axis=-1).reshape(-1, 4, 4)

    @cached_property
    def _curves(self) -> list[Curve]:
        rates = [(entry, entry.diff(TIME)) for entry in self.transform]
        return [Curve(Integer(0), Integer(1), (entry, rate, rate.diff(TIME))) for entry, rate in rates]
