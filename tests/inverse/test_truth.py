"""The truth is true: complex solutions are as many as books count, and real starts find no other real ones."""

from __future__ import annotations

import numpy as np
import pytest

from derive.verification.oracle.frames import forward_kinematics
from tests.inverse import truth
from tests.inverse.arms import CLASSES, PUBLISHED, is_regular, random_arm

ARMS = {case.name: case for case in PUBLISHED}

COUNTS = {"planar-2r-position": 2, "anthropomorphic-position": 4, "scara-rrpr": 2}
"""Siciliano et al., section 2.12; Spong et al., chapter 5; Pieper 1968."""

MORE_COUNTS = {
    "puma560": 8,
    "ur5": 8,
    "stanford": 8,
    "dvrk-psm": 8,
    "jaco": 16,
    "crx-10ia": 16,
    "manseur-doty": 16,
    "panda": 8,
}
"""Lee and Liang 1988, Raghavan and Roth 1993: sixteen at the most."""


def chain_of(case):
    return truth.Chain(case.arm, {"pose": truth.POSE, "position": truth.POSITION}[case.task], case.given)


def check_truth(name, count):
    chain = chain_of(ARMS[name])
    q = np.random.default_rng(5).uniform(-3, 3, (3, chain.arm.n))
    everything = truth.AllSolutions(chain)
    assert everything.count == count
    real, sure = everything.real(q)
    assert sure.all()
    for own, one in zip(real, q, strict=True):
        assert chain.distance(own, one).min() < 1e-9
        assert np.abs(chain.values(own) - chain.values(one)).max() < 1e-10
        others = truth.by_many_starts(chain, one)
        assert len(others) <= len(own)
        assert all(chain.distance(own, other).min() < 1e-6 for other in others)


@pytest.mark.parametrize(("name", "count"), COUNTS.items())
def test_solutions_are_as_many_as_books_say(name, count):
    check_truth(name, count)


@pytest.mark.sweep
@pytest.mark.parametrize(("name", "count"), MORE_COUNTS.items())
def test_solutions_of_more_arms_are_as_many_as_papers_say(name, count):
    check_truth(name, count)


def test_random_arms_are_regular_the_same_again_and_in_both_conventions():
    cases = [random_arm(kind, number) for number, kind in enumerate(CLASSES)]
    assert cases[5] == random_arm(list(CLASSES)[5], 5)
    assert all(map(is_regular, cases))
    assert {case.modified for case in cases} == {False, True}


def test_poses_and_slopes_of_the_truth_are_those_of_the_oracle():
    case = random_arm("6DOF-P-other", 0)
    chain, q = chain_of(case), np.random.default_rng(1).uniform(-2, 2, (4, 6))
    assert np.allclose(chain.pose(q)[0], forward_kinematics(case.arm, q), atol=1e-13)
    exact = forward_kinematics(case.arm, q[:, None] + 1e-30j * np.eye(6)).imag[..., :3, :].reshape(4, 6, 12) / 1e-30
    units = np.tile(chain.weight, (6, 1)) * chain.scale[:, None]
    assert np.allclose(chain.values_and_slopes(q)[1], np.swapaxes(exact * units, -1, -2), atol=1e-12)
