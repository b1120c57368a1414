"""Logs: the same rows from CSV, Parquet and tables, columns by pattern and unit, and what is wrong with a log."""

from collections.abc import Callable
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
    for source in (COLUMNS, pa.table(COLUMNS), str(tmp_path / "log.csv"), tmp_path / "log.parquet"):
        log = Log(source, PUMA)
        assert log.rows == 400
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
    assert found[:, 0] == pytest.approx([0, 0.01, 0.02])
    assert found[:, 1:7] == pytest.approx(np.full((3, 6), pi / 2))
    assert found[:, 7:] == pytest.approx(np.tile([-0.5, -1, -1, -1, -1, -1], (3, 1)))


def test_names_that_begin_with_a_minus() -> None:
    columns = {f"- {name}": values for name, values in COLUMNS.items()}
    patterns = {"q": "- q*", "qd": "- qd*", "qdd": "-- qdd*", "tau": "-- tau*", "time": "- time"}
    log = Log(columns, PUMA, patterns)
    signs = {"time": 1, "q": 1, "qd": 1, "qdd": -1, "tau": -1}
    assert {quantity: found[0][1] for quantity, found in log.columns.items()} == signs


def without(name: str) -> Callable[[Columns], Columns]:
    return lambda columns: {key: values for key, values in columns.items() if key != name}


def broken(name: str, start: int, end: int, value: float = np.nan) -> Callable[[Columns], Columns]:
    def change(columns: Columns) -> Columns:
        values = columns[name].copy()
        values[start:end] = value
        return columns | {name: values}

    return change


def cut(columns: Columns) -> Columns:
    return {name: np.delete(values, slice(100, 160)) for name, values in columns.items()}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (without("tau3"), r"no column tau3; its columns: 'time', 'q1', .* and 12 more; name them with --columns 'tau="),
        (without("qd2"), "no column qd2"),
        (broken("q2", 100, 113), r"no number in q2 from row 101 on \(13 rows, 0.13 s\); .* --drop"),
        (cut, "a gap of 0.61 s before row 101, t = 1.6 s"),
        (broken("time", 200, 201, 1.0), "time goes back by 0.99 s before row 201"),
        (lambda columns: columns | {"time": columns["time"][::-1]}, "times that do not grow, by -0.01 s"),
        (lambda columns: without("q3")(columns) | {"q3 [ft]": columns["q3"]}, "unit 'ft' of .* allowed: rad, deg"),
        (lambda columns: columns | {"q3": np.array(["x"] * 400)}, "the table: cannot be read: "),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_log(change: Callable[[Columns], Columns], message: str) -> None:
    with pytest.raises(DeriveError, match=message):
        rows(Log(change(COLUMNS), PUMA))


def test_places_that_are_passed_over_begin_new_segments() -> None:
    log = Log(broken("q2", 100, 113)(cut(COLUMNS)), PUMA, drop=True)
    assert [(len(block), starts) for block, starts in log.segments()] == [(100, True), (227, True)]
    long = {name: np.resize(values, 2 * BATCH) for name, values in COLUMNS.items()}
    long["time"] = np.arange(2 * BATCH) / 100
    assert [(len(block), starts) for block, starts in Log(long, PUMA).segments()] == [(BATCH, True), (BATCH, False)]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("1,abc" + ",1" * 23, r":3:1: 'abc' for q1; allowed: numbers; correct the line"),
        ("\n\n1,abc" + ",1" * 23, r":5:1: 'abc' for q1"),
        ("1,2,3", r":3:1: 3 cells; allowed: numbers; write 25"),
        ("0.01," + ",1" * 23, r":3:1: no number in q1 from row 2 on \(1 rows, 0.01 s\)"),
    ],
)
def test_what_is_wrong_with_a_line_of_a_csv(line: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("\n".join([",".join(COLUMNS), "0" + ",1" * 24, line, "0.02" + ",1" * 24, "0.03" + ",1" * 24]))
    with pytest.raises(DeriveError, match=message):
        rows(Log(path, PUMA))


def test_files_that_are_none_or_no_logs(tmp_path: Path) -> None:
    (tmp_path / "log.parquet").write_text("no")
    with pytest.raises(DeriveError, match=r"log.parquet: no Parquet: .*a CSV ends with .csv"):
        Log(tmp_path / "log.parquet", PUMA).names  # noqa: B018
    with pytest.raises(DeriveError, match=r"no file .*; allowed: a .csv or a .parquet"):
        Log(tmp_path / "none.csv", PUMA).rows  # noqa: B018
    with pytest.raises(DeriveError, match=r"no quantity 'tauu' of a log; .*; did you mean 'tau'"):
        Log(COLUMNS, PUMA, {"tauu": "x"}).columns  # noqa: B018
