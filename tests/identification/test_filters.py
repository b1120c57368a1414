"""Filters: blocks give what the whole gives, derivatives are those of the motion, fewer rows keep tau = Y beta."""

import numpy as np
import pytest

import derive.identification.log as module
from derive.errors import DeriveError
from derive.identification.log import Log
from tests.identification.logs import PUMA, simulated, states

pytest.importorskip("pyarrow")
pytest.importorskip("scipy")


def positions(rows: int, rate: float = 1000.0) -> dict[str, np.ndarray]:
    return {name: values for name, values in simulated(PUMA, rows, rate)[0].items() if not name.startswith("qd")}


def gathered(log: Log) -> list[np.ndarray]:
    def state(q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
        return np.stack([q, qd, qdd], axis=2)

    return [np.concatenate(parts) for parts in zip(*log.blocks(state), strict=True)]


@pytest.mark.parametrize("decimate", [1, 5])
@pytest.mark.first(1)
def test_blocks_give_what_the_whole_log_gives(decimate: int, monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    for size in (1 << 30, 700):
        monkeypatch.setattr(module, "WIDE", size)
        monkeypatch.setattr(module, "THIN", size)
        log = Log(positions(8000), PUMA, cutoff=20.0, decimate=decimate)
        found.append(gathered(log))
    assert len(found[0][0]) == -(-(8000 - 2 * log.margin) // decimate)
    for whole, parts in zip(*found, strict=True):
        assert parts == pytest.approx(whole, abs=2e-5 * np.abs(whole).max())


def test_speeds_and_accelerations_are_those_of_the_motion() -> None:
    t, q, qd, qdd = states(PUMA.n, 8000, 1000.0)
    time, speed, state, _ = gathered(Log(positions(8000), PUMA))
    used = np.rint(time * 1000).astype(int)
    assert time == pytest.approx(t[used])
    assert (speed == state[:, :, 1]).all()
    for order, wanted in enumerate((q, qd, qdd)):
        assert state[:, :, order] == pytest.approx(wanted[used], abs=1e-4 * np.abs(wanted).max())


def test_measured_speeds_are_differentiated_once_and_nothing_is_filtered_unasked() -> None:
    columns = simulated(PUMA, 8000, 1000.0)[0]
    assert Log(columns, PUMA).margin == 0
    speeds = {name: values for name, values in columns.items() if not name.startswith("qdd")}
    log = Log(speeds, PUMA)
    assert log.missing == ("qdd",)
    time, _, state, _ = gathered(log)
    wanted = states(PUMA.n, 8000, 1000.0)[3][np.rint(time * 1000).astype(int)]
    assert state[:, :, 2] == pytest.approx(wanted, abs=1e-4 * np.abs(wanted).max())


def test_what_cannot_be_filtered_is_refused() -> None:
    timeless = {name: values for name, values in positions(400).items() if name != "time"}
    with pytest.raises(DeriveError, match="no time, by which rows are filtered; add a column time"):
        Log(timeless, PUMA).band  # noqa: B018
    with pytest.raises(DeriveError, match="a cutoff of 600 Hz; allowed: below 500 Hz"):
        Log(positions(400), PUMA, cutoff=600.0).band  # noqa: B018
