"""The regressor of an arm of numbers, column by column from Newton's and Euler's laws, and the base parameters.

A body's wrench is linear in its mass, its first moment and its inertia about a frame's origin; a column is the work of
the wrench of one unit of them on the Jacobian of that origin. Base parameters are what a least-squares fit of the base
columns to the torques finds: no formula of theirs is used.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from derive.robot.inertial_parameters import Parameter
from derive.verification.oracle.frames import (
    Array,
    NumericArm,
    angular_jacobian,
    chain_frames,
    cross,
    joint_axes,
    point_jacobian,
    rotor_places,
)
from derive.verification.oracle.newton import Motion, inverse_dynamics, link_motions

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
    return _columns(known.arm, known.standard, q, qd, qdd, on_axes=False)


def base_regressor(known: Identification, q: Array, qd: Array, qdd: Array) -> Array:
    """Y with tau = Y beta."""
    return _columns(known.arm, known.base, q, qd, qdd, on_axes=True)


def base_parameters(known: Identification) -> Array:
    """The base parameters by least squares over random states."""
    q, qd, qdd = fitting_states(known)
    torques = inverse_dynamics(known.arm, q, qd, qdd)
    # Rows over the size of their torque, columns over their own: the fit is not ruled by units.
    largest = np.abs(torques).max(axis=0)
    weight = 1.0 / np.where(largest > 0, largest, 1.0)
    matrix = (base_regressor(known, q, qd, qdd) * weight[:, None]).reshape(-1, len(known.base))
    size = np.maximum(np.abs(matrix).max(axis=0), 1e-300)
    values: Array = np.linalg.lstsq(matrix / size, (torques * weight).ravel(), rcond=None)[0] / size
    return values


def fitting_states(known: Identification) -> tuple[Array, Array, Array]:
    """Random q, qd and qdd, enough of them to tell all parameters apart."""
    n = known.arm.n
    # At least three times as many equations as unknowns.
    count = 3 * (len(known.base) // n + 1) + len(known.base)
    states = np.random.default_rng(SEED).uniform(-2.0, 2.0, (3, count, n))
    return states[0], states[1], states[2]


def _columns(
    arm: NumericArm, parameters: tuple[Parameter, ...], q: Array, qd: Array, qdd: Array, *, on_axes: bool
) -> Array:
    """A column for each parameter, links' ones in frames on the axes of their joints or in DH frames."""
    frames = chain_frames(arm, q)
    seen = frames[..., 1:, :, :]
    if on_axes and arm.standard:  # from DH frame i back over Trans(x, a_i) Rot(x, alpha_i)
        c, s, one, zero = np.cos(arm.alpha), np.sin(arm.alpha), np.ones(arm.n), np.zeros(arm.n)
        rows = [[one, zero, zero, -arm.a], [zero, c, s, zero], [zero, -s, c, zero], [zero, zero, zero, one]]
        seen = seen @ np.moveaxis(np.array(rows), -1, 0)
    axis, _ = joint_axes(arm, frames)
    # Jacobians of the frames' origins, along whose rows the unit wrenches work.
    origins, places = seen[..., :3, 3], rotor_places(arm, frames)
    links = np.arange(1, arm.n + 1)
    state = _State(
        arm=arm,
        arguments=(q, qd, qdd),
        rotations=seen[..., :3, :3],
        origins=origins,
        motions=link_motions(arm, frames, axis, qd, qdd),
        linear=point_jacobian(arm, frames, origins, links),
        angular=angular_jacobian(arm, frames, links),
        places=places,
        rotor_linear=point_jacobian(arm, frames, places, links - 1),
    )
    return np.stack([_column(state, parameter) for parameter in parameters], axis=-1)


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """Frames of the parameters, the motion of their links and the rotors' places, all in frame 0."""

    arm: NumericArm
    arguments: tuple[Array, Array, Array]
    rotations: Array
    origins: Array
    motions: list[Motion]
    linear: Array
    angular: Array
    places: Array
    rotor_linear: Array


def _column(state: _State, parameter: Parameter) -> Array:
    """Torques per unit of one parameter, (..., n)."""
    i = parameter.joint - 1
    if parameter.of_link:
        force, moment = _body_wrench(state, i, parameter.part)
        return _work(state.linear[..., i, :, :], force) + _work(state.angular[..., i, :, :], moment)
    # tau = Jv^T (a - g0) at the rotor's place, for unit mass
    if parameter.part == "mm":
        lifted = state.motions[i].acceleration_at(state.places[..., i, :]) - state.arm.gravity_in_frame_0
        return _work(state.rotor_linear[..., i, :, :], lifted)
    if parameter.part == "Im":  # the whole arm with nothing on it but one rotor of unit inertia and no mass
        zero = np.zeros(state.arm.n)
        tensors, rotor = np.zeros_like(state.arm.inertia), (np.arange(state.arm.n) == i) * 1.0
        alone = replace(state.arm, mass=zero, inertia=tensors, rotor_mass=zero, rotor_inertia=rotor)
        alone = replace(alone, armature=zero, viscous=zero, coulomb=zero)
        return inverse_dynamics(alone, *state.arguments)
    _, qd, qdd = state.arguments
    own = {"Ia": qdd, "b": qd, "f": np.sign(qd)}[parameter.part]
    column: Array = own * (np.arange(state.arm.n) == i)
    return column


def _body_wrench(state: _State, i: int, part: str) -> tuple[Array, Array]:
    """Force, and moment about the frame's origin, that move a unit parameter of link i."""
    motion, turn, origin = state.motions[i + 1], state.rotations[..., i, :, :], state.origins[..., i, :]
    lifted = motion.acceleration_at(origin) - state.arm.gravity_in_frame_0
    # A unit mass at the origin: force a - g0.
    if part == "m":
        return lifted, np.zeros_like(lifted)
    if part[0] == "m":
        # A unit first moment along an axis e: force alpha x e + omega x (omega x e), moment e x (a - g0).
        lever = turn[..., :, _AXES[part[1]]]
        force = cross(motion.alpha, lever) + cross(motion.omega, cross(motion.omega, lever))
        return force, cross(lever, lifted)
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
    product: Array = np.einsum("...aj,...a->...j", jacobian, vector)
    return product
