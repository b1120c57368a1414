"""The interpreter of solution graphs, on a graph written by hand: the planar arm of two links."""

from __future__ import annotations

import numpy as np
import pytest

from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.walk import GraphWalk
from tests.inverse.closed.test_graph import planar_graph


def pose_at(q: np.ndarray, a1: float, a2: float) -> list[list[np.ndarray]]:
    x = a1 * np.cos(q[0]) + a2 * np.cos(q[0] + q[1])
    y = a1 * np.sin(q[0]) + a2 * np.sin(q[0] + q[1])
    c, s, zero = np.cos(q[0] + q[1]), np.sin(q[0] + q[1]), np.zeros_like(x)
    return [[c, -s, zero, x], [s, c, zero, y], [zero, zero, zero + 1, zero]]


def test_every_configuration_is_among_the_solutions_of_its_pose_and_all_lead_there() -> None:
    q = np.random.default_rng(3).uniform(-3, 3, (2, 200))
    pose = pose_at(q, 0.7, 0.4)
    run = GraphWalk(planar_graph(), FloatField({"a1": 0.7, "a2": 0.4}), pose)
    found = []
    for leaf in run.leaves():
        assert np.all(leaf.exists)
        angles = np.stack(run.angles(leaf))
        again = pose_at(angles, 0.7, 0.4)
        assert np.allclose(again[0][3], pose[0][3], atol=1e-12)
        assert np.allclose(again[1][3], pose[1][3], atol=1e-12)
        found.append(np.abs(np.exp(1j * angles) - np.exp(1j * q)).max(axis=0))
    assert len(found) == planar_graph().leaves == 2
    assert np.min(found, axis=0).max() < 1e-7


@pytest.mark.parametrize(("x", "branches"), [(1.1, 1), (1.1 + 1e-15, 1), (1.2, 0), (0.25, 0), (1.0, 2)])
def test_on_the_boundary_there_is_one_branch_and_beyond_it_none(x: float, branches: int) -> None:
    zero, one = np.zeros(1), np.ones(1)
    pose = [[one, zero, zero, np.array([x])], [zero, one, zero, zero], [zero, zero, one, zero]]
    run = GraphWalk(planar_graph(), FloatField({"a1": 0.7, "a2": 0.4}), pose)
    leaves = list(run.leaves())
    assert sum(int(np.all(leaf.exists)) for leaf in leaves) == branches
    assert all(np.isfinite(run.angles(leaf)).all() for leaf in leaves)


def test_where_a_folded_arm_can_turn_freely_the_joint_is_said_to_be_free() -> None:
    zero, one = np.zeros(1), np.ones(1)
    pose = [[one, zero, zero, zero], [zero, one, zero, zero], [zero, zero, one, zero]]
    run = GraphWalk(planar_graph(), FloatField({"a1": 0.5, "a2": 0.5}), pose, near=[np.array([0.3]), zero])
    leaf = next(run.leaves())
    assert np.all(leaf.exists)
    assert np.all(leaf.free[0])
    assert not np.any(leaf.free[1])
    assert np.allclose(run.angles(leaf), [[0.3], [np.pi]], atol=1e-7)
