"""Polynomial equations between joints as eigenvalue problems."""

import numpy as np
import pytest

from derive.inverse.general.choice import eliminations
from derive.inverse.general.elimination import EigenProblem
from tests.inverse.general.test_closure import pose_of, random_loop


@pytest.mark.parametrize("types", ["RRRRRR", "PRRPRR", "RRRRR"])
def test_the_hidden_joint_is_among_the_eigenvalues_and_the_others_in_the_eigenvector(types):
    loop = random_loop(types)
    q = np.random.default_rng(2).uniform(-2, 2, loop.n)
    pose = pose_of(loop, q)
    tried = sorted(eliminations(loop, pose), key=lambda each: each.eigenvalues)[:6]
    assert tried
    for elimination in tried:
        problem = EigenProblem.of(loop, elimination)
        values, vectors, turn, singular = problem.eigen(pose)
        assert not singular.any()
        assert values.shape == (1, elimination.eigenvalues)
        hidden = q[elimination.hidden]
        wanted = np.tan((hidden - turn[0]) / 2) if loop.revolute[elimination.hidden] else hidden
        which = np.abs(values[0] - wanted).argmin()
        assert abs(values[0, which] - wanted) < 1e-6 * (1 + wanted**2)
        product = np.ones(1)
        for joint, size in zip(problem.others, problem.shape, strict=True):
            x = q[joint]
            line = (1, np.cos(x), np.sin(x)) if loop.revolute[joint] else (1, x, x * x, x**3)[:size]
            if size == 4 and loop.revolute[joint]:
                line = (np.cos(1.5 * x), np.sin(1.5 * x), np.cos(0.5 * x), np.sin(0.5 * x))
            product = np.multiply.outer(product, line).reshape(-1)
        vector = vectors[0, :, which]
        parallel = abs(np.vdot(vector, product)) / np.linalg.norm(vector) / np.linalg.norm(product)
        assert parallel > 1 - 1e-6
