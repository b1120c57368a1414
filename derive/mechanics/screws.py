"""What every joint does to every link, as screws in the frames of the links, and the rotors as unit bodies.

The screw of joint a in a frame of link k is the angular velocity of the link and the velocity of the frame's origin
while joint a alone moves at unit rate (Featherstone, Rigid Body Dynamics Algorithms, section 2.2).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Generic

from derive.mechanics.chain import Chain, ChainJoint
from derive.mechanics.joint_motion import origin, to_child
from derive.mechanics.vectors import Frame, S, Vector, add, cross, multiply, transpose
from derive.robot.description import Link, Motor
from derive.robot.expression import ONE
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Screw(Generic[S]):
    """A unit rate of one joint, seen from a frame of a link further out.

    Attributes:
        angular: Angular velocity, in the frame's axes.
        linear: Velocity of the frame's origin, in the frame's axes.
    """

    angular: Vector[S]
    linear: Vector[S]

    def at(self, place: Vector[S]) -> Vector[S]:
        """Velocity of the link's point at ``place``."""
        return add(self.linear, cross(self.angular, place))

    def seen_from(self, frame: Frame[S]) -> Screw[S]:
        """The same in a frame fixed on the same link."""
        turned = transpose(frame.rotation)
        return Screw(multiply(turned, self.angular), multiply(turned, self.at(frame.position)))


def link_screws(chain: Chain[S]) -> list[list[Screw[S]]]:
    """For every link k its screws of joints 1..k in joint frame k, rates counted positive along +z."""
    found: list[list[Screw[S]]] = []
    for joint in chain.joints:
        found.append(next_screws(chain, joint, found[-1] if found else []))
    return found


def next_screws(chain: Chain[S], joint: ChainJoint[S], before: list[Screw[S]]) -> list[Screw[S]]:
    """The screws of the link behind a joint, from those of the link before it."""
    return [*(_outward(joint, screw) for screw in before), _own(chain, joint)]


def _outward(joint: ChainJoint[S], screw: Screw[S]) -> Screw[S]:
    return Screw(to_child(joint, screw.angular), to_child(joint, screw.at(origin(joint))))


def _own(chain: Chain[S], joint: ChainJoint[S]) -> Screw[S]:
    still, along = (chain.zero, chain.zero, chain.zero), (chain.zero, chain.zero, chain.one)
    return Screw(along, still) if joint.revolute else Screw(still, along)


def with_unit_rotors(robot: Robot) -> Robot:
    """The robot with nothing on it but its rotors, each of unit mass and unit inertia.

    In its chain ``coupling`` is sign * ratio, ``reflected`` is ratio^2, and the body of link i-1 is the rotor of joint
    i, so that its first moment is the rotor's place.
    """
    return replace(robot, links=tuple(_unit_rotor(link) for link in robot.links))


def _unit_rotor(link: Link) -> Link:
    return Link(motor=None if link.motor is None else Motor(ONE, ONE, link.motor.ratio))


def rotor_place(chain: Chain[S], joint: int) -> Vector[S]:
    """Where the rotor of a joint (from 1, not the first) sits in joint frame ``joint - 1``, from `with_unit_rotors`."""
    return chain.bodies[joint - 2].first_moment
