"""The printed regrouping: factors, brackets, both rows, what moves, and the equal product."""

from __future__ import annotations

from dataclasses import replace

import pytest

from derive.exchange.derivation import derivation_text
from derive.mechanics.convention import convert, has_equal_poses
from derive.robot.expression import ONE
from derive.robot.robot import Robot
from tests.random_robots import swept_catalogue

PLANAR = """\
standard: T = (Z_1 X_1) (Z_2 X_2) T_tool
modified: T = (X_0 Z_1) (X_1 Z_2) T'_tool
The factors are the same, the brackets are not: T'_base = T_base X_0^-1; T'_tool = X_2 T_tool.

factor  a   alpha  standard table  modified table
X_0     0   0      base            row 1
X_1     a1  0      row 1           row 2
X_2     a2  0      row 2           tool
"""


def test_a_planar_arm_is_regrouped_as_on_a_blackboard() -> None:
    text = derivation_text(convert(Robot.load("planar-2r-perugia")))
    assert text.partition("\n")[2].startswith(PLANAR)
    assert "\nA'_2 = X_1 Z_2, row 2 of the modified table =\n  c2  -s2  0  a1\n" in text
    assert "\n  link 2: [l2 - a2, 0, 0] is [l2, 0, 0] in the modified frame 2\n" in text
    assert text.endswith("are equal, entry by entry, in exact arithmetic.\n")


@pytest.mark.parametrize("name", swept_catalogue(usual=("skeleton-modified", "human-body", "spherical-wrist")))
def test_products_of_every_built_in_robot_are_equal_up_to_seven_rows(name: str) -> None:
    robot = Robot.load(name)
    conversion = convert(robot)
    if robot.n <= 7:
        assert has_equal_poses(conversion)
    text = derivation_text(conversion)
    assert ("are equal, entry by entry" in text) == (robot.n <= 7)
    assert ("rows are not multiplied out" in text) == (robot.n > 7)


def test_it_is_said_where_numbers_are_printed_shorter_than_they_are() -> None:
    text = "{{name: arm, convention: standard, joints: [{{type: revolute, a: {}}}, {{type: revolute, a: 0.25}}]}}"
    long, short = (Robot.from_text(text.format(length)) for length in ("0.123456789", "0.125"))
    said = "Matrices are printed with 6 significant digits of each number."
    assert said in derivation_text(convert(long))
    assert said not in derivation_text(convert(short))


def test_a_wrong_table_is_not_called_equal() -> None:
    conversion = convert(Robot.load("planar-2r-perugia"))
    wrong = replace(conversion.result.joints[1], a=ONE)
    spoilt = replace(conversion, result=replace(conversion.result, joints=(conversion.result.joints[0], wrong)))
    assert not has_equal_poses(spoilt)
    assert "are DIFFERENT, entry by entry" in derivation_text(spoilt)
