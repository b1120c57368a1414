"""Small semidefinite problems whose answers are known."""

from __future__ import annotations

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.model.identification.semidefinite import Cone, Limit, least, packed, unpacked

pytest.importorskip("clarabel")


def test_symmetric_matrices_and_vectors_turn_into_each_other_with_the_same_products() -> None:
    random = np.random.default_rng(1)
    one, other = random.normal(size=(2, 5, 4, 4))
    one, other = one + one.swapaxes(1, 2), other + other.swapaxes(1, 2)
    assert np.allclose(unpacked(packed(one)), one)
    assert np.allclose((packed(one) * packed(other)).sum(axis=1), np.einsum("nab,nba->n", one, other))


def test_the_least_shift_that_makes_a_matrix_semidefinite_is_its_least_eigenvalue() -> None:
    matrix = np.array([[1.0, 2.0, 0.0], [2.0, -1.0, 0.5], [0.0, 0.5, 0.3]])
    found = least(np.ones(1), [Limit(Cone.SEMIDEFINITE, packed(matrix), packed(np.eye(3))[:, None])])
    values, vectors = np.linalg.eigh(matrix)
    assert abs(found.x[0] + values[0]) < 1e-8
    assert np.allclose(unpacked(found.prices[0]), np.outer(vectors[:, 0], vectors[:, 0]), atol=1e-6)


def test_quadratic_functions_and_lengths_have_their_least() -> None:
    bound = Limit(Cone.NOT_NEGATIVE, np.array([-1.0]), np.array([[1.0, 1.0]]))
    assert np.allclose(least(np.zeros(2), [bound], np.diag([1.0, 3.0])).x, [0.75, 0.25], atol=1e-7)
    length = Limit(Cone.LONGEST_FIRST, np.array([0.0, 3.0, 4.0]), np.array([[1.0], [0.0], [0.0]]))
    assert abs(least(np.ones(1), [length]).x[0] - 5) < 1e-7


def test_limits_that_contradict_each_other_are_told() -> None:
    above, below = (Limit(Cone.NOT_NEGATIVE, np.array([-1.0]), np.array([[sign]])) for sign in (1.0, -1.0))
    with pytest.raises(DeriveError, match="PrimalInfeasible"):
        least(np.ones(1), [above, below])
