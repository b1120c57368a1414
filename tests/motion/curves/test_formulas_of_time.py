"""Formulas that a joint can follow."""

from __future__ import annotations

import pytest
from sympy import Abs, DiracDelta, cos, sign, sin, sqrt, tan

from derive.errors import DeriveError
from derive.motion.curves.formulas_of_time import followed
from derive.motion.motion import Motion
from derive.plans.hermite import TIME as t


@pytest.mark.parametrize(
    ("formula", "duration", "expected"),
    [
        (sqrt(t**2), 2, t),
        (sqrt((t - 2) ** 2), 2, 2 - t),
        (Abs(t - 3) + Abs(sin(t)), 1, 3 - t + sin(t)),
        (sqrt(t**2 + 1) + tan(t / 2), 3, sqrt(t**2 + 1) + tan(t / 2)),
        (1 / (t + 1), 2, 1 / (t + 1)),
    ],
)
def test_magnitudes_that_keep_their_sign_are_written_without(formula, duration, expected) -> None:  # type: ignore[no-untyped-def]
    found = followed(formula, duration)
    assert found == expected
    assert not found.diff(t).diff(t).has(DiracDelta, sign)


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        (sqrt((t - 1) ** 2), r"velocity jumps near t = 1 s"),
        (Abs(cos(t)), r"velocity jumps near t = 1.571 s"),
        (1 / (t - 0.7), r"division by zero near t = 0.7 s"),
        (1 / (1 - sin(t)), r"division by zero near t = 1.571 s"),
        (tan(t), r"tangent at its pole near t = 1.571 s"),
        (sqrt(t - 1), r"root of a negative number near t = 0 s"),
        (sqrt(t), r"its velocity is not finite: division by zero near t = 0 s"),
        (t * sqrt(t), r"its acceleration is not finite: division by zero near t = 0 s"),
    ],
)
def test_others_are_refused_with_the_time(formula, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(DeriveError, match=message) as caught:
        followed(formula, 2)
    assert caught.value.exit_status == 2
    assert "allowed: formulas with a finite velocity" in str(caught.value)


def test_a_plan_names_the_formula_and_its_place() -> None:
    head = "robot: {name: p, convention: standard, joints: [{type: revolute, a: 1}]}\n"
    with pytest.raises(DeriveError, match=r"p.yaml:2:14: curves, q1: the velocity jumps near t = 0.5 s"):
        Motion.from_text(head + "curves: {q1: sqrt((t - 1/2)**2)}\ntime: 1\n", "p.yaml")
    with pytest.raises(DeriveError, match=r"p.yaml:4:11: base, x: division by zero near t = 0 s"):
        Motion.from_text(head + "curves: {q1: t}\ntime: 1\nbase: {x: 1/t}\n", "p.yaml")
