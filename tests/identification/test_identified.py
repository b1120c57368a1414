"""From a log to a robot file and a page: known robots are found again, on rows that were not used, too."""

import numpy as np
import pytest

from derive.api.identify import identify
from derive.errors import DeriveError
from derive.identification.identified import Identified
from derive.identification.regression import Method
from derive.identification.report import report_page
from derive.identification.standard import Unknowns
from derive.robot.robot import Robot
from tests.identification.logs import PUMA, REAL, simulated

pytest.importorskip("pyarrow")
LOG, NOISE = simulated(REAL, 4000)
TRUTH = dict(zip((p.name for p in Unknowns.of(REAL).base.parameters), Unknowns.of(REAL).prior, strict=True))


@pytest.fixture(scope="module", params=[str(method) for method in Method])
def found(request: pytest.FixtureRequest) -> Identified:
    pytest.importorskip("clarabel")
    return identify(PUMA, LOG, method=request.param, held_out=0.25)


def test_the_robot_is_found_again(found: Identified) -> None:
    assert found.rows == 3000
    truth = np.array([TRUTH[name] for name in found.names])
    assert (np.abs(found.values - truth) <= 4 * found.deviations).all()
    assert found.residuals == pytest.approx(NOISE, rel=0.05 if found.method is not Method.OLS else 0.15)
    if found.method is not Method.OLS:  # the others weigh each joint by its noise
        assert (found.held_out <= 1.05 * NOISE).all()
    assert (found.before > 2 * NOISE).all()
    assert Unknowns.of(Robot.from_text(found.text)).prior == pytest.approx(found.values, rel=1e-7, abs=1e-9)


def test_the_page_and_the_tables_say_what_was_found(found: Identified) -> None:
    html = report_page(found)
    assert html.count("<figure>") == 6
    assert "http://" not in html.replace("http://www.w3.org", "")
    assert "Iyy1" not in html  # formulas are LaTeX
    assert "I_{yy1}" in html
    assert [len(row) for row in found.joint_rows()] == [5] * 6
    name, value, interval, prior, formula = found.parameter_rows()[0]
    assert (name, prior) == ("Izz1", "3.93757")
    assert float(value) == pytest.approx(found.values[0], rel=1e-5)
    assert float(interval) == pytest.approx(1.96 * found.deviations[0], rel=0.05)
    assert formula.startswith("Iyy1 + Ia1 + a2**2*m2 + 2*a2*mx2")


def test_positions_alone_and_fewer_rows_do() -> None:
    pytest.importorskip("scipy")
    fast, noise = simulated(REAL, 30_000, rate=1000.0)
    log = {name: values for name, values in fast.items() if not name.startswith("qd")}
    truth = np.array([TRUTH[name] for name in identify(PUMA, LOG).names])
    for decimate in (1, 10):
        result = identify(PUMA, log, decimate=decimate)
        assert (np.abs(result.values - truth) <= 4 * result.deviations).all()
        assert result.residuals == pytest.approx(noise / (1 if decimate == 1 else 3.7), rel=0.1)
        assert result.notes[0] == "qd, qdd by differences, filtered without delay at 10 Hz"
    assert result.notes[1] == "regressor and torques filtered alike, 1 of 10 rows kept"


def test_another_log_is_held_out_and_armatures_are_added() -> None:
    other, noise = simulated(REAL, 1000, seed=3)
    result = identify(PUMA, LOG, held_out=other, add=("viscous", "coulomb", "armature"))
    assert (result.rows, result.notes) == (4000, ())
    assert result.held_out == pytest.approx(noise, rel=0.1)


def test_the_edges_of_filters_are_not_what_is_held_out() -> None:
    pytest.importorskip("scipy")
    result = identify(PUMA, LOG, decimate=20, held_out=0.2)  # 400 rows at either end are edges
    assert result.rows == 128
    assert result.held_out == pytest.approx(result.residuals, rel=0.5)
    with pytest.raises(DeriveError, match="the table: none of its 4000 rows left to be held out; hold out a larger"):
        identify(PUMA, LOG, held_out=0.0001)


def test_what_does_not_move_is_named() -> None:
    still, _ = simulated(REAL, 2000, still=(0, 3))
    result = identify(PUMA, still, add=())
    (note,) = result.notes
    assert note.startswith("not excited by the log, kept as they were: Izz1, b1, ")
    assert note in result.text
    row = result.parameter_rows()[0]
    assert (row[0], row[2], row[1]) == ("Izz1", "kept", row[3])


def test_short_logs_are_refused() -> None:
    short = {name: values[:5] for name, values in LOG.items()}
    with pytest.raises(DeriveError, match="the table: 5 rows of 6 torques for 52 base parameters; give a longer log"):
        identify(PUMA, short)
    bare = {name: values[:300] for name, values in LOG.items() if not name.startswith("qd")}
    with pytest.raises(DeriveError, match="the table: 300 rows, none of them left between gaps and edges of filters"):
        identify(PUMA, bare, cutoff=0.5)
