"""Elementary equations are solved in print as they are in numbers, in the forms of textbooks."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import mpmath
import pytest
import sympy

from derive.algebra.ring import Polynomial, Ring
from derive.inverse.words.elementary import Scribe, Sign, Solved
from derive.lecture.point import value_of

NAMES = ("x", "y", "a", "b", "d")
RING = Ring(NAMES)
x, y, a, b, d = map(RING.generator, NAMES)
zero, one = RING.zero, RING.one
VALUES = dict(zip(NAMES, (mpmath.mpf(k) for k in ("0.7", "-0.9", "0.5", "0.4", "0.3")), strict=True))


def written(p: Polynomial) -> sympy.Expr:
    terms = []
    for exponents, coefficient in p.terms():
        powers = (sympy.Symbol(name) ** e for name, e in zip(NAMES, exponents, strict=True))
        terms.append(sympy.Mul(sympy.Rational(coefficient.numerator, coefficient.denominator), *powers))
    return sympy.Add(*terms)


def moves(p: Polynomial) -> bool:
    return any(p.degrees()[:2])


def scribe() -> Scribe:
    return Scribe(written, set(NAMES), moves)


def values(by: Scribe, solved: Solved) -> list[mpmath.mpf]:
    """The unknown for all choices of signs."""
    signs = sorted({s for e in (solved.value, *(line.value for line in by.lines)) for s in e.free_symbols}, key=str)
    signs = [sign for sign in signs if isinstance(sign, Sign)]
    found = []
    for choice in product((1, -1), repeat=len(signs)):
        known = {sympy.Symbol(name): value for name, value in VALUES.items()}
        known.update(zip(signs, map(mpmath.mpf, choice), strict=True))
        for line in by.lines:
            known[line.symbol] = value_of(line.value, known)
        found.append(value_of(solved.value, known))
    return found


def number(p: Polynomial) -> mpmath.mpf:
    return value_of(written(p), {sympy.Symbol(name): value for name, value in VALUES.items()})


ONE_EQUATION = {
    "both": (y, x, a),
    "scaled": (2 * a * b, -2 * a * d, x * x - y * y - b * b + d * d),
    "cosine": (2 * a * b, zero, x * x - a * a - b * b),
    "sine": (zero, a, b * d),
    "no constant": (-x, y, zero),
    "numbers": (3 * one, -4 * one, one),
}


@pytest.mark.parametrize("equation", ONE_EQUATION.values(), ids=ONE_EQUATION)
def test_both_angles_of_one_equation_satisfy_it(equation: Sequence[Polynomial]) -> None:
    by = scribe()
    first, second = values(by, by.one_equation("1", tuple(equation)))  # type: ignore[arg-type]
    assert abs(mpmath.sin((first - second) / 2)) > 1e-3
    A, B, C = map(number, equation)
    for angle in (first, second):
        assert abs(A * mpmath.cos(angle) + B * mpmath.sin(angle) - C) < 1e-12


def test_a_factor_that_moves_is_kept_with_its_sign_which_solution_is_which() -> None:
    towards = [scribe().one_equation("1", (e * a * x, e * b * x, d * one)).value for e in (1, -1)]
    assert all(sympy.Symbol("x") in value.free_symbols for value in towards)
    assert "/x" not in str(towards[0])
    assert "a*x" not in str(scribe().one_equation("1", (a * b, a * d, x)).value)


TWO_EQUATIONS = {
    "turned": ((a + b, -d, x), (d, a + b, y)),
    "turned and mirrored": ((a, d, x), (d, -a, y)),
    "apart": ((a, zero, x), (zero, -b, y)),
    "crossed": ((zero, a, x), (b, zero, y)),
    "any": ((a, x, b), (y, d, a)),
}


@pytest.mark.parametrize("equations", TWO_EQUATIONS.values(), ids=TWO_EQUATIONS)
def test_the_angle_of_two_equations_has_their_cosine_and_sine_but_for_a_positive_factor(
    equations: tuple[Sequence[Polynomial], ...],
) -> None:
    by = scribe()
    (angle,) = values(by, Solved(by.two_equations(sympy.Symbol("q"), "1", *map(tuple, equations))))  # type: ignore[arg-type]
    (A, B, C), (D, E, F) = (map(number, equation) for equation in equations)
    solution = mpmath.lu_solve(mpmath.matrix([[A, B], [D, E]]), mpmath.matrix([C, F]))
    assert abs(mpmath.sin((angle - mpmath.atan2(solution[1], solution[0])) / 2)) < 1e-12


@pytest.mark.parametrize("equation", [(one, zero, -x * x - d * d), (one, 2 * x, -y * y), (zero, a, x), (a, b, -d)])
def test_lengths_satisfy_their_equation(equation: tuple[Polynomial, Polynomial, Polynomial]) -> None:
    by = scribe()
    A, B, C = map(number, equation)
    found = values(by, by.length("1", equation))
    assert len(found) == (2 if A else 1)
    assert all(abs(A * r * r + B * r + C) < 1e-12 for r in found)


def test_names_clash_with_nothing() -> None:
    by = Scribe(written, {"D", "E", "F", "D_2"}, moves)
    assert by.name(("D", "E", "F"), "2") == "E_2"
    assert by.name(("D", "E", "F"), "2") == "F_2"
    assert by.name(("D", "E", "F"), "2") == "D_1"


def test_a_law_of_cosines_has_the_form_of_textbooks() -> None:
    by = scribe()
    solved = by.one_equation("2", (2 * a * b, zero, x * x + y * y - a * a - b * b))
    assert str(by.lines[0].symbol) == "D"
    assert str(by.lines[0].value) == "(-a**2 - b**2 + x**2 + y**2)/(2*a*b)"
    assert str(solved.value) == "atan2(epsilon_2*sqrt(1 - D**2), D)"


def test_an_offset_beside_an_axis_has_the_form_of_textbooks() -> None:
    by = scribe()
    solved = by.one_equation("1", (y, -x, d))
    assert str(solved.value) == "-atan2(d, epsilon_1*sqrt(-d**2 + x**2 + y**2)) + atan2(y, x)"
    assert str(solved.exists) == "x**2 + y**2 >= d**2"
