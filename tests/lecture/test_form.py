"""The lecture form: terms, trees and their ways to and from SymPy."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.errors import ExpressionError, Location
from derive.lecture.form import LectureForm, SymbolRoles
from derive.lecture.matrices import columns_matrix, symmetric_matrix
from derive.lecture.sympy_conversion import Expr, expression_from_sympy, expression_to_sympy, factor_to_sympy
from derive.lecture.terms import FactorTable, Monomial, common_factor, divide, partition, project
from derive.robot.evaluate import evaluate
from derive.robot.expression import Number
from derive.robot.options.style import NAMED_STYLES, Style
from derive.robot.parser import FORMULA_FUNCTIONS, parse_expression
from derive.robot.reading.size_limits import FORMULA_LIMITS
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


def test_dynamics_are_grouped_by_mass_gravity_by_sines_and_differences_of_angles_contracted() -> None:
    m1, m2, a1, a2, g, q1, q2 = sympy.symbols("m1 m2 a1 a2 g q1 q2")
    inertia = written(INERTIA, "dynamic", Style())
    assert inertia.coeff(m2) == a1**2 + a2**2 + 2 * a1 * a2 * sympy.cos(q2)
    torque = written(TORQUE, "gravity", Style())
    assert torque.coeff(sympy.cos(q1)) == a1 * g * (m1 + m2)
    assert torque.coeff(sympy.cos(q1 + q2)) == a2 * g * m2
    text = "sin(q1)*cos(q1 + q2) - cos(q1)*sin(q1 + q2)"
    assert written(text, "kinematic", Style()) == -sympy.sin(sympy.Symbol("q2"))


def test_a_difference_of_angles_is_one_factor_whose_number_does_not_depend_on_what_is_asked_for() -> None:
    domain = PolynomialDomain(ARM, sums=lambda group: False)
    (c1, s1), (c2, s2) = domain.cosine_sine_of(0), domain.cosine_sine_of(1)
    table = FactorTable(domain)
    ((monomial, coefficient),) = table.terms(c1 * (c1 * c2 - s1 * s2) + s1 * (s1 * c2 + c1 * s2)).items()
    ((factor, exponent),) = monomial
    assert (coefficient, exponent) == (1, 1)
    assert (table.factors[factor].kind, table.factors[factor].joints) == (Kind.COSINE, (1,))
    asked, fresh = FactorTable(PolynomialDomain(ARM)), FactorTable(PolynomialDomain(ARM))
    asked.terms(asked.domain.cosine_sine_of(1)[0] ** 2)
    assert asked.factors == fresh.factors


def monomial(rng: random.Random) -> Monomial:
    return tuple((f, rng.randint(1, 3)) for f in sorted(rng.sample(range(6), rng.randint(0, 4))))


def product(a: Monomial, b: Monomial) -> Monomial:
    total = dict(a)
    for f, e in b:
        total[f] = total.get(f, 0) + e
    return tuple(sorted(total.items()))


@pytest.mark.parametrize("seed", range(20))
def test_monomials_divide_and_are_put_together_again(seed: int) -> None:
    rng = random.Random(seed)
    terms = {monomial(rng): Fraction(rng.randint(1, 9)) for _ in range(8)}
    common = common_factor(terms)
    assert all(product(common, divide(m, common)) == m for m in terms)
    level = frozenset({0, 2, 4})
    parts = partition(terms, level)
    assert {product(outer, inner): c for outer, part in parts.items() for inner, c in part.items()} == terms
    assert all(project(inner, level) == () for part in parts.values() for inner in part)


X, Y = sympy.symbols("x y")


@pytest.mark.parametrize(
    "expression",
    [
        X**2 / 3 - Y,
        sympy.sqrt(X + 1) / Y,
        sympy.sin(X) * sympy.cos(Y) + sympy.tan(X),
        sympy.sec(X) + sympy.csc(Y) - sympy.cot(X),
        (X + Y) ** sympy.Rational(-3, 2),
        sympy.atan2(X, Y) + sympy.pi / 7,
        X * 0.25,
    ],
)
def test_the_tree_has_the_value_of_the_expression(expression: sympy.Expr) -> None:
    numbers = {"x": 0.7, "y": 1.9}
    found = evaluate(expression_from_sympy(expression), numbers)
    assert found == pytest.approx(float(expression.subs(numbers)), rel=1e-14)


def test_a_float_is_the_decimal_that_it_prints_and_shared_parts_stay_shared() -> None:
    assert expression_from_sympy(0.1) == Number(Fraction(1, 10))
    part = sympy.sin(X) + Y
    tree = expression_from_sympy(part**2 + sympy.cos(part))
    power, call = sorted(tree.terms, key=lambda term: type(term).__name__, reverse=True)
    assert power.base is call.arguments[0]


@pytest.mark.parametrize(
    "expression",
    [sympy.exp(X), X**Y, X ** sympy.Rational(1, 3), X**99, sympy.oo, sympy.I, sympy.zoo, "x", sympy.eye(2)],
)
def test_anything_else_is_refused(expression: object) -> None:
    with pytest.raises(ExpressionError):
        expression_from_sympy(expression)


@pytest.mark.parametrize(
    "text", ["a*(b - 2)/3", "sqrt(a + b)**3", "sin(a + b)*tan(b)", "atan2(a, b) + pi/5", "lambda + I"]
)
def test_there_and_back_is_the_same_number(text: str) -> None:
    tree = parse_expression(text, HERE, functions=FORMULA_FUNCTIONS, limits=FORMULA_LIMITS)
    numbers = {"a": 0.4, "b": 1.7, "lambda": 2.5, "I": 3.5}
    back = expression_from_sympy(expression_to_sympy(tree))
    assert evaluate(back, numbers) == pytest.approx(evaluate(tree, numbers), rel=1e-14)


def test_users_names_are_symbols_and_constant_angles_stay_as_they_are_written() -> None:
    assert expression_to_sympy(parse_expression("I*E", HERE)) == sympy.Symbol("I") * sympy.Symbol("E")
    robot = Robot.from_text("name: arm\nconvention: standard\njoints: [{type: revolute, a: a1, alpha: pi/5}]\n")
    domain = PolynomialDomain(robot)
    shown = {str(factor_to_sympy(domain, factor)) for factor in FactorTable(domain).factors}
    assert {"sin(q1)", "cos(q1)", "a1", "sin(pi/5)", "cos(pi/5)"} <= shown


def test_matrices_come_from_their_upper_triangle_and_from_linear_above_angular_rows() -> None:
    assert symmetric_matrix(3, [1, 2, 3, 4, 5, 6]) == sympy.Matrix([[1, 2, 3], [2, 4, 5], [3, 5, 6]])
    assert columns_matrix([(1, 2, 3)], [(4, 5, 6)], write=sympy.Integer) == sympy.Matrix([1, 2, 3, 4, 5, 6])
