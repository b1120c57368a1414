"""Printed solutions in LaTeX: names, alternatives, and when a text is one."""

from __future__ import annotations

import pytest

from derive.api.robots import load
from derive.checking.inverse.latex import gives_joints, latex_equations
from derive.checking.latex.names import PlusMinus
from derive.errors import Location
from derive.robot.expression import to_text

ROBOT = load("planar-2r-perugia")


@pytest.mark.parametrize(
    ("latex", "read"),
    [
        (r"\pm\sqrt{a_1}", ["±1*sqrt(a1)"]),
        (r"a_1 \mp a_2", ["a1 + ±1*a2"]),
        (r"\arccos\left(\frac{a_1}{a_2}\right)", ["acos(a1/a2)"]),
        (r"\cos^{-1} a_1", ["acos(a1)"]),
        (r"\tan^{-1}(a_1, a_2)", ["Atan2(a1, a2)"]),
        (r"A\tan(a_1, a_2)", ["Atan2(a1, a2)"]),
        (r"\text{Atan2}(a_1, a_2)", ["Atan2(a1, a2)"]),
        (r"{\rm atan2}(a_1, a_2)", ["atan2(a1, a2)"]),
        (r"\operatorname{arctan}\frac{a_1}{a_2}", ["atan(a1/a2)"]),
        (r"a_1 \text{ or } a_2", ["a1", "a2"]),
        (r"\begin{cases} a_1 & p_x > 0 \\ a_2 & p_x < 0 \end{cases}", ["a1", "a2"]),
    ],
)
def test_right_sides_are_read(latex: str, read: list[str]) -> None:
    text = rf"\theta_1 = {latex}"
    ((_, side),), _ = latex_equations(text, ROBOT, Location("notes"), PlusMinus(), document=False)
    assert [to_text(part.read({})) for part in side.parts] == read


def test_names_stand_on_the_line() -> None:
    _, words = latex_equations(r"p_{Wx} = r_{11} c_\phi + o_x", ROBOT, Location("notes"), PlusMinus(), document=False)
    assert {"pWx", "r11", "cphi", "ox"} <= set(words)


def test_a_text_is_a_solution_where_a_joint_is_an_arc() -> None:
    assert gives_joints(r"\theta_2 = \arccos D", ROBOT)
    assert gives_joints(r"D = 1 \\ q_{1} &= \operatorname{atan2}(y, x)", ROBOT)
    assert not gives_joints(r"\theta_2 = 0", ROBOT)
    assert not gives_joints(r"x = a_1 c_1", ROBOT)
    assert not gives_joints(r"\theta_7 = \arccos D", ROBOT)
