"""Base parameters from torques: triangular factors of the regressor, block by block, and what is estimated from them.

Of each joint's rows [Y_b, tau] only the triangular factor R of their QR decomposition is kept, and each further block
is put under it, R = qr([R; block]): the rows can be forgotten, as R x has the length of [Y_b, tau] x for every x (Golub
and Van Loan, Matrix Computations, section 5.3). So residuals, weights and the correlation with what a model predicts
need no second pass.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from derive.arrays import Array, Flags, Indices
from derive.errors import DeriveError, listed

DEPENDENT = 1e-6  # distance from the span of others below which a column of length 1 says nothing of its own
NOISELESS = 1e-12  # part of the torques below which residuals are rounding
SMALLEST = 1e-4  # part of them that no model meets: what it counts when bodies are looked for
# Correlation with the predicted torques beyond which these are the measured ones but for a sign, or for a unit, and the
# factor, either way, that no errors of a robot file explain.
OPPOSITE, ALIKE, OTHER_UNIT = -0.7, 0.9, 10.0


# How base parameters are estimated: by least squares of all torques, with each joint's torques by the size of its
# noise, or so within what physically consistent bodies can have.
Method = StrEnum("Method", {"OLS": "ols", "WLS": "wls", "POSSIBLE": "possible"})


@dataclass(eq=False)
class Factors:
    """The triangular factors of [Y_b, tau] by joints."""

    columns: tuple[Indices, ...]  # of each joint those that its torque can depend on
    count: int  # of all columns
    rows: int = 0  # how many of each joint
    factors: list[Array] = field(default_factory=list)  # (k + 1, k + 1) of each joint, k its columns

    def __post_init__(self) -> None:
        self.factors = [np.zeros((len(own) + 1, len(own) + 1)) for own in self.columns]

    def add(self, regressor: Array, torques: Array) -> None:
        """Take in some rows: (rows, n, p) and (rows, n)."""
        self.rows += len(torques)
        for j, own in enumerate(self.columns):
            rows = np.vstack([self.factors[j], np.column_stack([regressor[:, j, own], torques[:, j]])])
            self.factors[j] = np.asarray(np.linalg.qr(rows, mode="r"))

    def squares(self, beta: Array) -> Array:
        """(n,) the sum of squares of each joint's tau - Y_b beta."""
        ends = (factor @ np.append(beta[own], -1.0) for factor, own in zip(self.factors, self.columns, strict=True))
        return np.array([end @ end for end in ends])

    def deviations(self, beta: Array) -> Array:
        """(n,) the root mean square of each joint's tau - Y_b beta [N m or N]."""
        return np.sqrt(self.squares(beta) / max(self.rows, 1))

    def stacked(self, weights: Array) -> Array:
        """One factor of all joints' rows, each joint's times a weight: (p + 1, p + 1)."""
        rows = []
        for factor, own, weight in zip(self.factors, self.columns, weights, strict=True):
            rows.append(np.zeros((len(factor), self.count + 1)))
            rows[-1][:, [*own, self.count]] = weight * factor
        return np.asarray(np.linalg.qr(np.vstack(rows), mode="r"))


@dataclass(frozen=True, eq=False)
class Estimate:
    """Base parameters and how sure they are."""

    beta: Array  # (p,)
    deviation: Array  # (p,) standard deviations; zero for those that are kept
    kept: Flags  # (p,) whether the log does not excite it, so that it has its value from before
    factor: Array  # (p + 1, p + 1) of all rows, each by the noise of its joint


def estimate(factors: Factors, method: Method, prior: Array, largest: Array) -> Estimate:
    """Base parameters, those kept at their prior that the log does not tell from anything up to the largest, (p,)."""
    kept = _dependent(factors.stacked(np.ones(len(factors.columns)))[:, :-1])
    while True:
        found = _solved(factors, method, prior, kept)
        beyond = found.deviation / largest
        if not beyond.max(initial=0.0) > 1:
            return found
        kept = kept | (np.arange(len(prior)) == int(np.argmax(beyond)))


