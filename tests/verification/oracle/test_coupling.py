"""The oracle of coupled joints against Pinocchio and MuJoCo, which know the joints, and a constant matrix S."""

import random
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from derive.exchange.formats import exported
from derive.verification.oracle.functions import FUNCTIONS, Oracle
from tests.exchange.arms import dressed
from tests.random_robots import seeds
from tests.random_trees import coupled, random_tree
from tests.verification.oracle.pinocchio_reference import Array, Reference
from tests.verification.oracle.test_physics import TOLERANCE, motion, relative_error
from tests.verification.oracle.test_trees import check_functions

# By the axes of a function's value, from the last, along which there is an entry for each joint.
AXES: dict[Sequence[int], tuple[str, ...]] = {
    (): ("forward_kinematics", "link_transforms", "kinetic_energy", "potential_energy"),
    (-1, -2): (
        *("jacobian_hessian", "inertia_matrix", "coriolis_matrix", "inverse_dynamics_dq", "inverse_dynamics_dqd"),
        *("wrench_torques_dq", "wrench_torques_end_dq"),
    ),
}


def projected(outside: Reference, name: str, s: Array, given: Sequence[Array]) -> Array:
    """What Pinocchio computes joint by joint, by variables: S^T f(S q, S qd, S qdd)."""
    of_joints = [x if argument == "h" else s @ x for argument, x in zip(FUNCTIONS[name].arguments, given, strict=True)]
    if name == "forward_dynamics":
        q, qd, tau = *of_joints[:2], given[2]
        bias = s.T @ outside.inverse_dynamics(q, qd, np.zeros_like(q))
        return np.array(np.linalg.solve(s.T @ outside.inertia_matrix(q) @ s, tau - bias))
    value = getattr(outside, name)(*of_joints)
    for axis in next((axes for axes, names in AXES.items() if name in names), (-1,)):
        value = np.moveaxis(np.tensordot(value, s, (axis, 0)), -1, axis)
    return np.asarray(value)


@pytest.mark.parametrize("seed", seeds(100, 4, 100))
def test_every_function_is_that_of_the_joints_projected(seed: int) -> None:
    drawn = random_tree(random.Random(seed), 1 + seed % 9)
    drawn = replace(drawn, table=replace(drawn.table, joints=tuple(replace(j, sign=1) for j in drawn.table.joints)))
    robot, s = coupled(random.Random(seed), drawn.robot)
    assert {"forward_dynamics", "inverse_dynamics_dq"} <= {*Oracle.of(robot).functions}
    check_functions(drawn, robot, s, projected, seed)


@pytest.mark.parametrize("name", ["planar-3r", "kuka-kr5", "scara-perugia"])
def test_mujocos_inertia_and_bias_projected_are_ours(name: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    drawn = dressed(name, calm=True)
    plain = replace(drawn, joints=tuple(replace(joint, sign=1) for joint in drawn.joints))
    robot, s = coupled(random.Random(name), plain)
    model, given = mujoco.MjModel.from_xml_string(exported(plain, "mjcf", "given").text), motion(robot.dof, 3)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = s @ given["q"], s @ given["qd"]
    mujoco.mj_forward(model, data)
    inertia = np.zeros((robot.dof, plain.n))
    for row, column in zip(inertia, s.T, strict=True):
        mujoco.mj_mulM(model, data, row, column)
    oracle, still = Oracle.of(robot), np.zeros(robot.dof)
    assert relative_error(oracle.evaluate("inertia_matrix", given["q"]), inertia @ s) < TOLERANCE
    bias = oracle.evaluate("inverse_dynamics", given["q"], given["qd"], still)
    assert relative_error(bias, s.T @ (data.qfrc_bias - data.qfrc_passive)) < TOLERANCE
