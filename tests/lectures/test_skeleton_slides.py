"""Document 001, 'Cinematica degli scheletri': its matrices, slide by slide; its curves are in `tests/motion`."""

from __future__ import annotations

import pytest
from sympy import Expr, Matrix, Symbol, cos, exp, eye, sin, symbols

from derive.model.model import Model
from derive.robot.robot import Robot

l0, l1, Tx, Ty = symbols("l0 l1 Tx Ty")
beta, alpha = symbols("q1 q2")

ORIGIN = Matrix([0, 0, 0, 1])


def turned(angle: Symbol) -> Matrix:
    """The document's rotation, clockwise seen from +z."""
    return Matrix([[cos(angle), sin(angle), 0, 0], [-sin(angle), cos(angle), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def shifted(x: object, y: object = 0) -> Matrix:
    found = eye(4)
    found[0, 3], found[1, 3] = x, y
    return found


FACTORS = [shifted(Tx, Ty), turned(beta), shifted(l0), turned(alpha), shifted(l1)]
"""From the root to the hand, as slides 6 to 10 collect them from the hand to the root."""


@pytest.fixture(scope="module")
def model() -> Model:
    return Model(Robot.load("skeleton"))


@pytest.fixture(scope="module")
def modified() -> Model:
    """The same chain as slide 17 writes its matrices: first the link, then the turn."""
    return Model(Robot.load("skeleton-modified"))


def vanishes(expression: Expr) -> bool:
    """Decided: exponentials of sums of angles are independent."""
    return bool(expression.rewrite(exp).expand() == 0)


def equal(ours: Matrix, theirs: Matrix) -> bool:
    return ours.shape == theirs.shape and all(map(vanishes, ours - theirs))


def product(factors: list[Matrix]) -> Matrix:
    found = eye(4)
    for factor in factors:
        found = found * factor
    return found


def test_slides_6_to_10_the_end_point_grows_factor_by_factor(model: Model, modified: Model) -> None:
    both = alpha + beta
    printed = {
        6: (1, (l1, 0)),
        7: (2, (l1 * cos(alpha), -l1 * sin(alpha))),
        8: (3, (l1 * cos(alpha) + l0, -l1 * sin(alpha))),
        9: (4, (l1 * cos(both) + l0 * cos(beta), -l1 * sin(both) - l0 * sin(beta))),
        10: (5, (l1 * cos(both) + l0 * cos(beta) + Tx, -l1 * sin(both) - l0 * sin(beta) + Ty)),
    }
    for slide, (count, place) in printed.items():
        assert equal(product(FACTORS[-count:]) * ORIGIN, Matrix([*place, 0, 1])), slide
    assert equal(model.A(2) * ORIGIN, Matrix([*printed[7][1], 0, 1]))
    assert equal((model.A(1) * model.A(2)) * ORIGIN, Matrix([*printed[9][1], 0, 1]))
    assert equal(model.T, product(FACTORS))
    assert equal(modified.T, model.T)


def test_slide_17_the_planar_matrix_is_a_row_of_a_modified_table(modified: Model) -> None:
    assert equal(modified.A(2), shifted(l0) * turned(alpha))
    assert equal(modified.A(1), turned(beta))


def test_slides_18_and_19_the_product_as_printed_is_not_the_initial_transform(model: Model) -> None:
    """'verificare che risulta la trasformazione iniziale': with the printed columns (l, 0, 0) it does not."""
    printed = [shifted(l0) * turned(beta), shifted(l1) * turned(alpha)]
    found = shifted(Tx, Ty) * printed[0] * printed[1] * ORIGIN
    assert equal(found, Matrix([Tx + l0 + l1 * cos(beta), Ty - l1 * sin(beta), 0, 1]))
    assert not equal(found, model.T * ORIGIN)
    corrected = [turned(beta) * shifted(l0), turned(alpha) * shifted(l1)]
    assert equal(shifted(Tx, Ty) * corrected[0] * corrected[1], model.T)
    assert [equal(ours, model.A(k)) for k, ours in enumerate(corrected, start=1)] == [True, True]
