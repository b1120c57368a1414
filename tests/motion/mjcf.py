"""A robot as MJCF, MuJoCo's format, from its table: an independent simulator's view of the same arm."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree import ElementTree as Xml

import numpy as np

from derive.arrays import Array
from derive.robot.description import Convention, Joint
from derive.robot.evaluate import evaluate
from derive.robot.robot import Robot

ENTRIES = ("xx", "yy", "zz", "xy", "xz", "yz")


def mjcf(robot: Robot, values: Mapping[str, float], step: float) -> str:
    """The arm with masses, armature and viscous friction; without limits, contacts and Coulomb friction."""
    root = Xml.Element("mujoco")
    Xml.SubElement(root, "compiler", angle="radian", inertiafromgeom="false", balanceinertia="false")
    gravity = text(evaluate(cell, values) for cell in robot.gravity or ())
    option = Xml.SubElement(root, "option", timestep=repr(step), integrator="RK4", gravity=gravity)
    Xml.SubElement(option, "flag", contact="disable", constraint="disable")
    parent = Xml.SubElement(root, "worldbody")
    before = np.array([[evaluate(cell, values) for cell in row] for row in robot.base])
    for i, (joint, link) in enumerate(zip(robot.joints, robot.links, strict=True)):
        screw, fixed = parts(joint, values)
        standard = robot.convention is Convention.STANDARD
        here = before @ (screw @ fixed if standard else fixed @ screw)
        quaternion = text(quaternion_of(here[:3, :3]))
        body = Xml.SubElement(parent, "body", name=f"link{i + 1}", pos=text(here[:3, 3]), quat=quaternion)
        axis = np.linalg.inv(fixed) if standard else np.eye(4)
        Xml.SubElement(
            body,
            "joint",
            name=joint.variable,
            type="hinge" if joint.is_revolute else "slide",
            axis=text(joint.sign * axis[:3, 2]),
            pos=text(axis[:3, 3]),
            armature=repr(evaluate(link.armature, values)),
            damping=repr(evaluate(link.viscous, values)),
        )
        com = text(evaluate(cell, values) for cell in link.com)
        inertia = text(evaluate(getattr(link.inertia, entry), values) for entry in ENTRIES)
        mass = repr(evaluate(link.mass, values))
        Xml.SubElement(body, "inertial", pos=com, mass=mass, fullinertia=inertia)
        parent, before = body, np.eye(4)
    return Xml.tostring(root, encoding="unicode")


def parts(joint: Joint, values: Mapping[str, float]) -> tuple[Array, Array]:
    """Rot(z, theta) Trans(z, d) with the variable at zero, and Trans(x, a) Rot(x, alpha)."""
    theta, d, a, alpha = (evaluate(cell, values) for cell in (joint.theta, joint.d, joint.a, joint.alpha))
    c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    screw = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, d], [0, 0, 0, 1]])
    return screw, np.array([[1, 0, 0, a], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1]])


def quaternion_of(rotation: Array) -> Array:
    """The eigenvector of Bar-Itzhack's matrix to the eigenvalue 1: w, x, y, z."""
    r = rotation
    k = np.array(
        [
            [r[0, 0] - r[1, 1] - r[2, 2], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[2, 1] - r[1, 2]],
            [r[0, 1] + r[1, 0], r[1, 1] - r[0, 0] - r[2, 2], r[1, 2] + r[2, 1], r[0, 2] - r[2, 0]],
            [r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], r[2, 2] - r[0, 0] - r[1, 1], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], r[0, 0] + r[1, 1] + r[2, 2]],
        ]
    )
    x, y, z, w = np.linalg.eigh(k / 3)[1][:, -1]
    return np.array([w, x, y, z])


def text(numbers: object) -> str:
    return " ".join(repr(float(number)) for number in numbers)  # type: ignore[attr-defined]
