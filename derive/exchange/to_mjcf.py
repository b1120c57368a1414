"""A robot as MJCF, the format of MuJoCo."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from flint import arb

from derive.exchange.body_chain import Body, BodyChain, Rotor, quaternion
from derive.exchange.certificate import ball
from derive.exchange.numeric import text, texts
from derive.exchange.space import NOTHING, Frame
from derive.exchange.to_urdf import THICKNESS, rod
from derive.robot.body_remarks import ROUNDING
from derive.targets.templating import render

DENSITY = 1000
"""Of the cylinders that stand in for masses where a robot has none [kg/m^3]."""

LEAST = 1e-15
"""Of masses and principal moments in the file: MuJoCo takes no less [kg, kg m^2]."""

EARTH = "0 0 -9.81"
"""Gravity where the robot file gives none [m/s^2]."""


def mjcf_text(arm: BodyChain, head: list[str]) -> str:
    """The file.

    Args:
        arm: The robot.
        head: Lines that go into a comment before it.
    """
    gravity, end = arm.robot.gravity, arm.segments[-1].dh.then(arm.tool)
    radius = THICKNESS * arm.size
    spinning = _spinning(arm)
    bodies = [_body(arm, i, radius, spinning) for i in range(len(arm.segments))]
    return render(
        "exchange/robot.mjcf.jinja",
        name=arm.robot.name,
        head=head,
        gravity=EARTH if gravity is None else texts(map(ball, gravity)),
        density=DENSITY,
        bodies=bodies,
        margins=[body["margin"] for body in reversed(bodies)],
        tool={"pos": texts(end.origin), "quat": _turn(end)},
        rotors=[_tendon(arm, i, rotor) for i, rotor in spinning.items()],
        radius=f"{radius:.3g}",
        thick=f"{1.4 * radius:.3g}",
        half=f"{1.5 * radius:.3g}",
    )


def coupled_by_tendon(rotor: Rotor) -> bool:
    """Whether MuJoCo can say how a rotor turns with the joints before its own: their axes keep their angles to its own.

    Args:
        rotor: Of a joint.
    """
    return rotor.is_coupled and rotor.drag is not None


def _spinning(arm: BodyChain) -> dict[int, Rotor]:
    """The rotors that are tendons, by joint."""
    rotors = ((i, segment.rotor) for i, segment in enumerate(arm.segments))
    return {i: rotor for i, rotor in rotors if rotor is not None and coupled_by_tendon(rotor)}


def written_bodies(arm: BodyChain) -> list[Body | None]:
    """The bodies of the file: links with the rotors that they carry, in DH frames.

    Args:
        arm: The robot.
    """
    spinning = _spinning(arm)
    return [arm.body(i, spinning=spinning) for i in range(len(arm.segments))]


def _turn(frame: Frame) -> str:
    return texts(quaternion(frame))


def _tendon(arm: BodyChain, i: int, rotor: Rotor) -> dict[str, Any]:
    """The inertia of a rotor along drag[0] qd_1 + ... + ratio qd_i."""
    names = [segment.joint.variable for segment in arm.segments[: i + 1]]
    factors = [*map(repr, rotor.drag or ()), text(rotor.ratio)]
    coefficients = [(name, factor) for name, factor in zip(names, factors, strict=True) if abs(float(factor)) > 1e-15]
    return {"name": f"rotor_{names[-1]}", "armature": text(rotor.inertia), "joints": coefficients}


def _body(arm: BodyChain, i: int, radius: float, spinning: Collection[int]) -> dict[str, Any]:
    segment = arm.segments[i]
    joint, link, rotor = segment.joint, segment.link, segment.rotor
    frame = arm.base.then(segment.origin) if i == 0 else segment.origin
    armature = ball(link.armature)
    if rotor is not None and i not in spinning:
        armature = armature + rotor.reflected
    body, inertial = arm.body(i, spinning=spinning), None
    if body is not None:
        inertial = _inertial(body.moved(segment.dh))
    options = {
        "range": texts(map(ball, joint.limits)) if joint.limits else "",
        "armature": _unless_zero(armature),
        "damping": _unless_zero(ball(link.viscous)),
        "frictionloss": _unless_zero(ball(link.coulomb)),
    }
    force = None if joint.torque is None else text(ball(joint.torque))
    return {
        "margin": "  " * (i + 2),
        "name": f"link{i + 1}",
        "pos": texts(frame.origin),
        "quat": _turn(frame),
        "joint": joint.variable,
        "type": "hinge" if joint.is_revolute else "slide",
        "axis": f"0 0 {joint.sign}",
        "options": {key: value for key, value in options.items() if value},
        "inertial": inertial,
        "rod": rod(segment.end, radius),
        "force": force,
    }


def is_too_thin(body: Body) -> bool:
    """Whether MuJoCo would refuse a body though it is the limit of ones that exist: a point, a thin rod, or nothing.

    Args:
        body: Of a link.
    """
    return body.is_possible and bool(not body.mass >= LEAST or body.principal[0][0] < LEAST)


def _inertial(body: Body) -> dict[str, str]:
    """Mass, place and tensor; principal moments where those of the entries might be refused for their last digits."""
    (a, b, c), axes = body.principal
    slack = float(ROUNDING) * c
    if not body.is_possible or (body.mass >= LEAST and a > max(LEAST, slack) and a + b > c + slack):
        return {"mass": text(body.mass), "pos": texts(body.com), "fullinertia": texts(body.entries)}
    a, b = max(a, LEAST), max(b, LEAST)
    moments = (a, b, min(max(c, LEAST), a + b))
    mass = text(body.mass) if body.mass >= LEAST else repr(LEAST)
    tensor = " ".join(repr(float(moment)) for moment in moments)
    return {"mass": mass, "pos": texts(body.com), "quat": _turn(axes), "diaginertia": tensor}


def _unless_zero(value: arb) -> str:
    return text(value) if abs(value) > NOTHING else ""
