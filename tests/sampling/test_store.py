"""Stores that were interrupted, killed, made elsewhere or belong to something else, and lazy data sets."""

import itertools
import signal
import subprocess
import sys
import time
from pathlib import Path
from unittest import mock

import numpy as np
import pytest

from derive.api.map import map as lazy_map
from derive.api.map import write_map
from derive.errors import DeriveError
from derive.robot.robot import Robot
from derive.sampling import maps
from tests.places import ROOT
from tests.sampling.numeric_arms import ELBOW, SCARA

xarray = pytest.importorskip("xarray")
ROBOT = SCARA.robot
HOW = {"grid": 0.1, "orientations": 9}


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(maps, "_MOST", 1200)


def contents(store: Path) -> dict[str, bytes]:
    return {str(file.relative_to(store)): file.read_bytes() for file in sorted(store.rglob("*")) if file.is_file()}


@pytest.fixture
def whole(tmp_path: Path) -> dict[str, bytes]:
    written = write_map(ROBOT, tmp_path / "whole.zarr", **HOW)
    assert written.computed == written.blocks > 15
    return contents(written.path)


def test_an_interrupted_map_goes_on_to_the_same_bytes(tmp_path: Path, whole: dict[str, bytes]) -> None:
    path = tmp_path / "part.zarr"
    with pytest.raises(KeyboardInterrupt):
        write_map(ROBOT, path, **HOW, progress=mock.Mock(side_effect=[None] * 6 + [KeyboardInterrupt]))
    (path / "margin" / "c.partial").write_bytes(b"half")
    again = write_map(ROBOT, path, **HOW, resume=True)
    assert again.computed == again.blocks - 7
    assert contents(path) == whole
    assert write_map(ROBOT, path, **HOW, resume=True).computed == 0


KILLED = """
import os, signal, sys
from derive.robot.robot import Robot
from derive.api.map import write_map
from derive.sampling import maps
maps._MOST = 1200
tell = lambda _, text: text.startswith('3') and os.kill(os.getpid(), signal.SIGKILL)
write_map(Robot.from_text(sys.argv[2]), sys.argv[1], grid=0.1, orientations=9, progress=tell)
"""


@pytest.mark.sweep
def test_a_killed_map_goes_on_to_the_same_bytes(tmp_path: Path, whole: dict[str, bytes]) -> None:
    path, text = tmp_path / "killed.zarr", SCARA.text
    done = subprocess.run([sys.executable, "-c", KILLED, str(path), text], cwd=ROOT, timeout=300)
    assert done.returncode == -signal.SIGKILL
    again = write_map(ROBOT, path, **HOW, resume=True)
    assert 0 < again.computed < again.blocks
    assert contents(path) == whole


@pytest.mark.sweep
def test_a_cluster_that_loses_a_worker_makes_the_same_bytes(tmp_path: Path, whole: dict[str, bytes]) -> None:
    distributed = pytest.importorskip("distributed")
    path = tmp_path / "cluster.zarr"
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as local:
        victim, told = local.workers[0], itertools.count(1)

        def _tell(*_: str) -> None:
            if next(told) == 5:
                victim.process.process.kill()

        write_map(ROBOT, path, **HOW, scheduler=local.scheduler_address, progress=_tell)
    assert contents(path) == whole


def test_a_data_set_is_lazy_and_equals_the_store_and_a_box_is_a_part_of_it(tmp_path: Path) -> None:
    since = time.monotonic()
    with pytest.MonkeyPatch.context() as usual:
        usual.setattr(maps, "_MOST", 2**19)
        fine = lazy_map(ROBOT, grid=0.004, orientations=360)
    assert time.monotonic() - since < 30.0  # a thousand times as many poses as can be computed in that time
    assert fine.postures.size > 1e9
    lazy = lazy_map(ROBOT, **HOW, conditioning=True)
    store = write_map(ROBOT, tmp_path / "s.zarr", **HOW, conditioning=True).path
    stored = xarray.open_zarr(store)
    xarray.testing.assert_identical(stored.compute(), lazy.compute()[list(stored.variables)])
    assert stored.postures.dims == ("x", "y", "z", "angle")
    assert stored.manipulability.units == "m^2"
    assert stored.attrs["robot_file_sha256"] == ROBOT.digest
    assert np.allclose(stored.reachability, (stored.postures > 0).mean("angle"))
    box = lazy_map(ROBOT, **HOW, box=(0.2, 0.6, -0.3, 0.3, -0.4, 0.0))
    there = lazy.sel(x=box.x, y=box.y, z=box.z)
    assert box.sizes["x"] == 4
    xarray.testing.assert_equal(box.postures.compute(), there.postures.compute())
    alone = maps.map_dataset(maps.MapGrid.of(ELBOW.robot, 0.2))
    assert alone.postures.dims == ("x", "y", "z")


def test_a_store_of_another_map_is_refused_and_stays(tmp_path: Path, whole: dict[str, bytes]) -> None:
    path = tmp_path / "whole.zarr"
    other = Robot.from_text(SCARA.text.replace("0.4", "0.41"))
    cases: list[tuple[Robot, dict[str, object], str]] = [
        (ROBOT, {"grid": 0.2}, "cell_m, first_cell, cells differ"),
        (ROBOT, {"orientations": 8}, "orientations differ"),
        (ROBOT, {"conditioning": True}, "values differ"),
        (ROBOT, {"box": (-1, 1, 0, 1, -1, 1)}, "first_cell, cells differ"),
        (other, {}, "robot_file_sha256"),
    ]
    for robot, options, said in cases:
        with pytest.raises(DeriveError, match=f"is the store of another map: {said}"):
            write_map(robot, path, **{**HOW, **options}, resume=True)  # type: ignore[arg-type]
    (tmp_path / "folder").mkdir()
    with pytest.raises(DeriveError, match="is not the store of a map"):
        write_map(ROBOT, tmp_path / "folder", **HOW, resume=True)
    assert contents(path) == whole
