"""The regressor of an arm of numbers, column by column from Newton's and Euler's laws, and the base parameters.

A body's wrench is linear in its mass, its first moment and its inertia about a frame's origin; a column is the work of
the wrench of one unit of them on the Jacobian of that origin. Base parameters are what a least-squares fit of the base
columns to the torques finds: no formula of theirs is used.
"""

from dataclasses import dataclass, replace

import numpy as np

from derive.robot.inertial_parameters import Parameter
from derive.verification.oracle import frames as kinematics
from derive.verification.oracle.frames import Array, NumericArm, cross
from derive.verification.oracle.newton import inverse_dynamics, link_motions

_AXES = {"x": 0, "y": 1, "z": 2}

SEED = 20  # of the states at which base parameters are fitted


@dataclass(frozen=True, slots=True, eq=False)
class Identification:
    """An arm and the names of its parameters."""

    arm: NumericArm  # the numbers
    standard: tuple[Parameter, ...]  # parameters of the standard regressor, links' ones in DH frames
    # Base parameters, links' ones in joint frames: on the axis of joint i, DH frame i in the modified convention, DH
    # frame i before its a and alpha in the standard one.
    base: tuple[Parameter, ...]


def regressor(known: Identification, q: Array, qd: Array, qdd: Array) -> Array:
    """Y with tau = Y pi."""
    return _Columns(known.arm, q, qd, qdd, on_axes=False).of(known.standard)


def base_regressor(known: Identification, q: Array, qd: Array, qdd: Array) -> Array:
    """Y with tau = Y beta."""
    return _Columns(known.arm, q, qd, qdd, on_axes=True).of(known.base)


def base_parameters(known: Identification) -> Array:
    """The base parameters by least squares over random states."""
    q, qd, qdd = fitting_states(known)
    torques = inverse_dynamics(known.arm, q, qd, qdd)
    # Rows over the size of their torque, columns over their own: the fit is not ruled by units.
    largest = np.abs(torques).max(axis=0)
    weight = 1.0 / np.where(largest > 0, largest, 1.0)
    matrix = (base_regressor(known, q, qd, qdd) * weight[:, None]).reshape(-1, len(known.base))
    size = np.maximum(np.abs(matrix).max(axis=0), 1e-300)
    return np.asarray(np.linalg.lstsq(matrix / size, (torques * weight).ravel(), rcond=None)[0] / size)


def fitting_states(known: Identification) -> tuple[Array, Array, Array]:
    """Random q, qd and qdd, enough of them to tell all parameters apart."""
    n = known.arm.n
    # At least three times as many equations as unknowns.
    count = 3 * (len(known.base) // n + 1) + len(known.base)
    states = np.random.default_rng(SEED).uniform(-2.0, 2.0, (3, count, n))
    if any(parameter.part == "fp" for parameter in known.base):
        states[1, ::2] = 0.0  # only rest tells a constant weight from friction by direction
    return states[0], states[1], states[2]


class _Columns:
    """Columns of a regressor; links' parameters are in frames on the axes of their joints, or in DH frames."""

    def __init__(self, arm: NumericArm, q: Array, qd: Array, qdd: Array, *, on_axes: bool) -> None:
        frames = kinematics.chain_frames(arm, q)
        seen = frames[..., 1:, :, :]
        if on_axes and arm.standard:  # from DH frame i back over Trans(x, a_i) Rot(x, alpha_i)
            c, s, one, zero = np.cos(arm.alpha), np.sin(arm.alpha), np.ones(arm.n), np.zeros(arm.n)
            rows = [[one, zero, zero, -arm.a], [zero, c, s, zero], [zero, -s, c, zero], [zero, zero, zero, one]]
            seen = seen @ np.moveaxis(np.array(rows), -1, 0)
        links = arm.moves[:-1]
        self.arm, self.arguments = arm, (q, qd, qdd)
        self.motions = link_motions(arm, frames, kinematics.joint_axes(arm, frames), qd, qdd)
        self.places = kinematics.rotor_places(arm, frames)
        # Jacobians of the frames' origins, along whose rows the unit wrenches work.
        self.rotations, self.origins = seen[..., :3, :3], seen[..., :3, 3]
        self.linear = kinematics.point_jacobian(arm, frames, self.origins, links)
        self.angular = kinematics.angular_jacobian(arm, frames, links)
        self.rotor_linear = kinematics.point_jacobian(arm, frames, self.places, arm.moves[arm.parent])

    def of(self, parameters: tuple[Parameter, ...]) -> Array:
        return np.stack([self._column(parameter) for parameter in parameters], axis=-1)

    def _column(self, parameter: Parameter) -> Array:
        """Torques per unit of one parameter, (..., n)."""
        i = parameter.joint - 1
        if parameter.of_link:
            force, moment = self._body_wrench(i, parameter.part)
            return _work(self.linear[..., i, :, :], force) + _work(self.angular[..., i, :, :], moment)
        # tau = Jv^T (a - g0) at the rotor's place, for unit mass
        if parameter.part == "mm":
            carrier = self.motions[self.arm.parent[i] + 1]
            lifted = carrier.acceleration_at(self.places[..., i, :]) - self.arm.gravity_in_frame_0
            return _work(self.rotor_linear[..., i, :, :], lifted)
        if parameter.part == "Im":  # the whole arm with nothing on it but one rotor of unit inertia and no mass
            zero = np.zeros(self.arm.n)
            tensors, rotor = np.zeros_like(self.arm.inertia), (np.arange(self.arm.n) == i) * 1.0
            alone = replace(self.arm, mass=0.0 * self.arm.mass, inertia=tensors, rotor_mass=zero, rotor_inertia=rotor)
            alone = replace(alone, armature=zero, viscous=zero, coulomb=np.zeros((2, self.arm.n)))
            return inverse_dynamics(alone, *self.arguments)
        _, qd, qdd = self.arguments
        ways = {"f": np.sign(qd), "fp": 1.0 * (qd > 0), "fm": -1.0 * (qd < 0)}
        return np.asarray(({"Ia": qdd, "b": qd} | ways)[parameter.part] * (np.arange(self.arm.n) == i))

    def _body_wrench(self, i: int, part: str) -> tuple[Array, Array]:
        """Force, and moment about the frame's origin, that move a unit parameter of link i."""
        motion, turn, origin = self.motions[i + 1], self.rotations[..., i, :, :], self.origins[..., i, :]
        lifted = motion.acceleration_at(origin) - self.arm.gravity_in_frame_0
        # A unit mass at the origin: force a - g0.
        if part == "m":
            return lifted, np.zeros_like(lifted)
        if part[0] == "m":
            # A unit first moment along an axis e: force alpha x e + omega x (omega x e), moment e x (a - g0).
            lever = turn[..., :, _AXES[part[1]]]
            return cross(motion.alpha, lever) + cross(motion.omega, cross(motion.omega, lever)), cross(lever, lifted)
        # A unit entry of the tensor E, symmetric: moment E alpha + omega x E omega in frame 0.
        tensor = np.zeros((3, 3))
        j, k = _AXES[part[1]], _AXES[part[2]]
        tensor[j, k] = tensor[k, j] = 1.0
        inertia = turn @ tensor @ np.swapaxes(turn, -1, -2)
        momentum = np.einsum("...ab,...b->...a", inertia, motion.omega)
        moment = np.einsum("...ab,...b->...a", inertia, motion.alpha) + cross(motion.omega, momentum)
        return np.zeros_like(lifted), moment


def _work(jacobian: Array, vector: Array) -> Array:
    """J^T v, (..., n)."""
    return np.asarray(np.einsum("...aj,...a->...j", jacobian, vector))
