"""Kinematics nested from the base outwards is that of joint frames, of any scalars and of any length."""

from __future__ import annotations

import numpy as np
import pytest

from derive.lecture.form import LectureForm
from derive.lecture.matrices import columns_matrix, frame_matrix, only_body, symmetric_matrix
from derive.mechanics.exact_kinematics import Kinematics, Reference, jacobian_columns
from derive.model.long_chain import LongChain, nested_kinematics
from derive.model.model import Model
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.evaluate import evaluate
from tests.mechanics.arms import SEEDS, arm_of, assert_close


@pytest.mark.parametrize("seed", SEEDS)
def test_nested_kinematics_is_that_of_the_oracle(seed: int) -> None:
    arm = arm_of(seed)
    found = nested_kinematics(arm.chain)
    assert_close(found.end.rows(0.0, 1.0), arm.expected("forward_kinematics"))
    assert_close(np.vstack([np.array(found.linear).T, np.array(found.angular).T]), arm.expected("jacobian"))


@pytest.mark.parametrize("name", ["scara-perugia", "stanford-deluca", "puma560-corke"])
def test_nested_expressions_have_the_values_of_expanded_polynomials(name: str) -> None:
    robot = Robot.load(name)
    model = Model(robot)
    nested = LongChain(robot).kinematics
    symbols = sorted({*model.T.free_symbols, *frame_matrix(nested.end).free_symbols}, key=str)
    values = {symbol.name: 0.3 + 0.1 * k for k, symbol in enumerate(symbols)}
    assert_close(evaluate(frame_matrix(nested.end), values), evaluate(model.T, values))
    assert_close(evaluate(columns_matrix(nested.linear, nested.angular), values), evaluate(model.J, values))


def test_columns_of_the_exact_jacobian_are_derivatives_of_the_exact_pose() -> None:
    model = Model(Robot.load("scara-perugia"))
    assert isinstance(model.kinematics, Kinematics)
    columns = jacobian_columns(model.kinematics, Reference())
    assert len(columns) == model.robot.n
    for j, variable in enumerate(model.q):
        for i in range(3):
            slope = model.T[i, 3].diff(variable)
            assert (slope - LectureForm(model.domain).kinematic(columns[j][i])).expand(trig=True).equals(0)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_inertia_matrix_is_the_sum_over_links_and_rotors(seed: int) -> None:
    arm = arm_of(seed)
    values = parameter_values(arm.robot)
    total = np.diag([to_float(link.armature, values) for link in arm.robot.links])
    for i in range(1, arm.robot.n + 1):
        for part in (only_body(arm.robot, i, of_rotor=False), only_body(arm.robot, i, of_rotor=True)):
            total = total + Oracle.of(part).evaluate("inertia_matrix", arm.q)
    assert_close(total, arm.expected("inertia_matrix"))


def test_a_symmetric_matrix_from_its_upper_triangle() -> None:
    matrix = symmetric_matrix(3, [1, 2, 3, 4, 5, 6])
    assert matrix.tolist() == [[1, 2, 3], [2, 4, 5], [3, 5, 6]]
