"""What a generated function has to return, and how far off a value is: the yardstick of the tolerance of 1e-9.

An error is measured against the largest value that its own entry takes over the samples, so that a small wrist inertia
is not compared with a large shoulder inertia. Where an entry vanishes only rounding is left in it; then a thousandth of
its natural size counts, the bound that masses, lengths and rates give for that entry.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from derive.verification.oracle.frames import Array, NumericArm, task_rows
from derive.verification.oracle.functions import ANGLES, FUNCTIONS, Oracle, by_variables, stem
from derive.verification.oracle.identification import Identification, fitting_states
from derive.verification.oracle.rates import distance_from_singularity, task_mobility
from derive.verification.samples import SampleSet

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
    return np.where(difference == 0, 0.0, np.where(np.isnan(ratio), np.inf, ratio))


def largest(argument: Array) -> Array:
    """The largest size of each joint's entry over a batch."""
    return np.asarray(np.abs(argument).reshape(-1, argument.shape[-1]).max(axis=0))


class Bounds:
    """Bounds of an arm's quantities over a set of configurations, those of a function of an end at that end."""

    def __init__(self, oracle: Oracle, q: Array, function: str = "") -> None:
        arm = oracle.seen(function)
        # The longest way from joint i to anything beyond it: all lengths, slides extended, and the farthest mass.
        lengths = np.abs(arm.a) + np.abs(arm.d) + np.where(arm.revolute, 0.0, largest(q))
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
        if oracle.is_iterated:  # and of what is missing
            self.passive = np.append(self.passive, max(1.0, self.extent))
        self.rows = partial(task_rows, arm)  # of J, by part
        self.revolute = arm.revolute  # (n,) whether joint i turns
        self.inertia = np.where(arm.revolute, turning, mass) + own  # (n,) bound of B_ii
        self.gravity: Array = np.where(arm.revolute, mass * weight * lever, mass * weight)  # (n,) bound of g_i
        self.potential: Array = whole * weight * (farthest + np.linalg.norm(arm.base[:3, 3]))  # () bound of U
        # (2, n) viscous and Coulomb coefficients, absolute values
        self.friction = np.abs([arm.viscous, np.abs(arm.coulomb).max(axis=0)])

    def natural_size(self, function: str, arguments: Sequence[Array]) -> Array:
        """Natural size of each entry of a generated function's value."""
        name = stem(function)
        if name.startswith("manipulability"):  # the product of the lengths of as many rows as there are
            rows = self.rows(name.partition("_")[2].removeprefix("dq") or "all")
            lengths = np.linalg.norm(self.jacobian[rows], axis=1)
            return np.asarray(np.prod(lengths) * (self.steepness if name == "manipulability_dq" else 1.0))
        return np.asarray(_SIZES[name](self, *map(largest, arguments[1:])))

    @property
    def pose(self) -> Array:
        """Bound of T, (4, 4)."""
        return np.vstack([np.hstack([np.ones((3, 3)), np.full((3, 1), self.extent)]), np.ones((1, 4))])

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
        return np.asarray(self.rigid(rate, acceleration) + self.friction[0] * rate + self.friction[1])

    def rigid(self, rate: Array, acceleration: Array) -> Array:
        """Bound of B qdd + C qd + g."""
        return np.asarray(self.inertia_matrix @ acceleration + self.coriolis_matrix(rate) @ rate + self.gravity)

    def turning(self, rate: Array) -> float:
        """Bound of angular velocities [rad/s]: the sum over all joints, displacements as turns of the whole arm."""
        return float(np.where(self.revolute, rate, rate / max(self.reach, TINY)).sum())

    def undetermined(self, function: str) -> float:
        """How far apart right values may be.

        A base rounded in the file to 0.7071 is no rotation: R (z x r) and (R z) x (R r), both the Jacobian, then differ
        by its defect. A base whose defect is rounding of floats leaves nothing undetermined.
        """
        of_eight = ("jacobian_end", "jacobian_dot", "jacobian_hessian", *ANGLES)
        of_eight += tuple(name for name in FUNCTIONS if "wrench" in name)
        steps = {"jacobian": 4.0, **dict.fromkeys(of_eight, 8.0)}
        return steps.get(stem(function), 0.0) * self.base_defect if self.base_defect > ROUNDING else 0.0


