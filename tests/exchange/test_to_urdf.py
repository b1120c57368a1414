"""A robot as URDF is the same robot for others."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree as Xml

import numpy as np
import pytest
from flint import arb

from derive.exchange.formats import exported
from derive.exchange.to_urdf import rod
from derive.robot.expression import number
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import EVERY, FEW, dressed
from tests.exchange.urdfs import Reading

SWEEP = [pytest.param(name, marks=[] if name in FEW else pytest.mark.sweep) for name in EVERY]


@pytest.mark.parametrize("name", SWEEP)
def test_pinocchio_reads_the_same_poses_and_torques(name: str) -> None:
    robot = dressed(name)
    bare = replace(robot, gravity=(number(0), number(0), number("-9.81")))
    links = tuple(replace(link, armature=number(0), viscous=number(0)) for link in bare.links)
    oracle = Oracle.of(replace(bare, links=links))
    reading = Reading(exported(bare, "urdf").text, [joint.variable for joint in bare.joints])
    random = np.random.default_rng(3)
    for _ in range(3):
        q, qd, qdd = random.uniform(-2, 2, (3, robot.n))
        assert np.abs(reading.pose(q, "tool") - oracle.evaluate("forward_kinematics", q)).max() < 1e-13
        expected = oracle.evaluate("inverse_dynamics", q, qd, qdd)
        assert np.abs(reading.torque(q, qd, qdd) - expected).max() < 1e-12 * max(1, np.abs(expected).max())


def test_limits_friction_effort_and_speed_are_written() -> None:
    robot = dressed("stanford-deluca", coulomb=True)
    bounded = replace(robot.joints[1], limits=(number("-0.5"), number(2)), torque=number(7), speed=number("1.5"))
    made = exported(replace(robot, joints=(robot.joints[0], bounded, *robot.joints[2:])), "urdf")
    joints = {joint.get("name"): joint for joint in Xml.fromstring(made.text).iter("joint")}
    assert joints["q2"].find("limit").attrib == {"lower": "-0.5", "upper": "2", "effort": "7", "velocity": "1.5"}
    assert float(joints["q2"].find("dynamics").get("friction")) == Oracle.of(robot).arm.coulomb[1]
    assert [joints[q].get("type") for q in ("q1", "q2", "q3")] == ["continuous", "revolute", "prismatic"]
    assert joints["q3"].find("limit").get("lower") == "-10"
    assert "URDF wants limits of slides: 10 m to either side of q3" in made.remarks


def test_what_urdf_cannot_say_is_named_in_its_first_comment() -> None:
    made = exported(dressed("scara-matlab", rotors=True), "urdf")
    for lost in ("the armature of q1", "the rotor inertia", "the coupling of the rotor", "the gravity 0.3, -9.1, -2.7"):
        assert any(lost in remark for remark in made.remarks)
        assert lost in made.text.partition("-->")[0]


@pytest.mark.parametrize(("down", "is_named"), [("-9.81", False), ("-9.8", False), ("-1.62", True), ("9.81", True)])
def test_a_gravity_that_is_not_the_earths_is_named(down: str, is_named: bool) -> None:
    robot = replace(dressed("planar-3r"), gravity=(number(0), number(0), number(down)))
    assert any("the gravity 0, 0, " in remark for remark in exported(robot, "urdf").remarks) == is_named


def test_dashes_of_a_name_end_no_comment() -> None:
    made = exported(replace(dressed("planar-3r"), name="a---b----c"), "urdf")
    assert Xml.fromstring(made.text).get("name") == "a---b----c"


def test_a_cylinder_goes_from_joint_to_joint() -> None:
    found = rod((arb(0), arb(3), arb(4)), 0.1)
    assert found == {"xyz": "0 1.5 2", "rpy": "0 0.643501 1.5708", "length": "5", "to": "0 3 4"}
    assert rod((arb(0), arb(0), arb("0.05")), 0.1) is None


def test_joints_may_be_called_as_those_that_are_fixed() -> None:
    robot = dressed("planar-3r")
    named = [
        replace(joint, name=name) for joint, name in zip(robot.joints, ("tool-joint", "q3", "base-joint"), strict=True)
    ]
    text = exported(replace(robot, joints=tuple(named)), "urdf").text
    names = [joint.get("name") for joint in Xml.fromstring(text).iter("joint")]
    assert len({*names}) == len(names)
    assert Reading(text, ["tool-joint", "q3", "base-joint"]).model.nv == 3
