"""The tolerance of verification, 1e-9, and the yardstick of relative errors: how large an entry of a quantity may be.

An error is measured against the largest value that its own entry takes over the samples, so that a small wrist inertia
is not compared with a large shoulder inertia. Where an entry vanishes only rounding is left in it; then a thousandth of
its natural size counts, the bound that masses, lengths and rates give for that entry.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from derive.verification.oracle.frames import Array, NumericArm, task_rows
from derive.verification.oracle.functions import ANGLES, Oracle, stem
from derive.verification.oracle.identification import Identification

# Largest relative error of a generated function; rounding leaves about 1e-14, a wrong term 1e-3 and more.
TOLERANCE = 1e-9
FLOOR = 1e-3  # share of the natural size below which an entry counts as vanishing
# Share of the whole arm's reach that a lever counts for at least: places far from the base carry its rounding.
FAR = 0.1
ROUNDING = 1e-14  # defect of a rotation that is written exactly
TINY = 1e-300  # instead of 0, to divide by
# Parts of a link's inertial parameters; the others are inertias.
_PARTS = {"mx": "first moment", "my": "first moment", "mz": "first moment", "m": "mass", "mm": "mass"}


def relative_errors(difference: Array, scale: Array) -> Array:
    """Size of a difference in terms of a scale."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.abs(difference) / scale
    exact = np.broadcast_to(difference == 0, ratio.shape)
    return np.where(exact, 0.0, np.where(np.isnan(ratio), np.inf, ratio))


def largest(argument: Array) -> Array:
    """The largest size of each joint's entry over a batch."""
    return np.asarray(np.abs(argument).reshape(-1, argument.shape[-1]).max(axis=0))


class Bounds:
    """Bounds of an arm's quantities over a set of configurations, those of a function of an end at that end."""

    def __init__(self, oracle: Oracle, q: Array, function: str = "") -> None:
        arm = oracle.seen(function)
        # The longest way from joint i to anything beyond it: all lengths, slides extended, and the farthest mass.
        travel = np.where(arm.revolute, 0.0, largest(q))
        lengths = np.abs(arm.a) + np.abs(arm.d) + travel
        if arm.start is not None:
            lengths = lengths + np.linalg.norm(arm.start[:, :3, 3], axis=-1)
        com, beyond = np.linalg.norm(arm.com, axis=-1), arm.moves.T
        reach = np.array([lengths[row[:-1]].sum() + com[row[arm.carrier]].max() for row in beyond])
        farthest = lengths.sum() + com.max()
        lever = np.maximum(reach, FAR * farthest)
        # What joint i carries, and its weight; its own rotor sits on the link before.
        mass = _carried(arm, arm.mass) + _carried(arm, arm.rotor_mass) - arm.rotor_mass
        whole, weight = np.abs(arm.mass).sum() + np.abs(arm.rotor_mass).sum(), np.linalg.norm(arm.gravity)
        tensors = np.linalg.norm(arm.inertia, axis=(1, 2))
        # B_ii <= sum m r^2 + tensors; one r is at least the share of the whole reach whose rounding it carries.
        turning = mass * reach * lever + _carried(arm, tensors) + _carried(arm, arm.rotor_inertia)
        own = arm.ratio**2 * arm.rotor_inertia + np.abs(arm.armature)
        self.reach = float(farthest)  # from frame 0 to anything on the arm [m]
        # Reach plus base and tool [m], and the largest entry of R'R - 1 of the base, as written in the file.
        self.extent = float(lengths.sum() + np.abs(arm.base[:3, 3]).sum() + np.abs(arm.tool[:3, 3]).sum())
        self.base_defect = float(np.abs(arm.base[:3, :3].T @ arm.base[:3, :3] - np.eye(3)).max())
        self.passive = np.where(arm.revolute, np.pi, self.extent)[arm.passive]  # bound of their positions
        self.rows = partial(task_rows, arm)  # of J, by part
        self.revolute = arm.revolute  # (n,) whether joint i turns
        self.inertia = np.where(arm.revolute, turning, mass) + own  # (n,) bound of B_ii
        self.gravity: Array = np.where(arm.revolute, mass * weight * lever, mass * weight)  # (n,) bound of g_i
        self.potential: Array = whole * weight * (farthest + np.linalg.norm(arm.base[:3, 3]))  # () bound of U
        # (2, n) viscous and Coulomb coefficients, absolute values
        self.friction = np.abs([arm.viscous, np.abs(arm.coulomb).max(axis=0)])

    def natural_size(self, function: str, arguments: Sequence[Array]) -> Array:
        """Natural size of each entry of a generated function's value."""
        rates = [largest(argument) for argument in arguments[1:]]
        name = stem(function)
        match name:
            case "forward_kinematics" | "link_transforms":
                size = np.ones((4, 4))
                size[:3, 3] = self.extent
                return size
            case "passive_positions":
                return self.passive
            case "jacobian" | "jacobian_end" | "analytic_jacobian_rpy" | "analytic_jacobian_zyz":
                return self.jacobian
            case "jacobian_dot":
                return self.jacobian * self.turning(rates[0])
            case "jacobian_hessian":
                return self.jacobian[..., None] * self.steepness
            case "manipulability" | "manipulability_position" | "manipulability_orientation" | "manipulability_dq":
                # the product of the lengths of as many rows as there are
                rows = self.rows(name.partition("_")[2].removeprefix("dq") or "all")
                lengths = np.linalg.norm(self.jacobian[rows], axis=1)
                return np.asarray(np.prod(lengths) * (self.steepness if name == "manipulability_dq" else 1.0))
            case "wrench_torques" | "wrench_torques_end":
                return np.asarray(rates[0] @ self.jacobian)
            case "wrench_torques_dq" | "wrench_torques_end_dq":
                return np.outer(rates[0] @ self.jacobian, self.steepness)
            case "inertia_matrix":
                return self.inertia_matrix
            case "coriolis_matrix":
                return self.coriolis_matrix(rates[0])
            case "coriolis_vector":
                return self.coriolis_matrix(rates[0]) @ rates[0]
            case "gravity_vector":
                return self.gravity
            case "kinetic_energy":
                return 0.5 * (rates[0] @ self.inertia_matrix @ rates[0])
            case "potential_energy":
                return self.potential
            case "inverse_dynamics":
                return self.torque(*rates)
            case "inverse_dynamics_dq":
                rigid = self.torque(*rates) - self.friction[0] * rates[0] - self.friction[1]
                return np.outer(rigid, self.steepness)
            case "inverse_dynamics_dqd":
                return 2.0 * self.coriolis_matrix(rates[0]) + np.diag(self.friction[0])
            case _:  # it is verified in a way of its own
                raise KeyError(function)

    @property
    def jacobian(self) -> Array:
        """Bound of J, (6, n)."""
        linear = np.where(self.revolute, self.extent, 1.0)
        return np.vstack([np.tile(linear, (3, 1)), np.ones((3, len(linear)))])

    @property
    def steepness(self) -> Array:
        """Bound of derivatives by q, (n,), of what has size 1: an angle changes no term by more than its size."""
        return np.where(self.revolute, 1.0, 1.0 / max(self.reach, TINY))

    @property
    def inertia_matrix(self) -> Array:
        """Bound of B, (n, n): |B_ij| <= sqrt(B_ii B_jj), since B is positive semidefinite."""
        return np.asarray(np.sqrt(np.outer(self.inertia, self.inertia)))

    def coriolis_matrix(self, rate: Array) -> Array:
        """Bound of C."""
        return self.inertia_matrix * self.turning(rate)

    def torque(self, rate: Array, acceleration: Array) -> Array:
        """Bound of B qdd + C qd + g + friction."""
        moving: Array = self.inertia_matrix @ acceleration + self.coriolis_matrix(rate) @ rate
        return np.asarray(moving + self.gravity + self.friction[0] * rate + self.friction[1])

    def turning(self, rate: Array) -> float:
        """Bound of angular velocities [rad/s]: the sum over all joints, displacements as turns of the whole arm."""
        return float(np.where(self.revolute, rate, rate / max(self.reach, TINY)).sum())

    def undetermined(self, function: str) -> float:
        """How far apart right values may be.

        A base rounded in the file to 0.7071 is no rotation: R (z x r) and (R z) x (R r), both the Jacobian, then differ
        by its defect. A base whose defect is rounding of floats leaves nothing undetermined.
        """
        of_eight = ("jacobian_end", "jacobian_dot", "jacobian_hessian", *ANGLES)
        of_eight += tuple(f"wrench_torques{kind}" for kind in ("", "_dq", "_end", "_end_dq"))
        steps = {"jacobian": 4.0, **dict.fromkeys(of_eight, 8.0)}
        return steps.get(stem(function), 0.0) * self.base_defect if self.base_defect > ROUNDING else 0.0