# Natural sizes of values, from the bounds and the largest rates; other functions are verified in ways of their own.
_SIZES: Mapping[str, Callable[..., Any]] = {
    **dict.fromkeys(("forward_kinematics", "link_transforms"), lambda bounds: bounds.pose),
    "passive_positions": lambda bounds: bounds.passive,
    **dict.fromkeys(("jacobian", "jacobian_end", *ANGLES), lambda bounds: bounds.jacobian),
    "jacobian_dot": lambda bounds, qd: bounds.jacobian * bounds.turning(qd),
    "jacobian_hessian": lambda bounds: bounds.jacobian[..., None] * bounds.steepness,
    **dict.fromkeys(("wrench_torques", "wrench_torques_end"), lambda bounds, h: h @ bounds.jacobian),
    "wrench_torques_dq": lambda bounds, h: np.outer(h @ bounds.jacobian, bounds.steepness),
    "wrench_torques_end_dq": lambda bounds, h: np.outer(h @ bounds.jacobian, bounds.steepness),
    "inertia_matrix": lambda bounds: bounds.inertia_matrix,
    "coriolis_matrix": Bounds.coriolis_matrix,
    "coriolis_vector": lambda bounds, qd: bounds.coriolis_matrix(qd) @ qd,
    "gravity_vector": lambda bounds: bounds.gravity,
    "kinetic_energy": lambda bounds, qd: 0.5 * (qd @ bounds.inertia_matrix @ qd),
    "potential_energy": lambda bounds: bounds.potential,
    "inverse_dynamics": Bounds.torque,
    "inverse_dynamics_dq": lambda bounds, qd, qdd: np.outer(bounds.rigid(qd, qdd), bounds.steepness),
    **dict.fromkeys(
        ("inverse_dynamics_wrench", "inverse_dynamics_wrench_end"),
        lambda bounds, qd, qdd, h: bounds.torque(qd, qdd) + h @ bounds.jacobian,
    ),
    **dict.fromkeys(
        ("inverse_dynamics_wrench_dq", "inverse_dynamics_wrench_end_dq"),
        lambda bounds, qd, qdd, h: np.outer(bounds.rigid(qd, qdd) + h @ bounds.jacobian, bounds.steepness),
    ),
    "inverse_dynamics_dqd": lambda bounds, qd: 2.0 * bounds.coriolis_matrix(qd) + np.diag(bounds.friction[0]),
}


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
    moment = np.where(arm.revolute, pull, 0.0) + lever * spin
    of_link = {"mass": lever * pull, "first moment": moment, "inertia": np.full(arm.n, spin)}
    of_joint = dict.fromkeys(("f", "fp", "fm"), np.ones(arm.n))
    of_joint |= {"Im": ratio**2 * acceleration, "Ia": acceleration, "b": rate}
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


# -- what the oracle answers

SINGULAR = 1e-13  # smallest eigenvalue of B scaled to a unit diagonal at which accelerations are still determined
CONDITION = 1e-4  # the same of J B^-1 J^T, times that of B, below which the inverse is not compared
NEAR = 1e-3  # distance from singular angles at which rounding may reach a thousandth of what is allowed
MASSLESS = 1e-22  # share of its natural size below which a diagonal entry of B is the square of rounding
SPARE = 100.0  # rounding of the torques that base parameters are fitted to, in units of the last place
CACHED = 1 << 15  # numbers of a long batch that are compared at once: they stay in the processor's cache


