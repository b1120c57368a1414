"""The curve of the hand: document 001, slides 25 to 29."""

from __future__ import annotations

import numpy as np
import pytest
from sympy import Symbol, cos, latex, pi, sin, sqrt

from derive.errors import QuantityError
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.model.kinematic_model import KinematicModel
from derive.motion.hand_curve import HandCurve, printed_hand, printed_weights
from derive.motion.motion import Motion
from derive.plans.hermite import TIME
from tests.motion.plans import PICK_AND_PLACE
from tests.motion.skeleton import REACH, ROOT

L0, L1 = Symbol("l0"), Symbol("l1")


@pytest.fixture(scope="module")
def root() -> HandCurve:
    return HandCurve(Motion.from_text(ROOT))


def test_slide_29_the_hand_is_a_formula_of_the_curves(root: HandCurve) -> None:
    """P_e(t) = (l1 c_ab + l0 c_b + Tx, -l1 s_ab - l0 s_b + Ty), of alpha(t), beta(t), Tx(t), Ty(t)."""
    values = Motion.from_text(ROOT).plan.curves
    assert list(values) == ["q1", "q2", "q3", "q4"]
    beta, alpha = pi / 3 + sin(TIME) / 2, pi / 4 * sin(2 * TIME)
    x, y, z = root.formula
    assert (x - (L1 * cos(alpha + beta) + L0 * cos(beta) + 3 * TIME / 10)).expand() == 0
    assert (y - (-L1 * sin(alpha + beta) - L0 * sin(beta) + TIME**2 / 10)).expand() == 0
    assert z == 0


def test_formula_and_numbers_agree_and_velocities_are_derivatives() -> None:
    t, h = np.linspace(0, 5, 6), 1e-6
    for text in (REACH, ROOT):
        hand = HandCurve(Motion.from_text(text))
        p, v = hand(t)
        numbers = {L0: 0.4, L1: 0.3, Symbol("Tx"): 0.1, Symbol("Ty"): 0.2}
        for axis, entry in enumerate(hand.formula):
            rate = entry.diff(TIME)
            for place, speed, at in zip(p[:, axis], v[:, axis], t, strict=True):
                assert float(entry.subs(numbers).subs(TIME, at)) == pytest.approx(place, abs=1e-12)
                assert float(rate.subs(numbers).subs(TIME, at)) == pytest.approx(speed, abs=1e-12)
        assert (hand(t + h)[0] - hand(t - h)[0])[1:-1] / (2 * h) == pytest.approx(v[1:-1], abs=1e-8)


def test_a_base_that_moves_is_the_root_with_joints() -> None:
    moving = REACH.replace(", rpy: [0, 0, t/7]", "").replace("Tx: 0.1, Ty: 0.2", "Tx: 0, Ty: 0")
    t = np.linspace(0, 5, 50)
    for ours, theirs in zip(HandCurve(Motion.from_text(moving))(t), HandCurve(Motion.from_text(ROOT))(t), strict=True):
        assert ours == pytest.approx(theirs, abs=1e-12)


def test_slide_27_how_far_each_joint_moves_the_hand(root: HandCurve) -> None:
    """About P0 by sqrt(l1^2 + l0^2 + 2 l1 l0 cos a), about P1 by l1; the root by one."""
    one, two, shoulder, elbow = root.weights
    alpha = Symbol("q4")
    assert one == two == 1
    assert (shoulder**2 - (L0**2 + L1**2 + 2 * L0 * L1 * cos(alpha))).expand() == 0
    assert (elbow**2 - L1**2).expand() == 0
    assert list(printed_weights(Motion.from_text(ROOT)))[2].startswith("q3 moves the hand by sqrt(")


@pytest.mark.parametrize(
    ("point", "place", "rank", "determinant"),
    [
        ("rest", (4, 0, -1), 3, 0),
        ("A", (-2, 2, -1), 4, -4),
        ("B", (-2, 2, -3), 4, -4),
        ("C", (0, 4, -1), 3, 0),
        ("D", (0, 4, -3), 3, 0),
    ],
)
def test_points_of_document_004(point: str, place: tuple[int, ...], rank: int, determinant: int) -> None:
    """Simulation pages: where the five points are; three of them are singular, th2 = 0, the only singularity."""
    plan = Motion.from_text(PICK_AND_PLACE).plan
    model = KinematicModel(plan.robot)
    numbers = {Symbol(name): expression_to_sympy(value) for name, value in plan.robot.parameters}
    numbers |= {
        Symbol(joint.variable): expression_to_sympy(value)
        for joint, value in zip(plan.robot.joints, plan.points[point].q or (), strict=True)
    }
    assert tuple(model.p.subs(numbers)) == place
    assert model.J.subs(numbers).rank() == rank
    assert model.det_J(rows=(1, 2, 3), columns=(1, 2, 3)).subs(numbers) == determinant


def test_the_hand_of_document_004_runs_on_a_limacon() -> None:
    """Simulation pages, rest to A: q1 = q2 = u, p = 2(e^iu + e^2iu), and |dp/du| = 2 sqrt(5 + 4 cos u)."""
    motion = Motion.from_text(PICK_AND_PLACE)
    t = np.linspace(0, 3, 61)
    u, rate = (value[:, 0] for value in motion(t)[:2])
    p, v = HandCurve(motion)(t)
    assert p[:, 0] + 1j * p[:, 1] == pytest.approx(2 * (np.exp(1j * u) + np.exp(2j * u)), abs=1e-12)
    assert p[:, 2] == pytest.approx(np.full(61, -1.0), abs=1e-12)
    assert np.linalg.norm(v, axis=1) == pytest.approx(2 * np.sqrt(5 + 4 * np.cos(u)) * rate, abs=1e-12)
    a, b = Symbol("q1"), Symbol("q2")
    x, y, _ = HandCurve(motion).position
    arm = {Symbol("a1"): 2, Symbol("a2"): 2, a: TIME, b: TIME}
    squared = sum(entry.subs(arm).diff(TIME) ** 2 for entry in (x, y))
    assert (squared - (2 * sqrt(5 + 4 * cos(TIME))) ** 2).simplify() == 0


def test_print_leaves_out_what_is_always_zero_and_says_positions_and_velocities() -> None:
    lines = list(printed_hand(Motion.from_text(ROOT)))
    assert [line.split(" =")[0].strip() for line in lines] == ["hand", "px", "py", "vx", "vy"]
    assert "3*t/10" in lines[1]
    in_latex = list(printed_hand(Motion.from_text(ROOT), as_latex=True))
    assert in_latex[1].startswith("p_x(t) = ")
    assert latex(L0) in in_latex[1]


def test_a_symbol_without_number_is_named() -> None:
    hand = HandCurve(Motion.from_text(ROOT.replace("l0: 0.4, ", "")))
    with pytest.raises(QuantityError, match="'l0'"):
        hand(np.zeros(1))
    with pytest.raises(QuantityError, match="only curves"):
        _ = HandCurve(Motion.from_text(PICK_AND_PLACE)).formula
