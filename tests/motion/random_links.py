"""Robots of the catalogue with random links."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from derive.robot.description import Inertia, Link
from derive.robot.expression import Expression, number
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot


def decimal(value: float) -> Expression:
    """A number of four decimals."""
    return number(Fraction(round(value * 10000), 10000))


def numbered(name: str) -> Robot:
    """A robot of the catalogue with numbers for its symbols, and links of random possible bodies without rotors.

    Friction grows with what a joint carries: long chains without it are chaotic, and no two methods agree for 10 s.
    """
    robot, random = Robot.load(name), np.random.default_rng(len(name))

    def link(carried: int) -> Link:
        spread = random.normal(size=(3, 3)) / 5
        second = spread @ spread.T + 0.01 * np.eye(3)
        moments = np.trace(second) * np.eye(3) - second
        cells = (decimal(moments[at]) for at in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        com = tuple(decimal(c) for c in random.uniform(-0.2, 0.2, 3))
        armature, viscous = decimal(random.uniform(0.2, 0.4)), decimal(carried * random.uniform(1, 3))
        mass = decimal(random.uniform(1, 3))
        return Link(mass, com, Inertia(*cells), armature=armature, viscous=viscous)  # type: ignore[arg-type]

    gravity = (decimal(0.3), decimal(-9.1), decimal(-2.7))
    dressed = replace(robot, links=tuple(link(robot.n - i) for i in range(robot.n)), gravity=gravity)
    symbols = {symbol: decimal(random.uniform(0.3, 0.9)) for symbol in robot_symbols(dressed)}
    return replace(dressed, parameters=tuple(symbols.items()), runtime=())
