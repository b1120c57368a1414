"""What a generated function has to return, and how far off a returned value is."""

from dataclasses import dataclass

import numpy as np

from derive.verification.oracle.frames import Array
from derive.verification.oracle.functions import ANGLES, FUNCTIONS, Oracle, by_variables, stem
from derive.verification.oracle.identification import fitting_states
from derive.verification.oracle.rates import distance_from_singularity, task_mobility
from derive.verification.samples import SampleSet
from derive.verification.tolerance import FLOOR, TINY, TOLERANCE, Bounds, largest, regressor_size, relative_errors

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
        distance = np.empty(len(got))
        for start in range(0, len(got), step):
            part = got[start : start + step]
            distances = np.abs(part - wanted[: len(part)]).reshape(len(part), -1).max(axis=1)
            distance[start : start + step] = np.where(np.isnan(distances), np.inf, distances)
        order = np.argsort(distance, kind="stable")
        farthest = np.empty(count, dtype=int)
        farthest[order % count] = order
        return got[farthest]


@dataclass(frozen=True, slots=True, eq=False)
class PassiveExpectation(Expectation):
    """Positions of passive joints, of which angles a full turn apart are the same."""

    def errors(self, got: Array) -> Array:
        """How far off positions are."""
        turns = np.round((got - self.value) / (2 * np.pi)) * self.oracle.arm.revolute[self.oracle.arm.passive]
        return Expectation.errors(self, got - 2 * np.pi * turns)


@dataclass(frozen=True, slots=True, eq=False)
class AccelerationExpectation(Expectation):
    """Accelerations, measured by the torque that is left over, since B may be ill conditioned.

    The error of row i is |B qdd + h - tau|_i over sqrt(B_ii) sum_j sqrt(B_jj) |qdd_j| + |tau_i| + |h_i|: rounding alone
    leaves the unit roundoff times a modest factor of that, whatever the condition of B (Higham, Accuracy and Stability
    of Numerical Algorithms, section 10.1). Configurations where B is singular determine no accelerations.
    """

    bias: Array  # (..., n) C qd + g + friction
    root: Array  # (..., n) square roots of the diagonal of B, where that vanishes of its natural size

    def errors(self, got: Array) -> Array:
        """How far off accelerations are."""
        q, qd, tau = self.arguments
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
        together = np.abs(self.matrix @ got - self.torques).max()
        weight = np.abs(self.matrix).max(axis=0)
        alone = np.abs(got - self.value) * weight / np.maximum(np.abs(self.value) * weight, self.small)
        return np.asarray(np.maximum(alone, together))


def expectation(function: str, sample_set: SampleSet, arguments: tuple[Array, ...]) -> Expectation:
    """The oracle's answer."""
    oracle = sample_set.oracle
    if not arguments:
        return _base_parameters(oracle)
    of_joints, known = oracle.of_joints(function, arguments), stem(function)
    limits = Bounds(oracle, of_joints[0], function)
    if function == "forward_dynamics":
        return _accelerations(oracle, arguments, limits)
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


def _accelerations(oracle: Oracle, arguments: tuple[Array, ...], limits: Bounds) -> AccelerationExpectation:
    """Accelerations by solving with B, where it is regular."""
    q, qd, tau = arguments
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
    return AccelerationExpectation(oracle, arguments, value, scale, regular, bias, root)


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
