"""Real zeros of factors, and of the common zeros of minors: what is claimed holds in numbers."""

from __future__ import annotations

import pytest

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial
from derive.model.singularities.rank import rank_loss
from derive.model.singularities.real_zeros import RealZeros
from derive.robot.robot import Robot

ARM = """
name: arm
convention: standard
parameters: {a: 0.5, b: 0.5}
joints:
  - {type: revolute, a: a, alpha: pi/2}
  - {type: revolute, a: b, alpha: x}
  - {type: prismatic, a: k}
"""
DOMAIN = PolynomialDomain(Robot.from_text(ARM), rates=False)
C1, S1 = DOMAIN.cosine_sine_of(0)
C2, S2 = DOMAIN.cosine_sine_of(1)
A, B, K, Q3 = (DOMAIN.ring.generator(name) for name in ("a", "b", "k", "q3"))


@pytest.mark.parametrize(
    ("polynomials", "exist"),
    [
        ([K * C1 + S1], True),  # changes its sign by half a turn
        ([Q3 + K * Q3 * C1], True),
        ([K * K + Q3 * Q3], None),  # k may be zero
        ([1 + K * K + Q3 * Q3], False),
        ([1 + C1 * C1], False),
        ([K + C1], None),  # depends on k
        ([A + B * C1], None),  # touches zero
        ([A + C1], True),
        ([3 * A + B * C1 + B * S2], False),
        ([2 + C1 * C2 + S1 * S2], False),
        ([C1 - 2 * S1 * C2, C2 + 2 * C1 - 5], False),
        ([C1 - C2, S1 - S2], None),
    ],
)
def test_what_is_said_of_zeros_is_true(polynomials: list[Polynomial], exist: bool | None) -> None:
    assert RealZeros(DOMAIN).exist(polynomials) is exist


def test_numbers_of_the_file_decide_what_vanishes() -> None:
    zeros = RealZeros(DOMAIN)
    assert zeros.vanishes(A - B)
    assert zeros.vanishes(K * (A - B) * C1 + (A - B) * S2)
    assert not zeros.vanishes(A + B)
    assert not zeros.vanishes(A - K)
    assert not zeros.vanishes((A - B) * C1 + K * S2)


def test_what_vanishes_in_numbers_is_neither_a_pivot_nor_a_minor() -> None:
    zero, still = DOMAIN.ring.zero, K * (A - B)
    loss = rank_loss(DOMAIN, [[[still, C1, zero], [zero, S2, still * C1 + (A - B) * S1]]])
    assert (loss.rank, loss.unless, loss.complete) == (1, (), True)
    assert [len(family) for family in loss.families] == [2]


def test_the_rank_is_less_where_all_minors_are_zero() -> None:
    loss = rank_loss(DOMAIN, [[[C1, K * S2], [DOMAIN.ring.zero, S2 * C1], [Q3 * S2, Q3]]])
    found = {frozenset(str(zero.factor.value.raw) for zero in family) for family in loss.families}
    assert (loss.rank, loss.complete) == (2, True)
    assert found == {frozenset({"cos q1", "sin q2"}), frozenset({"cos q1", "q3"}), frozenset({"sin q2", "q3"})}
