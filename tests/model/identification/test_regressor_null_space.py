"""Changes of bodies that no torque notices, against the oracle's regressor."""

from __future__ import annotations

import numpy as np
import pytest

from derive.mechanics.space import exactly
from derive.model.identification.base_parameters import base_set
from derive.model.identification.exact_scalars import ExactDomain, is_zero
from derive.model.identification.regressor_null_space import WIDTH, bare_chain, combined, directions, keeping
from derive.robot.inertial_parameters import LINK_PARTS, Parameter
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle


@pytest.mark.parametrize("name", ["puma560-corke", "scara-matlab"])
def test_no_torque_notices_any_direction_and_there_are_no_more(name: str) -> None:
    robot = Robot.load(name)
    with exactly():
        domain = ExactDomain(robot)
        basis = directions(robot, bare_chain(robot, domain), domain)
        matrix = np.array([[float(entry) for entry in direction] for direction in basis])
    # the oracle's columns in joint frames: any link parameter may be asked for as if it were a base parameter
    columns = tuple(Parameter(i, part) for i in range(1, robot.n + 1) for part in LINK_PARTS)
    q, qd, qdd = np.random.default_rng(1).uniform(-2, 2, (3, 60, robot.n))
    regressor = Oracle.of(robot, base=columns).evaluate("base_regressor", q, qd, qdd).reshape(-1, len(columns))
    assert np.abs(regressor @ matrix.T).max() <= 1e-12 * np.abs(regressor).max()
    rank = np.linalg.matrix_rank(regressor, tol=1e-9 * np.abs(regressor).max())
    assert np.linalg.matrix_rank(matrix) == len(matrix) == len(columns) - rank
    assert rank <= len(base_set(robot).parameters)


def test_links_that_are_to_stay_do_not_change() -> None:
    robot = Robot.load("puma560-corke")
    with exactly():
        domain = ExactDomain(robot)
        basis = directions(robot, bare_chain(robot, domain), domain)
        fewer = keeping(basis, [1, 3])
        assert 0 < len(fewer) < len(basis)
        for direction in fewer:
            assert all(is_zero(direction[WIDTH * i + k]) for i in (1, 3) for k in range(WIDTH))
        total = combined(fewer, [domain.number(k) for k in range(len(fewer))])
        assert all(total[k] == sum(w * d[k] for w, d in enumerate(fewer)) for k in range(len(total)))
