"""MuJoCo moves an exported arm as the equations do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from derive.exchange.formats import exported
from derive.exchange.to_mjcf import mjcf_text
from derive.robot.expression import number
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import EVERY, FEW, dressed, numeric

mujoco = pytest.importorskip("mujoco")

SWEEP = [pytest.param(name, marks=[] if name in FEW else pytest.mark.sweep) for name in EVERY]


def worst(robot: Robot, text: str) -> tuple[float, float]:
    """Largest differences of accelerations, relative, and of poses at random states in which all joints slip."""
    model = mujoco.MjModel.from_xml_string(text)
    data, oracle, random = mujoco.MjData(model), Oracle.of(robot), np.random.default_rng(1)
    accelerations, poses = 0.0, 0.0
    for _ in range(10):
        q, tau = random.uniform(-3, 3, robot.n), random.uniform(-20, 20, robot.n)
        qd = random.choice([-1, 1], robot.n) * random.uniform(1, 2, robot.n)
        data.qpos[:], data.qvel[:], data.ctrl[:] = q, qd, tau
        mujoco.mj_forward(model, data)
        expected = oracle.evaluate("forward_dynamics", q, qd, tau)
        accelerations = max(accelerations, np.abs(data.qacc - expected).max() / max(1, np.abs(expected).max()))
        pose = oracle.evaluate("forward_kinematics", q)
        found = np.column_stack([data.site_xmat[0].reshape(3, 3), data.site_xpos[0]])
        poses = max(poses, np.abs(found - pose[:3]).max())
    return accelerations, poses


@pytest.mark.parametrize("name", SWEEP)
def test_accelerations_with_armature_and_viscous_friction_are_ours(name: str) -> None:
    robot = dressed(name)
    assert max(worst(robot, exported(robot, "mjcf").text)) < 1e-12


@pytest.mark.parametrize("name", ["planar-2r-perugia", "scara-matlab", "skeleton-modified"])
def test_rotors_are_coupled_where_axes_keep_their_angles(name: str) -> None:
    robot = dressed(name, rotors=True)
    made = exported(robot, "mjcf")
    assert max(worst(robot, made.text)) < 1e-12
    assert not any("coupling" in remark for remark in made.remarks)


def test_a_coupling_that_varies_is_named() -> None:
    remarks = exported(dressed("kuka-kr5", rotors=True), "mjcf").remarks
    expected = "MJCF cannot say the coupling of the rotor with the joints before it, which depends on q, of q4, q5, q6"
    assert expected in remarks


def test_coulomb_friction_is_ours_while_joints_slip() -> None:
    robot = dressed("kuka-kr5", coulomb=True)
    assert max(worst(robot, exported(robot, "mjcf").text)) < 1e-12


def test_limits_and_torques_are_those_of_the_robot() -> None:
    robot = dressed("planar-3r")
    first = replace(robot.joints[0], limits=(number("-0.5"), number(2)), torque=number(7))
    made = exported(replace(robot, joints=(first, *robot.joints[1:])), "mjcf")
    model = mujoco.MjModel.from_xml_string(made.text)
    assert model.jnt_limited.tolist() == [1, 0, 0]
    assert model.jnt_range[0].tolist() == [-0.5, 2]
    assert model.actuator_ctrllimited.tolist() == [1, 0, 0]
    assert model.actuator_ctrlrange[0].tolist() == [-7, 7]


def test_an_arm_without_masses_moves_with_those_of_its_cylinders() -> None:
    made = exported(numeric("kuka-kr5"), "mjcf")
    assert mujoco.MjModel.from_xml_string(made.text).body_mass[1:].min() > 0
    assert any("cylinders" in remark for remark in made.remarks)


def test_bodies_that_mujoco_refuses_are_named_before() -> None:
    made = exported(numeric("puma560-corke"), "mjcf")
    assert "MuJoCo refuses link 1, 3: no body of some thickness has such an inertia" in made.remarks
    with pytest.raises(ValueError, match=r"mass|inertia"):
        mujoco.MjModel.from_xml_string(made.text)
    assert callable(mjcf_text)
