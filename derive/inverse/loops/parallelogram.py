"""Loops that equal lengths make linear: of a parallelogram opposite sides turn alike.

Where the passive joints of a loop follow the variables with whole factors and a constant of whole right angles, they
are coupled joints, S q and constants, and nothing is left of the loop: a five-bar linkage with two pairs of equal sides
is written in the absolute angles of its cranks (Spong, Hutchinson and Vidyasagar, Robot Modeling and Control, 2006,
chapter on dynamics). Numbers propose, exact arithmetic decides: with the coupled joints put in, the frames that the
loop joins coincide identically.

A parallelogram and its counterpart with crossed sides meet where all sides lie on one line, so that one sign of the
closed form, the branch of the file, is either of them, depending on the side of that line. The linear one is smooth
there. It is taken where the branch is linear in some configuration within the limits of the variables.
"""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np

from derive.algebra.angles import composed, decompose
from derive.algebra.domain import PolynomialDomain
from derive.errors import QuantityError
from derive.inverse.loops.closing import Array, Closing, openings
from derive.inverse.loops.linkage import assembled, linkage, positions
from derive.robot.description import Joining, Joint, Loop, position
from derive.robot.expression import ZERO, Pi, Power, add, multiply, negate, number
from derive.robot.robot import Robot

_STEP, _NEAR = 1e-4, 1e-3  # of the variables [rad or m], and how near to whole numbers slopes and constants are
_RIGHT = np.pi / 2


def reduced(robot: Robot) -> Robot:
    """The robot with its linear loops turned into couplings; itself where there are none, or no closed form."""
    for k, loop in enumerate(robot.loops):
        try:  # loops behind this one do not matter to it
            loops = linkage(replace(robot, loops=robot.loops[: k + 1]))
        except QuantityError:
            return robot
        for joints in dict.fromkeys(_proposed(robot, loops)):
            coupled = replace(robot, joints=joints, loops=tuple(each for each in robot.loops if each != loop))
            if _is_closed(coupled, loop):
                return reduced(coupled)
    return robot


def _proposed(robot: Robot, loops: tuple[Closing, ...]) -> Iterator[tuple[Joint, ...]]:
    """The joints of a robot, the passive ones of the last loop as they follow the variables at some configurations."""
    places, names = loops[-1].passive, [each.variable for each in robot.variables]
    turns = np.array([[robot.joints[k].is_revolute] for k in places])
    values, q, full, _ = assembled(robot, loops)

    def _whole(angles: Array) -> Array:
        """Without whole turns."""
        return np.where(turns, (angles + np.pi) % (2 * np.pi) - np.pi, angles)

    start = np.array([full[k] for k in places])
    steps = [[x + _STEP * (j == k) for j, x in enumerate(q)] for k in range(len(q))]
    moved = [np.array([positions(robot, loops, step, values)[0][k] for k in places]) for step in steps]
    slopes = np.array([_whole(end - start) / _STEP for end in moved])  # variable, passive joint, configuration
    factors = np.round(slopes)
    rest = _whole(start - np.einsum("kps,ks->ps", factors, np.array(q))) / _RIGHT
    off = np.abs(slopes - factors).max(axis=(0, 1)) + np.abs(rest - np.where(turns, np.round(rest), 0)).max(axis=0)
    for at in np.flatnonzero(off < _NEAR):
        joints = list(robot.joints)
        for p, k in enumerate(places):
            joint, rights = joints[k], round(rest[p, at])
            own = zip(names, factors[:, p, at].astype(int).tolist(), strict=True)
            drive = tuple((name, number(joint.sign * factor)) for name, factor in own if factor)
            exact = decompose(add(joint.theta, multiply(number(Fraction(joint.sign * rights, 2)), Pi())))
            # Without whole turns; the constant of a slide, which is zero, leaves its angle as it is.
            theta = composed(replace(exact, pi_multiple=1 - (1 - exact.pi_multiple) % 2)) if rights else joint.theta
            # One that stands still has the factor 0: without any it would be a variable.
            drive = drive or ((names[0], ZERO),)
            joints[k] = replace(joint, name=joint.label, sign=1, theta=theta, drive=drive, follows=())
            meant = multiply(number(joint.sign), add(position(joints[k]), theta, negate(joint.theta)))
            joints[k] = replace(joints[k], meant=meant)
        yield tuple(joints)


def _is_closed(robot: Robot, loop: Loop) -> bool:
    """Whether a loop that the robot no longer has is closed in every configuration."""
    of_rod = [loop.length, Power(loop.length, -1)] if loop.by is Joining.DISTANCE else []
    domain = PolynomialDomain(robot, of_rod, rates=False)
    return not any(openings(robot, Closing(loops=(loop,), passive=()), domain)[1])
