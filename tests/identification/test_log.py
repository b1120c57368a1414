"""Logs: the same rows from CSV, Parquet and tables, columns by pattern and unit, and what is wrong with a log."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.identification.log import BATCH, Log
from tests.identification.logs import PUMA, Columns, simulated

pa = pytest.importorskip("pyarrow")
pytest.importorskip("pyarrow.csv")
pytest.importorskip("pyarrow.parquet")
COLUMNS = simulated(PUMA, rows=400)[0]


def rows(log: Log) -> np.ndarray:
    return np.concatenate([block for block, _ in log.segments()])


def test_a_table_a_csv_and_a_parquet_are_one_log(tmp_path: Path) -> None:
    pa.csv.write_csv(pa.table(COLUMNS), tmp_path / "log.csv")
    pa.parquet.write_table(pa.table(COLUMNS), tmp_path / "log.parquet", row_group_size=150)
    logs = [
        Log(source, PUMA)
        for source in (COLUMNS, pa.table(COLUMNS), str(tmp_path / "log.csv"), tmp_path / "log.parquet")
    ]
    assert [log.rows for log in logs] == [400] * 4
    for log in logs:
        assert list(log.columns) == ["time", "q", "qd", "qdd", "tau"]
        assert rows(log) == pytest.approx(np.array(list(COLUMNS.values())).T, rel=1e-12)
        assert log.step == pytest.approx(0.01)


def test_columns_by_pattern_unit_and_sign(tmp_path: Path) -> None:
    text = ["effort_0 [mNm];stamp (ms);" + ";".join(f"pos_j{j} [°]" for j in range(1, 7))]
    text[0] += ";" + ";".join(f"effort_{j} [mN m]" for j in range(1, 6))
    text += [";".join(["500", str(10 * k), *["90"] * 6, *["1000"] * 5]) for k in range(3)]
    path = tmp_path / "log.csv"
    path.write_text("\n".join(text))
    log = Log(path, PUMA, {"q": "pos_j*", "tau": "-effort_*", "time": "stamp"})
    found = rows(log)
    assert found[:, log.places("time")][:, 0] == pytest.approx([0, 0.01, 0.02])
    assert found[:, log.places("q")] == pytest.approx(np.full((3, 6), pi / 2))
    assert found[:, log.places("tau")] == pytest.approx(np.tile([-0.5, -1, -1, -1, -1, -1], (3, 1)))


def without(name: str) -> Columns:
    return {key: values for key, values in COLUMNS.items() if key != name}


def broken(columns: Columns, name: str, start: int, end: int, value: float = np.nan) -> Columns:
    places = np.arange(len(columns[name]))
    return columns | {name: np.where((start <= places) & (places < end), value, columns[name])}


CUT = {name: np.delete(values, slice(100, 160)) for name, values in COLUMNS.items()}


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (without("tau3"), r"no column tau3; its columns: 'time', 'q1', .* and 12 more; name them with --columns 'tau="),
        (without("qd2"), "no column qd2"),
        (broken(COLUMNS, "q2", 100, 113), r"no number in q2 from row 101 on \(13 rows, 0.13 s\); .* --drop"),
        (CUT, "a gap of 0.61 s before row 101, t = 1.6 s"),
        (broken(COLUMNS, "time", 200, 201, 1.0), "time goes back by 0.99 s before row 201"),
        (COLUMNS | {"time": COLUMNS["time"][::-1]}, "times that do not grow, by -0.01 s"),
        (without("q3") | {"q3 [ft]": COLUMNS["q3"]}, "unit 'ft' of .* allowed: rad, deg"),
        (COLUMNS | {"q3": np.array(["x"] * 400)}, "the table: cannot be read: "),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_log(columns: Columns, message: str) -> None:
    with pytest.raises(DeriveError, match=message):
        rows(Log(columns, PUMA))


def test_places_that_are_passed_over_begin_new_segments() -> None:
    log = Log(broken(CUT, "q2", 100, 113), PUMA, drop=True)
    assert [(len(block), starts) for block, starts in log.segments()] == [(100, True), (227, True)]
    long = {name: np.resize(values, 2 * BATCH) for name, values in COLUMNS.items()}
    long["time"] = np.arange(2 * BATCH) / 100
    assert [(len(block), starts) for block, starts in Log(long, PUMA).segments()] == [(BATCH, True), (BATCH, False)]


@pytest.mark.parametrize(
    ("name", "line", "patterns", "message"),
    [
        ("log.csv", "1,abc" + ",1" * 23, {}, r":3:1: invalid value 'abc'; allowed: numbers; correct the line"),
        ("log.csv", "1,2,3", {}, r":3:1: Expected 25 columns, got 3: 1,2,3; allowed: numbers; correct the line"),
        ("log.csv", "0.01," + ",1" * 23, {}, r":3:1: no number in q1 from row 2 on \(1 rows, 0.01 s\)"),
        ("log.csv", "1", {"tauu": "x"}, "no quantity 'tauu' of a log; .*; did you mean 'tau'"),
        ("log.parquet", "1", {}, r"log.parquet: no Parquet: .*a CSV ends with .csv"),
        (".", "1", {}, r"no file .*; allowed: a .csv or a .parquet"),
    ],
)
def test_what_is_wrong_with_a_file(
    name: str, line: str, patterns: dict[str, str], message: str, tmp_path: Path
) -> None:
    text = "\n".join([",".join(COLUMNS), "0" + ",1" * 24, line, "0.02" + ",1" * 24, "0.03" + ",1" * 24])
    for each in ("log.csv", "log.parquet"):
        (tmp_path / each).write_text(text)
    with pytest.raises(DeriveError, match=message):
        rows(Log(tmp_path / name, PUMA, patterns))
