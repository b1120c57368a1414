"""The lecture form: terms, plans that keep what they stand for, trees and their ways to and from SymPy."""

import random
from fractions import Fraction

import pytest
import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.errors import ExpressionError, Location
from derive.lecture import plan
from derive.lecture.form import LectureForm, SymbolRoles
from derive.lecture.plan import FactorTable, Monomial, common_factor, divide, multiply, partition, project
from derive.lecture.sympy_conversion import (
    Expr,
    columns_matrix,
    expression_from_sympy,
    expression_to_sympy,
    factor_to_sympy,
)
from derive.robot.evaluate import evaluate
from derive.robot.expression import Number
from derive.robot.options.style import NAMED_STYLES, Style
from derive.robot.parser import FORMULA_FUNCTIONS, parse_expression
from derive.robot.reading.size_limits import FORMULA_LIMITS
from tests.rows import robot_of_rows

HERE = Location("<test>")
ARM = robot_of_rows("R a: a1 | R a: a2")
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


@pytest.mark.parametrize("seed", range(20))
def test_monomials_divide_and_are_put_together_again(seed: int) -> None:
    rng = random.Random(seed)
    terms = {monomial(rng): Fraction(rng.randint(1, 9)) for _ in range(8)}
    common = common_factor(terms)
    assert all(multiply(common, divide(m, common)) == m for m in terms)
    level = frozenset({0, 2, 4})
    parts = partition(terms, level)
    assert {multiply(outer, inner): c for outer, part in parts.items() for inner, c in part.items()} == terms
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


@pytest.mark.parametrize("text", ["a*(b - 2)/3", "sqrt(a + b)**3", "sin(a+b)*tan(b)", "atan2(a, b)+pi/5", "lambda + I"])
def test_there_and_back_is_the_same_number(text: str) -> None:
    tree = parse_expression(text, HERE, functions=FORMULA_FUNCTIONS, limits=FORMULA_LIMITS)
    numbers = {"a": 0.4, "b": 1.7, "lambda": 2.5, "I": 3.5}
    back = expression_from_sympy(expression_to_sympy(tree))
    assert evaluate(back, numbers) == pytest.approx(evaluate(tree, numbers), rel=1e-14)


def test_names_and_angles_stay_as_written_and_linear_rows_above_angular_ones() -> None:
    assert expression_to_sympy(parse_expression("I*E", HERE)) == sympy.Symbol("I") * sympy.Symbol("E")
    domain = PolynomialDomain(robot_of_rows("R a: a1, alpha: pi/5"))
    shown = {str(factor_to_sympy(domain, factor)) for factor in FactorTable(domain).factors}
    assert {"sin(q1)", "cos(q1)", "a1", "sin(pi/5)", "cos(pi/5)"} <= shown
    assert columns_matrix([(1, 2, 3)], [(4, 5, 6)], write=sympy.Integer) == sympy.Matrix([1, 2, 3, 4, 5, 6])


NUMBERS = [Fraction(n) for n in (2, 3, 5, 7, 11)]


def value(tree: plan.Plan) -> Fraction:
    match tree:
        case plan.Term(coefficient, monomial):
            total = coefficient
        case plan.Times(coefficient, monomial, inner):
            total = coefficient
            for part, exponent in inner:
                total *= value(part) ** exponent
        case plan.Plus(parts):
            return sum((value(part) for part in parts), Fraction(0))
    for factor, exponent in monomial:
        total *= NUMBERS[factor] ** exponent
    return total


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("signs", [(-1, 1), (-1,)])
def test_every_rule_keeps_the_value(seed: int, signs: tuple[int, ...]) -> None:
    rng = random.Random(seed)
    monomials = {tuple((f, rng.randint(1, 2)) for f in sorted(rng.sample(range(5), 3))) for _ in range(7)}
    terms = {m: Fraction(rng.choice(signs) * rng.randint(1, 4)) for m in sorted(monomials)}
    levels = [frozenset({0}), frozenset({1, 2})]
    plans = [
        plan.flat(terms),
        plan.factored(terms, plan.flat),
        plan.factored(terms, plan.flat, frozenset({0, 1})),
        plan.grouped(terms, levels[1], plan.flat),
        plan.nested(terms, levels),
    ]
    assert {*map(value, plans)} == {value(plans[0])}
    assert plan.cheapest(plans).operations == min(tree.operations for tree in plans)


