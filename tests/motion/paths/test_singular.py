"""Singular configurations: the usual rank of J, the factor that vanishes, and ways that begin there."""

from __future__ import annotations

import numpy as np
import pytest

from derive.errors import RobotFileError
from derive.motion.motion import Motion
from derive.motion.paths.singular import usual_rank, vanishing_factor
from derive.motion.torques.functions import Functions
from derive.robot.robot import Robot

LINE = """
robot: {robot}
points:
  a: {start}
  b: {{pose: {{p: {place}, rpy: [pi, 0, 0]}}}}
path: [a, {{to: b, time: 1, line: yes}}]
"""


def test_the_rank_is_that_of_places_that_are_not_singular() -> None:
    functions = Functions(Robot.load("scara-matlab"), frozenset({"jacobian"}), {})
    assert usual_rank(functions, range(6)) == 4
    assert usual_rank(functions, range(3)) == 3
    assert usual_rank(functions, (3, 4)) == 0


@pytest.mark.parametrize(
    ("q", "factor"), [((0.3, 0.2, 0.1, 0, 1e-9, 0), "sin(q5)"), ((0.3, 0.2, 1.6178, 0, 1, 0), "q3")]
)
def test_the_factor_nearest_to_zero_is_named(q: tuple[float, ...], factor: str) -> None:
    robot = Robot.load("puma560-corke")
    numbers = {name: float(value.value) for name, value in robot.parameters}
    assert factor in vanishing_factor(robot, numbers, np.array(q))


def test_a_line_that_begins_at_a_singular_configuration_is_refused_with_what_vanishes() -> None:
    text = LINE.format(robot="scara-matlab", start="[0, 0, 1, 0]", place="[3, 0, -1]")
    with pytest.raises(RobotFileError, match=r"6:11: the way starts at a singular configuration, where sin\(q2\) = 0"):
        Motion.from_text(text)


def test_a_line_that_begins_beside_it_is_followed() -> None:
    text = LINE.format(robot="scara-matlab", start="[0, 0.3, 1, 0]", place="[3, 0.1, -1]")
    assert Motion.from_text(text).duration == 1
