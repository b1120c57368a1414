"""What else a plan says of the arm: other numbers of a simulated one, what pushes its joints, a base that moves."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Self

import numpy as np
from sympy import Expr, Integer, Matrix, cos, eye, sin

from derive.arrays import Array
from derive.errors import listed, near_miss, quoted
from derive.mechanics.vectors import about_axis
from derive.plans.cells import PlanCells
from derive.plans.profile import TIME, Curve
from derive.robot.expression import Expression, to_text
from derive.robot.names import robot_symbols
from derive.robot.reading.document import Document, KeyPath, YamlMapping
from derive.robot.robot import Robot

PAYLOAD = "payload"  # the key of a body among the numbers of the plant
KEPT = 8  # single times whose transforms are kept: plant and controller ask for the same
# Where a plan has the formulas of its position and its angles.
PATHS: dict[str, KeyPath] = {
    **{key: ("base", key) for key in ("x", "y", "z")},
    **{angle: ("base", "rpy", k) for k, angle in enumerate(("roll", "pitch", "yaw"))},
}


@dataclass(frozen=True, slots=True)
class Disturbance:
    """What pushes a joint for a time."""

    joint: int  # index of the joint
    torque: Expression  # torque or force [N m or N]
    start: Expression  # when it begins [s]
    end: Expression  # when it ends [s]


def plant_numbers(document: Document, robot: Robot, numbers: PlanCells) -> dict[str, Expression]:
    """Numbers of symbols that differ in the simulated arm."""
    node, symbols, found = document.find(("plant",)), (*robot_symbols(robot), PAYLOAD), {}
    for name in node.entries if isinstance(node, YamlMapping) else ():
        if name not in symbols:
            text, allowed = f"no symbol {quoted(name)} in {robot.name}", f"allowed: {listed(symbols)}"
            raise document.error(("plant", name), text, allowed, near_miss(name, symbols))
        if name != PAYLOAD:
            found[name] = numbers.plain(("plant", name))
    return found


def disturbances(document: Document, robot: Robot, numbers: PlanCells) -> tuple[Disturbance, ...]:
    """What pushes the joints."""
    variables, found = tuple(joint.variable for joint in robot.variables), []
    for k in range(document.length(("disturbance",))):
        path: KeyPath = ("disturbance", k)
        if (name := document.text(*path, "joint")) not in variables:
            text, allowed = f"no joint {quoted(name)}", f"allowed: {listed(variables)}"
            raise document.error((*path, "joint"), text, allowed, near_miss(name, variables))
        start, torque, end = (numbers.plain((*path, key)) for key in ("start", "torque", "end"))
        if not 0 <= numbers.size(start) < numbers.size(end):
            text = f"from {to_text(start)} to {to_text(end)} s"
            raise document.error((*path, "end"), text, "allowed: an end after the start, neither below zero")
        found.append(Disturbance(variables.index(name), torque, start, end))
    return tuple(found)


# -- a base that moves


def read_base(document: Document, numbers: PlanCells) -> tuple[Expression, ...]:
    """The formulas of the block ``base`` of a plan: x, y, z [m], roll, pitch, yaw [rad]; none of a base that stands."""
    if document.find(("base",)) is None:
        return ()
    kinds = (*[numbers.cells.length] * 3, *[numbers.cells.angle] * 3)
    return tuple(numbers.formula(path, kind) for path, kind in zip(PATHS.values(), kinds, strict=True))


@dataclass(frozen=True)
class BaseCurve:
    """The transform of a moving base and its derivatives, exact."""

    transform: Matrix  # from the base of the robot file to the world, (4, 4), in the symbol `TIME`

    @classmethod
    def of(cls, place: tuple[Expr, ...], angles: tuple[Expr, ...]) -> Self:
        """The transform of formulas."""
        # R = Rz(yaw) Ry(pitch) Rx(roll).
        turns = (about_axis(k, cos(angle), sin(angle), Integer(0), Integer(1)) for k, angle in enumerate(angles))
        roll, pitch, yaw = map(Matrix, turns)
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
