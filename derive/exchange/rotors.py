"""The bodies of a robot in formats without rotors: links with what they carry, as they are or the nearest that exist.

A rotor of inertia I on the link before joint i turns about the joint's axis at u + k qd_i, where that link turns at u.
Where the joint turns, the link behind it does so at u + s qd_i, with the sign s = +1 or -1 of its variable. Since

    I (u + k qd)^2 = (I - J) u^2 + J (u + s qd)^2 + (I k^2 - J) qd^2  with  J = s I k,

an inertia J about the axis on the link behind the joint, I - J on the one before it, and an armature I k^2 - J say
the same in every term of the dynamics, wherever both links are bodies that exist.
"""

from collections.abc import Callable, Collection
from dataclasses import replace

import numpy as np

from derive.errors import DeriveError
from derive.exchange.body_chain import BodyChain, ChainSegment, RigidBody, Rotor
from derive.mechanics.space import WORLD, Real, decimal
from derive.model.identification.possible import possible
from derive.model.identification.witness import NoSuchBodies
from derive.robot.expression import ZERO, add, number
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle

STATES = 100  # at which accelerations are compared
# Part of its largest moment by which a body is inside of what exists, where programs find moments by themselves.
INSIDE = 1e-12
ADDED = 1e-11  # part of its largest moment that is added to a body without a word
# An arm whose bodies hold the rotors that they carry, and what was changed, as sentences.
Written = tuple[BodyChain, tuple[str, ...]]


def with_rotors(arm: BodyChain, is_said: Callable[[Rotor], bool] | None, wanted: str) -> Written:
    """The arm as a format says it, which may say the inertia of some rotors otherwise; None for links alone.

    Other rotors may be divided then; the mass of each is part of the link that carries it.
    """
    said = [i for i, s in enumerate(arm.segments) if s.rotor is not None and is_said and is_said(s.rotor)]
    inside = 0.0 if is_said else INSIDE
    chosen: tuple[int, ...] = ()
    found = _chosen(_placed(arm, said, chosen), wanted, inside)
    for i, segment in enumerate(arm.segments):
        rotor = segment.rotor
        if not is_said or i in said or rotor is None or segment.body is None or not segment.joint.is_revolute:
            continue
        # It must turn with the joints before its own, in a way that bodies could say.
        if not (rotor.is_coupled and rotor.reflected > _share(segment)):
            continue
        try:
            other = _chosen(_placed(arm, said, (*chosen, i)), wanted, inside)
        except NoSuchBodies:
            continue
        if all(body.is_possible for k in (i - 1, i) if (body := other[0].segments[k].body)):
            found, chosen = other, (*chosen, i)
    return found


def _share(segment: ChainSegment) -> Real:
    """The inertia J of its rotor that goes to the link behind the joint."""
    return segment.joint.sign * segment.rotor.inertia * segment.rotor.ratio if segment.rotor else 0


def _placed(arm: BodyChain, said: Collection[int], divided: Collection[int]) -> BodyChain:
    """Rotors put into bodies: those of joints that are divided are nowhere else then."""
    segments = []
    for i, segment in enumerate(arm.segments):
        body, inwards = segment.body, WORLD.seen_from(segment.dh)
        beyond = arm.segments[i + 1] if i + 1 < len(arm.segments) else None
        # The rotor of the next joint stands on this link: its mass, and I or I - J about that axis.
        if body is not None and beyond is not None and beyond.rotor is not None:
            inertia = 0 if i + 1 in said else beyond.rotor.inertia - (_share(beyond) if i + 1 in divided else 0)
            body = body + (beyond.rotor.body + RigidBody.spinning(beyond.rotor.axis, inertia)).moved(inwards)
        if i in divided and body is not None and segment.rotor is not None:
            # The other side of a division: J about its own axis, and the armature I k^2 - J.
            body = body + RigidBody.spinning(WORLD.z, _share(segment)).moved(inwards)
            armature = number(decimal(segment.rotor.reflected - _share(segment)))
            link = replace(segment.link, motor=None, armature=add(segment.link.armature, armature))
            segment = replace(segment, link=link, rotor=None)
        segments.append(replace(segment, body=body))
    return replace(arm, segments=tuple(segments))


def _chosen(arm: BodyChain, wanted: str, inside: float) -> Written:
    """The arm with its bodies, or with the nearest that exist."""
    if wanted == "given":
        return arm, ()
    links = tuple(s.body.link(replace(s.link, motor=None)) for s in arm.segments if s.body is not None)
    found = possible(replace(arm.robot, links=links))
    repaired = [RigidBody.of(link) for link in found.robot.links]
    bodies = [body.settled(inside) for body in repaired]
    added = [float(sum(b.entries[:3]) - sum(a.entries[:3])) / 2 for a, b in zip(repaired, bodies, strict=True)]
    amounts = [(i, more) for i, more in enumerate(added, 1) if more > ADDED * bodies[i - 1].principal[0][2]]
    sizes = [f"{more:.2g} kg m^2 to link {i}" for i, more in amounts]
    changes = (f"rounding left too little for what exists: {', '.join(sizes)} are added",) if sizes else ()
    if gone := [str(i) for i, body in enumerate(bodies, 1) if not body.is_possible]:
        raise DeriveError(f"{arm.robot.name}: link {', '.join(gone)} does not exist as it would be written")
    segments = tuple(replace(s, body=body) for s, body in zip(arm.segments, bodies, strict=True))
    return replace(arm, segments=segments), (*found.report, *changes)


def lost_coupling(robot: Robot, written: BodyChain, is_said: Callable[[Rotor], bool]) -> float:
    """Error of accelerations that should be up to 1, at random states with speeds up to 1 [rad/s^2, m/s^2]."""
    links = []
    for segment in written.segments:
        rotor, link = segment.rotor, segment.link
        if rotor is not None and is_said(rotor):
            link = replace(link, motor=link.motor and replace(link.motor, mass=ZERO))
        elif rotor is not None:
            link = replace(link, motor=None, armature=add(link.armature, number(decimal(rotor.reflected))))
        links.append(segment.body.link(link) if segment.body else link)
    q, qd, qdd = np.random.default_rng(0).uniform(-1, 1, (3, STATES, robot.n)) * [[[np.pi]], [[1]], [[1]]]
    ours, theirs = Oracle.of(robot), Oracle.of(replace(robot, links=tuple(links)))
    # B'^-1 (tau - tau') of accelerations that are wanted: how far the motion of what is written goes astray.
    lack = np.subtract(*(oracle.evaluate("inverse_dynamics", q, qd, qdd) for oracle in (ours, theirs)))
    inverse = np.linalg.pinv(theirs.evaluate("inertia_matrix", q))
    return float(np.abs(np.einsum("kij,kj->ki", inverse, lack)).max())
