"""Runs of joints with parallel axes: one turn by the sum of their angles in place of one turn after another.

Where the axis of a revolute joint is parallel to that of the revolute joint before it, opposed or not, with prismatic
joints between them or not, the constant rotation between the two leaves z where it is up to its sign, and turns about
z add: Rot(z, t_1) C Rot(z, t_2) = Rot(z, t_1 +- t_2) C. In the axes in which a run begins, joint frame i is turned by
Rot(z, phi_i) C_i with phi_i = t_1 +- t_2 ... and C_i constant, and origins are sums of constant vectors turned by one
phi each: a_1 c_1 + a_2 c_12.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from derive.mechanics.chain import Chain
from derive.mechanics.joint_motion import turn_vector
from derive.mechanics.vectors import Frame, Matrix, Vector, add, column, identity, matmul, multiply, scale
from derive.programs.tape.graph import MINUS_ONE, ONE, ZERO
from derive.programs.tape.value import Value


class Turn(NamedTuple):
    """The angle of a revolute joint with its sign in a sum; joints count from 0."""

    joint: int
    direction: int


# Cosine and sine of a signed sum of joint angles; of no angle 1 and 0.
SumOfTurns = Callable[[Sequence[Turn]], tuple[Value, Value]]


@dataclass(frozen=True, slots=True)
class Placement:
    """Joint frame i in the axes of its run: Rot(z, phi) constant, at ``origin``."""

    cosine: Value  # cos(phi)
    sine: Value  # sin(phi)
    constant: Matrix[Value]  # C, 3x3; z goes to z or -z where the joint turns
    origin: Vector[Value]  # from the run's origin, in its axes
    step: Vector[Value]  # the last part of ``origin``, from the joint frame before
    direction: int  # +1 where z_i is z of the run, -1 where it points the other way, 0 for a slide across

    def turned(self, v: Vector[Value]) -> Vector[Value]:
        """A vector of joint frame i in the axes of the run."""
        return turn_vector(self.cosine, self.sine, multiply(self.constant, v))

    def axis(self) -> Vector[Value]:
        """z_i in the axes of the run."""
        return turn_vector(self.cosine, self.sine, column(self.constant, 2))


@dataclass(frozen=True, slots=True)
class ParallelRun:
    """Consecutive joints whose revolute axes are parallel."""

    first: int  # index of its first joint, from 0
    # Constant, from the last joint frame of the run before (for the first run frame 0) to the run's axes.
    fixed: Frame[Value]
    placements: tuple[Placement, ...]  # one for each joint

    @property
    def last(self) -> Placement:
        """The joint frame from which the next run goes on."""
        return self.placements[-1]


def parallel_runs(chain: Chain[Value], total: SumOfTurns) -> tuple[ParallelRun, ...]:
    """The runs of an arm, as long as they can be."""
    runs: list[ParallelRun] = []
    first = 0
    # Greedy: each run goes on until a joint turns about another direction.
    while first < chain.n:
        placements = _placements(chain, first, total)
        runs.append(ParallelRun(first, chain.joints[first].fixed, placements))
        first += len(placements)
    return tuple(runs)


def _placements(chain: Chain[Value], first: int, total: SumOfTurns) -> tuple[Placement, ...]:
    """The joints of the run that begins with some joint, up to that which turns about another direction."""
    zero, one = chain.zero, chain.one
    constant, origin = identity(zero, one), (zero, zero, zero)
    fixed = Frame(constant, origin)
    cosine, sine = one, zero
    turns: tuple[Turn, ...] = ()
    found: list[Placement] = []
    for i in range(first, chain.n):
        joint = chain.joints[i]
        if i > first:
            fixed = joint.fixed
        # C_i = C_{i-1} K: the constant rotation behind the turn by phi.
        before, constant = constant, matmul(constant, fixed.rotation)
        z = column(constant, 2)
        # The way to joint frame i is constant before the turn so far: K's position, and the offset along z_i.
        step = turn_vector(cosine, sine, add(multiply(before, fixed.position), scale(joint.offset, z)))
        origin = add(origin, step)
        if joint.revolute:
            # Parallel if z_i is +-z of the run, exactly; the first joint always is.
            direction = _direction(z)
            if direction == 0:
                break
            # phi = t_1 +- t_2 ..., taken as one cosine and sine.
            turns = (*turns, Turn(i, direction))
            cosine, sine = total(turns)
        else:
            # A slide's own constant turn about z goes into C.
            constant = matmul(constant, joint.motion(zero, one).rotation)
        found.append(Placement(cosine, sine, constant, origin, step, _direction(column(constant, 2))))
    return tuple(found)


def _direction(z: Vector[Value]) -> int:
    """+1 for z itself, -1 for its opposite, else 0; exact."""
    if z[0].ref != ZERO or z[1].ref != ZERO:
        return 0
    return {ONE: 1, MINUS_ONE: -1}.get(z[2].ref, 0)
