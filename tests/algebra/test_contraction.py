"""Angle sums and squares: short forms are found, and they are equal to what went in."""

import random

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from derive.algebra.angles import contracted_groups
from derive.algebra.contraction import MAX_ENUMERATED, MAX_STARS, paths, trees
from derive.algebra.domain import PolynomialDomain, polynomial_expression
from derive.algebra.ring import Polynomial
from derive.errors import Location
from derive.lecture.form import LectureForm
from derive.robot.evaluate import to_float
from derive.robot.options.style import Contraction
from derive.robot.parser import parse_expression
from tests.evaluate import evaluate
from tests.rows import robot_of_rows

PLANAR = robot_of_rows("R a: a1 | R a: a2 | R a: a3")


def written(cell: str, *, sums: bool = True) -> sympy.Expr:
    expression = parse_expression(cell, Location("cell"))
    domain = PolynomialDomain(PLANAR, [expression], sums=lambda group: sums)
    return LectureForm(domain).kinematic(domain.constant(expression))


@pytest.mark.parametrize("sums", [True, False])
@pytest.mark.parametrize(
    ("cell", "form"),
    [
        ("cos(q1)*cos(q2) - sin(q1)*sin(q2)", "cos(q1 + q2)"),
        ("sin(q1)*cos(q2 + q3) + cos(q1)*sin(q2 + q3)", "sin(q1 + q2 + q3)"),
        ("cos(q1)*cos(q1 + q2) + sin(q1)*sin(q1 + q2)", "cos(q2)"),
        ("sin(q1 + q2 + q3)*cos(q1) - cos(q1 + q2 + q3)*sin(q1)", "sin(q2 + q3)"),
        ("1 - cos(q3)**2", "sin(q3)**2"),
        ("a**2*cos(q1)**2 + a**2*sin(q1)**2", "a**2"),
        ("cos(q1)**2 - sin(q1)**2 + 1", "2*cos(q1)**2"),
        ("cos(q2)*cos(q2 + q3)", "cos(q2)*cos(q2 + q3)"),
        ("a*cos(q1) + b*cos(q1 + q2) + c*cos(q1 + q2 + q3)", "a*cos(q1) + b*cos(q1 + q2) + c*cos(q1 + q2 + q3)"),
    ],
)
def test_the_short_form_is_found_from_either_basis(cell: str, form: str, sums: bool) -> None:
    assert written(cell, sums=sums) == sympy.sympify(form)


def random_polynomial(domain: PolynomialDomain, rng: random.Random) -> Polynomial:
    total = domain.ring.zero
    for _ in range(rng.randint(1, 6)):
        term = domain.ring.number(rng.randint(-3, 3))
        for _ in range(rng.randint(0, 4)):
            term = term * rng.choice(domain.cosine_sine_of(rng.randrange(3)))
        total = total + term * domain.ring.generator(rng.choice(["a1", "a2"]))
    return total


@settings(max_examples=80, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.booleans())
def test_contraction_never_changes_the_value(seed: int, sums: bool) -> None:
    rng = random.Random(seed)
    domain = PolynomialDomain(PLANAR, sums=lambda group: sums)
    p = random_polynomial(domain, rng)
    values = {name: rng.uniform(-2, 2) for name in ("q1", "q2", "q3", "a1", "a2", "a3")}
    plain = to_float(polynomial_expression(p, domain), values)
    form = LectureForm(domain)
    assert evaluate(form.kinematic(p), values) == pytest.approx(plain, abs=1e-9)
    assert evaluate(form.dynamic(p), values) == pytest.approx(plain, abs=1e-9)


def test_products_are_built_in_sympys_own_order() -> None:
    form = written("3*a**2*b*cos(q1)*sin(q2)*cos(q1 + q2)**2 + z*a*q1")
    assert form == form.func(*form.args)
    for product in form.atoms(sympy.Mul):
        assert product.args == sympy.Mul(*product.args).args


@pytest.mark.parametrize(
    ("rows", "groups"),
    [
        ("R | R | R", ((0, 1, 2),)),
        ("R alpha: pi/2 | R | R", ((0,), (1, 2))),
        ("R | R alpha: pi | P | R", ((0, 1), (3,))),
        ("R | P | R", ((0, 2),)),
        ("R theta: -q1 | R theta: -q2", ((0, 1),)),
        ("R theta: -q1 | R", ((0,), (1,))),
        ("R alpha: pi | R theta: -q2", ((0, 1),)),
        ("R alpha: al | P alpha: -al | R", ((0, 2),)),
        ("R alpha: al | R", ((0,), (1,))),
    ],
)
def test_groups_are_aligned_parallel_axes(rows: str, groups: tuple[tuple[int, ...], ...]) -> None:
    assert contracted_groups(robot_of_rows(rows), Contraction.ALIGNED)[0] == groups


@pytest.mark.parametrize("n", [6, 20, 64])
def test_long_parallel_chains_stay_sums_of_angles(n: int) -> None:
    """Every relative angle of a planar chain is one sine or cosine, however many joints lie between."""
    domain = PolynomialDomain(robot_of_rows("|".join(f"R a: a{i}" for i in range(1, n + 1))))
    form = LectureForm(domain)
    c1, s1 = domain.ring.generator("cos q1"), domain.ring.generator("sin q1")
    whole = "+".join(f"q{i}" for i in range(1, n + 1))
    relative = domain.ring.generator(f"cos {whole}") * c1 + domain.ring.generator(f"sin {whole}") * s1
    assert form.kinematic(relative) == sympy.cos(sum(sympy.Symbol(f"q{i}") for i in range(2, n + 1)))


@pytest.mark.parametrize("size", range(1, MAX_STARS + 2))
@pytest.mark.parametrize("sums", [True, False])
def test_every_basis_spans_all_angles_and_the_own_one_comes_first(size: int, sums: bool) -> None:
    bases = trees(size, sums)
    assert bases[0] == tuple((0 if sums else i, i + 1) for i in range(size))
    assert all(len(tree) == size and len(paths(tree, 0)) == size + 1 for tree in bases)
    assert len(set(bases)) == len(bases)
    if size <= MAX_ENUMERATED:
        assert len(bases) == (size + 1) ** (size - 1)  # Cayley's formula
