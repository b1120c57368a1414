"""Document 001, 'Cinematica degli scheletri', slide by slide: what can be checked of 34 slides without a number."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest
from sympy import Expr, Matrix, Symbol, cos, exp, eye, sin, symbols

from derive.model.model import Model
from derive.motion.hand_curve import HandCurve
from derive.motion.incremental import Walker
from derive.motion.motion import Motion
from derive.motion.output.page import motion_page
from derive.robot.robot import Robot
from tests.motion.plans import ROOT

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


def test_slide_27_columns_of_the_jacobian_weigh_the_joints(model: Model) -> None:
    """The same turn moves the hand by sqrt(l1^2 + l0^2 + 2 l1 l0 cos a) about P0 and by l1 about P1."""
    about_p0, about_p1 = (model.J[:3, k] for k in range(2))
    assert vanishes(about_p0.dot(about_p0) - (l1**2 + l0**2 + 2 * l1 * l0 * cos(alpha)))
    assert vanishes(about_p1.dot(about_p1) - l1**2)
    text = "robot: skeleton\ncurves: {q1: t}\ntime: 1\nvalues: {l0: 2, l1: 1, Tx: 0, Ty: 0}"
    hand = HandCurve(Motion.from_text(text))
    assert hand.weights[1] == l1
    assert vanishes(hand.weights[0] ** 2 - (l0**2 + 2 * l0 * l1 * cos(alpha) + l1**2))


def test_slides_25_to_29_curves_in_curve_of_the_hand_out() -> None:
    """P(t) = f(alpha(t), beta(t), Tx(t), Ty(t) | l0, l1): any curves do, at any time, to rounding."""
    motion = Motion.from_text(ROOT)
    t = np.linspace(0, 5, 101)
    b, a = np.pi / 3 + np.sin(t) / 2, np.pi / 4 * np.sin(2 * t)
    x = 0.3 * np.cos(a + b) + 0.4 * np.cos(b) + 0.3 * t
    y = -0.3 * np.sin(a + b) - 0.4 * np.sin(b) + t**2 / 10
    p, v = HandCurve(motion)(t)
    assert p == pytest.approx(np.stack([x, y, 0 * t], axis=1), abs=1e-12)
    rates = np.cos(t) / 2, np.cos(t) / 2 + np.pi / 2 * np.cos(2 * t)
    speed = -0.3 * np.sin(a + b) * rates[1] - 0.4 * np.sin(b) * rates[0] + 0.3
    assert v[:, 0] == pytest.approx(speed, abs=1e-12)


@pytest.mark.parametrize("target", [(0.25, -0.45), (0.6, 0.1), (-0.3, -0.2)])
def test_slide_32_many_small_displacements_err_by_the_step_and_close(target: tuple[float, float]) -> None:
    walker = Walker(Robot.load("skeleton"), {"l0": 0.4, "l1": 0.3, "Tx": 0.0, "Ty": 0.0})
    wanted = np.array([*target, 0.0])
    errors = [walker.walk(np.array([0.3, 0.9]), wanted, steps) for steps in (100, 200, 400, 800)]
    ratios = [coarse.error / fine.error for coarse, fine in pairwise(errors)]
    assert ratios == pytest.approx([2, 2, 2], rel=0.08)
    assert abs(ratios[-1] - 2) < abs(ratios[0] - 2) + 1e-3
    for found in errors:
        assert np.linalg.norm(walker.place(found.q[-1]) - wanted) <= 1e-9


def test_slides_3_and_28_a_page_plays_a_curve_for_each_degree_of_freedom() -> None:
    page = motion_page(Motion.load("skeleton-reach"))
    start = page.index('{"modified"')
    configuration, _ = json.JSONDecoder().raw_decode(page[start:])
    tracks = configuration["playback"]["tracks"]
    assert [[piece[0] for piece in track] for track in tracks] == [["curve"]] * 4
    assert page.count('class="player-plot"') >= 6
