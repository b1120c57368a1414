"""The order of textbooks does not depend on the order in which SymPy holds terms and factors."""

from __future__ import annotations

import random

from sympy import Symbol, cos, pi, sin

from derive.handouts.notation.notation import Notation, Order, is_below
from derive.robot.robot import Robot

ROBOT = Robot.load("planar-2r-perugia")
Q1, Q2, QD1, QDD1 = (Symbol(name) for name in ("q1", "q2", "qd1", "qdd1"))
A1 = Symbol("a1")
MASS = Symbol(next(iter(Notation.of(ROBOT).inertial)))


def test_factors_stand_from_masses_to_accelerations() -> None:
    wanted = [MASS, A1, cos(Q1), sin(Q1), cos(Q1 + Q2), cos(Q2), A1 + cos(Q2), QD1, QDD1]
    for seed in range(20):
        shuffled = random.Random(seed).sample(wanted, len(wanted))
        assert sorted(shuffled, key=Order(Notation.of(ROBOT)).factor) == wanted


def test_terms_stand_from_accelerations_to_multiples_of_pi() -> None:
    wanted = [MASS * QDD1, MASS * QD1**2, A1, A1 * cos(Q1), A1 * cos(Q1 + Q2), pi]
    for seed in range(20):
        shuffled = random.Random(seed).sample(wanted, len(wanted))
        assert sorted(shuffled, key=Order(Notation.of(ROBOT)).term) == wanted


def test_negative_powers_are_denominators() -> None:
    assert is_below((1 / A1).as_base_exp()[1])
    assert not is_below((A1**2).as_base_exp()[1])
