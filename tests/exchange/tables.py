"""Tables of robot files as URDFs, one joint after the other."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping

import numpy as np

from derive.robot.description import Convention, Matrix
from derive.robot.evaluate import evaluate
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from tests.exchange.urdfs import J, urdf

Cells = list[tuple[float, ...]]


def numbers(robot: Robot) -> dict[str, float]:
    """A number for every name; random ones for those without."""
    source = random.Random(1)
    values = {name: evaluate(cell, {}) for name, cell in robot.parameters}
    return {name: round(source.uniform(0.2, 0.9), 3) for name in sorted(free_symbols(robot))} | values


def table_urdf(robot: Robot, values: Mapping[str, float]) -> str:
    """The arm as a URDF: rows as pairs of joints, one of them fixed."""
    joints = [_fixed(robot.base, values)]
    for row in robot.joints:
        theta, d, a, alpha = (repr(evaluate(cell, values)) for cell in (row.theta, row.d, row.a, row.alpha))
        along_x = J(f"{a} 0 0", f"{alpha} 0 0", type="fixed")
        kind = "revolute" if row.is_revolute else "prismatic"
        along_z = J(f"0 0 {d}", f"0 0 {theta}", f"0 0 {row.sign}", kind)
        joints += [along_z, along_x] if robot.convention is Convention.STANDARD else [along_x, along_z]
    return urdf([*joints, _fixed(robot.tool, values)])


def _fixed(matrix: Matrix, values: Mapping[str, float]) -> J:
    """A fixed joint by a transform."""
    m = np.array([[evaluate(cell, values) for cell in row] for row in matrix])
    pitch = math.asin(max(-1.0, min(1.0, -m[2, 0])))
    if abs(m[2, 0]) > 1 - 1e-12:
        roll, yaw = 0.0, math.atan2(-m[0, 1], m[1, 1])
    else:
        roll, yaw = math.atan2(m[2, 1], m[2, 2]), math.atan2(m[1, 0], m[0, 0])
    return J(" ".join(map(repr, m[:3, 3].tolist())), f"{roll!r} {pitch!r} {yaw!r}", type="fixed")


def cells(robot: Robot, values: Mapping[str, float]) -> Cells:
    """Rows of the table, base and tool in numbers."""
    rows = [tuple(evaluate(getattr(row, key), values) for key in ("theta", "d", "a", "alpha")) for row in robot.joints]
    frames = [tuple(evaluate(cell, values) for cell in row) for frame in (robot.base, robot.tool) for row in frame]
    return rows + frames
