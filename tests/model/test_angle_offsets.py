"""Constants of joint angles stay inside their sines and cosines, cos(q1 + pi/4), where they are no right angles."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

from derive.api.check import check_formula
from derive.handouts.fragment import fragment_text
from derive.handouts.notation.text import TextPrinter
from derive.model.model import Model
from derive.robot.robot import Robot

PLANAR = """
name: arm
convention: {convention}
units: {{angle: {unit}}}
joints:
  - {{type: revolute, theta: {0}, alpha: {right}, d: d1}}
  - {{type: revolute, theta: {1}, a: a2}}
  - {{type: revolute, theta: {2}, a: a3}}
"""
WITH_LINKS = "links: [{mass: m1}, {mass: m2, com: [-l2, 0, 0]}, {mass: m3, com: [-l3, 0, 0]}]\n"


def _robot(*angles: str, convention: str = "standard", unit: str = "rad", right: str = "pi/2", more: str = "") -> Robot:
    return Robot.from_text(PLANAR.format(*angles, convention=convention, unit=unit, right=right) + more)


def _shown(robot: Robot, name: str) -> str:
    return str(TextPrinter(robot).doprint(Model(robot).quantity(name)))


@pytest.mark.parametrize(
    ("angles", "expected"),
    [
        (("q1 + pi/4", "q2 - pi/6", "q3"), "cos(q1 + pi/4)*cos(q2 + q3 - pi/6)"),
        (("q1 + 3*pi/4", "q2", "q3"), "cos(q1 + 3*pi/4)*c23"),
        (("q1", "q2 + pi/4", "q3 + pi/4"), "-c1*s23"),
        (("q1", "q2 - pi/3", "q3 + pi/3"), "c1*c23"),
        (("q1 + pi/2", "-q2 + pi/5", "-q3"), "-s1*cos(q2 + q3 - pi/5)"),
        (("q1 + 1/5", "q2 + pi", "q3"), "-cos(q1 + 1/5)*c23"),
        (("q1 + beta", "q2 + pi/2", "q3"), "-cos(q1 + beta)*s23"),
    ],
)
def test_a_constant_that_is_no_right_angle_stays_in_the_sine(angles: tuple[str, ...], expected: str) -> None:
    assert _shown(_robot(*angles), "T[][1,1]") == expected


def test_every_quantity_takes_the_angles_of_the_table() -> None:
    robot = _robot("q1 + pi/4", "q2 - pi/6", "q3", more=WITH_LINKS)
    assert _shown(robot, "B[2,3]") == "m3*(a3 - l3)*(a3 - l3 + a2*c3)"
    assert _shown(robot, "g[3]") == "m3*g*cos(q2 + q3 - pi/6)*(a3 - l3)"
    assert "sqrt" not in "".join(_shown(robot, name) for name in ("T", "J", "B", "C", "g", "tau", "detJ"))
    (elbow,) = (c for c in Model(robot).singularities.conditions if c.joints == (3,))
    assert [str(value) for value in elbow.values] == ["0", "pi"]


def test_where_a_sine_vanishes_the_constant_is_subtracted() -> None:
    (elbow,) = (c for c in Model(_robot("q1", "q2 + beta", "q3 - 3*pi/4")).singularities.conditions if c.joints == (3,))
    assert [str(value) for value in elbow.values] == ["3*pi/4", "-pi/4"]


@pytest.mark.parametrize("formula", ["cos(q1 + pi/4)*c23", "sqrt(2)/2*(c1 - s1)*c23", "sin(pi/4 - q1)*(c2*c3 - s2*s3)"])
def test_formulas_with_and_without_the_constant_are_the_same(formula: str) -> None:
    assert Model(_robot("q1 + pi/4", "q2", "q3")).equal("T[][1,1]", formula)


def test_what_is_printed_is_checked() -> None:
    robot = _robot("q1 + 45", "q2 - 30", "q3", unit="deg", right="90")
    assert check_formula(robot, "T[][1,4]", _shown(robot, "T[][1,4]")).outcome == "same form"
    assert "45^{\\circ}" in fragment_text(robot, robot.handout, "T[][1,1]")


@pytest.mark.parametrize("contraction", ["aligned", "opposed"])
@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize(
    "angles",
    [("q1 + pi/4", "-q2 + pi/4", "q3 - pi/4"), ("q1 - 2*pi/3", "q2 + pi/4", "q3 + pi/4"), ("-q1 + 1", "q2", "q3")],
)
def test_transforms_are_products_of_the_rows(angles: tuple[str, ...], convention: str, contraction: str) -> None:
    robot = _robot(*angles, convention=convention)
    model = Model(robot, contraction=contraction)
    values = {"q1": 0.7, "q2": -1.1, "q3": 0.4, "d1": 0.3, "a2": 0.8, "a3": 0.6}
    product = np.eye(4)
    for row, text in enumerate(angles):
        turn = _angle(text, values)
        a, d, alpha = (
            (0.0, values["a2"], values["a3"])[row],
            values["d1"] if row == 0 else 0.0,
            math.pi / 2 if row == 0 else 0.0,
        )
        about_z, about_x = _screw(turn, d, 2), _screw(alpha, a, 0)
        product = product @ (about_z @ about_x if convention == "standard" else about_x @ about_z)
    found = np.array(model.T.subs(values), dtype=float)
    np.testing.assert_allclose(found, product, atol=1e-14)
    slopes = model.T[:3, 3].jacobian(model.q) - model.J[:3, :]
    assert np.abs(np.array(slopes.subs(values), dtype=float)).max() < 1e-14


def _angle(text: str, values: dict[str, float]) -> float:
    """The value of a cell such as ``-q2 + pi/4``, by hand."""
    total = 0.0
    for word in text.replace("- ", "-").replace("+ ", "").split():
        sign, size = (-1, word[1:]) if word.startswith("-") else (1, word)
        above, _, below = size.replace("*pi", "pi").partition("/")
        number = above.removesuffix("pi")
        whole = values[above] if above in values else float(number or 1) * (math.pi if above.endswith("pi") else 1)
        total += sign * whole / float(below or 1)
    return total


def _screw(angle: float, shift: float, axis: int) -> npt.NDArray[np.float64]:
    """A turn about and a shift along one axis."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(4)
    matrix[i, i] = matrix[j, j] = math.cos(angle)
    matrix[i, j], matrix[j, i] = -math.sin(angle), math.sin(angle)
    matrix[axis, 3] = shift
    return matrix
