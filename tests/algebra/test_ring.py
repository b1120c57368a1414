"""The ring of polynomials in sines, cosines and symbols: factors, quotients, residues."""

import math
import random
from fractions import Fraction

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factors import Factoring
from derive.algebra.generators import Kind
from derive.algebra.quotients import MAX_DENOMINATORS, QuotientRing
from derive.algebra.residues import Residue, ResidueDomain, echelon
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.errors import CheckError, Location
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.mechanics.chain import build_chain
from derive.robot.expression import Expression
from derive.robot.parser import FORMULA_FUNCTIONS, parse_expression
from derive.robot.reading.size_limits import FORMULA_LIMITS
from derive.robot.robot import Robot
from tests.random_robots import robot_text
from tests.rows import robot_of_rows

ODD = robot_of_rows("R alpha: 37*pi/180, a: a1 | R alpha: al2, d: sqrt(2)/3 | P theta: 0.3, a: 1/(b + 1)")


def domain_for(*cells: str) -> PolynomialDomain:
    return PolynomialDomain(ODD, [parse(cell) for cell in cells])


def parse(cell: str):  # type: ignore[no-untyped-def]
    return parse_expression(cell, Location("cell"))


def zero(*cells: str) -> Polynomial:
    """The sum of the cells, as a polynomial."""
    domain = domain_for(*cells)
    return sum((domain.constant(parse(cell)) for cell in cells), domain.ring.zero)


@pytest.mark.parametrize(
    "cell",
    [
        "sin(q1)**2 + cos(q1)**2 - 1",
        "cos(q1 + q2) - cos(q1)*cos(q2) + sin(q1)*sin(q2)",
        "sin(q1 - q2) - sin(q1)*cos(q2) + cos(q1)*sin(q2)",
        "cos(3*q1) - 4*cos(q1)**3 + 3*cos(q1)",
        "sqrt(2)*sqrt(3) - sqrt(6)",
        "sqrt(8) - 2*sqrt(2)",
        "sqrt(1/2) - sqrt(2)/2",
        "sqrt(a + b)**2 - a - b",
        "(a + b)/(a + b) - 1",
        "a/(a + b) + b/(a + b) - 1",
        "tan(al2)*cos(al2) - sin(al2)",
        "1 + tan(al2)**2 - 1/cos(al2)**2",
        "cos(pi/3) - 1/2",
        "cos(pi/12) - (sqrt(6) + sqrt(2))/4",
        "sin(7*pi/12) - (sqrt(6) + sqrt(2))/4",
        "cos(pi/12)**2 + sin(pi/12)**2 - 1",
        "sin(pi/3) - sqrt(3)/2",
        "sin(5*pi/4) + sqrt(2)/2",
        "cos(37*pi/180)**2 + cos(53*pi/180)**2 - 1",
        "sin(al2/2)*cos(al2/2)*2 - sin(al2)",
        "cos(0.3)**2 + sin(0.3)**2 - 1",
        "cos(q1 + pi/2) + sin(q1)",
        "pi*a - a*pi",
        # too long, or too many, for the addition theorem
        "cos(a + b + c + d + e + f)**2 + sin(a + b + c + d + e + f)**2 - 1",
        "sin(1000000*a)**2 + cos(1000000*a)**2 - 1",
        "sin(31*a)**2 + cos(31*a)**2 - 1",
        "cos(q1 + a + b + c + d + e)**2 + sin(q1 + a + b + c + d + e)**2 - 1",
    ],
)
def test_identities_reduce_to_zero(cell: str) -> None:
    assert not zero(cell)


@pytest.mark.parametrize("cell", ["sin(q1)**2 - cos(q1)**2", "sqrt(2) - 1.4142135623730951", "cos(37*pi/180) - 0.7986"])
def test_what_is_not_identical_stays(cell: str) -> None:
    assert zero(cell)