def _dependent(factor: Array) -> Flags:
    """Columns that those before them replace in this log (Gram-Schmidt, twice)."""
    lengths = np.linalg.norm(factor, axis=0)
    found: Flags = lengths <= NOISELESS * lengths.max(initial=0.0)
    basis = np.zeros((len(factor), 0))
    for k in np.flatnonzero(~found):
        column = factor[:, k] / lengths[k]
        for _ in range(2):
            column = column - basis @ (basis.T @ column)
        found[k] = (rest := np.linalg.norm(column)) < DEPENDENT
        basis = basis if found[k] else np.column_stack([basis, column / rest])
    return found


def _solved(factors: Factors, method: Method, prior: Array, kept: Flags) -> Estimate:
    """Least squares of the parameters that are not kept."""
    n, free, beta = len(factors.columns), np.flatnonzero(~kept), prior.copy()
    weights, fixed = np.ones(n), np.where(kept, prior, 0.0)
    degrees = max(factors.rows - len(free) / n, 1.0)
    torques = np.maximum(factors.deviations(np.zeros(len(prior))), np.finfo(float).tiny)
    for _ in range(1 if method is Method.OLS else 3):  # the noise by equal weights, then by itself
        factor = factors.stacked(weights)
        own, right = np.linalg.qr(factor[:, free]), factor[:, -1] - factor[:, :-1] @ fixed
        beta[free] = np.linalg.solve(own.R, own.Q.T @ right)
        noise = np.maximum(np.sqrt(factors.squares(beta) / degrees), NOISELESS * torques)
        weights = weights if method is Method.OLS else 1 / noise
    # Half of the covariance (Y^T W Y)^-1 (Y^T W S W Y) (Y^T W Y)^-1: S the noise of the joints, W the inverse, or one.
    inverse, weighed = np.linalg.inv(own.R), factors.stacked(1 / np.maximum(noise, SMALLEST * torques))
    half = factors.stacked(noise)[:, free] @ inverse @ inverse.T if method is Method.OLS else inverse.T
    deviation = np.zeros(len(prior))
    deviation[free] = np.linalg.norm(half, axis=0)
    return Estimate(beta, deviation, kept, weighed)


def refuse_strange_torques(factors: Factors, prior: Array, labels: Sequence[str]) -> None:
    """Refuse torques that are those of the robot file but for a sign or a unit."""
    fits = []  # of each joint the correlation of tau with Y_b beta, about zero, and the factor that fits best
    for factor, own in zip(factors.factors, factors.columns, strict=True):
        expected, measured = factor[:, :-1] @ prior[own], factor[:, -1]
        product, square = expected @ measured, expected @ expected
        length = np.sqrt(square * (measured @ measured))
        fits.append((product / length, product / square) if length else (0.0, 1.0))
    correlations, sizes = np.array(fits).T
    trust = "or take them as they are with --trust-torques"
    if (opposite := correlations < OPPOSITE).any():
        which = listed(f"{labels[j]} (correlation {correlations[j]:.2f})" for j in np.flatnonzero(opposite).tolist())
        found = f"torques opposite to those that the robot file predicts: {which}"
        turn = "turn them with --columns 'tau=-tau*'" if opposite.all() else "turn their signs in the log"
        raise DeriveError(found, remedy=f"{turn}, {trust}")
    is_other = (correlations > ALIKE) & (np.abs(np.log(np.abs(sizes) + NOISELESS)) > np.log(OTHER_UNIT))
    if is_other.any():
        which = listed(f"{labels[j]} ({sizes[j]:.3g} times)" for j in np.flatnonzero(is_other).tolist())
        found = f"torques in another unit than those that the robot file predicts: {which}"
        raise DeriveError(found, remedy=f"name the unit in the header, 'tau1 [mNm]', {trust}")
