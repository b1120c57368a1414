"""What a generated function has to return, and how far off a returned value is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.verify.expected import Expectation, PartialExpectation, relative
from derive.verify.identification import identification_expectation
from derive.verify.oracle.arm import Array
from derive.verify.oracle.oracle import ANGLES, FUNCTIONS, Oracle
from derive.verify.oracle.rates import distance_from_singularity
from derive.verify.report import TOLERANCE
from derive.verify.samples import SampleSet
from derive.verify.scales import FLOOR, Bounds, bounds

SINGULAR = 1e-13
"""Smallest eigenvalue of B scaled to a unit diagonal at which accelerations are still determined."""

NEAR = 1e-3
"""Distance from singular angles at which rounding may reach a thousandth of what is allowed."""

MASSLESS = 1e-22
"""Share of its natural size below which a diagonal entry of B is the square of rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class AccelerationExpectation(PartialExpectation):
    """Accelerations, measured by the torque that is left over, since B may be ill conditioned.

    The error of row i is |B qdd + h - tau|_i over sqrt(B_ii) sum_j sqrt(B_jj) |qdd_j| + |tau_i| + |h_i|: rounding alone
    leaves the unit roundoff times a modest factor of that, whatever the condition of B (Higham, Accuracy and Stability
    of Numerical Algorithms, section 10.1). Configurations where B is singular determine no accelerations.

    Attributes:
        bias: (..., n) C qd + g + friction.
        root: (..., n) square roots of the diagonal of B, where that vanishes of its natural size.
    """

    bias: Array
    root: Array

    def errors(self, got: Array) -> Array:
        """Relative torque error of each row; 0 where B is singular."""
        q, qd, tau = self.arguments
        finite = np.where(np.isfinite(got), got, 0.0)
        left = self.oracle.evaluate("inverse_dynamics", q, qd, finite) - tau
        inertial = self.root * (self.root * np.abs(finite)).sum(axis=-1, keepdims=True)
        errors = relative(left, np.maximum(inertial + np.abs(tau) + np.abs(self.bias), self.scale))
        errors[~np.isfinite(got)] = np.inf
        errors[~self.regular] = 0.0
        return errors


def expectation(function: str, sample_set: SampleSet, arguments: tuple[Array, ...]) -> Expectation:
    """The oracle's answer.

    Args:
        function: Name of the generated function.
        sample_set: The robot's numbers.
        arguments: Broadcast arguments, (..., n) each.
    """
    if FUNCTIONS[function].identifies:
        return identification_expectation(function, sample_set, arguments)
    oracle = sample_set.oracle
    limits = bounds(oracle, arguments[0])
    if function == "forward_dynamics":
        return _accelerations(oracle, arguments, limits)
    value = oracle.evaluate(function, *arguments)
    natural = limits.entry_scale(function, arguments)
    batch = tuple(range(arguments[0].ndim - 1))
    if function == "link_transforms":
        batch = (*batch, arguments[0].ndim - 1)
    yardstick = np.maximum(FLOOR, limits.undetermined(function) / TOLERANCE) * natural
    if function in ANGLES:
        return _angle_rates(oracle, arguments, ANGLES[function], value, yardstick)
    return Expectation(oracle, arguments, value, np.maximum(np.abs(value).max(axis=batch), yardstick))


def _angle_rates(
    oracle: Oracle, arguments: tuple[Array, ...], kind: str, value: Array, yardstick: Array
) -> PartialExpectation:
    """Near singular angles their rates grow with 1/distance, and what rounding leaves with its square."""
    distance = distance_from_singularity(oracle.arm, kind, arguments[0])
    regular = distance > NEAR
    near = np.where(regular, distance, 1.0)[..., None, None]
    return PartialExpectation(oracle, arguments, value, np.maximum(np.abs(value), yardstick / near**2), regular)


def _accelerations(oracle: Oracle, arguments: tuple[Array, ...], limits: Bounds) -> AccelerationExpectation:
    q, qd, tau = arguments
    matrix = oracle.evaluate("inertia_matrix", q)
    diagonal = np.diagonal(matrix, axis1=-2, axis2=-1)
    regular = _is_regular(matrix) & (diagonal > MASSLESS * limits.inertia).all(axis=-1)
    solvable = np.where(regular[..., None, None], matrix, np.eye(q.shape[-1]))
    bias = oracle.evaluate("inverse_dynamics", q, qd, np.zeros_like(qd))
    value = np.linalg.solve(solvable, (tau - bias)[..., None])[..., 0]
    root = np.sqrt(np.maximum(diagonal, FLOOR * limits.inertia))
    rate = _largest(qd)
    scale = FLOOR * limits.torque(rate, np.zeros_like(rate))
    return AccelerationExpectation(oracle, arguments, value, scale, regular, bias, root)


def _is_regular(matrix: Array) -> Array:
    diagonal = np.diagonal(matrix, axis1=-2, axis2=-1)
    root = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    scaled = matrix / (root[..., :, None] * root[..., None, :])
    smallest = np.abs(np.linalg.eigvalsh(scaled)).min(axis=-1)
    regular: Array = (smallest > SINGULAR) & (diagonal > 0).all(axis=-1)
    return regular


def _largest(rates: Array) -> Array:
    largest: Array = np.abs(rates).reshape(-1, rates.shape[-1]).max(axis=0)
    return largest