def test_the_normal_form_does_not_depend_on_the_order_of_operations() -> None:
    domain = domain_for("a", "b")
    s = domain.cosine_sine_of(0)[1]
    a, b = domain.ring.generator("a"), domain.ring.generator("b")
    assert (a + b) * s * s == s * (a * s) + b * s * s
    assert hash((a + b) * s) == hash(b * s + s * a)


@given(st.integers(-5, 5), st.fractions(max_denominator=30))
def test_numbers_mix_in_on_either_side(k: int, f: Fraction) -> None:
    x = RING.generator("a2")
    assert k + x == x + k
    assert f * x == x * f
    assert k - x == -(x - k)
    assert (f + x) - f == x


def test_a_budget_of_terms_is_kept() -> None:
    domain = PolynomialDomain(ODD, [parse("a + b")], max_terms=5)
    x = domain.ring.generator("a") + domain.ring.generator("b")
    with pytest.raises(TooManyTerms, match="more than 5 terms"):
        x**6


@pytest.mark.parametrize(("joint", "cell"), [(0, "cos(q1 + q2)"), (1, "sin(q2)**2*q3"), (2, "q3**2*cos(q1)")])
def test_derivatives_are_those_of_calculus(joint: int, cell: str) -> None:
    domain = domain_for(cell)
    symbol = sympy.Symbol(f"q{joint + 1}")
    text = str(sympy.diff(expression_to_sympy(parse(cell)), symbol))
    derived = domain.derivative(domain.constant(parse(cell)), joint)
    wide = domain_for(cell, text)
    assert wide.ring.project(derived) == wide.constant(parse(text))


DOMAIN = PolynomialDomain(Robot.load("puma560-corke"), rates=False)
RING = DOMAIN.ring


def product(p: Polynomial) -> Polynomial:
    return math.prod((factor.value**factor.exponent for factor in Factoring(DOMAIN).factors(p)), start=RING.one)


def some(rng: random.Random) -> Polynomial:
    c, s = DOMAIN.cosine_sine_of(rng.randrange(1, 5))
    a, b, d = (RING.generator(name) for name in rng.sample(["a2", "a3", "d3", "d4"], 3))
    return a * c + rng.choice([b, -b, RING.zero]) * s + rng.randint(-1, 1) * d


@pytest.mark.parametrize("seed", range(40))
def test_products_of_linear_forms_fall_apart_and_factors_multiply_to_the_polynomial(seed: int) -> None:
    rng = random.Random(seed)
    p = some(rng) * some(rng) * some(rng)
    found = Factoring(DOMAIN).factors(p)
    assert sum(factor.exponent for factor in found if not factor.value.is_constant) >= 3
    for polynomial in (p, p + some(rng)):
        assert product(polynomial) == polynomial


def test_squared_sines_sines_among_sums_and_zero_are_found_as_factors() -> None:
    c, s = DOMAIN.cosine_sine_of(2)
    found = Factoring(DOMAIN).factors(1 - c * c)
    assert [(f.value, f.exponent, f.kind, f.joints) for f in found] == [(s, 2, Kind.SINE, (2,))]
    c2, s2 = DOMAIN.cosine_sine_of(1)
    c3, s3 = DOMAIN.cosine_sine_of(2)
    sum_sine = s2 * c3 + c2 * s3
    found = {(f.kind, f.joints) for f in Factoring(DOMAIN).factors(s3 * sum_sine * c2)}
    assert found == {(Kind.SINE, (2,)), (Kind.SINE, (1, 2)), (Kind.COSINE, (1,))}
    assert [f.value for f in Factoring(DOMAIN).factors(RING.zero)] == [RING.zero]


HERE = Location("<test>")
ARM = robot_of_rows("R a: a1 | R a: a2")


def tree(text: str) -> Expression:
    return parse_expression(text, HERE, functions=FORMULA_FUNCTIONS | {"sign"}, limits=FORMULA_LIMITS)


def equal(left: str, right: str) -> bool:
    formulas = tree(left), tree(right)
    return not QuotientRing(ARM, formulas).difference(*formulas)


