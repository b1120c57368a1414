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

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Generic

from derive.mechanics.chain import Chain
from derive.mechanics.joint_motion import along_axes, axis, origin, to_child
from derive.mechanics.newton_euler import LinkMotion, angular_acceleration_tensor, link_motions
from derive.mechanics.vectors import Frame, S, Vector, add, cross, dot, multiply, scale, transpose
from derive.robot import tree
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


Screws = Mapping[int, Screw[S]]  # of the joints that move a link, by their index from 0


def next_screws(chain: Chain[S], i: int, before: Screws[S]) -> Screws[S]:
    """The screws of link i from those of the link that it follows."""
    # Joints further in: the same motion, its velocity that of the new origin. The joint itself moves about or along z.
    joint, along = chain.joints[i], (chain.zero, chain.zero, chain.one)
    outward = {k: Screw(to_child(joint, s.angular), to_child(joint, s.at(origin(joint)))) for k, s in before.items()}
    return {**outward, i: Screw(along, chain.null) if joint.revolute else Screw(chain.null, along)}


def with_unit_rotors(robot: Robot) -> Robot:
    """The robot with nothing but unit rotors, mass and inertia: ``coupling`` is sign * ratio, ``armature`` ratio^2."""
    motors = (link.motor and Motor(ONE, ONE, link.motor.ratio) for link in robot.links)
    return replace(robot, links=tuple(Link(motor=motor) for motor in motors), fixed=tree.massless(robot.fixed))


def coulomb_column(part: str, sign: Any) -> Any:
    """Coulomb friction per unit of a parameter by sign(qd): 1 and 0 for `fp`, 0 and -1 for `fm` where a joint moves."""
    ahead = (sign + sign * sign) * Fraction(1, 2)
    return {"f": sign, "fp": ahead, "fm": sign - ahead}[part]


@dataclass(frozen=True, slots=True)
class _LinkView(Generic[S]):
    """A link seen from a frame on it."""

    motion: LinkMotion[S]  # of the link, in the frame
    screws: Screws[S]  # of the joints that move it, in the frame

    def seen_from(self, frame: Frame[S]) -> _LinkView[S]:
        """The same link seen from another frame on it; U is computed anew, for turning it would cost more."""
        turned = transpose(frame.rotation)
        before = self.motion
        # a + U p is the acceleration of the new origin.
        acceleration = multiply(turned, add(before.acceleration, multiply(before.tensor, frame.position)))
        omega, alpha = multiply(turned, before.omega), multiply(turned, before.alpha)
        motion = LinkMotion(omega, alpha, angular_acceleration_tensor(omega, alpha)[0], acceleration)
        return _LinkView(motion, {k: screw.seen_from(frame) for k, screw in self.screws.items()})

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
            case _:  # Iyz
                moment = (y * y - z * z, -u[0][1], u[0][2])
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
        # Of every link the screws of the joints that move it, in its joint frame, rates counted positive along +z.
        screws: list[Screws[S]] = [{}]
        for i, joint in enumerate(chain.joints):
            screws.append(next_screws(chain, i, screws[joint.parent + 1]))
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
            found = {k: view.power(part, screw) for k, screw in view.screws.items()}
        elif part in ("mm", "Im"):
            found = dict(self._of_rotor(i, part))
        else:
            if part[0] == "f":
                assert self._sign is not None, "Coulomb friction needs a sign"
                own = coulomb_column(part, self._sign(self._qd[i]))
            else:
                # Armature and friction act on their own joint alone.
                own = {"Ia": self._qdd, "b": self._qd}[part][i]
            return [own if k == i else self.chain.zero for k in range(self.chain.n)]
        # From rates about +z to the sense of the joint variables; joints that do not move the link do no work on it.
        joints, zero = enumerate(self.chain.joints), self.chain.zero
        return [found.get(k, zero) if joint.sign > 0 else -found.get(k, zero) for k, joint in joints]

    def _of_rotor(self, i: int, part: str) -> Mapping[int, S]:
        """Per unit of a rotor's mass or inertia, counted positive along +z.

        Its inertia makes the rate of its momentum (omega.u + k rate) u on link i-1, and k times that about u on its
        own joint.
        """
        joint, acceleration, rate = self.chain.joints[i], self._accelerations[i], self._rates[i]
        # A rotor that stands on the ground: its mass never moves.
        if joint.parent < 0:
            return {} if part == "mm" else {i: joint.armature * acceleration}
        u, carrier = axis(joint), self._joint_views[joint.parent]
        if part == "mm":
            # Its mass: acceleration of its place against the velocity of its place.
            felt = add(carrier.motion.acceleration, multiply(carrier.motion.tensor, joint.rotor))
            return {k: dot(screw.at(joint.rotor), felt) for k, screw in carrier.screws.items()}
        omega, alpha = carrier.motion.omega, carrier.motion.alpha
        # Its inertia: the spin k rate + u . omega, whose axis u turns with link i-1.
        spin_rate = dot(u, alpha) + joint.coupling * acceleration
        spin = dot(u, omega) + joint.coupling * rate
        moment = add(scale(spin_rate, u), scale(spin, cross(omega, u)))
        return {k: dot(screw.angular, moment) for k, screw in carrier.screws.items()} | {i: joint.coupling * spin_rate}
