"""Joints that depend on each other, as other programs have them: each with its own position, and equations between."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from flint import arb, arb_mat

from derive.errors import DeriveError, listed
from derive.exchange.certificate import ball
from derive.exchange.numeric import text
from derive.exchange.reading.elements import free_name
from derive.mechanics.floats import ArrayDomain
from derive.mechanics.space import NOTHING, Real
from derive.robot.description import End, Joining, Joint, coupling
from derive.robot.evaluate import to_float
from derive.robot.expression import Name
from derive.robot.robot import Robot
from derive.robot.tree import ends

Sum = tuple[tuple[str, Real], ...]  # labels of joints with the factors of their positions


@dataclass(frozen=True, slots=True)
class Joined:
    """Two frames that a closed loop joins."""

    ends: tuple[str, str]  # the ends that stand for them
    by: Joining
    way: int  # along which of the first one's z axis that of the second points: 1, or -1 where they are opposed
    stretch: float  # of a rod, by how much it is longer than the way between them where all joints are at zero [m]


@dataclass(frozen=True, slots=True)
class Ties:
    """Equations between the positions of joints."""

    driven: Mapping[str, Sum]  # by the label of a joint what its position is
    variables: Mapping[str, Sum]  # what variables are that are no position of a joint, by name
    passive: frozenset[str] = frozenset()  # labels of joints that loops move
    loops: tuple[Joined, ...] = ()
    closed: tuple[float, ...] = ()  # positions of all joints with which the loops are closed [rad or m]


NONE = Ties({}, {})


def untied(robot: Robot) -> tuple[Robot, Ties]:
    """A robot of numbers with a variable for every joint, and the equations between these."""
    if not robot.coupled:
        return robot, NONE
    # x = S v of joints that are no passive ones of loops: n independent rows x_b of S give v = S_b^-1 x_b, and with it
    # the other rows, x = S S_b^-1 x_b.
    rows = [k for k, joint in enumerate(robot.joints) if not joint.follows]
    matrix = coupling(robot, lambda factor: arb(0) if isinstance(factor, Name) else ball(factor))
    basis: list[int] = []
    for k in sorted(rows, key=lambda k: bool(robot.joints[k].drive)):
        found = np.array([[float(factor) for factor in matrix[row]] for row in (*basis, k)])
        basis += [k] if np.linalg.matrix_rank(found) == len(found) else []
    inverse = arb_mat([matrix[k] for k in basis]).inv()
    labels = [robot.joints[k].label for k in basis]

    def _sum(factors: Sequence[arb]) -> Sum:
        return tuple((label, f) for label, f in zip(labels, factors, strict=True) if not abs(f) < NOTHING)

    driven = {robot.joints[k].label: _sum((arb_mat([matrix[k]]) * inverse).entries()) for k in rows if k not in basis}
    own = {joint.variable for joint in robot.joints if not joint.drive}
    sums = zip(robot.coupled, inverse.tolist(), strict=True)
    bare = replace(robot, joints=tuple(_alone(robot, joint) for joint in robot.joints), coupled=())
    ties = Ties(driven, {each.variable: _sum(row) for each, row in sums if each.variable not in own})
    return _open(robot, bare, ties) if robot.loops else (bare, ties)


def _alone(robot: Robot, joint: Joint) -> Joint:
    """A joint with a variable of its own, which is its label where that was none."""
    if joint.drive:
        return replace(joint, variable=joint.label, drive=())
    alike = next((v for v in robot.coupled if v.variable == joint.variable), joint)
    limits, speed, torque = joint.limits or alike.limits, joint.speed or alike.speed, joint.torque or alike.torque
    return replace(joint, limits=limits, speed=speed, torque=torque, follows=())


def _open(robot: Robot, bare: Robot, ties: Ties) -> tuple[Robot, Ties]:
    """With its loops open: an end stands for each of the frames that they join."""
    from derive.inverse.loops.closing import are_opposed, gaps
    from derive.inverse.loops.linkage import assembled, linkage

    loops, more = [], []
    values, q, full, _ = assembled(robot, linkage(robot))
    rest = ArrayDomain(robot, [np.zeros(1)] * robot.n, values)
    for k, loop in enumerate(robot.loops, 1):
        if loop.by is Joining.PRISMATIC:
            raise DeriveError(
                f"the loop of {robot.name} that joins {listed(loop.join)} by a slide",
                allowed="allowed in other programs: revolute, spherical, distance and fixed",
                remedy="write the slide as a row of the table, and close by: fixed",
                location=loop.location,
            )
        first, second = (free_name(f"loop{k}_{side}", [end.name for end in robot.ends]) for side in ("first", "second"))
        is_opposed = loop.by is Joining.REVOLUTE and are_opposed(robot, loop)
        stretch = to_float(loop.length, values) - float(np.linalg.norm(gaps(robot, loop, rest)))
        loops.append(Joined((first, second), loop.by, -1 if is_opposed else 1, stretch))
        more += [End(first, loop.join[0]), End(second, loop.join[1])]
    nearest = int(np.argmin(sum(np.square(x) for x in q)))
    closed = tuple(float(x[nearest]) for x in full)
    whole = tuple(replace(end, name=end.name or "tool") for end in ends(bare))
    ties = replace(ties, passive=frozenset(joint.label for joint in robot.passive), loops=tuple(loops), closed=closed)
    return replace(bare, ends=(*whole, *more), loops=()), ties


def in_words(total: Sum) -> str:
    """A sum of positions as text: ``shoulder + 0.5*elbow``."""
    terms = (label if factor == 1 else f"{text(factor)}*{label}" for label, factor in total)
    return " + ".join(terms).replace("+ -", "- ")
