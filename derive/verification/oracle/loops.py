"""How the joints of an arm of numbers follow its variables: by a constant matrix S, or around closed loops.

Where loops close, what the frames that they join share differs by none, phi(x) = 0. Newton's method leads there from a
guess, x_p <- x_p - Phi_p^+ phi, with Phi = dphi/dx and Phi_p its columns of the passive joints. Along the loops the
derivatives W = dx/dq keep Phi W = 0, and so Phi Wdot + Phidot W = 0, each solved by least squares for its passive rows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from derive.errors import VerificationError
from derive.robot.description import Joining
from derive.verification.oracle.frames import Array, NumericArm, angular_jacobian, chain_frames, cross, point_jacobian

STEP = 1e-30  # complex step
STEPS = 3  # of Newton's method, which needs two from where a guess has to be
CLOSED = 1e-13  # largest phi of a closed loop, lengths over that of the arm
NEAR = 1e-6  # from a guess to what it leads to, angles [rad], lengths over that of the arm
# Axes that the frames share; of others all.
SHARED = {Joining.REVOLUTE: (2,), Joining.SPHERICAL: (), Joining.DISTANCE: ()}
# Positions of the passive joints, (m, p), at variables (m, v); NaN where there are none.
Guess = Callable[[Array], Array]


@dataclass(frozen=True, slots=True, eq=False)
class Following:
    """The joints at configurations of the variables; NaN where loops cannot be closed in the branch of the file."""

    arm: NumericArm
    x: Array  # (..., n) positions of all joints
    slope: Array  # W, (..., n, v)

    @classmethod
    def of(cls, arm: NumericArm, q: Array, guess: Guess | None) -> Following:
        """At configurations (..., v), loops closed from a guess on."""
        assert arm.coupling is not None, "each joint has its own variable"
        x = q @ arm.coupling.T
        if guess is None:
            return cls(arm, x, arm.coupling)
        x[..., arm.passive] = guess(q.reshape(-1, q.shape[-1])).reshape(*q.shape[:-1], len(arm.passive))
        exists = np.isfinite(x).all(axis=-1)
        x[~exists] = np.nan
        found = x[exists]
        for _ in range(STEPS):
            gap, matrix = _closure(arm, found)
            found[:, arm.passive] += _passive(arm, matrix, gap[..., None])[..., 0]
        gap = np.abs(_closure(arm, found)[0]).max(axis=-1)
        moved = np.abs((found - x[exists]) / np.where(arm.revolute, 1.0, arm.length)).max(axis=-1)
        for k in np.flatnonzero(~(gap <= CLOSED) | ~(moved <= NEAR))[:1]:
            raise VerificationError(
                f"closed form of loops: {moved[k]:.3g} from where they are open by {gap[k]:.3g}, at q = {q[exists][k]}",
                allowed=f"allowed: {NEAR:g} and {CLOSED:g}",
            )
        x[exists] = found
        slope = np.broadcast_to(arm.coupling, (*q.shape[:-1], *arm.coupling.shape)).copy()
        matrix = _closure(arm, x)[1]
        slope[..., arm.passive, :] = _passive(arm, matrix, matrix @ slope)
        return cls(arm, x, slope)

    def rates(self, qd: Array) -> Array:
        """W qd, (..., n)."""
        return np.asarray((self.slope @ qd[..., None])[..., 0])

    def slope_dot(self, qd: Array) -> Array:
        """Wdot along loops, (..., n, v)."""
        slope, matrix = np.zeros_like(self.slope), _closure(self.arm, self.x + 1j * STEP * self.rates(qd))[1]
        slope[..., self.arm.passive, :] = _passive(self.arm, matrix.real, matrix.imag / STEP @ self.slope)
        return slope

    def arguments(self, names: Sequence[str], arrays: Sequence[Array]) -> tuple[Array, ...]:
        """Those of a function of the joints: x, W qd and W qdd + Wdot qd; a wrench as it is."""
        found = [array if name == "h" else self.rates(array) for name, array in zip(names, arrays, strict=True)]
        if "qdd" in names and self.arm.loops:
            found[2] = found[2] + (self.slope_dot(arrays[1]) @ arrays[1][..., None])[..., 0]
        return self.x, *found[1:]

    def clearance(self) -> Array:
        """Smallest singular value of Phi_p: 0 where it does not determine the passive joints, or no loop closes."""
        matrix = _closure(self.arm, self.x)[1] * np.where(self.arm.revolute, 1.0, self.arm.length)
        return np.asarray(np.linalg.svd(np.nan_to_num(matrix[..., self.arm.passive]), compute_uv=False)[..., -1])


def _passive(arm: NumericArm, matrix: Array, right: Array) -> Array:
    """-Phi_p^+ times a right side (..., rows, m), which is NaN where Phi is."""
    return np.asarray(-np.linalg.pinv(np.nan_to_num(matrix[..., arm.passive])) @ right)


def _closure(arm: NumericArm, x: Array) -> tuple[Array, Array]:
    """Values phi, (..., rows), and derivatives Phi, (..., rows, n)."""
    frames = chain_frames(arm, x)
    values, slopes = [], []
    for by, length, *places in arm.loops:
        one, other = (frames[..., joint + 1, None, :3, :] @ own for joint, own in places)
        turns = [np.swapaxes(angular_jacobian(arm, frames, arm.moves[[k]])[..., 0, :, :], -1, -2) for k, _ in places]
        points = [(at[..., 3], arm.moves[[k]]) for at, (k, _) in zip((one, other), places, strict=True)]
        moves = [np.swapaxes(point_jacobian(arm, frames, *point)[..., 0, :, :], -1, -2) for point in points]
        gap, rate = (one - other)[..., 3], moves[0] - moves[1]
        if by is Joining.PRISMATIC:  # what is beside the axis
            z = other[..., 2]
            gap, rate = cross(gap, z), cross(rate, z) + cross(gap, cross(turns[1], z))
        if by is Joining.DISTANCE:  # (gap^2 - L^2)/2L
            rate = (gap * rate).sum(axis=-1, keepdims=True) / length
            gap = ((gap * gap).sum(axis=-1, keepdims=True) - length**2) / (2 * length)
        values += [gap / arm.length]
        slopes += [rate / arm.length]
        for k in SHARED.get(by, range(3)):
            values += [one[..., k] - other[..., k]]
            slopes += [cross(turns[0], one[..., k]) - cross(turns[1], other[..., k])]
    return np.concatenate(values, axis=-1)[..., 0, :], np.swapaxes(np.concatenate(slopes, axis=-1), -1, -2)
