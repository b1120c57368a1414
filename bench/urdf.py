"""A robot as URDF, every number with all its digits."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree import ElementTree as Xml

import numpy as np

from bench.plain_arm import PlainArm, PlainJoint
from bench.robots import Array

BASE, END = "base", "end"


def urdf(arm: PlainArm, name: str = "arm") -> str:
    """The robot as XML; links ``base``, ``link1`` ... ``linkN``, ``end``; joints ``q1`` ... ``qN``."""
    robot = Xml.Element("robot", name=name)
    Xml.SubElement(robot, "link", name=BASE)
    before = BASE
    for i, joint in enumerate(arm.joints, start=1):
        _link(robot, f"link{i}", joint)
        _joint(robot, f"q{i}", before, f"link{i}", joint)
        before = f"link{i}"
    Xml.SubElement(robot, "link", name=END)
    fixed = Xml.SubElement(robot, "joint", name="tip", type="fixed")
    _connected(fixed, before, END, arm.end)
    return Xml.tostring(robot, encoding="unicode")


def _link(robot: Xml.Element, name: str, joint: PlainJoint) -> None:
    inertial = Xml.SubElement(Xml.SubElement(robot, "link", name=name), "inertial")
    Xml.SubElement(inertial, "origin", xyz=_numbers(joint.com), rpy="0 0 0")
    Xml.SubElement(inertial, "mass", value=repr(joint.mass))
    entries = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    Xml.SubElement(inertial, "inertia", {key: repr(float(joint.inertia[at])) for key, at in entries.items()})


def _joint(robot: Xml.Element, name: str, parent: str, child: str, joint: PlainJoint) -> None:
    kind = "revolute" if joint.revolute else "prismatic"
    element = Xml.SubElement(robot, "joint", name=name, type=kind)
    _connected(element, parent, child, joint.placement)
    Xml.SubElement(element, "axis", xyz=f"0 0 {joint.sign:g}")
    Xml.SubElement(element, "limit", lower="-100", upper="100", effort="1000", velocity="100")


def _connected(element: Xml.Element, parent: str, child: str, placement: Array) -> None:
    Xml.SubElement(element, "parent", link=parent)
    Xml.SubElement(element, "child", link=child)
    Xml.SubElement(element, "origin", xyz=_numbers(placement[:3, 3]), rpy=_numbers(roll_pitch_yaw(placement)))


def _numbers(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def roll_pitch_yaw(placement: Array) -> tuple[float, float, float]:
    """Angles of R = Rot(z, yaw) Rot(y, pitch) Rot(x, roll), pitch within a right angle of 0."""
    r = placement[:3, :3]
    across = float(np.hypot(r[0, 0], r[1, 0]))
    pitch = float(np.arctan2(-r[2, 0], across))
    if across < 1e-9:
        return float(np.arctan2(-r[1, 2], r[1, 1])), pitch, 0.0
    return float(np.arctan2(r[2, 1], r[2, 2])), pitch, float(np.arctan2(r[1, 0], r[0, 0]))
