"""``derive identify``, ``map`` and ``sample``: tables, files, JSON, and how an interrupted map goes on."""

import json
from pathlib import Path
from unittest import mock

import pytest

from derive.cli.data import sample
from derive.sampling import maps
from tests.cli.command import PLANAR, accepted, derive, refused
from tests.identification.logs import REAL, simulated

pa = pytest.importorskip("pyarrow")
pytest.importorskip("pyarrow.csv")


@pytest.fixture
def log(tmp_path: Path) -> Path:
    columns = simulated(REAL, 800)[0]
    named = {f"effort_{name[3:]}" if name.startswith("tau") else name: values for name, values in columns.items()}
    pa.csv.write_csv(pa.table(named), tmp_path / "log.csv")
    return tmp_path


IDENTIFY = ("identify", "puma560-corke", "log.csv", "--columns", "tau=effort_*")


def test_what_was_found_is_printed_and_written(log: Path) -> None:
    printed = accepted(*IDENTIFY, "-o", "found.yaml", "--report", "page.html", "--held-out", "0.2", folder=log).stdout
    lines = printed.splitlines()
    assert lines[0] == "found.yaml: 640 rows, wls"
    assert lines[1].split() == ["joint", "torque", "RMS", "residual", "before", "residual", "held", "out"]
    assert lines[8].split() == ["parameter", "value", "+-", "95", "%", "prior"]
    assert [line.split()[0] for line in lines[9:12]] == ["Izz1", "b1", "f1"]
    assert (log / "page.html").is_file()
    assert "wls, 800 rows; residuals by joint" in accepted(*IDENTIFY, folder=log).stdout
    found = json.loads(accepted(*IDENTIFY, "--json", "--method", "ols", "--add", "none", folder=log).stdout)
    assert (found["method"], found["rows"], len(found["values"]), found["held_out"]) == ("ols", 800, 46, None)
    accepted("show", "found.yaml", "B[1,1]", folder=log)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (IDENTIFY[:3], "log.csv:1:1: no column tau1, tau2, tau3, tau4, tau5, tau6; its"),
        ((*IDENTIFY[:4], "effort"), "'effort' in --columns; allowed: q=...*,"),
        ((*IDENTIFY, "--held-out", "other.csv"), "no file 'other.csv'"),
    ],
)
def test_what_is_wrong_is_one_message(arguments: tuple[str, ...], message: str, log: Path) -> None:
    assert message in refused(*arguments, "-o", "found.yaml", folder=log).stderr
    assert not (log / "found.yaml").exists()


pytest.importorskip("xarray")
MAP = ("map", "planar.yaml", "-o", "reach.zarr")


def test_a_map_is_reported_and_resumed(tmp_path: Path) -> None:
    (tmp_path / "planar.yaml").write_text(PLANAR)
    done = derive(*MAP, "--grid", "0.1", folder=tmp_path)
    assert done.status == 0
    assert done.stdout.startswith("reach.zarr: 324 cells, 324 poses\nreached: ")
    assert done.stdout.endswith("without limits: q1, full turns\n")
    again = derive(*MAP, "--grid", "0.1", "--resume", "--json", folder=tmp_path)
    report = json.loads(again.stdout)
    assert (report["computed"], report["path"], report["cells"]) == (0, "reach.zarr", 324)
    refused = derive(*MAP, folder=tmp_path)
    assert "reach.zarr exists already; choose another name, remove it, or go on with it by --resume" in refused.stderr


def test_an_interrupt_says_how_to_go_on(tmp_path: Path) -> None:
    (tmp_path / "planar.yaml").write_text(PLANAR)
    with mock.patch.object(maps, "computed", side_effect=KeyboardInterrupt):
        done = derive(*MAP, "--grid", "0.1", folder=tmp_path)
    assert done.status == 130
    assert "finished blocks are kept; go on with: --resume -o reach.zarr" in done.stderr


def test_a_table_and_the_same_numbers_as_data(tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text(PLANAR.replace("-pi/2, pi/2", "0, 1"))
    name = "manipulability_position"
    asked = ("sample", "arm.yaml", name, "--over", "grid", "--number", "1e4", "--reduce", "max,quantiles")
    done = accepted(*asked, folder=tmp_path)
    assert done.stderr == "derive: warning: no limits of q1: full turns\n"
    rows = [line.split() for line in done.stdout.splitlines()]
    assert rows[0] == ["10000", "configurations", "max", "1%", "5%", "25%", "50%", "75%", "95%", "99%"]
    assert (rows[1][:2], len(rows)) == ([name, "0.168294"], 2)  # 0.2 sin 1
    found = json.loads(accepted(*asked, "--json", folder=tmp_path).stdout)[name]
    assert (found["number"], found["lacking"], found["where"]["max"]["q"][1]) == (10000, 0, 1.0)
    assert sample.DESCRIPTION.startswith("Print")
