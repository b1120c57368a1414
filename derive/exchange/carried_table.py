"""The table that a URDF carries with it: where it is proven to be the arm's, it goes before one by common normals.

Many tables are right for one arm. A URDF that `derive export` wrote says from which it was made, so that it comes back.
"""

from dataclasses import replace
from itertools import pairwise

from derive.errors import DeriveError
from derive.exchange.arm import Arm
from derive.exchange.body_chain import body_chain
from derive.exchange.certificate import along_x, along_z, ball, certify, frame_of
from derive.exchange.common_normals import DHRow, Placement
from derive.exchange.numeric import text
from derive.exchange.urdf import SLIDE, Urdf
from derive.mechanics.space import WORLD, exactly
from derive.robot.description import Convention, Description, Link, Ways
from derive.robot.expression import ZERO, Expression, number
from derive.robot.robot import Robot
from derive.robot.writer import robot_text

SAME = 1e-9  # poses that differ by less are the same: a URDF's numbers have 17 digits [m, rad]


def carried_table(urdf: Urdf, arm: Arm, convention: Convention | None) -> Robot | None:
    """The table of numbers that a URDF carries; None without one, of the other convention, or of another arm."""
    if not urdf.table:
        return None
    try:
        table = Robot.from_text(urdf.table, f"{urdf.source}, dh_table")
        kinds = [(joint.is_revolute, joint.label) for joint in table.joints]
        if convention not in (None, table.convention) or kinds != [(a.is_revolute, a.joint.name) for a in arm.axes]:
            return None
        certificate = certify(arm, table)
    except DeriveError:
        return None
    return table if certificate.position < SAME and certificate.rotation < SAME else None


def placement_of(table: Robot) -> Placement:
    """Where the frames of a table are at q = 0."""
    with exactly():
        frames, rows = [frame_of(table.base)], []
        for joint in table.joints:
            row = DHRow(*(ball(cell) for cell in (joint.theta, joint.d, joint.a, joint.alpha)))
            along, across = along_z(row.theta, row.d), along_x(row.a, row.alpha)
            standard = table.convention is Convention.STANDARD
            frames.append(frames[-1].then(along.then(across) if standard else across.then(along)))
            rows.append(row)
        return Placement(table.convention, tuple(frames), tuple(rows), frame_of(table.tool), ())


def table_text(robot: Robot) -> str:
    """A robot file of what a URDF has no words for: table, slides without limits, gravity, motors, uneven friction."""
    joints = tuple(replace(joint, speed=None, torque=None) for joint in robot.joints)
    links = tuple(
        Link(
            armature=link.armature, motor=link.motor, coulomb=link.coulomb if isinstance(link.coulomb, tuple) else ZERO
        )
        for link in robot.links
    )
    return robot_text(
        Description(robot.name, "", robot.convention, joints, robot.base, robot.tool, robot.gravity, links)
    )


def _friction(link: Link, own: Link) -> Expression | Ways:
    """Coulomb friction by direction where a table has it and its mean is that of the URDF; else that of the URDF."""
    same = isinstance(own.coulomb, tuple) and text(ball(own.signed[0])) == text(ball(link.signed[0]))
    return own.coulomb if same else link.coulomb


def with_table(robot: Description, table: Robot) -> Description:
    """A robot with the cells of a table to the letter, and with its gravity, motors and friction by direction."""
    cells = ("variable", "name", "sign", "theta", "d", "a", "alpha")
    joints = []
    for joint, row in zip(robot.joints, table.joints, strict=True):
        # Limits of the table, where the URDF has them, or its stand-in for a slide without; else those of the URDF.
        limits, written = joint.limits, row.limits or (None if row.is_revolute else (number(-SLIDE), number(SLIDE)))
        if limits and written and [text(ball(cell)) for cell in limits] == [text(ball(cell)) for cell in written]:
            limits = row.limits
        joints.append(replace(joint, limits=limits, **{cell: getattr(row, cell) for cell in cells}))
    robot = replace(robot, joints=tuple(joints), base=table.base, tool=table.tool)
    if not (robot.links and table.links):
        return robot
    links = tuple(
        replace(link, armature=own.armature, motor=own.motor, coulomb=_friction(link, own))
        for link, own in zip(robot.links, table.links, strict=True)
    )
    robot = replace(robot, links=links, gravity=table.gravity, parameters=())
    segments = body_chain(Robot.of(robot)).segments
    bodies = [segment.body for segment in segments]
    # Links of the URDF hold the rotors that they carry: these are taken out again.
    for i, (segment, following) in enumerate(pairwise(segments)):
        if following.rotor is not None and segment.body is not None:
            rotor = following.rotor.carried.moved(WORLD.seen_from(segment.dh))
            bodies[i] = segment.body + rotor.negative
    return replace(robot, links=tuple(b.link(own) if b else own for b, own in zip(bodies, links, strict=True)))
