"""The example of the inverse kinematics: one pose, all its configurations."""

import math

import numpy as np
import pytest
import sympy

from derive.handouts.parts.inverse_example import reached
from derive.model.model import Model
from derive.robot.evaluate import parameter_values
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, numeric_arm
from tests.inverse.arms import PUBLISHED


@pytest.mark.parametrize(("name", "count"), [("scara-perugia", 2), ("planar-3r", 2), ("stanford-laschi", 8)])
def test_every_configuration_reaches_the_pose_by_the_oracle(name: str, count: int) -> None:
    robot = Robot.load(name)
    values = dict.fromkeys(free_symbols(robot), 0.4)
    numbers = {sympy.Symbol(n): float(x) for n, x in parameter_values(robot, values).items()}
    q = [0.3 + 0.2 * k for k in range(robot.n)]
    found = reached(Model(robot).inverse, numbers, q)
    arm = numeric_arm(robot, values)
    poses = forward_kinematics(arm, np.array([solution.q for solution in found]))
    assert len(found) == count
    assert np.abs(poses - forward_kinematics(arm, np.array(q))).max() < 1e-12
    assert len({solution.number for solution in found}) == count
    assert min(max(abs(math.remainder(a - b, 2 * math.pi)) for a, b in zip(s.q, q, strict=True)) for s in found) < 1e-9


def test_an_arm_without_formulas_is_solved_in_floats() -> None:
    robot = next(case.robot() for case in PUBLISHED if case.name == "crx-10ia")
    q = [math.radians(x) for x in (30, 60, -30, 90, -60, 120)]
    found = reached(Model(robot).inverse, {}, q)
    poses = forward_kinematics(numeric_arm(robot, {}), np.array([solution.q for solution in found]))
    assert len(found) == 8
    assert np.abs(poses - forward_kinematics(numeric_arm(robot, {}), np.array(q))).max() < 1e-9
