"""Base parameters: block by block as at once, within their deviations in hundreds of runs, kept where nothing moves."""

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.identification.regression import Factors, Method, estimate, refuse_strange_torques
from derive.identification.standard import Unknowns
from derive.verification.oracle.functions import Oracle
from tests.identification.logs import REAL, simulated
from tests.random_robots import swept

UNKNOWNS = Unknowns.of(REAL)


def rows_of(count: int, noise: float, still: tuple[int, ...] = ()) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The oracle's regressor, torques and their noise."""
    columns, sizes = simulated(REAL, count, noise=noise, still=still)
    names = [[f"{name}{j}" for j in range(1, 7)] for name in ("q", "qd", "qdd", "tau")]
    *state, torques = [np.stack([columns[each] for each in row], axis=1) for row in names]
    return Oracle.of(REAL, base=UNKNOWNS.base.parameters).evaluate("base_regressor", *state), torques, sizes


def factors_of(regressor: np.ndarray, torques: np.ndarray, block: int = 500) -> Factors:
    there = (np.abs(regressor) > 1e-9).any(axis=0)
    found = Factors(tuple(map(np.flatnonzero, there)), regressor.shape[2])
    for start in range(0, len(torques), block):
        found.add(regressor[start : start + block], torques[start : start + block])
    return found


def test_blocks_give_what_least_squares_of_all_rows_gives() -> None:
    regressor, torques, sizes = rows_of(1200, 0.01)
    prior, anything = np.zeros(len(UNKNOWNS.prior)), np.full(len(UNKNOWNS.prior), np.inf)
    factors = factors_of(regressor, torques, 170)
    found = estimate(factors, Method.OLS, prior, anything)
    flat = regressor.reshape(-1, len(prior))
    wanted = np.linalg.lstsq(flat, torques.ravel(), rcond=None)[0]
    assert found.beta == pytest.approx(wanted, rel=1e-6, abs=1e-9)
    residual = torques - regressor @ found.beta
    assert factors.squares(found.beta) == pytest.approx((residual**2).sum(axis=0))
    # The covariance for noise that differs by joint, (Y^T Y)^-1 Y^T S Y (Y^T Y)^-1.
    inverse, noise = np.linalg.inv(flat.T @ flat), residual.var(axis=0)
    middle = np.einsum("rjp,j,rjq->pq", regressor, noise, regressor)
    assert found.deviation == pytest.approx(np.sqrt(np.diag(inverse @ middle @ inverse)), rel=0.02)
    weighed = estimate(factors, Method.WLS, prior, anything)
    whitened = (regressor / sizes[:, None]).reshape(-1, len(prior))
    assert weighed.deviation == pytest.approx(np.sqrt(np.diag(np.linalg.inv(whitened.T @ whitened))), rel=0.05)
    assert (weighed.deviation < found.deviation * 1.05).all()


@pytest.mark.parametrize(("runs", "least"), [(300, 295), *swept((1000, 990))])
def test_each_parameter_is_within_three_deviations_in_hundreds_of_runs(runs: int, least: int) -> None:
    regressor, clean, _ = rows_of(400, 0.0)
    sizes, random = 0.01 * np.abs(clean).max(axis=0), np.random.default_rng(5)
    factors, within = factors_of(regressor, clean), np.zeros(len(UNKNOWNS.prior))
    bases = [np.linalg.qr(regressor[:, j, own]) for j, own in enumerate(factors.columns)]
    for _ in range(runs):
        torques = clean + random.normal(size=clean.shape) * sizes
        for j, (q, r) in enumerate(bases):  # what `Factors.add` finds, as the regressor is the same in all runs
            along = q.T @ torques[:, j]
            rest = np.sqrt(torques[:, j] @ torques[:, j] - along @ along)
            factors.factors[j] = np.block([[r, along[:, None]], [np.zeros((1, len(r))), np.full((1, 1), rest)]])
        found = estimate(factors, Method.WLS, UNKNOWNS.prior, UNKNOWNS.largest)
        within += np.abs(found.beta - UNKNOWNS.prior) <= 3 * found.deviation
    assert not found.kept.any()
    assert within.min() >= least


def test_a_log_without_noise_is_exact() -> None:
    regressor, torques, _ = rows_of(300, 0.0)
    found = estimate(factors_of(regressor, torques), Method.WLS, 0 * UNKNOWNS.prior, 0 * UNKNOWNS.prior + np.inf)
    assert found.beta == pytest.approx(UNKNOWNS.prior, rel=1e-8, abs=1e-10)


def test_what_does_not_move_is_kept_and_the_rest_is_found() -> None:
    regressor, torques, sizes = rows_of(2000, 0.01, still=(0, 3))
    factors, prior = factors_of(regressor, torques), UNKNOWNS.prior * 1.1
    found = estimate(factors, Method.WLS, prior, UNKNOWNS.largest)
    kept = {p.name for p, own in zip(UNKNOWNS.base.parameters, found.kept, strict=True) if own}
    assert kept >= {"Izz1", "b1", "f1", "Ia4", "b4", "f4"}
    assert (found.beta[found.kept] == prior[found.kept]).all()
    residual = torques - regressor @ found.beta
    assert residual.std(axis=0) == pytest.approx(sizes, rel=0.05)
    # What the log tells with a deviation above anything that a robot has is kept, too.
    tight = estimate(factors, Method.WLS, prior, np.where(found.kept, np.inf, 1e-9))
    assert tight.kept.all()


@pytest.mark.parametrize(
    ("factor", "message"),
    [
        (-1.0, r"torques opposite to those .*: q2 \(correlation -1.00\); turn their signs in the log, or take them"),
        (1000.0, r"torques in another unit .*: q2 \(1e\+03 times\); name the unit in the header, 'tau1 \[mNm\]'"),
        (0.001, r"another unit .*: q2 \(0.001 times\)"),
    ],
)
def test_torques_of_another_sign_or_unit_are_refused(factor: float, message: str) -> None:
    regressor, torques, _ = rows_of(300, 0.01)
    labels = [f"q{j}" for j in range(1, 7)]
    refuse_strange_torques(factors_of(regressor, torques), UNKNOWNS.prior, labels)
    torques[:, 1] *= factor
    with pytest.raises(DeriveError, match=message):
        refuse_strange_torques(factors_of(regressor, torques), UNKNOWNS.prior, labels)


def test_the_sign_of_all_torques_is_turned_by_an_option() -> None:
    regressor, torques, _ = rows_of(300, 0.01)
    with pytest.raises(DeriveError, match=r"q6 \(correlation -1.00\); turn them with --columns 'tau=-tau\*'"):
        refuse_strange_torques(factors_of(regressor, -torques), UNKNOWNS.prior, [f"q{j}" for j in range(1, 7)])
