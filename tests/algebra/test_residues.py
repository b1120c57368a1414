"""Polynomials modulo a prime: sums, products and the relations of the ring go over; ranks are those of the image."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest

from derive.algebra.domain import PolynomialDomain
from derive.algebra.residues import Residue, ResidueDomain, echelon
from derive.mechanics.chain import build_chain
from derive.robot.robot import Robot
from tests.random_robots import robot_text

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
        assert equal(image.value(a * b), image.value(a) * image.value(b))
        assert equal(image.value(a + b), image.value(a) + image.value(b))
        assert equal(image.value(a - b), image.value(a) - image.value(b))


def equal(a: Residue, b: Residue) -> bool:
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


def test_zero_and_one_give_the_other_operand_and_all_others_what_integers_give() -> None:
    prime, numbers = 101, [[3, 50, 100]]
    many, zero, one, two = (Residue(prime, values) for values in (numbers, [[0]], [[1]], [[2]]))
    assert many * one is many is one * many
    assert many + zero is many is zero + many
    assert many - zero is many
    assert (zero - many).values.tolist() == [[98, 51, 1]]
    assert many * zero is zero is zero * many
    assert (many * two).values.tolist() == [[6, 100, 99]] == (two * many).values.tolist()
    assert (many + one).values.tolist() == [[4, 51, 0]]
