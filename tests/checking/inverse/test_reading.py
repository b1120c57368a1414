"""What lines are about, from their sides."""

from __future__ import annotations

import pytest

from derive.api.robots import load
from derive.checking.inverse.reading import Vocabulary
from derive.errors import CheckError
from derive.robot.expression import Name
from tests.checking.inverse.test_printed import solution


def test_a_chain_of_sides_names_and_gives() -> None:
    printed, vocabulary = solution(
        "scara-perugia", "alpha = theta1 + theta2 - theta4 = atan2(r12, r11); theta1 = 0; theta2 = 0"
    )
    assert vocabulary.new == {"alpha"}
    assert [line.name for line in printed.lines if line.target is None] == ["alpha"]
    assert printed.given[0].quantity == "q1 + q2 - q4"
    assert not printed.joints.meaning(Name("alpha"))


def test_a_side_may_hold_what_is_named() -> None:
    printed, _ = solution("planar-2r-perugia", "r = sqrt(x**2 + y**2) = theta2*r; theta2 = r; theta1 = atan2(y, x)")
    assert [line.quantity for line in printed.given] == ["q2*r", "q2", "q1"]


def test_the_middle_side_may_be_the_name() -> None:
    printed, vocabulary = solution("scara-perugia", "theta1 + theta2 - theta4 = alpha = atan2(r12, r11)")
    assert vocabulary.new == {"alpha"}
    assert [line.quantity for line in printed.lines] == ["alpha", "q1 + q2 - q4"]


def test_joints_have_the_names_of_books() -> None:
    found = Vocabulary.of(load("scara-perugia"), ["theta1", "d3", "th_2", "q_4", "theta3", "theta12", "C2", "sgn"], [])
    assert found.meanings["theta1"] == Name("q1")
    assert found.meanings["d3"] == Name("q3")
    assert found.meanings["th_2"] == Name("q2")
    assert "theta3" not in found.meanings
    assert list(found.sums) == ["theta12"]


def test_the_same_line_twice_is_an_alternative() -> None:
    printed, _ = solution("planar-2r-perugia", "theta2 = x; theta1 = atan2(y, x) or q1 + pi; theta2 = y")
    assert [len(line.formulas) for line in printed.given] == [2, 2]


def test_a_condition_of_the_pose_gives_nothing() -> None:
    with pytest.raises(CheckError, match="no line gives a joint variable"):
        solution("planar-2r-perugia", "r13 = 0")


def test_an_equation_with_named_quantities_on_both_sides_is_one() -> None:
    printed, _ = solution("planar-2r-perugia", "r = sqrt(x**2 + y**2); r*cos(theta1) = x; theta1 = atan2(y, x)")
    assert [line.quantity for line in printed.given] == ["r*c1", "q1"]
