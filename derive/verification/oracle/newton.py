"""Inverse dynamics of an arm of numbers by Newton's and Euler's laws, written in frame 0.

Motion goes outwards link by link; forces and their moments about the origin of frame 0 are summed inwards. Rotor i is a
body on the link that joint i follows with mass, with inertia about its own axis only, and with a spin of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.verification.oracle.frames import Array, NumericArm, chain_frames, cross, joint_axes, rotor_places


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """A link's motion in frame 0, (..., 3) each."""

    omega: Array  # angular velocity
    alpha: Array  # angular acceleration
    point: Array  # a point of the link
    acceleration: Array  # of this point

    def acceleration_at(self, place: Array) -> Array:
        """Acceleration a + alpha x r + omega x (omega x r) of a place on the link, both (..., 3) in frame 0."""
        r = place - self.point
        return self.acceleration + cross(self.alpha, r) + cross(self.omega, cross(self.omega, r))


@dataclass(frozen=True, slots=True, eq=False)
class Wrench:
    """A force and its moment about the origin of frame 0."""

    force: Array
    moment: Array

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(self.force + other.force, self.moment + other.moment)


def inverse_dynamics(arm: NumericArm, q: Array, qd: Array, qdd: Array) -> Array:
    """Joint torques tau = B qdd + C qd + g + armature qdd + viscous qd + Coulomb friction, (..., n) [N m, N]."""
    frames = chain_frames(arm, q)
    axis, on_axis = axes = joint_axes(arm, frames)
    places = rotor_places(arm, frames)
    motions = link_motions(arm, frames, axes, qd, qdd)
    zero = np.zeros_like(q[..., :1] + axis[..., 0, :])
    # What each link carries: its own bodies, and everything beyond it once that is known; the last is that of the base.
    carried = [Wrench(zero, zero)] * (arm.n + 1)
    for k, i in enumerate(arm.carrier):
        carried[i] = carried[i] + _body_wrench(arm, k, frames[..., i + 1, :, :], motions[i + 1])
    torques: list[Array] = []
    for i in reversed(range(arm.n)):
        z, wrench, parent = axis[..., i, :], carried[i], arm.parent[i]
        carrier = motions[parent + 1]
        # The rotor's acceleration about its axis: its own, and that of the link on which it sits.
        spin_rate = arm.ratio[i] * qdd[..., i] + dot(z, carrier.alpha)
        # From the origin of frame 0 to a point of the axis: n - r x f.
        moment = wrench.moment - cross(on_axis[..., i, :], wrench.force)
        held = dot(z, moment) if arm.revolute[i] else dot(z, wrench.force)  # by the joint's actuator
        # In the sense of q; the motor turns ratio times as fast, so its torque counts ratio times.
        torques.append(arm.sign[i] * held + arm.ratio[i] * arm.rotor_inertia[i] * spin_rate)
        # The rotor itself is carried by the link before, so it counts from here inward: m (a - g0) at its place.
        place = places[..., i, :]
        force = arm.rotor_mass[i] * (carrier.acceleration_at(place) - arm.gravity_in_frame_0)
        # d/dt (I spin z) = I (spin' z + spin omega x z), z turning with that link
        spin = arm.ratio[i] * qd[..., i] + dot(z, carrier.omega)
        turning = spin_rate[..., None] * z + spin[..., None] * cross(carrier.omega, z)
        wrench = wrench + Wrench(force, cross(place, force) + arm.rotor_inertia[i] * turning)
        carried[parent] = carried[parent] + wrench
    rigid = np.stack(torques[::-1], axis=-1)
    ahead, back = arm.coulomb
    dry = np.where(qd.real > 0, ahead, 0.0) - np.where(qd.real < 0, back, 0.0)
    resisting: Array = arm.armature * qdd + arm.viscous * qd + dry
    return rigid + resisting


def dot(u: Array, v: Array) -> Array:
    """Scalar product over the last axis."""
    return np.asarray((u * v).sum(axis=-1))


def link_motions(arm: NumericArm, frames: Array, axes: tuple[Array, Array], qd: Array, qdd: Array) -> list[Motion]:
    """Motions of links 0 to n, by the joints' axes; link 0 is at rest."""
    axis, on_axis = axes
    zero = np.zeros_like(axis[..., 0, :])
    motions = [Motion(zero, zero, zero, zero)]
    for i in range(arm.n):
        u = arm.sign[i] * axis[..., i, :]
        rate, acceleration = qd[..., i, None], qdd[..., i, None]
        before, origin = motions[arm.parent[i] + 1], frames[..., i + 1, :3, 3]
        if arm.revolute[i]:  # the links share the points of the axis
            # omega_i = omega_{i-1} + u qd; alpha gains u qdd + omega_{i-1} x u qd
            omega = before.omega + u * rate
            alpha = before.alpha + u * acceleration + cross(before.omega, u) * rate
            # Over a point of the axis, which belongs to both links, to the origin of frame i.
            shared = on_axis[..., i, :]
            hinge = Motion(omega, alpha, shared, before.acceleration_at(shared))
            motions.append(Motion(omega, alpha, origin, hinge.acceleration_at(origin)))
        else:  # carried along, plus Coriolis and relative acceleration
            # a_i = a of the coinciding point + 2 omega x u qd + u qdd
            relative = 2.0 * cross(before.omega, u) * rate + u * acceleration
            motions.append(Motion(before.omega, before.alpha, origin, before.acceleration_at(origin) + relative))
    return motions


def _body_wrench(arm: NumericArm, k: int, frame: Array, motion: Motion) -> Wrench:
    """What moves body k: m (a - g0) at its centre of mass and d/dt (I omega)."""
    rotation, com = frame[..., :3, :3], frame[..., :3, 3] + frame[..., :3, :3] @ arm.com[k]
    # R I R^T in frame 0; d/dt (I omega) = I alpha + omega x I omega
    inertia = rotation @ arm.inertia[k] @ np.swapaxes(rotation, -1, -2)
    force = arm.mass[k] * (motion.acceleration_at(com) - arm.gravity_in_frame_0)
    momentum = np.einsum("...ab,...b->...a", inertia, motion.omega)
    moment = np.einsum("...ab,...b->...a", inertia, motion.alpha) + cross(motion.omega, momentum)
    return Wrench(force, cross(com, force) + moment)
