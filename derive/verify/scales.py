"""How large an entry of a quantity may be: the yardstick of relative errors.

An error is measured against the largest value that its own entry takes over the samples, so that a small wrist inertia
is not compared with a large shoulder inertia. Where an entry vanishes only rounding is left in it; then a thousandth of
its natural size counts, the bound that masses, lengths and rates give for that entry.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from derive.verify.oracle.arm import Arm, Array
from derive.verify.oracle.oracle import ANGLES, Oracle

FLOOR = 1e-3
"""Share of the natural size below which an entry counts as vanishing."""

FAR = 0.1
"""Share of the whole arm's reach that a lever counts for at least: places far from the base carry its rounding."""

ROUNDING = 1e-14
"""Defect of a rotation that is written exactly."""


@dataclass(frozen=True, slots=True, eq=False)
class Bounds:
    """Bounds of an arm's quantities over a set of configurations.

    Attributes:
        reach: From frame 0 to anything on the arm [m].
        extent: Reach plus base and tool [m].
        base_defect: Largest entry of R'R - 1 of the base, as written in the file.
        revolute: (n,) whether joint i turns.
        inertia: (n,) bound of B_ii.
        gravity: (n,) bound of g_i.
        friction: (2, n) viscous and Coulomb coefficients, absolute values.
    """

    reach: float
    extent: float
    base_defect: float
    revolute: Array
    inertia: Array
    gravity: Array
    friction: Array

    def entry_scale(self, function: str, arguments: Sequence[Array]) -> Array:
        """Natural size of each entry of a generated function's value.

        Args:
            function: Name of the function, any but forward dynamics.
            arguments: Its arguments, (..., n) each; the largest rates count.
        """
        rates = [np.abs(argument).reshape(-1, argument.shape[-1]).max(axis=0) for argument in arguments[1:]]
        match function:
            case "forward_kinematics" | "link_transforms":
                return self._transform()
            case "jacobian":
                return self._jacobian()
            case "inertia_matrix":
                return self._inertia()
            case "coriolis_matrix":
                return self._coriolis(rates[0])
            case "gravity_vector":
                return self.gravity
            case "inverse_dynamics":
                return self.torque(*rates)
            case "jacobian_dot":
                return self._jacobian() * self._turning(rates[0])
            case "analytic_jacobian_rpy" | "analytic_jacobian_zyz":
                return self._jacobian()
            case "coriolis_vector":
                coriolis: Array = self._coriolis(rates[0]) @ rates[0]
                return coriolis
            case "inverse_dynamics_dq":
                return self._position_derivative(*rates)
            case "inverse_dynamics_dqd":
                viscous: Array = 2.0 * self._coriolis(rates[0]) + np.diag(self.friction[0])
                return viscous
            case _:
                raise KeyError(function)

    def torque(self, rate: Array, change: Array) -> Array:
        """Bound of B qdd + C qd + g + friction, (n,)."""
        moving: Array = self._inertia() @ change + self._coriolis(rate) @ rate
        bound: Array = moving + self.gravity + self.friction[0] * rate + self.friction[1]
        return bound

    def _position_derivative(self, rate: Array, change: Array) -> Array:
        """Bound of d tau / d q, (n, n): an angle changes no term by more than the term's size."""
        rigid = self.torque(rate, change) - self.friction[0] * rate - self.friction[1]
        bound: Array = np.outer(rigid, np.where(self.revolute, 1.0, 1.0 / max(self.reach, 1e-300)))
        return bound

    def _transform(self) -> Array:
        scale = np.ones((4, 4))
        scale[:3, 3] = self.extent
        return scale

    def _jacobian(self) -> Array:
        linear = np.where(self.revolute, self.extent, 1.0)
        return np.vstack([np.tile(linear, (3, 1)), np.ones((3, len(linear)))])

    def undetermined(self, function: str) -> float:
        """How far apart right values may be, relative to their natural size.

        A base rounded in the file to 0.7071 is no rotation: R (z x r) and (R z) x (R r), both the Jacobian, then differ
        by its defect. A base whose defect is rounding of floats leaves nothing undetermined.
        """
        steps = {"jacobian": 4.0, "jacobian_dot": 8.0, **dict.fromkeys(ANGLES, 8.0)}
        return steps.get(function, 0.0) * self.base_defect if self.base_defect > ROUNDING else 0.0

    def _inertia(self) -> Array:
        scale: Array = np.sqrt(np.outer(self.inertia, self.inertia))
        return scale

    def _coriolis(self, rate: Array) -> Array:
        scale: Array = self._inertia() * self._turning(rate)
        return scale

    def _turning(self, rate: Array) -> float:
        """Bound of angular velocities, with displacements counted as turns of the whole arm [rad/s]."""
        return float(np.where(self.revolute, rate, rate / max(self.reach, 1e-300)).sum())


def bounds(oracle: Oracle, q: Array) -> Bounds:
    """The bounds of an arm at configurations (samples, n)."""
    arm = oracle.arm
    travel = np.where(arm.revolute, 0.0, np.abs(q).reshape(-1, arm.n).max(axis=0))
    lengths = np.abs(arm.a) + np.abs(arm.d) + travel
    com = np.linalg.norm(arm.com, axis=-1)
    reach = np.array([lengths[i:].sum() + com[i:].max() for i in range(arm.n)])
    mass = _outwards(arm.mass) + _outwards(arm.rotor_mass) - arm.rotor_mass
    force = mass * np.linalg.norm(arm.gravity)
    return Bounds(
        reach=float(reach[0]),
        extent=float(lengths.sum() + np.abs(arm.base[:3, 3]).sum() + np.abs(arm.tool[:3, 3]).sum()),
        base_defect=float(np.abs(arm.base[:3, :3].T @ arm.base[:3, :3] - np.eye(3)).max()),
        revolute=arm.revolute,
        inertia=_inertia_bound(arm, mass, reach),
        gravity=np.where(arm.revolute, force * np.maximum(reach, FAR * reach[0]), force),
        friction=np.abs([arm.viscous, arm.coulomb]),
    )


def _inertia_bound(arm: Arm, mass: Array, reach: Array) -> Array:
    tensors = np.linalg.norm(arm.inertia, axis=(1, 2))
    turning = mass * reach * np.maximum(reach, FAR * reach[0]) + _outwards(tensors) + _outwards(arm.rotor_inertia)
    own = arm.ratio**2 * arm.rotor_inertia + np.abs(arm.armature)
    bound: Array = np.where(arm.revolute, turning, mass) + own
    return bound


def _outwards(values: Array) -> Array:
    """Sums over the links from i to the end, of absolute values."""
    sums: Array = np.cumsum(np.abs(values)[::-1])[::-1]
    return sums
