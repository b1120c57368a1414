"""The regressor: torques per unit of every parameter, tau = Y(q, qd, qdd) pi, and the screws that it is made of.

The screw of joint a in a frame of link k is the angular velocity of the link and the velocity of the frame's origin
while joint a alone moves at unit rate (Featherstone, Rigid Body Dynamics Algorithms, section 2.2).

One outward pass gives the motion of every link and the screws of all joints in its frame. The wrench of a unit
parameter has few entries there, and its work on the screw of joint a is the entry (a, parameter): with acceleration a
(less gravity), U = alpha^ + omega^ omega^ and the screw (w, v)

    mass: v.a,    first moment: U^T v + a x w,    tensor: w.(E alpha + omega x E omega) for the unit tensors E.

So no wrench has to be carried inward (compare Gautier and Khalil 1988; Siciliano et al., Robotics, section 7.2.2).
Rotors are unit bodies of their own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import accumulate
from typing import Any, Generic

from derive.mechanics.chain import Chain, ChainJoint
from derive.mechanics.joint_motion import along_axes, axis, origin, to_child
from derive.mechanics.newton_euler import LinkMotion, angular_acceleration_tensor, link_motions
from derive.mechanics.vectors import Frame, S, Vector, add, cross, dot, multiply, scale, transpose
from derive.robot.description import Link, Motor
from derive.robot.expression import ONE
from derive.robot.inertial_parameters import Parameter
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Screw(Generic[S]):
    """A unit rate of one joint, seen from a frame of a link further out."""

    angular: Vector[S]  # angular velocity, in the frame's axes
    linear: Vector[S]  # velocity of the frame's origin, in the frame's axes

    def at(self, place: Vector[S]) -> Vector[S]:
        """Velocity of a point of the link."""
        return add(self.linear, cross(self.angular, place))

    def seen_from(self, frame: Frame[S]) -> Screw[S]:
        """The screw in another frame fixed on the same link."""
        turned = transpose(frame.rotation)
        return Screw(multiply(turned, self.angular), multiply(turned, self.at(frame.position)))


def next_screws(chain: Chain[S], joint: ChainJoint[S], before: list[Screw[S]]) -> list[Screw[S]]:
    """The screws of the link behind a joint."""
    # Joints further in: the same motion, its velocity that of the new origin. The joint itself moves about or along z.
    outward = [Screw(to_child(joint, screw.angular), to_child(joint, screw.at(origin(joint)))) for screw in before]
    along = (chain.zero, chain.zero, chain.one)
    return [*outward, Screw(along, chain.null) if joint.revolute else Screw(chain.null, along)]


def with_unit_rotors(robot: Robot) -> Robot:
    """The robot with nothing on it but its rotors, each of unit mass and unit inertia.

    In its chain ``coupling`` is sign * ratio, ``armature`` is ratio^2, and the body of link i-1 is the rotor of joint
    i, so that its first moment is the rotor's place.
    """
    motors = (link.motor and Motor(ONE, ONE, link.motor.ratio) for link in robot.links)
    return replace(robot, links=tuple(Link(motor=motor) for motor in motors))


def rotor_place(chain: Chain[S], joint: int) -> Vector[S]:
    """Where the rotor of a joint sits, in joint frame ``joint - 1``."""
    return chain.bodies[joint - 2].first_moment


def coulomb_column(part: str, sign: Any) -> Any:
    """Coulomb friction per unit of a parameter by sign(qd): 1 and 0 for `fp`, 0 and -1 for `fm` where a joint moves."""
    ahead = (sign + sign * sign) * Fraction(1, 2)
    return {"f": sign, "fp": ahead, "fm": sign - ahead}[part]


@dataclass(frozen=True, slots=True)
class _LinkView(Generic[S]):
    """A link seen from a frame on it."""

    motion: LinkMotion[S]  # of the link, in the frame
    screws: Sequence[Screw[S]]  # of joints 1..k, in the frame

    def seen_from(self, frame: Frame[S]) -> _LinkView[S]:
        """The same link seen from another frame on it; U is computed anew, for turning it would cost more."""
        turned = transpose(frame.rotation)
        before = self.motion
        # a + U p is the acceleration of the new origin.
        acceleration = multiply(turned, add(before.acceleration, multiply(before.tensor, frame.position)))
        omega, alpha = multiply(turned, before.omega), multiply(turned, before.alpha)
        motion = LinkMotion(omega, alpha, angular_acceleration_tensor(omega, alpha)[0], acceleration)
        return _LinkView(motion, [screw.seen_from(frame) for screw in self.screws])

    def power(self, part: str, screw: Screw[S]) -> S:
        """What the wrench of a unit parameter does on a unit rate."""
        motion = self.motion
        u, (x, y, z), (ax, ay, az) = motion.tensor, motion.omega, motion.alpha
        moment: Vector[S]  # E alpha + omega x (E omega) of the unit tensor E
        match part:
            case "m":
                # m a, and no moment about the origin.
                return dot(screw.linear, motion.acceleration)
            case "mx" | "my" | "mz":
                # Force U e_k, moment e_k x a: v . U e_k + w . (e_k x a), the latter as (a x w)_k.
                k = "xyz".index(part[1])
                turning = cross(motion.acceleration, screw.angular)[k]
                return dot((u[0][k], u[1][k], u[2][k]), screw.linear) + turning
            case "Ixx":
                moment = (ax, x * z, -(x * y))
            case "Iyy":
                moment = (-(y * z), ay, x * y)
            case "Izz":
                moment = (y * z, -(x * z), az)
            case "Ixy":
                moment = (-u[2][0], u[2][1], x * x - y * y)
            case "Ixz":
                moment = (u[1][0], z * z - x * x, -u[1][2])
            case "Iyz":
                moment = (y * y - z * z, -u[0][1], u[0][2])
            case _:
                raise KeyError(part)
        return dot(screw.angular, moment)


class Regressor(Generic[S]):
    """Columns of the regressor of one arm in one state."""

    def __init__(
        self, chain: Chain[S], qd: Sequence[S], qdd: Sequence[S], *, ends: bool, sign: Callable[[S], S] | None = None
    ) -> None:
        self.chain = chain
        self._qd, self._qdd = qd, qdd
        self._sign = sign
        self._rates, self._accelerations = along_axes(chain, qd), along_axes(chain, qdd)
        motions = link_motions(chain, self._rates, self._accelerations)
        # Links' parameters of the file stand in DH frames, base parameters in joint frames.
        # Of every link k the screws of joints 1..k, in joint frame k, rates counted positive along +z.
        none: list[Screw[S]] = []
        screws = list(accumulate(chain.joints, lambda inner, joint: next_screws(chain, joint, inner), initial=none))
        self._joint_views = [_LinkView(m, s) for m, s in zip(motions[1:], screws[1:], strict=True)]
        self._views = self._joint_views
        if ends:
            self._views = [view.seen_from(end) for view, end in zip(self._joint_views, chain.ends, strict=True)]

    def rows(self, parameters: Sequence[Parameter]) -> list[list[S]]:
        """Y(q, qd, qdd) with tau = Y pi."""
        columns = [self.column(parameter) for parameter in parameters]
        return [[column[i] for column in columns] for i in range(self.chain.n)]

    def column(self, parameter: Parameter) -> list[S]:
        """Torques per unit of one parameter."""
        i, part = parameter.joint - 1, parameter.part
        if parameter.of_link:
            view = self._views[i]
            found = [view.power(part, screw) for screw in view.screws]
        elif part in ("mm", "Im"):
            found = self._of_rotor(i, part)
        else:
            if part[0] == "f":
                assert self._sign is not None, "Coulomb friction needs a sign"
                own = coulomb_column(part, self._sign(self._qd[i]))
            else:
                # Armature and friction act on their own joint alone.
                own = {"Ia": self._qdd, "b": self._qd}[part][i]
            return [own if k == i else self.chain.zero for k in range(self.chain.n)]
        joints = self.chain.joints[: len(found)]
        # From rates about +z to the sense of the joint variables; joints beyond the link do no work on it.
        signed = [value if joint.sign > 0 else -value for joint, value in zip(joints, found, strict=True)]
        return signed + [self.chain.zero] * (self.chain.n - len(found))

    def _of_rotor(self, i: int, part: str) -> list[S]:
        """Per unit of a rotor's mass or inertia, counted positive along +z.

        Its inertia makes the rate of its momentum (omega.u + k rate) u on link i-1, and k times that about u on its
        own joint.
        """
        joint, acceleration, rate = self.chain.joints[i], self._accelerations[i], self._rates[i]
        # The first rotor stands on the ground: its mass never moves.
        if i == 0:
            return [] if part == "mm" else [joint.armature * acceleration]
        u, carrier = axis(joint), self._joint_views[i - 1]
        if part == "mm":
            # Its mass: acceleration of its place against the velocity of its place.
            place = rotor_place(self.chain, i + 1)
            felt = add(carrier.motion.acceleration, multiply(carrier.motion.tensor, place))
            return [dot(screw.at(place), felt) for screw in carrier.screws]
        omega, alpha = carrier.motion.omega, carrier.motion.alpha
        # Its inertia: the spin k rate + u . omega, whose axis u turns with link i-1.
        spin_rate = dot(u, alpha) + joint.coupling * acceleration
        spin = dot(u, omega) + joint.coupling * rate
        moment = add(scale(spin_rate, u), scale(spin, cross(omega, u)))
        return [*(dot(screw.angular, moment) for screw in carrier.screws), joint.coupling * spin_rate]
