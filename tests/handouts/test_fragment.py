"""Fragments: every quantity that the model has can be put into notes, alone, and names the packages that it needs."""

from __future__ import annotations

import pytest

from derive.errors import QuantityError, TargetError
from derive.handouts.fragment import fragment_text
from derive.robot.robot import Robot

ARM = """
name: bar
convention: standard
joints: [{type: revolute, a: a1}, {type: revolute, a: a2}]
gravity: [0, -g, 0]
links: [{mass: m1, com: [-l1, 0, 0], inertia: {zz: I1}}, {mass: m2, com: [-l2, 0, 0], inertia: {zz: I2}}]
"""
NAMES = (
    *("T", "T[0,1]", "A[1]", "p", "R", "J", "Jv_com[2]", "B", "B[1,2]", "Bdot", "C", "N", "g", "tau", "tau[1]"),
    *("kinetic", "potential", "christoffel[1,1,2]"),
)


@pytest.fixture(scope="module")
def bar() -> Robot:
    """Two links in a plane."""
    return Robot.from_text(ARM)


@pytest.mark.parametrize("name", NAMES)
def test_a_quantity_stands_alone(bar: Robot, name: str) -> None:
    """A comment that says what it is and needs, and one display with an equals sign; braces and brackets are closed."""
    heading, body = fragment_text(bar, bar.handout, name).split("\n", 1)
    assert heading.startswith(f"% {name} of bar: written by derive")
    assert r"needs \usepackage{amsmath}" in heading
    assert "=" in body
    assert r"\documentclass" not in body
    assert body.count("{") - body.count(r"\{") == body.count("}") - body.count(r"\}")
    assert body.count(r"\begin") == body.count(r"\end")


def test_a_part_names_what_its_tables_need(bar: Robot) -> None:
    assert "booktabs" in fragment_text(bar, bar.handout, "table").split("\n")[0]


def test_matrices_wider_than_amsmath_expects_say_so() -> None:
    joints = ", ".join(["{type: revolute, a: 1}"] * 11)
    robot = Robot.from_text(f"name: snake\nconvention: standard\njoints: [{joints}]\n")
    text = fragment_text(robot, robot.handout, "J")
    assert "MaxMatrixCols" in text or text.count("bmatrix") == 0


def test_what_there_is_not_is_refused_with_what_may_be_meant(bar: Robot) -> None:
    with pytest.raises(TargetError, match="did you mean 'inertia'"):
        fragment_text(bar, bar.handout, "inerta")
    plain = Robot.from_text("name: bar\nconvention: standard\njoints: [{type: revolute, a: a1}]\n")
    with pytest.raises(QuantityError, match="no links"):
        fragment_text(plain, plain.handout, "B")
