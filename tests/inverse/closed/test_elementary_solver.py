"""Elementary equations solved over floats: every value satisfies its equation, and coinciding ones are one."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from derive.algebra.ring import Polynomial, Ring
from derive.inverse.closed.elementary_solver import CONIC_TERMS, Branch, Solver
from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.nodes import NodeEquation, NodeFormula, NodeKind, Provenance

RING = Ring(("x",))
SOURCE = Provenance(1, 2, "p.p")


def _number(p: Polynomial) -> np.float64:
    return np.float64(sum(coefficient for _, coefficient in p.terms()))


def _equation(coefficients: dict[tuple[int, ...], Fraction | int]) -> NodeEquation:
    kept = {exponents: RING.number(Fraction(value)) for exponents, value in coefficients.items() if value}
    return NodeEquation(kept, 0, SOURCE)


def solved(kind: NodeKind, *equations: NodeEquation) -> list[Branch]:
    solver = Solver(FloatField({}), _number, np.float64(1))
    formula = NodeFormula(kind, equations)
    assert not solver.degenerate(formula)
    return [branch for branch in solver.solve(formula) if branch.exists]


def rest(equation: NodeEquation, branch: Branch) -> float:
    """What the equation is at a value."""
    terms = equation.terms.items()
    return float(sum(_number(p) * np.prod(np.power(branch.numbers, e)) for e, p in terms))


ONE_ANGLE = [(3, 4, 2), (3, 0, 2), (0, -4, 1), (1, 2, 0), (-2, 1, -1)]


@pytest.mark.parametrize(("a", "b", "c"), ONE_ANGLE)
def test_one_equation_has_the_two_angles_that_satisfy_it(a: int, b: int, c: int) -> None:
    equation = _equation({(1, 0): a, (0, 1): b, (0, 0): -c})
    first, second = solved(NodeKind.TYPE_2, equation)
    for branch in (first, second):
        assert abs(rest(equation, branch)) < 1e-14
        assert abs(np.hypot(*branch.numbers) - 1) < 1e-14
    assert np.abs(np.subtract(first.numbers, second.numbers)).max() > 0.1


@pytest.mark.parametrize(("c", "count"), [(4, 2), (5, 1), (6, 0)])
def test_where_two_angles_coincide_one_is_left_and_beyond_none(c: int, count: int) -> None:
    found = solved(NodeKind.TYPE_2, _equation({(1, 0): 3, (0, 1): 4, (0, 0): -c}))
    assert len(found) == count
    assert all(bool(branch.boundary) == (count == 1) for branch in found)


@pytest.mark.parametrize("kept", [(3, 4, -4, 3), (2, 0, 0, 5), (0, 2, 5, 0)])
def test_two_equations_have_the_angle_that_satisfies_both(kept: tuple[int, int, int, int]) -> None:
    a, b, d, e = kept
    cosine, sine = Fraction(3, 5), Fraction(-4, 5)
    first = _equation({(1, 0): a, (0, 1): b, (0, 0): -(a * cosine + b * sine)})
    second = _equation({(1, 0): d, (0, 1): e, (0, 0): -(d * cosine + e * sine)})
    (branch,) = solved(NodeKind.TYPE_3, first, second)
    assert np.allclose(branch.numbers, [0.6, -0.8], atol=1e-15)


@pytest.mark.parametrize(("a", "b", "c", "count"), [(0, 2, -3, 1), (1, 0, -4, 2), (2, 3, -5, 2), (1, 2, 3, 0)])
def test_lengths_satisfy_their_equation(a: int, b: int, c: int, count: int) -> None:
    equation = _equation({(2,): a, (1,): b, (0,): c})
    found = solved(NodeKind.QUADRATIC if a else NodeKind.TYPE_1, equation)
    assert len(found) == count
    assert all(abs(rest(equation, branch)) < 1e-13 for branch in found)


def test_a_conic_meets_the_unit_circle_in_four_points() -> None:
    equation = _equation(dict(zip(CONIC_TERMS, (4, 1, -3, 1, -1, 0), strict=True)))
    found = solved(NodeKind.CONIC, equation)
    assert len(found) == 4
    assert all(abs(rest(equation, branch)) < 1e-12 for branch in found)
    assert all(abs(np.hypot(*branch.numbers) - 1) < 1e-12 for branch in found)


@pytest.mark.parametrize("sine_or_cosine", [0, 1])
@pytest.mark.parametrize("away", [1e-3, 1e-6, 1e-9])
def test_beside_a_folded_elbow_of_equal_lengths_the_angle_has_all_its_digits(away: float, sine_or_cosine: int) -> None:
    """2 c = x^2 - 2: beside c = -1 the sine is x, but for x^3, and 1 - c^2 would have lost it."""
    ring = Ring(("x",))
    x = ring.generator("x")
    terms = {(1, 0) if sine_or_cosine else (0, 1): ring.number(Fraction(2)), (0, 0): 2 - x * x}
    solver = Solver(FloatField({}), lambda p: np.float64(sum(c * away ** e[0] for e, c in p.terms())), np.float64(1))
    both = solver.solve(NodeFormula(NodeKind.TYPE_2, (NodeEquation(terms, 2, SOURCE),)))
    assert all(branch.exists and not branch.boundary for branch in both)
    found = [branch.numbers[sine_or_cosine] for branch in both]
    np.testing.assert_allclose(found, np.array([1, -1]) * away * np.sqrt(1 - away**2 / 4), rtol=1e-12)


@pytest.mark.parametrize(("short", "known"), [(1e-3, True), (1e-9, True), (1e-13, False)])
def test_equations_that_are_one_turned_determine_an_angle_where_they_have_a_length(short: float, known: bool) -> None:
    x = Ring(("x",)).generator("x")
    rows = ({(1, 0): 3 * x, (0, 1): 4 * x, (0, 0): -5 * x}, {(1, 0): -4 * x, (0, 1): 3 * x})
    solver = Solver(FloatField({}), lambda p: np.float64(sum(c * short ** e[0] for e, c in p.terms())), np.float64(1))
    formula = NodeFormula(NodeKind.TYPE_3, tuple(NodeEquation(row, 1, SOURCE) for row in rows))
    assert bool(solver.degenerate(formula)) is not known


def test_a_length_that_may_be_negative_is_no_square_and_rounding_leaves_it_its_root() -> None:
    ring = Ring(("x",))
    terms = {(1, 0): ring.number(Fraction(1)), (0, 0): 1 - ring.generator("x")}
    solver = Solver(
        FloatField({}), lambda p: np.float64(sum(c * (-1e-16) ** e[0] for e, c in p.terms())), np.float64(1)
    )
    first, second = solver.solve(NodeFormula(NodeKind.TYPE_2, (NodeEquation(terms, 1, SOURCE),)))
    assert (bool(first.exists), bool(first.boundary), bool(second.exists)) == (True, True, False)


def test_two_entries_of_a_rotation_are_nowhere_degenerate_and_nothing_is_computed_to_see_that() -> None:
    first, second = _equation({(1, 0): 1, (0, 0): -1}), _equation({(0, 1): 1, (1, 0): 0, (0, 0): 0})
    turned = [
        _equation({(1, 0): Fraction(3, 5), (0, 1): Fraction(4, 5)}),
        _equation({(1, 0): Fraction(-4, 5), (0, 1): Fraction(3, 5)}),
    ]
    for pair in ((first, second), turned):
        assert not Solver(FloatField({}), _refuse, np.float64(1)).degenerate(NodeFormula(NodeKind.TYPE_3, tuple(pair)))


def _refuse(p: Polynomial) -> np.float64:
    raise AssertionError(p)