def test_a_common_factor_saves_its_multiplications_and_a_sum_of_negatives_has_its_sign_outside() -> None:
    """x*y + x*z takes three operations, x*(y + z) two."""
    one = Fraction(1)
    terms = {((0, 1), (1, 1)): one, ((0, 1), (2, 1)): one}
    assert (plan.flat(terms).operations, plan.factored(terms, plan.flat).operations) == (3, 2)
    terms = {((0, 1), (1, 1)): Fraction(-1), ((0, 1), (2, 1)): Fraction(-2)}
    found = plan.factored(terms, plan.flat)
    assert isinstance(found, plan.Times)
    assert found.coefficient == -1


def test_squares_of_sums_are_found_and_sums_that_are_no_products_left() -> None:
    square = {((0, 2),): Fraction(1), ((0, 1), (1, 1)): Fraction(2), ((1, 2),): Fraction(1)}
    found = plan.product_form(square)
    assert isinstance(found, plan.Times)
    assert [exponent for _, exponent in found.inner] == [2]
    assert value(found) == value(plan.flat(square))
    assert plan.product_form({((0, 2),): Fraction(1), ((1, 2),): Fraction(1)}) is None
    single = {((0, 1), (1, 1)): Fraction(1), ((0, 1), (2, 1)): Fraction(1)}
    assert plan.product_form(single) is None
    assert plan.product_form(single, monomials=True) is not None


def _sum(*numbers: str) -> plan.Plan:
    """Number of factor 0, number of factor 1, ...; the first term is plain."""
    return plan.Plus(tuple(plan.Term(Fraction(n), ((k, 1),) if k else ()) for k, n in enumerate(numbers)))


def _numbers(tree: plan.Plan) -> list[Fraction]:
    match tree:
        case plan.Term(coefficient, _):
            return [coefficient]
        case plan.Times(coefficient, _, inner):
            return [coefficient, *(n for part, _ in inner for n in _numbers(part))]
        case plan.Plus(parts):
            return [n for part in parts for n in _numbers(part)]


@pytest.mark.parametrize(
    ("coefficient", "sums", "expected"),
    [
        ("-4.8e-8", [(("141", "10000"), 1)], ["-6.768e-6", "-4.8e-4"]),
        ("-4.8e-8", [(("141", "10000"), 2)], ["-4.8", "0.0141", "1"]),
        ("-1.7e-8", [(("31", "10000"), 1), (("-500", "0", "3441"), 1)], ["-0.17", "0.0031", "1", "-0.5", "0", "3.441"]),
        ("10", [(("0.1", "0.1"), 1), (("1", "1"), 1)], ["1", "1", "1", "1", "1"]),
        ("0.5", [(("1", "2"), 1), (("1", "1"), 1)], ["0.5", "1", "2", "1", "1"]),
        ("1", [(("0.05", "0.2"), 1), (("1", "1"), 1)], ["1", "0.05", "0.2", "1", "1"]),
    ],
)
def test_products_of_decimals_have_numbers_of_usual_size(
    coefficient: str, sums: list[tuple[tuple[str, ...], int]], expected: list[str]
) -> None:
    given = plan.Times(Fraction(coefficient), (), tuple((_sum(*numbers), exponent) for numbers, exponent in sums))
    plain = plan.with_plain_numbers(given)
    assert value(plain) == value(given)
    assert _numbers(plain) == [Fraction(n) for n in expected]
    assert plain.operations <= given.operations


@pytest.mark.parametrize("seed", range(20))
def test_plain_numbers_keep_the_value(seed: int) -> None:
    rng = random.Random(seed)

    def drawn() -> str:
        return str(rng.choice([-1, 1]) * Fraction(rng.randint(1, 10 ** rng.randint(1, 5)), rng.choice([1, 100])))

    sums = tuple((_sum(drawn(), drawn(), drawn()), rng.randint(1, 2)) for _ in range(rng.randint(1, 2)))
    given = plan.Times(Fraction(rng.randint(1, 999), 10**6), ((3, 1),), sums)
    plain = plan.with_plain_numbers(given)
    assert value(plain) == value(given)
    assert all(abs(n) < plan.LARGE_FACTOR for part, _ in getattr(plain, "inner", ()) for n in _numbers(part))
