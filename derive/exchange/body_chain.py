"""A robot as other programs have it: bodies that hang on each other by joints about or along their own z axis.

The frame of link i stands on the axis of joint i and moves with the link: at q_i = 0 it is frame i-1 of a standard
table, and frame i of a modified one before Rot(z, theta_i) Trans(z, d_i). So its place in the one before is
Rot(z, theta) Trans(z, d) Trans(x, a) Rot(x, alpha) in both conventions, which a URDF says with the table's own numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from flint import arb

from derive.exchange.certificate import ball, frame_of, motions
from derive.exchange.ties import NONE, Ties
from derive.mechanics import vectors
from derive.mechanics.chain import build_chain, way_frame
from derive.mechanics.space import NOTHING, WORLD, Frame, Point, Real, decimal, length, plus, times, unit
from derive.mechanics.vectors import Symmetric, axial_tensor, conjugate, cross, dot, from_matrix, steiner, transpose
from derive.model.identification.exact_scalars import ExactDomain
from derive.robot import tree
from derive.robot.description import BASE, INERTIA, Convention, Inertia, Joint, Link, RootType
from derive.robot.expression import ZERO, number
from derive.robot.robot import Robot
from derive.robot.validate import ROUNDING
from derive.verification.oracle.frames import Array, chain_frames, joint_axes, numeric_arm

RESIDUE = 1e-15  # moments of inertia that are left of nothing by a URDF's decimals [kg m^2]
TIP = "tool"  # the end effector of a robot with one end
NO_INERTIA = Symmetric(*[arb(0)] * 6)
CONSTANT = 1e-12  # how little the cosine of two axes varies where it does not


@dataclass(frozen=True, slots=True)
class RigidBody:
    """A rigid body in some frame."""

    mass: Real  # [kg]
    com: Point  # centre of mass [m]
    inertia: Symmetric[Real]  # the tensor about it, along the axes of the frame [kg m^2]

    @classmethod
    def of(cls, link: Link) -> RigidBody:
        """A link of numbers in its own DH frame, without its motor."""
        com = (ball(link.com[0]), ball(link.com[1]), ball(link.com[2]))
        return cls(ball(link.mass), com, Symmetric(*(ball(getattr(link.inertia, key)) for key in INERTIA)))

    @classmethod
    def spinning(cls, axis: Point, inertia: Real) -> RigidBody:
        """An inertia about an axis, without a mass."""
        return cls(arb(0), WORLD.origin, axial_tensor(inertia, axis))

    def settled(self, inside: float) -> RigidBody:
        """The nearest body that exists and is a little inside of the limit, where rounding has left it beyond."""
        # Its second moments along its principal axes, (A + B - C)/2 and so on, become at least some part of its largest
        # moment: each adds what it lacks to the moments about both other axes.
        moments, axes = self.principal
        lack = np.maximum(inside * moments[2] - moments.sum() / 2 + moments, 0)
        body = self
        for axis, own in zip((axes.x, axes.y, axes.z), lack, strict=True):
            body = body + RigidBody.spinning(axis, arb(float(lack.sum() - own)))
        return replace(body, mass=self.mass if self.mass > 0 else arb(0))

    def moved(self, frame: Frame) -> RigidBody:
        """The same body seen from outside."""
        turn = transpose((frame.x, frame.y, frame.z))
        return RigidBody(self.mass, frame.point(self.com), from_matrix(conjugate(turn, self.inertia.matrix)))

    def about(self, point: Point) -> Symmetric[Real]:
        """The tensor about a point (Steiner)."""
        return self.inertia + steiner(self.mass, plus(self.com, point, -1))

    def __add__(self, other: RigidBody) -> RigidBody:
        mass, com = self.mass + other.mass, self.com
        if mass > 0:
            com = times(plus(times(self.com, self.mass), other.com, other.mass), 1 / mass)
        return RigidBody(mass, com, self.about(com) + other.about(com))

    def link(self, own: Link) -> Link:
        """The body as a link of a robot file."""
        x, y, z = (number(decimal(c)) for c in self.com)
        inertia = Inertia(*(number(decimal(entry)) for entry in self.entries))
        return replace(own, mass=number(decimal(self.mass)), com=(x, y, z), inertia=inertia)

    @property
    def entries(self) -> tuple[Real, ...]:
        """Inertia xx, yy, zz, xy, xz, yz."""
        return tuple(getattr(self.inertia, key) for key in INERTIA)

    @property
    def principal(self) -> tuple[Array, Frame]:
        """Principal moments, rising, in floats [kg m^2], and a frame at the centre of mass along their axes."""
        moments, axes = np.linalg.eigh([[float(entry) for entry in row] for row in self.inertia.matrix])
        along, beside, _ = (unit((arb(axis[0]), arb(axis[1]), arb(axis[2]))) for axis in axes.T)
        across = unit(plus(beside, along, -dot(along, beside)))
        return moments, Frame(self.com, along, across, cross(along, across))

    @property
    def is_possible(self) -> bool:
        """Whether there is such a body, or bodies as near to it as one likes: a point, a thin rod or plate, or none."""
        a, b, c = self.principal[0]
        slack = float(ROUNDING) * c + RESIDUE
        return bool(not self.mass < 0 and a >= -slack and a + b >= c - slack)


@dataclass(frozen=True, slots=True)
class Rotor:
    """The rotor of a joint."""

    body: RigidBody  # its mass, in the frame of the link that carries it
    axis: Point  # about which it spins, there
    inertia: Real  # about its axis [kg m^2]
    ratio: Real  # of its gear
    drag: tuple[float, ...] | None  # rate about its axis of the link that carries it, by joint rates; None if it varies

    @property
    def is_coupled(self) -> bool:
        """Whether it turns with the joints before its own."""
        spins = bool(abs(self.inertia * self.ratio) > NOTHING)
        return spins and (self.drag is None or any(abs(c) > CONSTANT for c in self.drag))

    @property
    def reflected(self) -> Real:
        """Ratio squared times inertia."""
        return self.ratio * self.ratio * self.inertia


@dataclass(frozen=True, slots=True)
class ChainSegment:
    """A joint and the link that it moves."""

    joint: Joint  # row of the table, of numbers
    link: Link  # as in the robot file, of numbers
    origin: Frame  # frame of the link in that of the one before, at zero
    dh: Frame  # its DH frame in this frame
    body: RigidBody | None  # in its DH frame, as `body_chain` makes it without rotors; None without dynamics
    rotor: Rotor | None  # that of this joint
    end: Point  # where the next joint or the tip is
    parent: int  # place of the segment that it follows, -1 on the base
    after: str = ""  # label of the row that it follows in a tree


@dataclass(frozen=True, slots=True)
class Part:
    """What moves with a link of a tree: a row without motion, an end, or the body of a root that floats."""

    name: str  # label of the row, or name of the end
    after: str  # label of the row that it follows
    parent: int  # place of the segment with which it moves, -1 on the base
    frame: Frame  # its frame in that of the segment's link
    body: RigidBody | None = None  # in its own frame; None where there is none
    is_end: bool = False


@dataclass(frozen=True, slots=True)
class BodyChain:
    """All segments of a robot."""

    robot: Robot  # of numbers
    base: Frame  # frame 0 in the world
    segments: tuple[ChainSegment, ...]  # from the base on
    tool: Frame  # the end effector in frame n
    parts: tuple[Part, ...] = ()  # rows without motion and ends of a tree
    root: Part | None = None  # a root that floats, on which parents of -1 stand
    ties: Ties = NONE  # equations between the positions of joints

    @property
    def rows(self) -> dict[str, Part]:
        """Rows without motion by their labels."""
        return {part.name: part for part in self.parts if not part.is_end}

    @property
    def size(self) -> float:
        """The longest link [m]."""
        return max([0.1, *(float(length(segment.end)) for segment in self.segments)])


def body_chain(robot: Robot) -> BodyChain:
    """The bodies of a robot; whoever computes with them does so inside `exactly`."""
    standard = robot.convention is Convention.STANDARD
    starts, origins, dh = _frames(robot)
    tool, base = frame_of(robot.tool), frame_of(robot.base)
    ends = [*(origin.origin for origin in origins[1:]), dh[-1].point(tool.origin)]
    # Of each joint the cosines of its axis with those of the turning joints before it, where they are constant:
    # w_i . z = sum_j s_j (z_j . z_i) qd_j, so that constant cosines make a constant coupling.
    numeric, q = numeric_arm(robot), np.random.default_rng(0).uniform(-2, 2, (6, robot.n))
    axes, _ = joint_axes(numeric, chain_frames(numeric, q))
    cosines: Array = np.einsum("kia,kja->kij", axes, axes) * (numeric.sign * numeric.revolute)
    drags: list[tuple[float, ...] | None] = []
    for i in range(robot.n):
        turning = cosines[:, i, :i] * numeric.moves[i, :i]
        varies = i > 0 and float(np.ptp(turning, axis=0).max()) > CONSTANT
        drags.append(None if varies else tuple(float(c) for c in turning[0]))
    links = robot.links or (Link(),) * robot.n
    segments = []
    rows = zip(robot.joints, links, starts, origins, dh, ends, drags, tree.parents(robot), strict=True)
    for joint, link, start, origin, own, end, drag, parent in rows:
        body, rotor = RigidBody.of(link) if robot.links else None, None
        if (motor := link.motor) is not None:
            # A point mass where the frame of its joint's axis is: o_{i-1} in a standard table, o_i in a modified one.
            place = start.origin if standard else plus(start.origin, start.z, ball(joint.d))
            rotating = RigidBody(ball(motor.mass), place, NO_INERTIA)
            rotor = Rotor(rotating, origin.z, ball(motor.inertia), ball(motor.ratio), drag)
        after = joint.stand.after if joint.stand else robot.joints[parent].label if parent >= 0 else BASE
        segments.append(ChainSegment(joint, link, origin, own, body, rotor, end, parent, after))
    arm = BodyChain(robot, base, tuple(segments), tool)
    return _with_parts(arm) if robot.is_tree else arm


def _frames(robot: Robot) -> tuple[list[Frame], list[Frame], list[Frame]]:
    """Of each joint the axis and the link in the link that it follows, and its DH frame in its link."""
    # From a link of a chain to the next it is Rot(z, theta) Trans(z, d) Trans(x, a) Rot(x, alpha) in both conventions:
    # in a standard table the row before it, in a modified one the z part of the row before and the x part of its own.
    # The frame of a link of a tree stands behind Rot(z, theta) Trans(z, d) of its own row: others follow in any place.
    standard = robot.convention is Convention.STANDARD
    starts: list[Frame] = []
    origins: list[Frame] = []
    dh: list[Frame] = []
    for joint, row in zip(robot.joints, build_chain(robot, ExactDomain(robot)).joints, strict=True):
        along, across = motions(joint)
        start = (dh[row.parent] if row.parent >= 0 else WORLD).then(_in_balls(row.mount))
        starts.append(start if standard else start.then(across))
        beyond = across if standard else WORLD
        origins.append(starts[-1].then(along) if robot.is_tree else starts[-1])
        dh.append(beyond if robot.is_tree else along.then(beyond))
    return starts, origins, dh


def _in_balls(frame: vectors.Frame[Any] | None) -> Frame:
    if frame is None:
        return WORLD
    origin, x, y, z = (vectors.scale(arb(1), vector) for vector in (frame.position, *vectors.transpose(frame.rotation)))
    return Frame(origin, x, y, z)


def _with_parts(arm: BodyChain) -> BodyChain:
    """A tree with rows without motion and ends; of a root that floats the body alone, without its joints."""
    robot, segments, domain = arm.robot, arm.segments, ExactDomain(arm.robot)
    ends = [replace(end, name=end.name or TIP) for end in tree.ends(robot)]

    def _placed(label: str, tool: Frame) -> tuple[int, Frame]:
        joint, frame = way_frame(robot, label, domain)
        return joint, (segments[joint].dh if joint >= 0 else WORLD).then(_in_balls(frame)).then(tool)

    rows = ((row, RigidBody.of(row.link) if row.link else None) for row in robot.fixed)
    parts = [Part(row.name, row.stand.after, *_placed(row.name, WORLD), body) for row, body in rows]
    parts += [Part(end.name, end.after, *_placed(end.after, frame_of(end.tool)), is_end=True) for end in ends]
    root = None
    if robot.root and robot.root.type is RootType.PLANAR and parts[0].body:
        # The link of its last joint has the body: other programs move none without a mass.
        last = segments[parts[0].parent]
        body = parts[0].body.moved(parts[0].frame.seen_from(last.dh))
        segments = tuple(replace(last, body=body) if segment is last else segment for segment in segments)
        parts[0] = replace(parts[0], body=None)
    if robot.root and robot.root.type is RootType.FLOATING:
        root, parts, own = parts[0], parts[1:], len(robot.root.variables)
        # What stands on the root does so on its body: the links are counted without those of its joints.
        inwards = WORLD.seen_from(root.frame)
        moved = [(p, inwards.then(p.frame) if p.parent < own else p.frame) for p in parts]
        parts = [replace(part, frame=frame, parent=max(part.parent - own, -1)) for part, frame in moved]
        seen = []
        for segment in segments[own:]:
            frame, rotor, parent = inwards if segment.parent < own else WORLD, segment.rotor, segment.parent - own
            rotor = rotor and replace(rotor, body=rotor.body.moved(frame), axis=frame.direction(rotor.axis))
            seen.append(replace(segment, origin=frame.then(segment.origin), rotor=rotor, parent=max(parent, -1)))
        segments = tuple(seen)
    beyond = [(s.parent, s.origin.origin) for s in segments] + [(part.parent, part.frame.origin) for part in parts]
    shown = []
    for i, segment in enumerate(segments):  # the farthest thing on a link is what it is drawn to
        points = [point for parent, point in beyond if parent == i]
        end = max(points, key=lambda point: float(length(point)), default=WORLD.origin)
        shown.append(replace(segment, end=end))
    return replace(arm, segments=tuple(shown), parts=tuple(parts), root=root)


def roll_pitch_yaw(frame: Frame) -> Point:
    """Angles with Rz(yaw) Ry(pitch) Rx(roll) as rotation [rad]."""
    x, y, z = frame.x, frame.y, frame.z
    # Pitch of +-pi/2: roll and yaw turn about one axis, and all is roll.
    if not (flat := length((x[0], x[1], arb(0)))) > NOTHING:
        sign = -1 if x[2] > 0 else 1
        return (angle_of(y[0] * sign, y[1]), arb.pi() / 2 * sign, arb(0))
    return (angle_of(y[2], z[2]), angle_of(-x[2], flat), angle_of(x[1], x[0]))


def angle_of(sine: Real, cosine: Real) -> Real:
    """The angle of a direction; a ball around the branch cut would be all angles."""
    if not abs(sine) > NOTHING:
        return arb(0) if cosine > 0 else arb.pi()
    return arb.atan2(sine, cosine)


def quaternion(frame: Frame) -> tuple[Real, ...]:
    """The rotation of a frame as w, x, y, z."""
    roll, pitch, yaw = (angle / 2 for angle in roll_pitch_yaw(frame))
    (cr, sr), (cp, sp), (cy, sy) = ((angle.cos(), angle.sin()) for angle in (roll, pitch, yaw))
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def is_world(frame: Frame) -> bool:
    """Whether a frame is where it is seen from."""
    return not any(abs(c) > NOTHING for c in (*frame.origin, *roll_pitch_yaw(frame)))


def given(cell: object) -> bool:
    """Whether a cell says something."""
    return cell is not None and cell != ZERO
