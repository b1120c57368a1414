"""The oracle: the generated functions by name, evaluated on an arm of numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from math import inf

import numpy as np
import numpy.typing as npt

from derive.errors import VerificationError
from derive.robot.description import Joining
from derive.robot.inertial_parameters import Parameter, standard_parameters
from derive.robot.robot import Robot
from derive.verification.oracle import frames, identification, lagrange, newton, rates
from derive.verification.oracle.frames import Array, NumericArm, cross, numeric_arm, together
from derive.verification.oracle.identification import Identification


@dataclass(frozen=True, slots=True)
class Definition:
    """One function of the generated interface."""

    # Names of its arguments, each of shape (..., n), a wrench (..., 6); none for what depends on parameters alone.
    arguments: tuple[str, ...]
    dynamic: bool  # whether it needs link parameters
    function: Callable[..., Array]  # its independent evaluation, from an arm and the arguments
    # Axes of its value for one configuration: 0 for a scalar, 1 for a vector, 2 for a matrix, 3 for one matrix a
    # link or row.
    axes: int = 2
    most: float = inf  # joints up to which arms have it
    # Whether it needs to know which parameters are base parameters: its first argument is then an `Identification`.
    identifies: bool = False
    wrench: str = ""  # axes of the wrench under which it is, where a robot's file asks for it
    joints: tuple[int, ...] = ()  # axes of its value, from the last, that have an entry for each joint


def forward_dynamics(oracle: Oracle, q: Array, qd: Array, tau: Array) -> Array:
    """Accelerations B^-1 (tau - C qd - g - friction) of the variables."""
    bias = oracle.evaluate("inverse_dynamics", q, qd, np.zeros_like(qd))
    return np.linalg.solve(oracle.evaluate("inertia_matrix", q), (tau - bias)[..., None])[..., 0]


def coriolis_vector(oracle: Oracle, q: Array, qd: Array) -> Array:
    """C qd: the torques of a motion without acceleration, gravity and friction."""
    return replace(oracle, arm=rates.weightless(oracle.arm)).evaluate("inverse_dynamics", q, qd, np.zeros_like(qd))


def under_wrench(oracle: Oracle, *arguments: Array, function: str, axes: str) -> Array:
    """Dynamics under a wrench h: forward_dynamics of tau + J^T h, or the torques, or their slopes, less those of h."""
    *motion, h = arguments
    felt = oracle.evaluate(f"wrench_torques{axes}{'_dq' * function.endswith('_dq')}", motion[0], h)
    if function == "forward_dynamics":
        return oracle.evaluate(function, *motion[:-1], motion[-1] + felt)
    return oracle.evaluate(function, *motion) - felt


def by_variables(value: Array, matrix: Array, axes: Sequence[int]) -> Array:
    """A value with an entry for each variable in place of each joint, along some axes: W^T v, W (..., n, v)."""
    for axis in axes:
        rows = np.moveaxis(value, axis, -1)[..., None, :]
        others = (1,) * max(0, rows.ndim - matrix.ndim)
        spread = matrix.reshape(*matrix.shape[:-2], *others, *matrix.shape[-2:])
        value = np.moveaxis((rows @ spread)[..., 0, :], -1, axis)
    return value


# Axes that have an entry for each joint.
LAST, BOTH = (-1,), (-1, -2)
FUNCTIONS: Mapping[str, Definition] = {
    "forward_kinematics": Definition(("q",), False, frames.forward_kinematics),
    "passive_positions": Definition(("q",), False, frames.passive_positions, axes=1),
    "link_transforms": Definition(("q",), False, frames.link_transforms, axes=3),
    "jacobian": Definition(("q",), False, frames.jacobian, joints=LAST),
    "jacobian_end": Definition(("q",), False, frames.jacobian_end, joints=LAST),
    "jacobian_dot": Definition(("q", "qd"), False, rates.jacobian_dot, joints=LAST),
    "jacobian_hessian": Definition(("q",), False, rates.jacobian_hessian, axes=3, most=16, joints=BOTH),
    **{
        f"analytic_jacobian_{k}": Definition(("q",), False, partial(rates.analytic_jacobian, kind=k), joints=LAST)
        for k in rates.TILTED
    },
    "inertia_matrix": Definition(("q",), True, lagrange.inertia_matrix, joints=BOTH),
    "coriolis_matrix": Definition(("q", "qd"), True, lagrange.coriolis_matrix, joints=BOTH),
    "gravity_vector": Definition(("q",), True, lagrange.gravity_vector, axes=1, joints=LAST),
    "kinetic_energy": Definition(("q", "qd"), True, lagrange.kinetic_energy, axes=0),
    "potential_energy": Definition(("q",), True, lagrange.potential_energy, axes=0),
    "inverse_dynamics": Definition(("q", "qd", "qdd"), True, newton.inverse_dynamics, axes=1, joints=LAST),
    "forward_dynamics": Definition(("q", "qd", "tau"), True, forward_dynamics, axes=1),
    "coriolis_vector": Definition(("q", "qd"), True, coriolis_vector, axes=1, joints=LAST),
    "inverse_dynamics_dq": Definition(("q", "qd", "qdd"), True, rates.inverse_dynamics_dq, joints=BOTH),
    "inverse_dynamics_dqd": Definition(("q", "qd"), True, rates.inverse_dynamics_dqd, joints=BOTH),
    "regressor": Definition(("q", "qd", "qdd"), True, identification.regressor, identifies=True),
    "base_regressor": Definition(("q", "qd", "qdd"), True, identification.base_regressor, identifies=True),
    "base_parameters": Definition((), True, identification.base_parameters, axes=1, identifies=True),
    "manipulability": Definition(("q",), False, rates.manipulability, axes=0, most=16),
    **{
        f"manipulability_{k}": Definition(("q",), False, partial(rates.manipulability, part=k), axes=0, most=16)
        for k in ("position", "orientation")
    },
    "manipulability_dq": Definition(("q",), False, rates.manipulability_dq, axes=1, most=16),
    "wrench_torques": Definition(("q", "h"), False, rates.wrench_torques, axes=1, joints=LAST),
    "wrench_torques_dq": Definition(
        ("q", "h"), True, partial(rates.slopes, rates.wrench_torques), most=16, joints=BOTH
    ),
    "wrench_torques_end": Definition(("q", "h"), False, rates.wrench_torques_end, axes=1, joints=LAST),
    "wrench_torques_end_dq": Definition(
        ("q", "h"), True, partial(rates.slopes, rates.wrench_torques_end), most=16, joints=BOTH
    ),
    "task_inertia": Definition(("q",), True, lambda arm, q: np.linalg.pinv(rates.task_mobility(arm, q)), most=16),
    **{
        f"{name}_wrench{suffix}{order}": Definition(
            ("q", "qd", last, "h"),
            True,
            partial(under_wrench, function=f"{name}{order}", axes=suffix),
            axes=2 if order else 1,
            most=16 if order else inf,
            wrench=axes,
        )
        for axes, suffix in (("world", ""), ("end", "_end"))
        for name, last, order in (
            ("inverse_dynamics", "qdd", ""),
            ("forward_dynamics", "tau", ""),
            ("inverse_dynamics", "qdd", "_dq"),
        )
    },
}

# What the derivatives of W add to a rate: Jdot W + J Wdot, and W^T (C W + B Wdot).
BENT: Mapping[str, str] = {"jacobian_dot": "jacobian", "coriolis_matrix": "inertia_matrix"}
# Functions that robots with loops lack, besides those that all lack whose joints are coupled.
OPEN = ("jacobian_hessian", "inverse_dynamics_d", "wrench_torques_dq", "wrench_torques_end_dq", "task_inertia")
# How names of functions of one end begin; a tree has them for each of its ends, ``jacobian_end_left``.
OF_AN_END = ("forward_kinematics", "jacobian", "analytic_jacobian", "manipulability", "wrench_torques")
# Functions that an arm lacks if its orientation angles are singular in every configuration.
ANGLES: Mapping[str, str] = {f"analytic_jacobian_{kind}": kind for kind in rates.TILTED}
SINGULAR = 1e-9  # distance from singular angles that is rounding


@cache
def stem(name: str) -> str:
    """The function of a name, without the end of a tree: ``jacobian_end`` of ``jacobian_end_left``."""
    return max((known for known in FUNCTIONS if f"{name}_".startswith(f"{known}_")), key=len, default=name)


@dataclass(frozen=True, slots=True, eq=False)
class Oracle:
    """Every generated function of one robot with given numbers, evaluated independently."""

    arm: NumericArm  # the robot's numbers
    dynamic: bool  # whether the robot has link parameters
    is_tree: bool = False  # whether it is more than one chain of rows
    # Which parameters the regressors' columns belong to; None without regressors.
    identification: Identification | None = None
    wrenches: tuple[str, ...] = ()  # axes of a wrench that its dynamics take
    guess: Guess | None = None  # of the passive joints, where loops close; None without loops
    is_iterated: bool = False  # whether generated code finds passive joints by iteration, and tells what is missing

    @classmethod
    def of(
        cls, robot: Robot, parameters: Mapping[str, float] | None = None, base: tuple[Parameter, ...] | None = None
    ) -> Oracle:
        """The oracle of ``robot``."""
        arm = numeric_arm(robot, parameters)
        known = None if base is None else Identification(arm, standard_parameters(robot), base)
        return cls(arm, robot.has_dynamics, robot.is_tree, known, robot.wrench)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all functions, in order, those of an end for each end."""
        ends = [f"_{end}" if end else "" for end in self.arm.ends]
        return tuple(name + end for name in FUNCTIONS for end in (ends if name.startswith(OF_AN_END) else ("",)))

    @property
    def dof(self) -> int:
        """Number of variables."""
        return self.arm.n if self.arm.coupling is None else self.arm.coupling.shape[1]

    def seen(self, name: str) -> NumericArm:
        """The numbers, seen from the end in the name of a function."""
        end = name.removeprefix(stem(name))[1:]
        return self.arm.at(end) if end else self.arm

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions that this robot has."""
        names = []
        for name in self.names:
            function, arm = stem(name), self.seen(name)
            definition = FUNCTIONS[function]
            if function in ANGLES:
                # whether the end effector's angles are regular in some configuration
                most, count = (np.pi, 512) if self.arm.loops else (1.0, 4)  # loops close at some of them
                q = np.random.default_rng(0).uniform(-most, most, (count, self.dof))
                q = self.of_joints(name, [q])[0]
                present = bool((rates.distance_from_singularity(arm, ANGLES[function], q) > SINGULAR).any())
            elif definition.identifies:
                present = self.identification is not None
            else:
                present = (self.dynamic or not definition.dynamic) and self.arm.n <= definition.most
                present &= definition.wrench in ("", *self.wrenches)
                present &= self.arm.coupling is None or not function.startswith("manipulability")
                present &= not self.arm.loops or not function.startswith(OPEN)
                present &= function != "passive_positions" or bool(self.arm.loops)
                present &= name != "task_inertia" or (not self.is_tree and len(frames.task_rows(arm)) <= arm.n)
            names += [name] * present
        return tuple(names)

    def evaluate(self, name: str, *arguments: npt.ArrayLike) -> Array:
        """The value of a generated function."""
        arrays = together([np.asarray(argument, dtype=float) for argument in arguments])
        definition = FUNCTIONS[stem(name)]
        of = self.identification if definition.identifies else self.seen(name)
        if definition.wrench or definition.function in (forward_dynamics, coriolis_vector):
            return definition.function(self, *arrays)
        if self.arm.coupling is None:
            return definition.function(of, *arrays)
        known, axes = self.following(arrays[0]), definition.joints
        value = definition.function(of, *known.arguments(definition.arguments, arrays))
        if self.is_iterated and name == "passive_positions":
            return np.concatenate([value, np.zeros((*value.shape[:-1], 1))], axis=-1)
        value = by_variables(value, known.slope, axes)
        if self.arm.loops and (rigid := BENT.get(stem(name))):
            bent = FUNCTIONS[rigid].function(of, known.x) @ known.slope_dot(arrays[1])
            value = value + by_variables(bent, known.slope, axes[1:])
        return value

    def of_joints(self, name: str, arguments: Sequence[Array]) -> tuple[Array, ...]:
        """The arguments of a function, joint by joint."""
        if self.arm.coupling is None:
            return tuple(arguments)
        return self.following(arguments[0]).arguments(FUNCTIONS[stem(name)].arguments, arguments)

    def following(self, q: Array) -> Following:
        """The joints at configurations of the variables."""
        return Following.of(self.arm, q, self.guess)

    def shares(self, q: Array) -> Array:
        """(n, v) the largest sizes of derivatives of joints by variables."""
        slope = self.following(q).slope
        return np.asarray(np.abs(slope).reshape(-1, *slope.shape[-2:]).max(axis=0))


# -- how the joints of an arm follow its variables: by a constant matrix S, or around closed loops
#
# Where loops close, what the frames that they join share differs by none, phi(x) = 0. Newton's method leads there from
# a guess, x_p <- x_p - Phi_p^+ phi, with Phi = dphi/dx and Phi_p its columns of the passive joints. Along the loops the
# derivatives W = dx/dq keep Phi W = 0, and so Phi Wdot + Phidot W = 0, each solved by least squares for its passive
# rows.

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
    placed = frames.chain_frames(arm, x)
    values, slopes = [], []
    for by, length, *places in arm.loops:
        one, other = (placed[..., joint + 1, None, :3, :] @ own for joint, own in places)
        spins = (frames.angular_jacobian(arm, placed, arm.moves[[k]]) for k, _ in places)
        turns = [np.swapaxes(spin[..., 0, :, :], -1, -2) for spin in spins]
        points = [(at[..., 3], arm.moves[[k]]) for at, (k, _) in zip((one, other), places, strict=True)]
        moves = [np.swapaxes(frames.point_jacobian(arm, placed, *point)[..., 0, :, :], -1, -2) for point in points]
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
