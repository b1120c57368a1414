"""Lines of a printed solution: what they need, in which order they can be used, what they give."""

from __future__ import annotations

import math

import pytest

from derive.api.robots import load
from derive.checking.inverse.order import determined_joints, free_joints
from derive.checking.inverse.poses import places
from derive.checking.inverse.printed import PrintedInverse, is_same, with_calls
from derive.checking.inverse.reading import Vocabulary, assembled
from derive.checking.inverse.text import text_equations
from derive.checking.latex.names import PlusMinus
from derive.errors import CheckError, Location
from derive.robot.expression import Call, Name


def solution(robot: str, text: str) -> tuple[PrintedInverse, Vocabulary]:
    arm = load(robot)
    return assembled(arm, *text_equations(text, arm, Location("notes"), PlusMinus()))


def test_a_line_has_a_value_for_every_choice() -> None:
    text = "r = +-sqrt(x**2 + y**2 - a1**2); theta2 = atan2(+-r, x) or pi; theta1 = atan2(r, y)"
    printed, _ = solution("planar-2r-perugia", text)
    first, second = printed.given
    assert len(printed.choices(first)) == 3
    assert list(printed.shared((first, second))) == list(printed.choices(second))
    assert list(printed.coupled()) == [(first, second)]
    assert [line.name for line in printed.named_before(first)] == ["r"]


def test_sums_are_known_before_their_terms() -> None:
    text = "theta3 = theta123 - theta1 - theta2; theta123 = atan2(r21, r11)\n"
    text += "theta2 = atan2(px, py)\ntheta1 = atan2(py, px)"
    printed, _ = solution("planar-3r", text)
    assert determined_joints(printed) == ("q1", "q2", "q3")
    assert free_joints(printed) == ()


def test_a_joint_that_no_line_gives_is_known() -> None:
    printed, _ = solution("planar-3r", "theta23 = atan2(r21, r11) - theta1; theta2 = theta23 - theta3")
    assert free_joints(printed) == ("q1", "q3")
    assert determined_joints(printed) == ("q2",)


def test_cosine_and_sine_together_are_an_angle_and_one_alone_is_none() -> None:
    assert determined_joints(solution("planar-2r-perugia", "c2 = x/a1")[0]) == ()
    assert determined_joints(solution("planar-2r-perugia", "c2 = x/a1; s2 = y/a1")[0]) == ("q2",)


def test_lines_that_need_each_other_are_refused() -> None:
    printed, _ = solution("planar-2r-perugia", "theta1 = atan2(y, x) - theta2; theta2 = atan2(y, x) - theta1")
    with pytest.raises(CheckError, match="q1, q2 are given by each other"):
        _ = determined_joints(printed)
    with pytest.raises(CheckError, match="given by each other"):
        solution("planar-2r-perugia", "K = L + 1; L = K - 1; theta1 = K")


def test_too_many_signs_are_refused() -> None:
    with pytest.raises(CheckError, match="plus-minus signs"):
        solution("planar-2r-perugia", "theta1 = " + "".join(f"+-a{1 + k % 2}" for k in range(11)))


def test_truth_is_what_a_line_should_give_at_every_configuration() -> None:
    printed, vocabulary = solution("planar-2r-perugia", "theta1 = atan2(y - a2*s12, x - a2*c12)")
    (line,) = printed.given
    assert printed.is_angle(line)
    assert all(printed.hits(line, place) for place in places(vocabulary.pose, vocabulary.sums))


def test_a_left_side_without_a_value_says_nothing() -> None:
    printed, vocabulary = solution("planar-2r-perugia", "sqrt(c1) = x; theta1 = 0")
    hits = [printed.hits(printed.given[0], place) for place in places(vocabulary.pose, vocabulary.sums)]
    assert {True, False} == set(hits)


def test_angles_are_the_same_up_to_full_turns() -> None:
    assert is_same(1 + 2 * math.pi, 1, True)
    assert not is_same(1 + 2 * math.pi, 1, False)
    assert not is_same(1 + math.pi, 1, True)


def test_calls_are_exchanged_everywhere() -> None:
    x, y = Name("x"), Name("y")
    e = Call("Atan2", (Call("Atan2", (x, y)), y))
    assert with_calls(e, "Atan2", "atan2", True) == Call("atan2", (y, Call("atan2", (y, x))))
