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
        """Velocity of a point of the link.

        Args:
            place: The point in the frame.
        """
        return add(self.linear, cross(self.angular, place))

    def seen_from(self, frame: Frame[S]) -> Screw[S]:
        """The screw in another frame fixed on the same link.

        Args:
            frame: That frame in this one.
        """
        turned = transpose(frame.rotation)
        return Screw(multiply(turned, self.angular), multiply(turned, self.at(frame.position)))


def link_screws(chain: Chain[S]) -> list[list[Screw[S]]]:
    """The screws of joints 1..k of every link k, in joint frame k, rates counted positive along +z.

    Args:
        chain: The arm.
    """
    found: list[list[Screw[S]]] = []
    for joint in chain.joints:
        found.append(next_screws(chain, joint, found[-1] if found else []))
    return found


def next_screws(chain: Chain[S], joint: ChainJoint[S], before: list[Screw[S]]) -> list[Screw[S]]:
    """The screws of the link behind a joint.

    Args:
        chain: The arm.
        joint: Joint i.
        before: Those of link i-1, in joint frame i-1.

    Returns:
        i screws, in joint frame i.
    """
    outward = [Screw(to_child(joint, screw.angular), to_child(joint, screw.at(origin(joint)))) for screw in before]
    along = (chain.zero, chain.zero, chain.one)
    return [*outward, Screw(along, chain.null) if joint.revolute else Screw(chain.null, along)]


def with_unit_rotors(robot: Robot) -> Robot:
    """The robot with nothing on it but its rotors, each of unit mass and unit inertia.

    In its chain ``coupling`` is sign * ratio, ``armature`` is ratio^2, and the body of link i-1 is the rotor of joint
    i, so that its first moment is the rotor's place.

    Args:
        robot: A robot with links.
    """
    motors = (link.motor and Motor(ONE, ONE, link.motor.ratio) for link in robot.links)
    return replace(robot, links=tuple(Link(motor=motor) for motor in motors))


def rotor_place(chain: Chain[S], joint: int) -> Vector[S]:
    """Where the rotor of a joint sits, in joint frame ``joint - 1``.

    Args:
        chain: The chain of a robot `with_unit_rotors`.
        joint: From 1, not the first.
    """
    return chain.bodies[joint - 2].first_moment