@dataclass(frozen=True, slots=True, eq=False)
class Expectation:
    """The oracle's answer for a batch of arguments."""

    oracle: Oracle  # the robot with its numbers
    arguments: tuple[Array, ...]  # broadcast arguments, (..., n) each
    value: Array  # the answer, (..., *shape)
    scale: Array  # what an error of each entry is measured against, broadcastable to ``value``
    regular: Array  # (...) where there is a value; configurations without one are called but not compared

    def errors(self, got: Array) -> Array:
        """How far off a value is."""
        errors = relative_errors(got - self.value, self.scale)
        errors[~self.regular] = 0.0
        return errors

    def farthest_repetitions(self, got: Array) -> Array:
        """For each argument the value farthest off; row i, (rows, *shape), belongs to argument i modulo their count."""
        count = len(self.value)
        step = count * max(1, CACHED // self.value.size)
        wanted = np.resize(self.value, (step, *self.value.shape[1:]))
        distance = np.full(-(-len(got) // count) * count, -1.0)
        for start in range(0, len(got), step):
            part = got[start : start + step]
            distances = np.abs(part - wanted[: len(part)]).reshape(len(part), -1).max(axis=1)
            distance[start : start + len(part)] = np.where(np.isnan(distances), np.inf, distances)
        return np.asarray(got[distance.reshape(-1, count).argmax(axis=0) * count + np.arange(count)])


@dataclass(frozen=True, slots=True, eq=False)
class PassiveExpectation(Expectation):
    """Positions of passive joints, of which angles a full turn apart are the same."""

    def errors(self, got: Array) -> Array:
        """How far off positions are."""
        revolute = self.oracle.arm.revolute[self.oracle.arm.passive]
        turns = np.round((got - self.value) / (2 * np.pi)) * np.resize([*revolute, False], got.shape[-1])
        return Expectation.errors(self, got - 2 * np.pi * turns)


@dataclass(frozen=True, slots=True, eq=False)
class AccelerationExpectation(Expectation):
    """Accelerations, measured by the torque that is left over, since B may be ill conditioned.

    The error of row i is |B qdd + h - tau|_i over sqrt(B_ii) sum_j sqrt(B_jj) |qdd_j| + |tau_i| + |h_i|: rounding alone
    leaves the unit roundoff times a modest factor of that, whatever the condition of B (Higham, Accuracy and Stability
    of Numerical Algorithms, section 10.1). Configurations where B is singular determine no accelerations.
    """

    tau: Array  # (..., n) the torques, with what joints feel of a wrench
    bias: Array  # (..., n) C qd + g + friction
    root: Array  # (..., n) square roots of the diagonal of B, where that vanishes of its natural size

    def errors(self, got: Array) -> Array:
        """How far off accelerations are."""
        (q, qd, *_), tau = self.arguments, self.tau
        finite = np.where(np.isfinite(got), got, 0.0)
        left = self.oracle.evaluate("inverse_dynamics", q, qd, finite) - tau
        inertial = self.root * (self.root * np.abs(finite)).sum(axis=-1, keepdims=True)
        errors = relative_errors(left, np.maximum(inertial + np.abs(tau) + np.abs(self.bias), self.scale))
        errors[~np.isfinite(got)] = np.inf
        errors[~self.regular] = 0.0
        return errors


@dataclass(frozen=True, slots=True, eq=False)
class BaseExpectation(Expectation):
    """Base parameters, measured by the torques of random motions: by nothing else are they determined.

    An error counts by the share of the torques that it makes, against the parameter's own share where that is not
    small; and the torques of all parameters together, which are what is counted, must be right.
    """

    matrix: Array  # base regressor of these motions, each row over the natural size of its torque, (states * n, b)
    torques: Array  # their torques over the natural sizes, (states * n,)
    small: float  # a share of the torques below which a parameter's own is small, from the condition of ``matrix``

    def errors(self, got: Array) -> Array:
        """How far off base parameters are."""
        if not np.isfinite(got).all():
            return np.full(got.shape, np.inf)
        weight = np.abs(self.matrix).max(axis=0)
        alone = np.abs(got - self.value) * weight / np.maximum(np.abs(self.value) * weight, self.small)
        return np.asarray(np.maximum(alone, np.abs(self.matrix @ got - self.torques).max()))


def expectation(function: str, sample_set: SampleSet, arguments: tuple[Array, ...]) -> Expectation:
    """The oracle's answer."""
    oracle = sample_set.oracle
    if not arguments:
        return _base_parameters(oracle)
    of_joints, known = oracle.of_joints(function, arguments), stem(function)
    limits = Bounds(oracle, of_joints[0], function)
    if function.startswith("forward_dynamics"):
        return _accelerations(oracle, function, arguments, limits)
    value = oracle.evaluate(function, *arguments)
    if function == "task_inertia":  # whose entries are those of unit directions times the roots of the diagonal
        root = np.sqrt(np.maximum(np.diagonal(value, axis1=-2, axis2=-1), TINY))
        of_inertia = np.abs(_eigenvalues(oracle.evaluate("inertia_matrix", *arguments))).min(axis=-1)
        mobility = task_mobility(oracle.arm, *arguments)
        rows = np.diagonal(mobility, axis1=-2, axis2=-1)
        regular = np.asarray(_eigenvalues(mobility).min(axis=-1) * of_inertia > CONDITION)
        regular &= (rows > NEAR**2 * rows.max()).all(axis=-1)  # a row of rounding alone is dependent, too
        return Expectation(oracle, arguments, value, root[..., None] * root[..., None, :], regular)
    if FUNCTIONS[known].identifies:
        assert oracle.identification is not None, "only robots with regressors have these functions"
        natural = regressor_size(limits, oracle.identification, function, arguments[1:])
    else:
        natural = limits.natural_size(function, of_joints)
        if oracle.arm.coupling is not None:
            natural = by_variables(natural, oracle.shares(arguments[0]), FUNCTIONS[known].joints)
    yardstick = np.maximum(FLOOR, limits.undetermined(function) / TOLERANCE) * natural
    if known in ANGLES:  # near singular ones rates grow with 1/distance, what rounding leaves with its square
        distance = distance_from_singularity(oracle.seen(function), ANGLES[known], of_joints[0])
        regular = distance > NEAR
        near = np.where(regular, distance, 1.0)[..., None, None]
        return Expectation(oracle, arguments, value, np.maximum(np.abs(value), yardstick / near**2), regular)
    if function.startswith("manipulability"):  # what rounding leaves of w^2 is large in w, and in its slope, near zero
        name = known.removesuffix("_dq") + function.removeprefix(known)
        volume = value if name == function else oracle.evaluate(name, *arguments)
        share = volume / np.maximum(max(volume.max(), TINY), FLOOR * limits.natural_size(name, arguments))
        regular, axes = share > NEAR, tuple(range(volume.ndim, value.ndim))
        near = np.expand_dims(np.where(regular, share, 1.0), axes)
        size = np.maximum(np.abs(value[regular]).max(initial=0.0), yardstick)
        return Expectation(oracle, arguments, value, size / near, regular)
    batch = list(range(arguments[0].ndim - 1))
    if function == "link_transforms":  # the frames of all links have one size
        batch.append(len(batch))
    scale = np.maximum(np.abs(value).max(axis=tuple(batch)), yardstick)
    every = np.ones(arguments[0].shape[:-1], dtype=bool)
    return (PassiveExpectation if known == "passive_positions" else Expectation)(oracle, arguments, value, scale, every)


def _eigenvalues(matrix: Array) -> Array:
    """Those of a symmetric matrix scaled to a unit diagonal."""
    diagonal = np.diagonal(matrix, axis1=-2, axis2=-1)
    unit = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    return np.asarray(np.linalg.eigvalsh(matrix / (unit[..., :, None] * unit[..., None, :])))


def _accelerations(
    oracle: Oracle, function: str, arguments: tuple[Array, ...], limits: Bounds
) -> AccelerationExpectation:
    """Accelerations by solving with B, where it is regular."""
    q, qd, tau, *wrench = arguments
    if wrench:
        tau = tau + oracle.evaluate(function.replace("forward_dynamics_wrench", "wrench_torques"), q, *wrench)
    matrix, s = oracle.evaluate("inertia_matrix", q), None if oracle.arm.coupling is None else oracle.shares(q)
    inertia = limits.inertia if s is None else (np.sqrt(limits.inertia) @ s) ** 2
    diagonal = np.diagonal(matrix, axis1=-2, axis2=-1)
    regular = np.abs(_eigenvalues(matrix)).min(axis=-1) > SINGULAR
    regular &= (diagonal > MASSLESS * inertia).all(axis=-1)
    solvable = np.where(regular[..., None, None], matrix, np.eye(q.shape[-1]))
    bias = oracle.evaluate("inverse_dynamics", q, qd, np.zeros_like(qd))
    value = np.linalg.solve(solvable, (tau - bias)[..., None])[..., 0]
    root = np.sqrt(np.maximum(diagonal, FLOOR * inertia))
    rate = largest(oracle.of_joints("coriolis_vector", (q, qd))[1])
    torque = limits.torque(rate, np.zeros_like(rate))
    scale = FLOOR * (torque if s is None else torque @ s)
    return AccelerationExpectation(oracle, arguments, value, scale, regular, tau, bias, root)


def _base_parameters(oracle: Oracle) -> BaseExpectation:
    """Base parameters by a fit, and the torques that they are fitted to."""
    assert oracle.identification is not None, "only robots with regressors have these functions"
    q, qd, qdd = fitting_states(oracle.identification)
    torques = oracle.evaluate("inverse_dynamics", q, qd, qdd)
    rates = largest(qd)
    size, natural = np.abs(torques).max(axis=0), Bounds(oracle, q).torque(rates, rates)
    # A joint that nothing loads has torques of rounding, and its parameters what the fit of the others leaves.
    is_loaded = size > TOLERANCE * natural
    size = np.where(is_loaded, np.maximum(size, FLOOR * natural), np.where(natural > 0, natural, 1.0))
    matrix = oracle.evaluate("base_regressor", q, qd, qdd) / size[:, None]
    flat = matrix.reshape(-1, matrix.shape[-1])
    column = np.abs(flat).max(axis=0)
    singular = np.linalg.svd(flat / np.where(column > 0, column, 1.0), compute_uv=False)
    condition = float(singular[0] / max(singular[-1], TINY))  # by how much a fit multiplies rounding
    small = max(FLOOR, SPARE * np.finfo(float).eps * condition / TOLERANCE)
    value = oracle.evaluate("base_parameters")
    wanted = (torques / size).ravel()
    every = np.ones(wanted.shape, dtype=bool)
    return BaseExpectation(oracle, (), value, np.ones_like(value), every, flat, wanted, small)
