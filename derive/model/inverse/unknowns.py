"""What is solved for, as generators of one ring: joint angles, slides, and sums of the angles of parallel joints.

Parallel joints form a group (opposed axes too), whose angles books add. Seen from its first link the link after k
joints of a group of m is turned by phi_k, k = 0..m; joint angles and their sums are the differences phi_v - phi_u.
Each difference has a cosine and a sine of its own in the ring: which of them describe an arm is a matter of choice,
made equation by equation. Knowing some of them splits 0..m into sets within which all differences are known.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

from derive.algebra.angles import decompose
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Generator, Kind
from derive.algebra.ring import Polynomial
from derive.model.inverse.nodes import Unknown
from derive.robot.description import Joint
from derive.robot.expression import ZERO, Expression, Name, Number, Pi, add, multiply
from derive.robot.robot import Robot
from derive.robot.style import Contraction

ENTRIES = tuple(f"[{row},{column}]" for row in (1, 2, 3) for column in (1, 2, 3, 4))
"""Of the upper three rows of a pose."""

INVARIANTS = (
    "p.p",
    *(f"u[{k}]" for k in (1, 2, 3)),
    *(f"m[{row},{column}]" for row in (1, 2, 3) for column in (1, 2, 3)),
    *(f"k[{row},{column}]" for row in (1, 2, 3) for column in (1, 2, 3)),
)
"""Of the pose W = (R, p) within the arm: p.p, u = R^T p, m = [p]x R and k = p.p R - 2 p u^T."""


class InverseDomain(PolynomialDomain):
    """The ring in which inverse kinematics is derived.

    Besides what a robot's ring has, it holds the cosine and sine of every sum of neighbouring angles of a group, the
    entries ``T[row,column]`` of the pose, those of the pose within the arm, ``W[row,column]``, and its `INVARIANTS`.

    Args:
        robot: The robot, without constants in its joint variables (`shifted`).
        extra: Further constants that the ring must be able to hold.
    """

    def __init__(self, robot: Robot, extra: Iterable[Expression] = ()) -> None:
        super().__init__(robot, extra, sums=lambda group: False, contraction=Contraction.OPPOSED, rates=False)

    def _needed_generators(self, rates: bool) -> Iterator[Generator]:
        for group in self.groups:
            for u, v in combinations(range(len(group) + 1), 2):
                if v - u > 1:
                    members = group[u:v]
                    key = "+".join(self.robot.joints[m].variable for m in members)
                    sine, cosine = f"sin {key}", f"cos {key}"
                    argument = self.angle_sum(members)
                    yield Generator(Kind.SINE, sine, argument, -1, cosine)
                    yield Generator(Kind.COSINE, cosine, argument, -1, sine)
        yield from super()._needed_generators(rates)
        names = [f"{pose}{entry}" for pose in "WT" for entry in ENTRIES]
        yield from (Generator(Kind.PARAMETER, name, Name(name)) for name in [*INVARIANTS, *names])

    def unknown(self, *joints: int) -> Unknown:
        """The angle of a joint, or of the sum of neighbouring ones of a group, or the length of a slide.

        Args:
            joints: Indices of the joints, from 0.
        """
        key = "+".join(self.robot.joints[m].variable for m in joints)
        if not self.robot.joints[joints[0]].is_revolute:
            return Unknown(joints, (1,), (key,))
        signs = tuple(self.directions[joints[0]] * self.directions[m] for m in joints)
        return Unknown(joints, signs, (f"cos {key}", f"sin {key}"))

    def joint_turn(self, joint: int, start: int) -> tuple[Polynomial, ...]:
        """The motion of a joint about (along) its own axis, its angle as a difference of sums of angles.

        Args:
            joint: Its index.
            start: The joint of its group at which the sums begin, or the first one after it; -1 for the group's end.
        """
        row = self.robot.joints[joint]
        if not row.is_revolute:
            return (row.sign * self.ring.generator(row.variable),)
        g = next(k for k, group in enumerate(self.groups) if joint in group)
        group = self.groups[g]
        root = sum(member < start for member in group) if start >= 0 else len(group)
        place, sign = group.index(joint), row.sign * self.directions[joint]
        (c, s), (d, e) = self.turn(g, root, place), self.turn(g, root, place + 1)
        return c * d + s * e, sign * (c * e - s * d)

    def turn(self, group: int, u: int, v: int) -> tuple[Polynomial, Polynomial]:
        """Cosine and sine of phi_v - phi_u of a group.

        Args:
            group: Its number in `groups`.
            u: Joints of the group before the one link.
            v: Before the other.
        """
        if u == v:
            return self.ring.one, self.ring.zero
        members = self.groups[group][min(u, v) : max(u, v)]
        cosine, sine = map(self.ring.generator, self.unknown(*members).generators)
        positive = (self.directions[members[0]] > 0) == (u < v)
        return cosine, sine if positive else -sine


def shifted(robot: Robot) -> tuple[Robot, tuple[Expression, ...]]:
    """The robot with its joint variables counted from where their cells have no constants but right angles.

    Args:
        robot: The robot.

    Returns:
        The robot, and for each joint the constant that its new variable has more than the old one.
    """
    joints, shifts = zip(*map(_shifted_joint, robot.joints), strict=True)
    return replace(robot, joints=joints), shifts


def _shifted_joint(joint: Joint) -> tuple[Joint, Expression]:
    if not joint.is_revolute:
        return replace(joint, d=ZERO), multiply(Number(Fraction(joint.sign)), joint.d)
    exact = decompose(joint.theta)
    right = Fraction(round(exact.pi_multiple * 2), 2)
    kept = multiply(Number(right), Pi()) if right else ZERO
    rest = add(joint.theta, multiply(Number(-right), Pi())) if right else joint.theta
    if not exact.terms and exact.pi_multiple == right:
        return joint, ZERO
    return replace(joint, theta=kept), multiply(Number(Fraction(joint.sign)), rest)
