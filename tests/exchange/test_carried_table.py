"""A robot that goes out as URDF comes back."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.exchange.arm import arm_of
from derive.exchange.carried_table import carried_table, placement_of, table_text
from derive.exchange.formats import exported
from derive.exchange.from_urdf import Imported, ImportOptions, import_urdf
from derive.exchange.read_urdf import read_urdf
from derive.mechanics.space import exactly
from derive.robot.description import Convention
from derive.robot.expression import Pi, multiply, number
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import SWEEP, dressed, numeric
from tests.exchange.urdfs import J, Reading, urdf


def back(text: str, convention: Convention) -> Imported:
    return import_urdf(read_urdf(text.encode(), "arm.urdf"), None, None, ImportOptions(convention=convention))


def cells(robot: Robot) -> list[object]:
    rows = [(j.type, j.variable, j.sign, j.theta, j.d, j.a, j.alpha) for j in robot.joints]
    return [*rows, robot.base, robot.tool]


@pytest.mark.parametrize("name", SWEEP)
def test_the_table_comes_back_to_the_letter_and_torques_to_rounding(name: str) -> None:
    for robot in (numeric(name), dressed(name, rotors=True, coulomb=True)):
        found = back(exported(robot, "urdf").text, robot.convention)
        assert cells(found.robot) == cells(robot)
        assert found.certificate.position < 1e-13
        if not robot.links:
            continue
        states = np.random.default_rng(2).uniform(-2, 2, (3, 4, robot.n))
        ours, theirs = (Oracle.of(r).evaluate("inverse_dynamics", *states) for r in (robot, found.robot))
        assert np.abs(ours - theirs).max() < 1e-12 * np.abs(ours).max()


SLANTED = """
name: slanted
convention: standard
joints:
  - {type: revolute, q: q1, theta: q1 + 1.7398639118778688, d: 0.4, a: 0.097873524170258314}
  - {type: revolute, q: q2, theta: q2 + 2.1154531206566901, d: 0.3, alpha: 0.7}
gravity: [0, 0, -9.81]
links:
  - {mass: 2.5, com: [0, 0.1, 0.15], inertia: {xx: 0.02, yy: 0.03, zz: 0.04}}
  - {mass: 1.5, com: [-0.07, 0, 0], inertia: {xx: 0.012, yy: 0.012, zz: 0.002, xy: -0.0001}}
"""


def test_limits_come_back_and_links_without_the_noise_of_turning_them() -> None:
    """An entry of 1e-19 would stand in every equation."""
    robot = Robot.from_text(SLANTED)
    assert back(exported(robot, "urdf").text, robot.convention).robot.links == robot.links
    robot = dressed("stanford-deluca")
    ends = (multiply(number("-1/2"), Pi()), number(2))
    for places in ((), (1, 2)):
        joints = tuple(replace(joint, limits=ends if k in places else None) for k, joint in enumerate(robot.joints))
        found = back(exported(replace(robot, joints=joints), "urdf").text, robot.convention)
        assert [joint.limits for joint in found.robot.joints] == [joint.limits for joint in joints]
    narrower = exported(robot, "urdf").text.replace('lower="-10" upper="10"', 'lower="-9" upper="10"')
    assert back(narrower, robot.convention).robot.joints[2].limits == (number(-9), number(10))


def test_a_table_of_another_arm_or_convention_gives_way_to_common_normals() -> None:
    robot = numeric("kuka-kr5")
    text = exported(robot, "urdf").text
    assert cells(back(text.replace('axis xyz="0 0 1"', 'axis xyz="0 1 0"', 1), robot.convention).robot) != cells(robot)
    assert back(text, Convention.MODIFIED).robot.convention is Convention.MODIFIED
    read = read_urdf(text.encode(), "arm.urdf")
    with exactly():
        arm = arm_of(read, None, None, Fraction(0))
        assert carried_table(read, arm, Convention.STANDARD) is not None
        assert carried_table(replace(read, table="joints: ["), arm, Convention.STANDARD) is None
        assert carried_table(replace(read, table=""), arm, Convention.STANDARD) is None


@pytest.mark.parametrize("name", ["kuka-lwr4", "skeleton-modified"])
def test_frames_of_a_table_are_those_of_the_oracle(name: str) -> None:
    robot = numeric(name)
    placement = placement_of(Robot.from_text(table_text(robot)))
    oracle = Oracle.of(robot)
    with exactly():
        end = placement.frames[-1].then(placement.tool)
    pose = oracle.evaluate("forward_kinematics", np.zeros(robot.n))
    assert np.abs([float(c) for c in end.origin] - pose[:3, 3]).max() < 1e-15


NAMED = """
name: named
convention: modified
joints:
  - {type: revolute, theta: -q1, d: 0.3, limits: [-2, 2], speed: 3, torque: 80, name: "shoulder \\"pan\\" & <turn>"}
  - {type: prismatic, d: q2 + 0.1, alpha: pi/2, limits: [0, 0.4], torque: 9.5, name: it's a  slide}
  - {type: revolute, q: q7, theta: q7, a: 0.1}
gravity: [0, 0, -9.81]
links:
  - {mass: 2, com: [0, 0, 0.1], inertia: {xx: 0.02, yy: 0.02, zz: 0.01}}
  - {mass: 1, com: [0, 0.1, 0], inertia: {xx: 0.02, yy: 0.02, zz: 0.01}, motor: {mass: 0.1, inertia: 1e-4, ratio: 30}}
  - {mass: 1, com: [0, 0.1, 0], inertia: {xx: 0.02, yy: 0.02, zz: 0.01}, friction: {viscous: 0.3}}
"""


def test_names_speeds_torques_and_the_convention_come_back_and_names_of_a_urdf_stay() -> None:
    robot = Robot.from_text(NAMED)
    text = exported(robot, "urdf").text
    found = import_urdf(read_urdf(text.encode(), "arm.urdf"), None, None)
    assert found.robot.joints == robot.joints
    assert (found.robot.convention, found.robot.base, found.robot.tool) == (robot.convention, robot.base, robot.tool)
    assert found.joints == tuple(joint.label for joint in robot.joints)
    assert "the table is the one that the URDF carries with it" in found.notes
    assert back(text, Convention.STANDARD).robot.convention is Convention.STANDARD
    text = urdf([J(name="pan&#10;x"), J("0.3 0 0", "1.57 0 0", name="q2"), J("0 0 1", name="w" * 600)])
    joints = import_urdf(read_urdf(text.encode(), "arm.urdf"), None, None).robot.joints
    assert [joint.name for joint in joints] == ["pan\\nx", "", "w" * 500]
    assert [joint.variable for joint in joints] == ["q1", "q2", "q3"]


def test_every_format_has_the_names() -> None:
    mujoco = pytest.importorskip("mujoco")
    robot = Robot.from_text(NAMED)
    names = [joint.label for joint in robot.joints]
    model = mujoco.MjModel.from_xml_string(exported(robot, "mjcf").text)
    assert [model.joint(i).name for i in range(3)] == names
    assert [model.actuator(i).name for i in range(3)] == names
    assert Reading(exported(robot, "urdf").text, names).model.nv == 3
    for to in ("rtb", "corke", "rigidbodytree", "csv"):
        assert "slide" in exported(robot, to).text
    assert "rigidBodyJoint('it''s a slide', 'prismatic')" in exported(robot, "rigidbodytree").text
    compile(exported(robot, "rtb").text, "rtb.py", "exec")
