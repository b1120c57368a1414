"""The style of a book is found from its formulas, for every option from formulas that only this option writes."""

from __future__ import annotations

import pytest

from derive.checking.formulas.findings import Outcome
from derive.checking.style_finding import Example, StyleEvidence, find_style
from derive.lecture.shorthand import read_formula
from derive.robot.options.style import Style
from derive.robot.robot import Robot

ARM = Robot.from_text("""
name: arm
convention: standard
joints: [{type: revolute, a: a1}, {type: revolute, a: a2}]
gravity: [0, -g, 0]
links:
  - {mass: m1, com: [l1 - a1, 0, 0], inertia: {zz: I1}}
  - {mass: m2, com: [l2 - a2, 0, 0], inertia: {zz: I2}}
""")
ELBOW = Robot.from_text("""
name: elbow
convention: standard
joints: [{type: revolute, alpha: pi/2}, {type: revolute, a: a2}, {type: revolute, a: a3, alpha: -pi/2},
  {type: revolute, d: d4, alpha: pi/2}]
""")


def example(robot: Robot, quantity: str, text: str) -> Example:
    return Example(robot, quantity, read_formula(text, robot), text)


FORMS = [
    ("inertia: expanded", ARM, "B[1,1]", "I1 + I2 + m1*l1**2 + m2*a1**2 + m2*l2**2 + 2*m2*a1*l2*c2"),
    ("gravity: body", ARM, "g[1]", "m1*g*l1*c1 + m2*g*(a1*c1 + l2*c12)"),
    ("g: term", ARM, "g[1]", "(m1*g*l1 + m2*g*a1)*c1 + m2*g*l2*c12"),
    ("g: outside", ARM, "g[1]", "g*((m1*l1 + m2*a1)*c1 + m2*l2*c12)"),
    ("potential: function", ARM, "potential", "(m1*l1 + m2*a1)*g*s1 + m2*l2*g*s12"),
    ("velocities: symbol", ARM, "coriolis_vector[1]", "-m2*a1*l2*s2*(2*qd1*qd2 + qd2**2)"),
    ("velocities: factored", ARM, "coriolis_vector[1]", "-m2*a1*l2*s2*qd2*(2*qd1 + qd2)"),
    ("coriolis: product", ARM, "C[1,2]", "-m2*a1*l2*s2*qd1 - m2*a1*l2*s2*qd2"),
    (
        "kinetic: body",
        ARM,
        "kinetic",
        "m1*l1**2*qd1**2/2 + I1*qd1**2/2 + I2*(qd1 + qd2)**2/2"
        " + m2*(a1**2*qd1**2 + l2**2*(qd1 + qd2)**2 + 2*a1*l2*c2*qd1*(qd1 + qd2))/2",
    ),
    ("rotations: tool", ELBOW, "T[][1,1]", "c4*c1*c23 - s4*s1"),
    ("positions: expanded", ELBOW, "T[][1,4]", "a2*c1*c2 + a3*c1*c23 - d4*c1*s23"),
]


@pytest.mark.parametrize(("option", "robot", "quantity", "text"), FORMS, ids=[row[0] for row in FORMS])
def test_an_option_is_found_from_a_formula_that_it_writes(option: str, robot: Robot, quantity: str, text: str) -> None:
    finding = find_style([example(robot, quantity, text)])
    assert finding.reproduced == 1
    assert [found.outcome for found in finding.findings] == [Outcome.SAME_FORM]
    asked = Style.of(option)
    evidence = StyleEvidence([example(robot, quantity, text)])
    assert evidence.finding(asked).reproduced == 1


def test_of_two_ways_to_write_the_more_frequent_one_is_taken_and_the_other_is_explained() -> None:
    finding = find_style(
        [
            example(ARM, "g[1]", "m1*g*l1*c1 + m2*g*(a1*c1 + l2*c12)"),
            example(
                ARM,
                "tau[1]",
                "(I1 + m1*l1**2 + I2 + m2*(a1**2 + l2**2 + 2*a1*l2*c2))*qdd1"
                " + (I2 + m2*(l2**2 + a1*l2*c2))*qdd2 - m2*a1*l2*s2*(2*qd1*qd2 + qd2**2)"
                " + m1*g*l1*c1 + m2*g*(a1*c1 + l2*c12)",
            ),
            example(ARM, "coriolis_vector[1]", "-2*m2*a1*l2*s2*qd1*qd2 - m2*a1*l2*s2*qd2**2"),
            example(ARM, "potential", "g*(m1*l1*s1 + m2*a1*s1 + m2*l2*s12)"),
            example(ARM, "B[2,2]", "I2 + m2*l2"),
        ]
    )
    assert finding.style.gravity.value == "body"
    outcomes = [found.outcome for found in finding.findings]
    assert outcomes[-1] is Outcome.WRONG
    assert finding.findings[-1].reason == "it is not equal to the derived formula"
    assert outcomes.count(Outcome.SAME_FORM) >= 2
    assert all(found.reason for found in finding.findings if found.outcome is Outcome.EQUAL)


def test_an_equation_of_motion_gives_every_part_its_own_option() -> None:
    craig = (
        "m2*l2**2*(qdd1 + qdd2) + I1*qdd1 + I2*(qdd1 + qdd2) + m2*a1*l2*c2*(2*qdd1 + qdd2)"
        " + m1*l1**2*qdd1 + m2*a1**2*qdd1 - m2*a1*l2*s2*qd2**2 - 2*m2*a1*l2*s2*qd1*qd2"
        " + m1*g*l1*c1 + m2*g*a1*c1 + m2*g*l2*c12"
    )
    finding = find_style([example(ARM, "tau[1]", craig)])
    assert finding.reproduced == 1
    assert finding.style.accelerations.value == "term"
    assert finding.style.velocities.value in ("product", "expanded")


def test_without_an_example_the_others_decide() -> None:
    texts = ["m2*g*l2*c12", "m1*g*l1*c1 + m2*g*(a1*c1 + l2*c12)"]
    evidence = StyleEvidence([example(ARM, f"g[{2 - i}]", text) for i, text in enumerate(texts)])
    assert evidence.best_style().gravity.value == "body"
    assert evidence.best_style(without=1) == Style()
