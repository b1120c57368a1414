"""`derive map`: its report, as lines and as data, what it refuses, and how an interrupted one goes on."""

import json
from pathlib import Path
from unittest import mock

import pytest

from derive.sampling import maps
from tests.cli.command import derive

pytest.importorskip("xarray")
ROBOT = """\
name: planar
convention: standard
joints:
  - {type: revolute, a: 0.5}
  - {type: revolute, a: 0.4, limits: [-pi/2, pi/2]}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "planar.yaml").write_text(ROBOT)
    return tmp_path


COMMAND = ("map", "planar.yaml", "-o", "reach.zarr")


def test_a_map_is_reported_and_resumed(folder: Path) -> None:
    done = derive(*COMMAND, "--grid", "0.1", folder=folder)
    assert done.status == 0
    assert done.stdout.startswith("reach.zarr: 324 cells, 324 poses\nreached: ")
    assert done.stdout.endswith("without limits: q1, full turns\n")
    again = derive(*COMMAND, "--grid", "0.1", "--resume", "--json", folder=folder)
    report = json.loads(again.stdout)
    assert (report["computed"], report["path"], report["cells"]) == (0, "reach.zarr", 324)
    refused = derive(*COMMAND, folder=folder)
    assert "reach.zarr exists already; choose another name, remove it, or go on with it by --resume" in refused.stderr


def test_an_interrupt_says_how_to_go_on(folder: Path) -> None:
    with mock.patch.object(maps, "computed", side_effect=KeyboardInterrupt):
        done = derive(*COMMAND, "--grid", "0.1", folder=folder)
    assert done.status == 130
    assert "finished blocks are kept; go on with: --resume -o reach.zarr" in done.stderr


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--grid", "-1"], "a grid of -1 m; allowed: the side of a cell in metres, above zero"),
        (["--orientations", "0"], "'0' is not a whole number from 1"),
        (["--box", "0,x"], "'0,x' is not a list of numbers such as 0.2,0.6"),
        (["--box", "0,1"], "the box 0, 1 is not one that the arm reaches; allowed: x0,x1,y0,y1 within x from"),
        (["--grid", "1e-5"], "a map of 3.24e+10 poses: up to 292 GB and about 9 h of one core; allowed: 1e+10 unasked"),
        (["--workers", "2", "--scheduler", "tcp://127.0.0.1:9"], "--workers with --scheduler"),
        (["--plot", "a.txt"], "has the ending of another kind of file"),
    ],
)
def test_what_is_wrong_is_one_line(folder: Path, options: list[str], said: str) -> None:
    done = derive(*COMMAND, *options, folder=folder)
    assert done.status == 2
    assert said in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (folder / "reach.zarr").exists()
