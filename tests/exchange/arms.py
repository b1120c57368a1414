"""Robots of numbers to export: those of the catalogue, as they are or with links of random possible bodies."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from derive.exchange.numeric import with_numbers
from derive.robot.description import Inertia, Link, Motor
from derive.robot.expression import Expression, number
from derive.robot.load import catalogue_names
from derive.robot.names import limit_symbols, number_of, robot_symbols
from derive.robot.robot import Robot

FEW = ("scara-matlab", "skeleton-modified", "stanford-deluca", "puma560-corke")
"""Slides, parallel axes, reversed variables, a base, both conventions."""

EVERY = catalogue_names()


def decimal(value: float) -> Expression:
    return number(Fraction(round(value * 10000), 10000))


def chosen_numbers(robot: Robot) -> dict[str, Expression]:
    """Lengths for the symbols that have none."""
    random = np.random.default_rng(len(robot.name))
    symbols = dict.fromkeys((*robot_symbols(robot), *limit_symbols(robot)))
    return {name: decimal(random.uniform(0.3, 0.9)) for name in symbols if name not in number_of(robot)}


def numeric(name: str) -> Robot:
    robot = Robot.load(name)
    return with_numbers(robot, chosen_numbers(robot))


def dressed(name: str, *, rotors: bool = False, coulomb: bool = False) -> Robot:
    """A robot of the catalogue with random bodies that exist, and without limits."""
    robot, random = numeric(name), np.random.default_rng(len(name))

    def link() -> Link:
        spread = random.normal(size=(3, 3)) / 5
        second = spread @ spread.T + 0.01 * np.eye(3)
        moments = np.trace(second) * np.eye(3) - second
        cells = (decimal(moments[at]) for at in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        x, y, z = (decimal(c) for c in random.uniform(-0.2, 0.2, 3))
        motor = Motor(*(decimal(random.uniform(*ends)) for ends in ((0.1, 0.5), (0.001, 0.002), (-60, 60))))
        return Link(
            decimal(random.uniform(1, 3)),
            (x, y, z),
            Inertia(*cells),
            motor=motor if rotors else None,
            armature=decimal(random.uniform(0.2, 0.4)),
            viscous=decimal(random.uniform(1, 3)),
            coulomb=decimal(random.uniform(1, 3) * coulomb),
        )

    joints = tuple(replace(joint, limits=None) for joint in robot.joints)
    gravity = (decimal(0.3), decimal(-9.1), decimal(-2.7))
    return replace(robot, joints=joints, gravity=gravity, links=tuple(link() for _ in range(robot.n)))
