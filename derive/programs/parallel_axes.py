"""Runs of joints with parallel axes: one turn by the sum of their angles in place of one turn after another.

Where the axis of a revolute joint is parallel to that of the revolute joint before it, opposed or not, with prismatic
joints between them or not, the constant rotation between the two leaves z where it is up to its sign, and turns about
z add: Rot(z, t_1) C Rot(z, t_2) = Rot(z, t_1 +- t_2) C. In the axes in which a run begins, joint frame i is turned by
Rot(z, phi_i) C_i with phi_i = t_1 +- t_2 ... and C_i constant, and origins are sums of constant vectors turned by one
phi each: a_1 c_1 + a_2 c_12.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from derive.mechanics.chain import Chain, ChainJoint
from derive.mechanics.vectors import Frame, Matrix, Vector, add, column, identity, matmul, multiply, scale
from derive.programs.tape.value import Value


class Turn(NamedTuple):
    """The angle of a revolute joint with its sign in a sum; joints count from 0."""

    joint: int
    direction: int


SumOfTurns = Callable[[Sequence[Turn]], tuple[Value, Value]]
"""Cosine and sine of a signed sum of joint angles; of no angle 1 and 0."""


@dataclass(frozen=True, slots=True)
class Placement:
    """Joint frame i in the axes of its run: Rot(z, phi) constant, at ``origin``.

    Attributes:
        cosine: cos(phi).
        sine: sin(phi).
        constant: C, 3x3; z goes to z or -z where the joint turns.
        origin: From the run's origin, in its axes.
        step: The last part of ``origin``, from the joint frame before.
        direction: +1 where z_i is z of the run, -1 where it points the other way, 0 for a slide across.
    """

    cosine: Value
    sine: Value
    constant: Matrix[Value]
    origin: Vector[Value]
    step: Vector[Value]
    direction: int

    def turned(self, v: Vector[Value]) -> Vector[Value]:
        """A vector of joint frame i in the axes of the run."""
        return about_z(self.cosine, self.sine, multiply(self.constant, v))

    def axis(self) -> Vector[Value]:
        """z_i in the axes of the run."""
        return about_z(self.cosine, self.sine, column(self.constant, 2))


@dataclass(frozen=True, slots=True)
class Run:
    """Consecutive joints whose revolute axes are parallel.

    Attributes:
        first: Index of its first joint, from 0.
        fixed: Constant, from the last joint frame of the run before (for the first run frame 0) to the run's axes.
        placements: One for each joint.
    """

    first: int
    fixed: Frame[Value]
    placements: tuple[Placement, ...]

    @property
    def last(self) -> Placement:
        """The joint frame from which the next run goes on."""
        return self.placements[-1]


def about_z(c: Value, s: Value, v: Vector[Value]) -> Vector[Value]:
    """Rot(z) v."""
    x, y, z = v
    return (c * x - s * y, s * x + c * y, z)


def parallel_runs(chain: Chain[Value], total: SumOfTurns) -> tuple[Run, ...]:
    """The runs of an arm, as long as they can be, from the base outwards.

    Args:
        chain: The arm.
        total: Makes the cosine and sine of a sum of joint angles.
    """
    return tuple(_runs(chain, total))


def _runs(chain: Chain[Value], total: SumOfTurns) -> Iterator[Run]:
    still = Frame(identity(chain.zero, chain.one), (chain.zero, chain.zero, chain.zero))
    first = 0
    while first < chain.n:
        here = _Here(still.rotation, still.position, still.position, chain.one, chain.zero, ())
        step: _Here | None = here.after(first, chain.joints[first], still, chain, total)
        placements: list[Placement] = []
        i = first
        while step is not None:
            here = step
            placements.append(here.placement(chain))
            i += 1
            step = here.after(i, chain.joints[i], chain.joints[i].fixed, chain, total) if i < chain.n else None
        yield Run(first, chain.joints[first].fixed, tuple(placements))
        first = i


@dataclass(frozen=True, slots=True)
class _Here:
    """A joint frame in the axes of its run, and the turns that lead there."""

    constant: Matrix[Value]
    origin: Vector[Value]
    step: Vector[Value]
    cosine: Value
    sine: Value
    turns: tuple[Turn, ...]

    def after(
        self, index: int, joint: ChainJoint[Value], fixed: Frame[Value], chain: Chain[Value], total: SumOfTurns
    ) -> _Here | None:
        """The next joint frame; None where its joint turns about another direction."""
        constant = matmul(self.constant, fixed.rotation)
        z = column(constant, 2)
        shift = add(multiply(self.constant, fixed.position), scale(joint.offset, z))
        step = about_z(self.cosine, self.sine, shift)
        origin = add(self.origin, step)
        if not joint.revolute:
            constant = matmul(constant, joint.motion(chain.zero, chain.one).rotation)
            return _Here(constant, origin, step, self.cosine, self.sine, self.turns)
        direction = _direction(z, chain)
        if direction == 0:
            return None
        turns = (*self.turns, Turn(index, direction))
        return _Here(constant, origin, step, *total(turns), turns)

    def placement(self, chain: Chain[Value]) -> Placement:
        direction = _direction(column(self.constant, 2), chain)
        return Placement(self.cosine, self.sine, self.constant, self.origin, self.step, direction)


def _direction(z: Vector[Value], chain: Chain[Value]) -> int:
    """+1 for z itself, -1 for its opposite, else 0; exact."""
    if z[0].ref != chain.zero.ref or z[1].ref != chain.zero.ref:
        return 0
    return {chain.one.ref: 1, (-chain.one).ref: -1}.get(z[2].ref, 0)
