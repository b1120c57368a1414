"""The eliminations that an arm has, and those that serve it best."""

import math

import numpy as np
import pytest

from derive.model.inverse.elimination_choice import eliminations, find_general
from derive.model.inverse.numeric_chain import NumericChain
from tests.inverse.arms import PUBLISHED
from tests.model.inverse.test_closure import pose_of, random_loop


@pytest.mark.parametrize("types", ["RRRRRR", "RRPRRR"])
def test_a_general_arm_has_sixteen_eigenvalues(types):
    loop = random_loop(types)
    pose = pose_of(loop, np.random.default_rng(1).uniform(-2, 2, 6))
    assert min(each.eigenvalues for each in eliminations(loop, pose)) == 16


def test_the_best_elimination_is_first_and_no_two_hide_the_same_joint():
    arm = next(case for case in PUBLISHED if case.name == "jaco")
    found = find_general(NumericChain.of(arm.robot(choice=False), arm.values))
    places = [(each.start, each.hidden) for each in found]
    assert len(set(places)) == len(places) > 1
    assert found[0].eigenvalues == 16
    for each in found:
        assert sum(each.rows) == math.prod(
            (2 if joint in each.straight else 3) + (joint == each.multiplied)
            for joint in each.unknowns
            if joint != each.hidden
        )


def test_an_arm_of_two_joints_has_no_elimination():
    loop = random_loop("RR")
    chain = NumericChain(
        np.array([True, True]), np.ones(2), np.array(loop.gaps[:2]), loop.gaps[2], np.full((2, 2), (-math.pi, math.pi))
    )
    assert find_general(chain) == ()
