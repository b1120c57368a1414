"""The inverse kinematics of a model: every branch in closed form, proved by putting it into T."""

from __future__ import annotations

from dataclasses import replace

import pytest
import sympy

from derive.inverse.words.solutions import InverseKinematics, inverse_kinematics
from derive.robot.options.style import Contraction
from derive.robot.robot import Robot
from tests.inverse.closed.test_graph import PLANAR, planar_graph


@pytest.fixture(scope="module")
def planar() -> InverseKinematics:
    robot = Robot.from_text(PLANAR)
    return InverseKinematics(planar_graph(), robot, robot.style)


def test_there_is_one_solution_for_each_choice_of_signs(planar: InverseKinematics) -> None:
    assert len(planar.solutions) == planar.graph.leaves == 2
    assert [list(solution.signs.values()) for solution in planar.solutions] == [[1], [-1]]


def test_explicit_solutions_hold_pose_and_parameters_alone(planar: InverseKinematics) -> None:
    allowed = set(sympy.symbols("px py a1 a2"))
    for solution in planar.solutions:
        assert set(solution.explicit) == set(sympy.symbols("q1 q2"))
        assert all(value.free_symbols <= allowed for value in solution.explicit.values())


def test_where_an_unknown_is_free_is_said(planar: InverseKinematics) -> None:
    (degenerate,) = planar.degenerate
    assert degenerate.unknown == sympy.Symbol("q1")
    assert set(degenerate.conditions) == set(sympy.symbols("px py"))


def test_who_asks_again_has_the_same_solutions_and_another_style_others() -> None:
    robot = Robot.load("planar-3r")
    found = inverse_kinematics(robot, robot.style)
    assert inverse_kinematics(Robot.load("planar-3r"), robot.style) is found
    assert inverse_kinematics(robot, replace(robot.style, contraction=Contraction.OPPOSED)) is not found
