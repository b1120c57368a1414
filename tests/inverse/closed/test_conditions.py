"""What is said of reachable poses holds there, and what does not hold elsewhere tells them apart, signs included."""

from __future__ import annotations

import pytest

from derive.handouts.notation.derivation import derivation_lines
from derive.handouts.notation.notation import Notation
from derive.inverse.words.solutions import inverse_kinematics
from derive.model.model import Model
from derive.robot.robot import Robot

ARMS = {
    "{type: revolute, d: d1}, {type: prismatic, alpha: -pi/2}, {type: prismatic}": (
        "r33 = 0, r31 = 0, r32 = -1, px*c1 = -py*s1"
    ),
    "{type: prismatic, alpha: pi/2}, {type: prismatic, alpha: pi/2, theta: pi/2}, {type: prismatic}": (
        "r13 = 1, r23 = 0, r33 = 0, r31 = 1, r32 = 0"
    ),
    "{type: revolute, d: d1, alpha: -pi/2}, {type: revolute, a: a2}, {type: revolute, a: a3}, "
    "{type: revolute, a: a4, alpha: -pi/2}, {type: revolute, d: d5}": "r23*c1 = r13*s1",
    "{type: revolute, alpha: -pi/2}, {type: revolute, alpha: pi/2}, {type: revolute, d: d6}": (
        "px = d6*r13, py = d6*r23, pz = d6*r33"
    ),
}


@pytest.mark.parametrize("joints", ARMS)
def test_conditions_are_those_of_textbooks_with_their_signs(joints: str) -> None:
    robot = Robot.from_text(f"name: arm\nconvention: standard\njoints: [{joints}]\n")
    lines = derivation_lines(Model(robot).inverse, "text", Notation.of(robot))
    assert lines[1] == f"a pose can be reached only if {ARMS[joints]}"


def test_an_angle_tells_the_orientation_of_a_planar_arm() -> None:
    """So the last link is taken off first, as textbooks do, and the elbow follows from the law of cosines."""
    robot = Robot.load("planar-3r")
    lines = derivation_lines(inverse_kinematics(robot, robot.style, ("x", "y", "phi")), "text", Notation.of(robot))
    assert "   wx = px - a3*r11" in lines
    assert "   D = (wx**2 + wy**2 - a1**2 - a2**2)/(2*a1*a2)" in lines
