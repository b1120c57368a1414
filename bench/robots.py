"""The robots that are compared, and the numbers at which results are checked."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import numpy.typing as npt

from derive.robot.evaluate import parameter_values
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle

Array = npt.NDArray[np.float64]

FOLDER = Path(__file__).parent / "robots"

COUNTED = (
    "stanford-symbolic",
    "puma560-symbolic",
    "rx90-symbolic",
    "arm-7r-symbolic",
    "puma560-numeric",
    "arm-7r-numeric",
    "stanford-numeric",
    "scara-symbolic",
    "scara-numeric",
    "planar-2r-symbolic",
    "planar-2r-numeric",
)
"""Robots whose operations are counted."""

TIMED = ("puma560-numeric", "arm-7r-numeric")
"""Robots on which evaluation is timed."""


@dataclass(frozen=True)
class Case:
    """A robot, numbers for its free symbols, and configurations.

    Attributes:
        name: Name of its file without the ending.
        robot: The robot.
        numbers: A number for every symbol without one.
    """

    name: str
    robot: Robot
    numbers: dict[str, float]

    @cached_property
    def oracle(self) -> Oracle:
        """The independent recursion with these numbers."""
        return Oracle.of(self.robot, self.numbers)

    @cached_property
    def values(self) -> dict[str, float]:
        """Numbers of all symbols."""
        return {name: float(value) for name, value in parameter_values(self.robot, self.numbers).items()}

    def motions(self, count: int) -> tuple[Array, Array, Array]:
        """Positions, velocities and accelerations, (count, n) each; the same ones in every run."""
        draws = np.random.default_rng(560).uniform(-2.0, 2.0, (3, count, self.robot.n))
        return draws[0], draws[1], draws[2]


def load(name: str) -> Case:
    """A robot of the harness by its file's name."""
    robot = Robot.load(FOLDER / f"{name}.yaml")
    draws = np.random.default_rng(9).uniform(0.2, 1.5, 10_000)
    names = free_symbols(robot)
    return Case(name, robot, dict(zip(names, draws[: len(names)].tolist(), strict=True)))
