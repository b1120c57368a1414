"""Arms of slanted, parallel and sliding axes with bodies."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from derive.robot.description import Inertia, Link
from derive.robot.expression import number
from derive.robot.robot import Robot

TABLES = {
    "spatial": "[{type: revolute, d: 0.3, alpha: 0.7}, {type: prismatic, theta: 0.4, a: 0.2, alpha: pi/2}, "
    "{type: revolute, a: 0.25, d: 0.1, alpha: -1.1}, {type: revolute, d: 0.1}]",
    "planar": "[{type: revolute, a: 0.5}, {type: revolute, a: 0.4}, {type: revolute, a: 0.3}]",
    "upright": "[{type: revolute, d: 0.3, a: 0.2, alpha: pi/2}, {type: revolute, a: 0.4}, {type: prismatic, a: 0.1}]",
}


def arm(name: str, convention: str = "standard") -> Robot:
    """An arm of random bodies that exist."""
    random = np.random.default_rng(len(name))
    rows = TABLES[name].replace("type: revolute", "type: revolute, theta: Q").replace("prismatic", "prismatic, d: Q")
    for i in range(1, rows.count("Q") + 1):
        rows = rows.replace("Q", f"q{i}", 1)
    lines = [f"name: {name}", f"convention: {convention}", f"joints: {rows}", "gravity: [0, 0, -9.81]", "links:"]
    for _ in range(rows.count("type")):
        points = random.integers(-20, 21, size=(6, 3)) / 100
        away = points - points.mean(axis=0)
        second = away.T @ away
        tensor = np.trace(second) * np.eye(3) - second
        cells = ", ".join(
            f"{x}{y}: {tensor['xyz'.index(x), 'xyz'.index(y)]:.6f}" for x, y in ("xx", "yy", "zz", "xy", "xz", "yz")
        )
        lines.append(
            f"  - {{mass: 6, com: [{', '.join(f'{c:.3f}' for c in points.mean(axis=0))}], "
            f"inertia: {{{cells}}}, armature: 0.1}}"
        )
    return Robot.from_text("\n".join(lines) + "\n")


def with_links(robot: Robot, *links: tuple[str, str, str]) -> Robot:
    """The robot with other links: mass, com, tensor."""
    made = []
    for mass, com, tensor in links:
        x, y, z = (number(Fraction(cell)) for cell in com.split())
        made.append(
            Link(number(Fraction(mass)), (x, y, z), Inertia(*(number(Fraction(cell)) for cell in tensor.split())))
        )
    return replace(robot, links=tuple(made))