SAME = [
    ("tan(q1)", "sin(q1)/cos(q1)"),
    ("tan(q1/2)", "sin(q1)/(1 + cos(q1))"),
    ("1/(1 + 1/a1)", "a1/(a1 + 1)"),
    ("1/a1 + 1/a2", "(a1 + a2)/(a1*a2)"),
    ("(1 - cos(q1)**2)/sin(q1)", "sin(q1)"),
    ("sqrt(a1)**2/a2", "a1/a2"),
    ("sign(a1)*atan2(a1, a2) + 1/a2", "atan2(a1, a2)*sign(a1) + a2**-1"),
]
OTHER = [("tan(q1)", "tan(q2)"), ("1/a1", "a1"), ("sign(a1)", "sin(a1)")]


@pytest.mark.parametrize(("left", "right"), SAME + OTHER)
def test_equal_formulas_differ_by_zero_and_others_do_not(left: str, right: str) -> None:
    assert equal(left, right) is ((left, right) in SAME)


def test_divisions_by_zero_and_many_denominators_are_refused() -> None:
    with pytest.raises(CheckError, match="zero everywhere"):
        equal("1/(sin(q1)**2 + cos(q1)**2 - 1)", "0")
    with pytest.raises(TooManyTerms):
        QuotientRing(ARM, [tree(" + ".join(f"1/b{i}" for i in range(MAX_DENOMINATORS + 1)))])


@pytest.mark.parametrize(("text", "faithful"), [("a1*sin(q1)/a2", True), ("sqrt(a1)", False), ("sign(a1)", False)])
def test_only_plain_formulas_are_told_apart_for_certain(text: str, faithful: bool) -> None:
    assert QuotientRing(ARM, [tree(text)]).faithful is faithful


PRIME = 2**31 - 1


@pytest.mark.parametrize("seed", range(12))
def test_the_image_respects_products_and_relations(seed: int) -> None:
    """Rotations stay rotations, roots stay roots: the whole chain of a robot is carried over."""
    domain = PolynomialDomain(Robot.from_text(robot_text(random.Random(seed), 3)), rates=False)
    image = ResidueDomain(domain, 4, seed)
    rng = random.Random(seed)
    joints = build_chain(domain.robot, domain).joints
    entries = [v for joint in joints for row in joint.fixed.rotation for v in row]
    entries += [v for joint in joints for v in (joint.cosine, joint.sine, joint.offset)]
    for _ in range(20):
        a, b = rng.choice(entries), rng.choice(entries)
        assert equal_images(image.value(a * b), image.value(a) * image.value(b))
        assert equal_images(image.value(a + b), image.value(a) + image.value(b))
        assert equal_images(image.value(a - b), image.value(a) - image.value(b))


def equal_images(a: Residue, b: Residue) -> bool:
    return bool(np.all(a.values == b.values))


def test_fractions_and_signs_go_over() -> None:
    half = Residue(PRIME, [[1]]) * Fraction(1, 2)
    assert (half + half).values.tolist() == [[1]]
    assert (1 - half).values.tolist() == half.values.tolist()
    assert (-half + half).values.tolist() == [[0]]


@pytest.mark.parametrize("seed", range(6))
def test_the_echelon_form_gives_every_column_in_the_first_independent_ones(seed: int) -> None:
    rng = np.random.default_rng(seed)
    left, right = rng.integers(0, PRIME, (12, 4)), rng.integers(0, 9, (4, 9))
    matrix = np.array(left.astype(object) @ right.astype(object) % PRIME, dtype=np.int64)
    pivots, form = echelon(matrix, PRIME)
    assert len(pivots) == 4
    assert pivots[0] == 0
    for j in range(9):
        combined = sum(matrix[:, p].astype(object) * int(form[k, j]) for k, p in enumerate(pivots)) % PRIME
        assert np.all(combined == matrix[:, j])
