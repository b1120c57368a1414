"""The derivation of the inverse kinematics reads as in a textbook."""

from __future__ import annotations

import pytest

from derive.handouts.notation.derivation import derivation_lines
from derive.handouts.notation.notation import Notation
from derive.model.inverse.solutions import InverseKinematics
from derive.robot.robot import Robot
from tests.model.inverse.test_graph import PLANAR, planar_graph


@pytest.fixture(scope="module")
def planar() -> InverseKinematics:
    robot = Robot.from_text(PLANAR)
    return InverseKinematics(planar_graph(), robot, robot.style)


def test_the_planar_arm_is_solved_as_in_textbooks(planar: InverseKinematics) -> None:
    lines = derivation_lines(planar, "text", Notation.of(planar.robot))
    assert lines[0] == "2 solutions, and no more"
    assert "   D = (px**2 + py**2 - a1**2 - a2**2)/(2*a1*a2)" in lines
    assert "   q2 = atan2(+-sqrt(1 - D**2), D)" in lines
    assert "   real for abs(D) <= 1" in lines
    assert "     a1*c1 + a2*c12 = px" in lines
    assert "   q1 = atan2(py, px) - atan2(a2*s2, a1 + a2*c2)" in lines
    assert "   free where px = 0 and py = 0" in lines


def test_in_latex_the_law_of_cosines_is_a_fraction(planar: InverseKinematics) -> None:
    text = "\n".join(derivation_lines(planar, "latex", Notation.of(planar.robot)))
    assert r"D &= \frac{p_{x}^{2} + p_{y}^{2} - a_{1}^{2} - a_{2}^{2}}{2a_{1}a_{2}}" in text
    assert r"\operatorname{atan2}(\pm \sqrt{1 - D^{2}},\, D)" in text


def test_in_python_every_line_is_an_assignment_of_what_is_known(planar: InverseKinematics) -> None:
    known = {"a1", "a2", "px", "py", "epsilon_2"}
    for line in derivation_lines(planar, "python", Notation.of(planar.robot)):
        name, _, value = line.partition("#")[0].partition(" = ")
        compile(value.strip(), "<line>", "eval")
        known.add(name)
    assert {"D", "q1", "q2"} <= known
