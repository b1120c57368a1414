"""Joints from eigenvalues and vectors, and the three that were eliminated."""

import numpy as np
import pytest

from derive.inverse.general.candidates import candidates, finished
from derive.inverse.general.choice import eliminations
from derive.inverse.general.elimination import EigenProblem
from tests.inverse.general.test_closure import pose_of, random_loop


def apart(loop, joints, q):
    """Differences of joints from q, full turns aside; NaN where a joint is not known."""
    difference = joints - q
    return np.abs(np.where(loop.revolute, 2 * np.sin(difference / 2), difference))


@pytest.mark.parametrize("types", ["RRRRRR", "PRRPRR", "RRRRR"])
def test_a_configuration_is_among_the_candidates_of_its_pose_first_in_part_and_then_whole(types):
    loop = random_loop(types)
    q = np.random.default_rng(7).uniform(-2, 2, (3, loop.n))
    pose = np.concatenate([pose_of(loop, one) for one in q])
    elimination = min(eliminations(loop, pose[:1]), key=lambda each: each.eigenvalues)
    problem = EigenProblem.of(loop, elimination)
    found = candidates(problem, pose)
    known = list(elimination.unknowns)
    whole = finished(problem, found, pose)
    assert np.isnan(np.delete(found.joints, known, axis=1)).all()
    assert not found.doubtful.any()
    for place, one in enumerate(q):
        part = apart(loop, found.joints[found.place == place], one)[:, known]
        assert part.max(axis=1).min() < 1e-6
        assert apart(loop, whole.joints[whole.place == place], one).max(axis=1).min() < 1e-6


def test_the_joints_of_an_arm_whose_position_is_wanted_follow_from_linear_equations():
    loop = random_loop("RRR").with_tip
    q = np.array([0.4, -1.1, 0.8])
    pose = pose_of(random_loop("RRR"), q)
    elimination = min(eliminations(loop, pose), key=lambda each: each.eigenvalues)
    problem = EigenProblem.of(loop, elimination)
    whole = finished(problem, candidates(problem, pose), pose)
    assert apart(loop, whole.joints, np.append(q, 0.0)).max(axis=1).min() < 1e-6
