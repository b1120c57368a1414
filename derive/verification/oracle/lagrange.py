"""B, C and g of an arm of numbers by the textbook: Jacobians, Christoffel symbols, gradient of U.

Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control, section 7.1. All functions take
configurations ``(..., n)``.
"""

import numpy as np

from derive.verification.oracle import frames as kinematics
from derive.verification.oracle.frames import Array, NumericArm, chain_frames

STEP = 1e-30  # complex step: no difference is taken, so it may be so small that the truncation error vanishes
CHUNK = 500_000  # Jacobian entries in memory at once while B is differentiated


def inertia_matrix(arm: NumericArm, q: Array) -> Array:
    """B = sum m Jv'Jv + Jw' R I R' Jw over bodies, and rotors with inertia about their axes alone, and armatures."""
    frames = chain_frames(arm, q)
    axis, _ = kinematics.joint_axes(arm, frames)
    linear, angular = link_jacobians(arm, frames)
    # Angular Jacobian in the axes of each body's link, where its tensor is constant: R^T Jw.
    in_link = _transpose(frames[..., arm.carrier + 1, :3, :3]) @ angular
    moving = _transpose(linear) @ (arm.mass[:, None, None] * linear)
    links = (moving + _transpose(in_link) @ (arm.inertia @ in_link)).sum(axis=-3)
    linear, angular = rotor_jacobians(arm, frames)
    # Of a rotor's angular velocity only the part about its own axis has inertia.
    spin = np.einsum("...ka,...kaj->...kj", axis, angular)
    moving = _transpose(linear) @ (arm.rotor_mass[:, None, None] * linear)
    rotors = moving.sum(axis=-3) + np.einsum("k,...ki,...kj->...ij", arm.rotor_inertia, spin, spin)
    return np.asarray(links + rotors + np.diag(arm.armature))


def coriolis_matrix(arm: NumericArm, q: Array, qd: Array) -> Array:
    """C with C_ij = sum_k c_ijk qd_k."""
    return np.asarray(np.einsum("...ijk,...k->...ij", christoffel_symbols(arm, q), qd))


def christoffel_symbols(arm: NumericArm, q: Array) -> Array:
    """c_ijk = 1/2 (dB_ij/dq_k + dB_ik/dq_j - dB_jk/dq_i)."""
    slope = inertia_derivatives(arm, q)
    # slope[k, i, j] is dB_ij/dq_k; by_k[i, j, k] and by_j[i, j, k] = dB_ik/dq_j reorder it.
    by_k = np.moveaxis(slope, -3, -1)
    return 0.5 * (by_k + np.swapaxes(by_k, -1, -2) - slope)


def inertia_derivatives(arm: NumericArm, q: Array) -> Array:
    """dB/dq_k by complex step."""
    # f(q + i h e_k) = f(q) + i h df/dq_k: the imaginary part over h, in chunks of directions (Martins et al. 2003).
    size = max(1, CHUNK // (3 * q.size * arm.n))
    steps = 1j * STEP * np.eye(arm.n)
    chunks = [steps[k : k + size] for k in range(0, arm.n, size)]
    return np.concatenate([inertia_matrix(arm, q[..., None, :] + chunk).imag / STEP for chunk in chunks], axis=-3)


def gravity_vector(arm: NumericArm, q: Array) -> Array:
    """The gradient dU/dq with U = -sum m g0' p over bodies and rotors, (..., n) [N m, N]."""
    frames = chain_frames(arm, q)
    links, _ = link_jacobians(arm, frames)
    rotors, _ = rotor_jacobians(arm, frames)
    # dU/dq_j = -sum m g0 . dp/dq_j, in frame 0 as the Jacobians are
    g0 = arm.gravity_in_frame_0
    down_links = np.einsum("k,...kaj,a->...j", arm.mass, links, g0)
    return np.asarray(-down_links - np.einsum("k,...kaj,a->...j", arm.rotor_mass, rotors, g0))


def potential_energy(arm: NumericArm, q: Array) -> Array:
    """U = -sum m g0' p over bodies and rotors, with p in the world."""
    frames = chain_frames(arm, q)
    # Places in the world, since U is zero at its origin
    turn, origin = arm.base[:3, :3], arm.base[:3, 3]
    links = _mass_centres(arm, frames) @ turn.T + origin
    rotors = kinematics.rotor_places(arm, frames) @ turn.T + origin
    return np.asarray(-(links @ arm.gravity) @ arm.mass - (rotors @ arm.gravity) @ arm.rotor_mass)


def kinetic_energy(arm: NumericArm, q: Array, qd: Array) -> Array:
    """T = 1/2 qd' B qd."""
    return np.asarray(0.5 * np.einsum("...i,...ij,...j->...", qd, inertia_matrix(arm, q), qd))


def link_jacobians(arm: NumericArm, frames: Array) -> tuple[Array, Array]:
    """Linear and angular Jacobians of the bodies' centres of mass, as the frames are seen, (..., k, 3, n) both."""
    moves = arm.moves[arm.carrier]
    linear = kinematics.point_jacobian(arm, frames, _mass_centres(arm, frames), moves)
    return linear, kinematics.angular_jacobian(arm, frames, moves)


def rotor_jacobians(arm: NumericArm, frames: Array) -> tuple[Array, Array]:
    """Those of the rotors, (..., n, 3, n): each moves with the link before and spins about z by ratio * qd_i more."""
    moves = arm.moves[arm.parent]
    linear = kinematics.point_jacobian(arm, frames, kinematics.rotor_places(arm, frames), moves)
    axis, _ = kinematics.joint_axes(arm, frames)
    # ratio z qd_i on top of the rotation of the link that carries it
    spin = axis[..., :, :, None] * (np.eye(arm.n) * arm.ratio[:, None])[:, None, :]
    return linear, kinematics.angular_jacobian(arm, frames, moves) + spin


def _mass_centres(arm: NumericArm, frames: Array) -> Array:
    """(..., k, 3) in frame 0."""
    links = frames[..., arm.carrier + 1, :, :]
    return np.asarray(links[..., :3, 3] + np.einsum("...kab,kb->...ka", links[..., :3, :3], arm.com))


def _transpose(matrix: Array) -> Array:
    return np.swapaxes(matrix, -1, -2)
