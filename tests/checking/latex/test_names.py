"""Names as LaTeX prints them, found among those of a robot."""

from __future__ import annotations

import pytest

from derive.checking.latex.names import LatexNames, Symbol
from derive.errors import CheckError
from derive.robot.expression import Call, Expression, Name, Pi, add
from derive.robot.robot import Robot

ARM = Robot.from_text(
    "name: arm\nconvention: standard\njoints:\n  - {type: revolute, a: l_1, alpha: alpha1}\n"
    "  - {type: revolute, a: ml1}\n  - {type: prismatic}\n"
)


def meaning(text: str, dots: int = 0) -> Expression:
    return LatexNames(ARM).meaning(Symbol(text, 0, dots))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("pi", Pi()),
        ("l_1", Name("l_1")),
        ("l1", Name("l_1")),
        ("m1l", Name("ml1")),
        ("ML1", Name("ml1")),
        ("theta2", Name("q2")),
        ("q3", Name("q3")),
        ("d3", Name("q3")),
        ("c12", Call("cos", (add(Name("q1"), Name("q2")),))),
        ("sq1q2", Call("sin", (add(Name("q1"), Name("q2")),))),
        ("calpha1", Call("cos", (Name("alpha1"),))),
    ],
)
def test_a_printed_name_stands_for_one_thing(text: str, expected: Expression) -> None:
    assert meaning(text) == expected


def test_dots_are_velocities_and_accelerations() -> None:
    assert meaning("theta1", 1) == Name("qd1")
    assert meaning("q3", 2) == Name("qdd3")


@pytest.mark.parametrize(("text", "dots"), [("zz", 0), ("theta3", 0), ("l1", 1), ("q1", 3)])
def test_other_names_are_refused(text: str, dots: int) -> None:
    with pytest.raises(CheckError):
        meaning(text, dots)


def test_two_ways_to_read_a_name_are_one_too_many() -> None:
    robot = Robot.from_text("name: r\nconvention: standard\njoints: [{type: revolute, a: m_1, d: m_1_}]\n")
    with pytest.raises(CheckError, match="two ways"):
        LatexNames(robot).meaning(Symbol("m1", 0))


def test_c_before_an_angle_is_a_cosine_unless_the_robot_has_a_c() -> None:
    assert LatexNames(ARM).circular(Symbol("c", 0)) == "cos"
    with_c = Robot.from_text("name: r\nconvention: standard\njoints: [{type: revolute, a: c}]\n")
    assert LatexNames(with_c).circular(Symbol("c", 0)) == ""
