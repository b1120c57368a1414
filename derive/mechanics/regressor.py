"""The regressor: torques per unit of every parameter, tau = Y(q, qd, qdd) pi.

One outward pass gives the motion of every link and the screws of all joints in its frame. The wrench of a unit
parameter has few entries there, and its work on the screw of joint a is the entry (a, parameter): with acceleration a
(less gravity), U = alpha^ + omega^ omega^ and the screw (w, v)

    mass: v.a,    first moment: U^T v + a x w,    tensor: w.(E alpha + omega x E omega) for the unit tensors E.

So no wrench has to be carried inward (compare Gautier and Khalil 1988; Siciliano et al., Robotics, section 7.2.2).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic

from derive.mechanics.chain import Chain
from derive.mechanics.joint_motion import axis, rates
from derive.mechanics.link_motion import LinkMotion, link_motions
from derive.mechanics.screws import Screw, link_screws, rotor_place
from derive.mechanics.vectors import Frame, Matrix, S, Vector, add, cross, dot, multiply, scale, transpose
from derive.robot.inertial_parameters import Parameter

_AXES = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True, slots=True)
class Station(Generic[S]):
    """A frame on a link.

    Attributes:
        motion: Of the link, seen from the frame.
        screws: Of joints 1..k in the frame.
    """

    motion: LinkMotion[S]
    screws: Sequence[Screw[S]]


class Regressor(Generic[S]):
    """Columns of the regressor of one arm in one state.

    Args:
        chain: The chain of the robot with unit rotors, see `derive.mechanics.screws.with_unit_rotors`.
        velocities: qd, n entries.
        accelerations: qdd, n entries.
        ends: Whether the links' parameters are those in the DH frames of the file; else in joint frames.
        sign: The sign of a velocity; left out where no Coulomb friction is asked for.
    """

    def __init__(
        self,
        chain: Chain[S],
        velocities: Sequence[S],
        accelerations: Sequence[S],
        *,
        ends: bool,
        sign: Callable[[S], S] | None = None,
    ) -> None:
        self.chain = chain
        self._qd, self._qdd = velocities, accelerations
        self._sign = sign
        self._speed, self._gain = rates(chain, velocities), rates(chain, accelerations)
        motions = link_motions(chain, self._speed, self._gain)
        screws = link_screws(chain)
        self._stations = [Station(m, s) for m, s in zip(motions[1:], screws, strict=True)]
        self._frames = [_moved(s, f) for s, f in zip(self._stations, chain.ends, strict=True)] if ends else []

    def rows(self, parameters: Sequence[Parameter]) -> list[list[S]]:
        """Y, n rows, a column for each parameter."""
        columns = [self.column(parameter) for parameter in parameters]
        return [[column[i] for column in columns] for i in range(self.chain.n)]

    def column(self, parameter: Parameter) -> list[S]:
        """Torques per unit of a parameter, n entries."""
        found = self._along_z(parameter)
        joints = self.chain.joints[: len(found)]
        signed = [value if joint.sign > 0 else -value for joint, value in zip(joints, found, strict=True)]
        return signed + [self.chain.zero] * (self.chain.n - len(found))

    def _along_z(self, parameter: Parameter) -> list[S]:
        """The torques of the joints that feel it, counted positive along +z."""
        i, part = parameter.joint - 1, parameter.part
        if parameter.of_link:
            station = (self._frames or self._stations)[i]
            return [_work(part, station.motion, screw) for screw in station.screws]
        if part == "mm":
            return self._rotor_mass(i)
        if part == "Im":
            return self._rotor_inertia(i)
        own = {"Ia": self._qdd[i], "b": self._qd[i]}.get(part)
        if own is None:
            assert self._sign is not None, "Coulomb friction needs a sign"
            own = self._sign(self._qd[i])
        before = [self.chain.zero] * i
        return [*before, own if self.chain.joints[i].sign > 0 else -own]

    def _rotor_mass(self, i: int) -> list[S]:
        if i == 0:
            return []
        carrier, place = self._stations[i - 1], rotor_place(self.chain, i + 1)
        acceleration = add(carrier.motion.acceleration, multiply(carrier.motion.spread, place))
        return [dot(screw.at(place), acceleration) for screw in carrier.screws]

    def _rotor_inertia(self, i: int) -> list[S]:
        """The change of its momentum (omega.u + k rate) u on link i-1, and k times that about u on its own joint."""
        joint, gain, rate = self.chain.joints[i], self._gain[i], self._speed[i]
        if i == 0:
            return [joint.reflected * gain]
        u, carrier = axis(joint), self._stations[i - 1]
        omega, alpha = carrier.motion.omega, carrier.motion.alpha
        growth = dot(u, alpha) + joint.coupling * gain
        spin = dot(u, omega) + joint.coupling * rate
        moment = add(scale(growth, u), scale(spin, cross(omega, u)))
        return [*(dot(screw.angular, moment) for screw in carrier.screws), joint.coupling * growth]


def _moved(station: Station[S], frame: Frame[S]) -> Station[S]:
    """The same link seen from another frame on it."""
    turned = transpose(frame.rotation)
    before = station.motion
    acceleration = multiply(turned, add(before.acceleration, multiply(before.spread, frame.position)))
    omega, alpha = multiply(turned, before.omega), multiply(turned, before.alpha)
    motion = LinkMotion(omega, alpha, _spread(omega, alpha), acceleration)
    return Station(motion, [screw.seen_from(frame) for screw in station.screws])


def _spread(omega: Vector[S], alpha: Vector[S]) -> Matrix[S]:
    """U = alpha^ + omega^ omega^, computed anew: turning it would cost more."""
    (x, y, z), (ax, ay, az) = omega, alpha
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
    return (
        (-(yy + zz), xy - az, xz + ay),
        (xy + az, -(xx + zz), yz - ax),
        (xz - ay, yz + ax, -(xx + yy)),
    )


def _work(part: str, motion: LinkMotion[S], screw: Screw[S]) -> S:
    """What the wrench of a unit parameter does on a unit rate."""
    if part == "m":
        return dot(screw.linear, motion.acceleration)
    if part[0] == "m":
        k = _AXES[part[1]]
        u = motion.spread
        turning = cross(motion.acceleration, screw.angular)[k]
        return dot((u[0][k], u[1][k], u[2][k]), screw.linear) + turning
    return dot(screw.angular, _moment(part, motion))


def _moment(part: str, motion: LinkMotion[S]) -> Vector[S]:
    """E alpha + omega x (E omega) of a unit tensor."""
    u, (x, y, z), (ax, ay, az) = motion.spread, motion.omega, motion.alpha
    match part:
        case "Ixx":
            return (ax, x * z, -(x * y))
        case "Iyy":
            return (-(y * z), ay, x * y)
        case "Izz":
            return (y * z, -(x * z), az)
        case "Ixy":
            return (-u[2][0], u[2][1], x * x - y * y)
        case "Ixz":
            return (u[1][0], z * z - x * x, -u[1][2])
        case "Iyz":
            return (y * y - z * z, -u[0][1], u[0][2])
    raise KeyError(part)
