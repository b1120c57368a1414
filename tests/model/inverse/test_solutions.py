"""The inverse kinematics of a model: every branch in closed form, proved by putting it into T."""

from __future__ import annotations

import pytest
import sympy

from derive.model.inverse.solutions import InverseKinematics
from derive.robot.robot import Robot
from tests.model.inverse.test_graph import PLANAR, planar_graph


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
