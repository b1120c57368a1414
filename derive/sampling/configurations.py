"""Configurations by their numbers: whoever asks for number k gets the same one, in whatever order and company."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, pi

import numpy as np

from derive.arrays import Array
from derive.errors import DeriveError, RobotFileError, listed
from derive.programs.program import WIDTHS
from derive.robot.robot import Robot
from derive.targets.target import joint_bounds, joint_limits

BLOCK = 8192
"""Configurations that are drawn, evaluated and reduced together, always the same ones: then nothing else matters."""

# What arguments of functions other than q are called where a bound of them is asked for.
BOUNDS: Mapping[str, str] = {"qd": "speed", "qdd": "qdd", "tau": "tau", "h": "wrench"}


@dataclass(frozen=True, slots=True)
class Configurations:
    """Arguments of functions: q and others, uniformly random between bounds, or q on a grid."""

    low: Mapping[str, tuple[float, ...]]  # lower bounds by argument, q first
    high: Mapping[str, tuple[float, ...]]
    number: int
    seed: int
    points: tuple[int, ...] = ()  # of the grid along each variable; empty for random ones

    @property
    def blocks(self) -> int:
        """How many blocks there are; the last one may be shorter."""
        return -(-self.number // BLOCK)

    def block(self, index: int) -> dict[str, Array]:
        """Arguments of a block by name, (rows, width) each.

        Philox (Salmon et al. 2011) is a cipher of a counter: block k has the numbers from k 2^64 on.
        """
        rows = min(BLOCK, self.number - index * BLOCK)
        widths = [len(bounds) for bounds in self.low.values()]
        generator = np.random.Generator(np.random.Philox(key=self.seed, counter=[0, index, 0, 0]))
        shares = generator.random((rows, sum(widths)))
        if self.points:
            places = np.unravel_index(index * BLOCK + np.arange(rows), self.points)
            for column, (place, count) in enumerate(zip(places, self.points, strict=True)):
                shares[:, column] = place / (count - 1) if count > 1 else 0.5
        parts = np.split(shares, np.cumsum(widths)[:-1], axis=1)
        found = {}
        for (name, low), part in zip(self.low.items(), parts, strict=True):
            found[name] = np.ascontiguousarray(low + (np.subtract(self.high[name], low)) * part)
        return found


def ranges(
    robot: Robot, arguments: Iterable[str], bounds: Mapping[str, float | Sequence[float] | None]
) -> tuple[dict[str, tuple[float, ...]], dict[str, tuple[float, ...]], tuple[str, ...]]:
    """Lower and upper bounds of q within its limits and of other arguments [SI units], and what was assumed."""
    pairs, remarks = [], []
    for variable, pair in zip(robot.variables, joint_limits(robot), strict=True):
        if pair is None and not variable.is_revolute:
            found, remedy = f"{variable.label} of {robot.name} slides without limits", "give it limits: [lower, upper]"
            raise RobotFileError(found, remedy=f"{remedy} in the robot file")
        if pair is None:
            remarks.append(f"{variable.label} has no limits: a full turn")
        pairs.append(pair or (-pi, pi))
    low = {"q": tuple(pair[0] for pair in pairs)}
    high = {"q": tuple(pair[1] for pair in pairs)}
    for name in (name for name in BOUNDS if name in {*arguments}):
        high[name] = _bound(robot, name, bounds.get(BOUNDS[name]))
        low[name] = tuple(-value for value in high[name])
    return low, high, tuple(remarks)


def _bound(robot: Robot, name: str, given: float | Sequence[float] | None) -> tuple[float, ...]:
    """The largest magnitudes of an argument: one for all entries, one for each, or the robot file's own."""
    width, option = WIDTHS.get(name, robot.dof), BOUNDS[name]
    own = joint_bounds(robot).get({"qd": "SPEED_LIMITS", "tau": "TORQUE_LIMITS"}.get(name, ""), (None,))
    values = [given] if isinstance(given, float | int) else own if given is None else given
    found = [float(value) for value in values if value is not None]
    if given is None and len(found) < len(own):
        raise DeriveError(f"{name} has no bounds", remedy=f"give --{option}: one number or {width} [SI units]")
    found = found * width if len(found) == 1 else found
    if len(found) != width or not all(value >= 0 and isfinite(value) for value in found):
        text = listed(f"{value:g}" for value in found)
        raise DeriveError(f"--{option} {text}", allowed=f"allowed: one number from 0 on, or {width}")
    return tuple(found)


def grid(number: int, variables: int) -> tuple[int, ...]:
    """Points of a grid along each variable: as many as ``number`` allows, equally many along each."""
    most = max(round(number ** (1.0 / variables)), 1)
    return (most if most**variables <= number else most - 1,) * variables
