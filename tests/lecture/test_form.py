"""The lecture form: every style writes the same value, grouped in its own way."""

from __future__ import annotations

import pytest
import sympy

from derive.algebra.domain import PolynomialDomain
from derive.errors import Location
from derive.lecture.form import LectureForm, SymbolRoles
from derive.lecture.sympy_conversion import Expr
from derive.robot.options.style import NAMED_STYLES, Style
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot

HERE = Location("<test>")
ARM = Robot.from_text("name: arm\nconvention: standard\njoints: [{type: revolute, a: a1}, {type: revolute, a: a2}]\n")
INERTIA = "m1*a1**2 + m2*a1**2 + m2*a2**2 + 2*m2*a1*a2*cos(q2) + I2"
TORQUE = "m1*a1*g*cos(q1) + m2*a1*g*cos(q1) + m2*a2*g*cos(q1 + q2)"


def written(text: str, quantity: str, style: Style) -> Expr:
    cell = parse_expression(text, HERE)
    domain = PolynomialDomain(ARM, [cell])
    form = LectureForm(domain, SymbolRoles(frozenset({"m1", "m2", "I2"}), frozenset({"g"})), style)
    return getattr(form, quantity)(domain.constant(cell))


@pytest.mark.parametrize("style", NAMED_STYLES.values(), ids=NAMED_STYLES)
@pytest.mark.parametrize("quantity", ["kinematic", "dynamic", "gravity", "determinant"])
@pytest.mark.parametrize("text", [INERTIA, TORQUE, "sin(q1)*cos(q1 + q2) - cos(q1)*sin(q1 + q2)"])
def test_no_style_changes_the_value(text: str, quantity: str, style: Style) -> None:
    numbers = {"m1": 2, "m2": 3, "I2": 5, "g": 7, "a1": 11, "a2": 13, "q1": 0.3, "q2": 0.8}
    expected = sympy.sympify(text, locals={name: sympy.Symbol(name) for name in numbers}).subs(numbers)
    found = written(text, quantity, style).subs(numbers)
    assert float(found) == pytest.approx(float(expected), rel=1e-12)


def test_dynamics_are_grouped_by_mass_and_gravity_by_sines_and_cosines() -> None:
    m1, m2, a1, a2, g, q1, q2 = sympy.symbols("m1 m2 a1 a2 g q1 q2")
    inertia = written(INERTIA, "dynamic", Style())
    assert inertia.coeff(m2) == a1**2 + a2**2 + 2 * a1 * a2 * sympy.cos(q2)
    torque = written(TORQUE, "gravity", Style())
    assert torque.coeff(sympy.cos(q1)) == a1 * g * (m1 + m2)
    assert torque.coeff(sympy.cos(q1 + q2)) == a2 * g * m2


def test_a_difference_of_angles_is_contracted() -> None:
    text = "sin(q1)*cos(q1 + q2) - cos(q1)*sin(q1 + q2)"
    assert written(text, "kinematic", Style()) == -sympy.sin(sympy.Symbol("q2"))
