"""What a base that moves adds to the torques of an arm, and what it does to it: Newton-Euler, started with its motion.

In the axes of the base, a point at r of it accelerates with R^T (p'' - g) + U r, where U = R^T R'' = alpha^ +
omega^ omega^ and omega^ = R^T R'; that is how the recursion of `derive.mechanics.newton_euler` sees a link. Joint
accelerations are multiplied by the same inertia matrix whether the base moves or not, so that the difference of the two
recursions has none of them: it depends on time, position and velocity alone.

Energy is that in the world, where base and joints work on the arm: E' = f.v + m.omega + tau.qd, with f and m the force
and the moment of the base at the origin of frame 0, v and omega its velocities (Newton-Euler gives them, so that they
and the energies, by velocities alone, are told apart by any fault in either).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any, Generic, Self

import numpy as np
from sympy import Expr, Integer, Matrix, cos, eye, sin

from derive.arrays import Array
from derive.mechanics import newton_euler, vectors
from derive.mechanics.chain import Body, Chain, Domain, body_in, build_chain, constant_vector
from derive.mechanics.energy import kinetic_energy, potential_energy
from derive.mechanics.floats import ArrayDomain, FloatDomain
from derive.mechanics.joint_motion import along_axes
from derive.mechanics.newton_euler import LinkMotion, angular_acceleration_tensor, carried_wrenches, inverse_dynamics
from derive.mechanics.vectors import Frame, S, Symmetric, Vector, add, dot, matmul, multiply, subtract, transpose
from derive.plans.profile import TIME, Curve
from derive.plans.segments import Payload
from derive.programs.tape.build import cut
from derive.programs.tape.graph import Graph
from derive.programs.tape.tape import Tape
from derive.programs.tape.value import QD, TapeDomain, Value
from derive.robot import tree
from derive.robot.description import INERTIA, Inertia, Link
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, Name
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot


def carried_body(robot: Robot, payload: Payload, values: Mapping[str, float]) -> tuple[int, Body[float]]:
    """The joint that moves what the tool carries, and the body in the frame of its link."""
    arm, joints = tree.arm(robot, payload.end)
    domain, (x, y, z) = FloatDomain(arm, [0.0] * arm.n, values), payload.com
    link = Link(payload.mass, (x, y, z), Inertia(*payload.inertia))
    return joints[-1], body_in(build_chain(arm, domain).tip, link, domain)


@dataclass(frozen=True)
class OpenLinks:
    """A robot of which the links at some ends have symbols instead of numbers, so that what they carry may change."""

    robot: Robot  # with these symbols
    names: Mapping[int, tuple[str, ...]]  # of mass, centre of mass and inertia about it, by the joint of the link

    @classmethod
    def of(cls, robot: Robot, payloads: Iterable[Payload | None]) -> Self:
        """Open the links that carry payloads."""
        taken, stem = set(robot_symbols(robot)), "carried"
        while any(name.startswith(stem) for name in taken):
            stem += "_"
        ends = (tree.end_named(robot, payload.end) for payload in payloads if payload)
        carrying = {tree.way_to(robot, end.after).joint for end in ends}
        links, opened = list(robot.links), {}
        for place, joint in enumerate(sorted(carrying)):
            names = [f"{stem}{place or ''}{part}" for part in ("m", "x", "y", "z", *INERTIA)]
            mass, x, y, z, *inertia = map(Name, names)
            links[joint] = replace(links[joint], mass=mass, com=(x, y, z), inertia=Inertia(*inertia))
            opened[joint] = tuple(names)
        return cls(replace(robot, links=tuple(links)), opened)

    def carrying(
        self, robot: Robot, values: Mapping[str, float], payloads: Iterable[Payload | None] = ()
    ) -> dict[str, float]:
        """The numbers of a robot, and those of the symbols for its open links with what is carried."""
        found, carried = dict(values), [carried_body(robot, each, values) for each in payloads if each]
        domain, unit = FloatDomain(robot, (), values), Frame(vectors.identity(0.0, 1.0), (0.0, 0.0, 0.0))
        for joint, names in self.names.items():
            body = sum((other for place, other in carried if place == joint), body_in(unit, robot.links[joint], domain))
            com = vectors.scale(1 / body.mass if body.mass else 0.0, body.first_moment)
            inertia = body.inertia + vectors.steiner(-body.mass, com)
            found |= zip(names, (body.mass, *com, *(getattr(inertia, key) for key in INERTIA)), strict=True)
        return found


KEPT = 8  # single times whose transforms are kept: plant and controller ask for the same
BASE = "base"  # argument of a tape: upper rows of the transform of the base, its rate and second derivative


@dataclass(frozen=True, slots=True)
class OnBase(Generic[S]):
    """An arm on a base that moves, at an instant, over any scalar type."""

    chain: Chain[S]  # the arm at its configuration
    motion: LinkMotion[S]  # of frame 0 in its own axes, its acceleration less gravity
    velocity: Vector[S]  # of the origin of frame 0, in the same axes
    weight: tuple[Vector[S], S]  # gravity in the same axes, and times the way to frame 0 from the world's origin

    @classmethod
    def of(cls, chain: Chain[S], base: Sequence[Frame[S]], gravity: Vector[S]) -> Self:
        """From the transform of the base, its rate and its second derivative, and from gravity in the world."""
        pose, rate, bend = base
        fixed = chain.base
        # Frame 0 stands in the base as `fixed`: its rotation in the world is R_w = R R_f, its rates R' R_f and R'' R_f.
        back = transpose(matmul(pose.rotation, fixed.rotation))
        spin, tensor = (matmul(back, matmul(each.rotation, fixed.rotation)) for each in (rate, bend))
        # R_w^T R_w' = omega^; R_w^T R_w'' = alpha^ + omega^ omega^, whose off-diagonal entries give alpha.
        x, y, z = omega = (spin[2][1], spin[0][2], spin[1][0])
        alpha = (tensor[2][1] - y * z, tensor[0][2] - x * z, tensor[1][0] - x * y)
        # o = p + R p_f and its derivatives: place, velocity and acceleration of the origin of frame 0 in the world.
        place, speed, push = (add(each.position, multiply(each.rotation, fixed.position)) for each in base)
        found, differences = angular_acceleration_tensor(omega, alpha)
        motion = LinkMotion(omega, alpha, found, multiply(back, subtract(push, gravity)), differences)
        return cls(chain, motion, multiply(back, speed), (multiply(back, gravity), dot(gravity, place)))

    def added(self, qd: Sequence[S]) -> list[S]:
        """What is added to the torques of the arm on a base that stands [N m or N]."""
        still = [self.chain.zero] * self.chain.n
        # B qdd is the same in both recursions, so that qdd = 0 tells the difference.
        moving, standing = (inverse_dynamics(self.chain, qd, still, base=each) for each in (self.motion, None))
        return [a - b for a, b in zip(moving, standing, strict=True)]

    def power(self, qd: Sequence[S], qdd: Sequence[S]) -> S:
        """Of the force and the moment by which the base moves the arm [W]."""
        rates, accelerations = along_axes(self.chain, qd), along_axes(self.chain, qdd)
        motions = newton_euler.link_motions(self.chain, rates, accelerations, base=self.motion)
        *_, (_, (force, moment)) = carried_wrenches(self.chain, motions, rates, accelerations, ())
        return dot(force, self.velocity) + dot(moment, self.motion.omega)

    def energy(self, qd: Sequence[S], half: S) -> S:
        """Kinetic and potential energy in the world [J], without that of what is fixed to the base."""
        nothing, (gravity, drop) = self.chain.zero, self.weight
        # Links fixed to the base move with it whatever the joints do: their energy is the base's own.
        ground = Body(nothing, self.chain.null, Symmetric(*[nothing] * 6))
        chain = replace(self.chain, gravity=gravity, drop=drop, ground=ground)
        return kinetic_energy(chain, qd, half, (self.velocity, self.motion.omega)) + potential_energy(chain)


class NumberedDomain(TapeDomain):
    """Cells of a robot as numbers on a graph, and its configuration as arguments."""

    def __init__(self, robot: Robot, graph: Graph, values: Mapping[str, float]) -> None:
        super().__init__(robot, graph)
        self._values = values

    def constant(self, expression: Expression) -> Value:
        """The value of a cell."""
        return self.number(Fraction(evaluate(expression, self._values)))


@dataclass(frozen=True)
class BaseCurve:
    """The transform of a moving base and its derivatives, exact."""

    transform: Matrix  # from the base of the robot file to the world, (4, 4), in the symbol `TIME`

    @classmethod
    def of(cls, place: tuple[Expr, ...], angles: tuple[Expr, ...]) -> Self:
        """The transform of formulas."""
        # R = Rz(yaw) Ry(pitch) Rx(roll).
        turns = (vectors.about_axis(k, cos(x), sin(x), Integer(0), Integer(1)) for k, x in enumerate(angles))
        roll, pitch, yaw = map(Matrix, turns)
        whole = eye(4)
        whole[:3, :3], whole[:3, 3] = yaw * pitch * roll, Matrix(place)
        return cls(whole)

    def __call__(self, t: Array, order: int) -> Array:
        """The transform, or a derivative of it by time."""
        return np.stack([curve.sampled(t, order) for curve in self._curves], axis=-1).reshape(-1, 4, 4)

    @cached_property
    def single(self) -> Callable[[float], tuple[list[list[float]], ...]]:
        """Transform, rate and second derivative at one time, as rows; what was asked last is kept."""
        return lru_cache(KEPT)(lambda t: tuple(self(np.array([t]), order)[0].tolist() for order in range(3)))

    @cached_property
    def _curves(self) -> list[Curve]:
        rates = [(entry, entry.diff(TIME)) for entry in self.transform]
        return [Curve(Integer(0), Integer(1), (entry, rate, rate.diff(TIME))) for entry, rate in rates]


@dataclass(frozen=True)
class BaseTorques:
    """Torques that an arm needs since its base moves."""

    robot: Robot  # the robot; its gravity is that of the world in which the base moves
    values: Mapping[str, float]  # numbers of all symbols
    base: BaseCurve  # the motion of its base
    duration: float  # how long it moves [s]; before and after it stands

    def carrying(self, *payloads: Payload | None) -> Self:
        """Those of the arm whose links are as heavy as with what its ends carry."""
        if not any(payloads):
            return self
        links = OpenLinks.of(self.robot, payloads)
        return replace(self, robot=links.robot, values=links.carrying(self.robot, self.values, payloads))

    def _gravity(self, domain: Domain[S]) -> Vector[S]:
        zero = domain.number(0)
        return constant_vector(self.robot.gravity, domain) if self.robot.gravity else (zero, zero, zero)

    def _many(self, t: Array, q: Array) -> OnBase[Any]:
        """The arm at many times, (times,), and configurations, (times, n)."""
        domain = ArrayDomain(self.robot, tuple(np.moveaxis(q, -1, 0)), self.values)
        inside = np.clip(t, 0.0, self.duration)
        base = np.array([self.base(inside, order) for order in range(3)])
        base[1:, inside != t] = 0.0  # before its motion and after it a base stands
        frames = [_frame([list(row) for row in np.moveaxis(each[:, :3], 0, -1)]) for each in base]
        return OnBase.of(build_chain(self.robot, domain), frames, self._gravity(domain))

    def at(self, t: float, q: Array) -> OnBase[float]:
        """The arm at one time [s] and configuration, (n,), without the cost of arrays."""
        domain = FloatDomain(self.robot, q.tolist(), self.values)
        inside = min(max(t, 0.0), self.duration)
        pose, *rates = self.base.single(inside)
        if inside != t:
            rates = [[[0.0] * 4] * 4] * 2
        frames = [_frame(rows) for rows in (pose, *rates)]
        return OnBase.of(build_chain(self.robot, domain), frames, self._gravity(domain))

    def __call__(self, t: Array, q: Array, qd: Array, payload: Payload | None = None) -> Array:
        """What is added to the torques of the arm on a base that stands, (times, n) [N m or N], at times (times,)."""
        torques = self.carrying(payload)._many(t, q).added(tuple(np.moveaxis(qd, -1, 0)))
        return np.stack([np.broadcast_to(torque, t.shape) for torque in torques], axis=-1)

    def power(self, t: Array, q: Array, qd: Array, qdd: Array, payload: Payload | None = None) -> Array:
        """What the base does to the arm, (times,) [W]."""
        rates, accelerations = (tuple(np.moveaxis(each, -1, 0)) for each in (qd, qdd))
        return np.asarray(np.broadcast_to(self.carrying(payload)._many(t, q).power(rates, accelerations), t.shape))

    def energy(self, t: Array, q: Array, qd: Array) -> Array:
        """Kinetic and potential energy of the arm in the world, (times,) [J]."""
        return np.asarray(np.broadcast_to(self._many(t, q).energy(tuple(np.moveaxis(qd, -1, 0)), 0.5), t.shape))

    def single(self, *payloads: Payload | None) -> Callable[[float, Array, Array], Array]:
        """What is added to the torques, as a function of one time [s], joint variables and velocities, (n,) each."""
        carried = self.carrying(*payloads)
        return lambda t, q, qd: np.array(carried.at(t, q).added(qd.tolist()))

    def tape(self, payload: Payload | None = None) -> Tape:
        """The same as a program with the arguments ``q``, ``qd`` and `BASE`."""
        carried, graph = self.carrying(payload), Graph()
        domain = NumberedDomain(carried.robot, graph, carried.values)
        frames = [
            _frame([[domain.argument(BASE, 12 * order + 4 * i + j) for j in range(4)] for i in range(3)])
            for order in range(3)
        ]
        rates = [domain.argument(QD, j) for j in range(self.robot.n)]
        torques = OnBase.of(build_chain(carried.robot, domain), frames, self._gravity(domain)).added(rates)
        return cut(graph, [torque.ref for torque in torques])


def _frame(rows: Sequence[Sequence[Any]]) -> Frame[Any]:
    """Three rows of four entries as a frame; of a derivative no transform, and yet of that form."""
    a, b, c = ((row[0], row[1], row[2]) for row in rows[:3])
    return Frame((a, b, c), (rows[0][3], rows[1][3], rows[2][3]))
