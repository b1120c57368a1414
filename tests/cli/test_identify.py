"""``derive identify``: files, tables, JSON, and one message for what is wrong."""

import json
from pathlib import Path

import pytest

from tests.cli.command import accepted, refused
from tests.identification.logs import REAL, simulated

pa = pytest.importorskip("pyarrow")
pytest.importorskip("pyarrow.csv")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    columns = simulated(REAL, 800)[0]
    named = {f"effort_{name[3:]}" if name.startswith("tau") else name: values for name, values in columns.items()}
    pa.csv.write_csv(pa.table(named), tmp_path / "log.csv")
    return tmp_path


COMMAND = ("identify", "puma560-corke", "log.csv", "--columns", "tau=effort_*")


def test_what_was_found_is_printed_and_written(folder: Path) -> None:
    printed = accepted(*COMMAND, "-o", "found.yaml", "--report", "page.html", "--held-out", "0.2", folder=folder).stdout
    lines = printed.splitlines()
    assert lines[0] == "found.yaml: 640 rows, wls"
    assert lines[1].split() == ["joint", "torque", "RMS", "residual", "before", "residual", "held", "out"]
    assert lines[8].split() == ["parameter", "value", "+-", "95", "%", "prior"]
    assert [line.split()[0] for line in lines[9:12]] == ["Izz1", "b1", "f1"]
    assert (folder / "page.html").is_file()
    assert "wls, 800 rows; residuals by joint" in accepted(*COMMAND, folder=folder).stdout
    found = json.loads(accepted(*COMMAND, "--json", "--method", "ols", "--add", "none", folder=folder).stdout)
    assert (found["method"], found["rows"], len(found["values"]), found["held_out"]) == ("ols", 800, 46, None)
    accepted("build", "found.yaml", "--effort", "quick", "--only", "--target", "numpy", folder=folder)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (COMMAND[:3], "log.csv:1:1: no column tau1, tau2, tau3, tau4, tau5, tau6; its"),
        ((*COMMAND[:4], "effort"), "'effort' in --columns; allowed: q=...*,"),
        ((*COMMAND, "--held-out", "other.csv"), "no file 'other.csv'"),
    ],
)
def test_what_is_wrong_is_one_message(arguments: tuple[str, ...], message: str, folder: Path) -> None:
    assert message in refused(*arguments, "-o", "found.yaml", folder=folder).stderr
    assert not (folder / "found.yaml").exists()
