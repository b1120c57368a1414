"""Inverse kinematics in C: limits, lengths and what may be left out, as the robot has them."""

from __future__ import annotations

from derive.targets.c_inverse import c_inverse
from tests.targets.generated_models import source_of
from tests.targets.test_inverse import elbow, program_of


def test_joints_without_limits_have_infinite_ones() -> None:
    robot, program = elbow(), program_of(elbow())
    assert program.inverse is not None
    text = c_inverse(program.inverse, source_of(robot, program))
    assert text.lower == "-2.0, -INFINITY, -INFINITY, -1.0"
    assert text.upper == "2.0, INFINITY, INFINITY, 1.0"
    assert text.revolute == "1, 1, 1, 0"


def test_what_is_loaded_has_the_length_that_the_program_reads() -> None:
    robot, program = elbow(), program_of(elbow())
    assert program.inverse is not None
    text = c_inverse(program.inverse, source_of(robot, program))
    assert text.size == text.branches * robot.n
    assert {load.name: load.width for load in text.loads}["T"] == 16
    assert {load.name for load in text.loads if load.is_optional} <= {"near"}