def _carried(arm: NumericArm, values: Array) -> Array:
    """Sums over what joint i carries of absolute values of the bodies, or of the rotors as if they were bodies."""
    total = np.zeros(arm.n + 1)
    np.add.at(total, arm.carrier[: len(values)], np.abs(values))
    for i in reversed(range(arm.n)):
        total[arm.parent[i]] += total[i]
    return total[:-1]


def regressor_size(limits: Bounds, known: Identification, function: str, motion: Sequence[Array]) -> Array:
    """Natural size of each entry of a regressor: what unit parameters weigh at the largest rates."""
    arm = known.arm
    rate, acceleration = (largest(argument) for argument in motion)
    # Bounds of omega, |alpha| + |omega|^2 and the slides' acceleration with Coriolis term, over the whole arm.
    turn = np.where(arm.revolute, rate, 0.0).sum()
    spin = np.where(arm.revolute, acceleration, 0.0).sum() + turn**2
    slide = np.where(arm.revolute, 0.0, acceleration + 2.0 * turn * rate).sum()
    # Acceleration of the farthest point less gravity: what a unit mass weighs.
    pull = limits.reach * spin + slide + np.linalg.norm(arm.gravity)
    lever = np.where(arm.revolute, limits.reach, 1.0)
    ratio = np.abs(arm.ratio)
    of_link = {
        "mass": lever * pull,
        "first moment": np.where(arm.revolute, pull, 0.0) + lever * spin,
        "inertia": np.full(arm.n, spin),
    }
    of_joint = {
        "Im": ratio**2 * acceleration,
        "Ia": acceleration,
        "b": rate,
        **dict.fromkeys(("f", "fp", "fm"), np.ones(arm.n)),
    }
    columns = []
    for parameter in known.standard if function == "regressor" else known.base:
        part, i = parameter.part, parameter.joint - 1
        if part in of_joint:
            # A rotor's inertia also acts on all joints before, by the rotation of its carrier.
            shared = (1.0 + ratio[i]) * spin if part == "Im" else 0.0
            columns.append(shared + np.where(np.arange(arm.n) == i, of_joint[part], 0.0))
        else:
            columns.append(of_link[_PARTS.get(part, "inertia")])
    return np.asarray(np.maximum(np.stack(columns, axis=-1), TINY))
