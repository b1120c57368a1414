"""What regressors and base parameters have to return, and how far off a returned value is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.robot.inertial_parameters import LINK_PARTS, Parameter
from derive.verify.expected import Expectation
from derive.verify.oracle.arm import Arm, Array
from derive.verify.oracle.identification import Identification, fitting_states
from derive.verify.oracle.oracle import Oracle
from derive.verify.report import TOLERANCE
from derive.verify.samples import SampleSet
from derive.verify.scales import FLOOR, Bounds, bounds

_SPARE = 100.0
"""Rounding of the torques that are fitted, in units of the last place."""

_KIND = {"m": "m", "mm": "m", **dict.fromkeys(("mx", "my", "mz"), "h"), **dict.fromkeys(LINK_PARTS[4:], "I")}


@dataclass(frozen=True, slots=True, eq=False)
class BaseExpectation(Expectation):
    """Base parameters, measured by the torques of random motions: by nothing else are they determined.

    An error counts by the share of the torques that it makes, against the parameter's own share where that is not
    small; and the torques of all parameters together must be right.

    Attributes:
        matrix: Base regressor of these motions, each row over the natural size of its torque, (states * n, b).
        torques: Their torques, over the same, (states * n,).
        small: A share of the torques below which a parameter's own is small, from the condition of ``matrix``.
    """

    matrix: Array
    torques: Array
    small: float

    @property
    def compared(self) -> int:
        """The torques that are compared."""
        return len(self.torques)

    @property
    def called(self) -> int:
        """All of them."""
        return len(self.torques)

    def errors(self, got: Array) -> Array:
        """Relative error of each parameter, or that of the torques if it is larger."""
        if not np.isfinite(got).all():
            return np.full(got.shape, np.inf)
        together = np.abs(self.matrix @ got - self.torques).max()
        weight = np.abs(self.matrix).max(axis=0)
        alone = np.abs(got - self.value) * weight / np.maximum(np.abs(self.value) * weight, self.small)
        errors: Array = np.maximum(alone, together)
        return errors


def identification_expectation(function: str, sample_set: SampleSet, arguments: tuple[Array, ...]) -> Expectation:
    """The oracle's answer.

    Args:
        function: ``regressor``, ``base_regressor`` or ``base_parameters``.
        sample_set: The robot's numbers.
        arguments: Broadcast arguments, (..., n) each; none for the base parameters.
    """
    oracle = sample_set.oracle
    known = oracle.identification
    assert known is not None, "only robots with regressors have these functions"
    if function == "base_parameters":
        return _base_expectation(oracle, known)
    value = oracle.evaluate(function, *arguments)
    parameters = known.standard if function == "regressor" else known.base
    natural = _entry_scale(bounds(oracle, arguments[0]), known.arm, parameters, arguments[1:])
    largest = np.abs(value).reshape(-1, *value.shape[-2:]).max(axis=0)
    return Expectation(oracle, arguments, value, np.maximum(largest, FLOOR * natural))


def _base_expectation(oracle: Oracle, known: Identification) -> BaseExpectation:
    q, qd, qdd = fitting_states(known)
    torques = oracle.evaluate("inverse_dynamics", q, qd, qdd)
    rates = np.abs(qd).max(axis=0)
    size = np.maximum(np.abs(torques).max(axis=0), FLOOR * bounds(oracle, q).torque(rates, rates))
    size = np.where(size > 0, size, 1.0)
    matrix = oracle.evaluate("base_regressor", q, qd, qdd) / size[:, None]
    flat = matrix.reshape(-1, matrix.shape[-1])
    value = oracle.evaluate("base_parameters")
    small = max(FLOOR, _SPARE * np.finfo(float).eps * _condition(flat) / TOLERANCE)
    return BaseExpectation(oracle, (), value, np.ones_like(value), flat, (torques / size).ravel(), small)


def _condition(matrix: Array) -> float:
    """How much a fit multiplies rounding, the columns brought to one size."""
    size = np.abs(matrix).max(axis=0)
    singular = np.linalg.svd(matrix / np.where(size > 0, size, 1.0), compute_uv=False)
    return float(singular[0] / max(singular[-1], 1e-300))


def _entry_scale(limits: Bounds, arm: Arm, parameters: tuple[Parameter, ...], motion: tuple[Array, ...]) -> Array:
    """Natural size of each entry, (n, p): what unit parameters weigh at the largest rates."""
    rate, change = (np.abs(a).reshape(-1, arm.n).max(axis=0) for a in motion)
    turn = np.where(arm.revolute, rate, 0.0).sum()
    spin = np.where(arm.revolute, change, 0.0).sum() + turn**2
    slide = np.where(arm.revolute, 0.0, change + 2.0 * turn * rate).sum()
    pull = limits.reach * spin + slide + np.linalg.norm(arm.gravity)
    lever = np.where(arm.revolute, limits.reach, 1.0)
    link = {"m": lever * pull, "I": np.full(arm.n, spin)}
    link["h"] = np.where(arm.revolute, pull, 0.0) + lever * spin
    ratio = np.abs(arm.ratio)
    own = {"Im": ratio**2 * change, "Ia": change, "b": rate, "f": np.ones(arm.n)}
    columns = []
    for p in parameters:
        if p.part in own:
            shared = (1.0 + ratio[p.joint - 1]) * spin if p.part == "Im" else 0.0
            columns.append(shared + np.where(np.arange(arm.n) == p.joint - 1, own[p.part], 0.0))
        else:
            columns.append(link[_KIND[p.part]])
    scale: Array = np.maximum(np.stack(columns, axis=-1), 1e-300)
    return scale
