"""A map as a lazy data set of xarray, and as a Zarr store that is filled block by block and never half a block."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.errors import OutputError, listed
from derive.publish.atomic_folder import system_errors
from derive.sampling.clusters import Cluster, Tell, data_module
from derive.sampling.grid import MapGrid
from derive.sampling.reach import VALUES, computed, functions_of, value_type
from derive.version import __version__

_LAST = "postures"  # written last of a block, whose chunk of it says that all of the block is there
_SHARE = "reachability"  # per cell
_SHARED = {"units": "1", "long_name": "share of the orientations in which the cell's centre is reached"}
_NEEDED = "maps"


def map_dataset(grid: MapGrid) -> Any:
    """The map as an `xarray.Dataset` of lazy Dask arrays, one chunk for each block."""
    arrays, xarray = data_module("dask.array", _NEEDED), data_module("xarray", _NEEDED)
    sizes, kinds = grid.orientations.sizes, value_type(grid)
    sides = zip(grid.block_shape, grid.shape, strict=True)
    chunks = [(side,) * (count // side) + (count % side,) * (count % side > 0) for side, count in sides]
    chunks += [(size,) for size in sizes.values()]
    empty = np.empty((0,) * len(chunks), [*kinds.items()])
    records = arrays.map_blocks(computed, grid=grid, chunks=tuple(chunks), dtype=empty.dtype, meta=empty)
    lengths = len(grid.axes) - sum(not way.revolute for way in grid.ranges)  # rows of J in metres, columns by metres
    volume = f"m^{lengths}" if lengths else "1"
    told = {name: {"units": VALUES[name][0] or volume, "long_name": VALUES[name][1]} for name in kinds}
    variables = {name: ((*grid.axes, *sizes), records[name], words) for name, words in told.items()}
    variables[_SHARE] = (grid.axes, share_of(records, grid), _SHARED)
    along = {name: (name, values, {"units": "m"}) for name, values in zip(grid.axes, grid.centres, strict=True)}
    turned = {
        name: (dimension, values, {"units": "rad" if name == dimension else "1"})
        for name, (dimension, values) in grid.orientations.coordinates.items()
    }
    return xarray.Dataset(variables, along | turned, attributes(grid))


def attributes(grid: MapGrid) -> dict[str, Any]:
    """What tells one map from another: the robot file, what was asked, and what answered."""
    robot, solver = grid.robot, functions_of(grid)
    limits = ("none" if way.assumed and way.revolute else way.interval for way in grid.ranges)
    return {
        "robot": robot.name,
        "robot_file_sha256": robot.digest,
        "task": listed(robot.inverse.task),
        "joint_limits": "; ".join(f"{way.variable}: {text}" for way, text in zip(grid.ranges, limits, strict=True)),
        "values": listed(value_type(grid)),
        "cell_m": grid.step,
        "first_cell": list(grid.first),
        "cells": list(grid.shape),
        "orientations": dict(grid.orientations.sizes),
        "inverse_kinematics": f"{Path(solver.module.__file__).stem}, up to {solver.branches} postures",
        "derive_version": __version__,
    }


class MapStore:
    """A Zarr store that holds a map, or the finished blocks of one."""

    def __init__(self, path: Path, grid: MapGrid) -> None:
        self.path, self.grid, self.zarr = path, grid, data_module("zarr", _NEEDED)

    def begin(self, *, resume: bool) -> None:
        """Make a store without blocks, or find one of the same map, of which interrupted writes are removed."""
        if not os.path.lexists(self.path):
            self._create()
        elif not resume:
            remedy = "choose another name, remove it, or go on with it by --resume"
            raise OutputError(f"{self.path} exists already", remedy=remedy)
        remedy = "choose another name, or leave out what differs"
        try:
            there = self._open().attrs
        except (OSError, ValueError) as error:
            raise OutputError(f"{self.path} is not the store of a map", remedy=remedy) from error
        if differing := [name for name, value in attributes(self.grid).items() if there.get(name) != value]:
            raise OutputError(f"{self.path} is the store of another map: {listed(differing)} differ", remedy=remedy)
        for file in self.path.rglob("*.partial"):
            file.unlink()

    def _create(self) -> None:
        nothing = {name: {"fill_value": 0 if kind == "u1" else np.nan} for name, kind in value_type(self.grid).items()}
        nothing[_SHARE] = {"fill_value": 0.0}
        whole, folder = map_dataset(self.grid), self.path.parent
        with system_errors(self.path, "choose another place"):
            folder.mkdir(parents=True, exist_ok=True)
            with TemporaryDirectory(prefix=".derive-", dir=folder) as staging:
                made = Path(staging, self.path.name)
                with warnings.catch_warnings():  # other readers than Zarr's may not know consolidated metadata
                    warnings.simplefilter("ignore", UserWarning)
                    whole.to_zarr(made, compute=False, zarr_format=3, encoding=nothing)
                made.rename(self.path)

    def _open(self) -> Any:
        return self.zarr.open_group(self.path, mode="r+")

    def fill(self, workers: Cluster, tell: Tell | None = None, every: int = 1) -> int:
        """Compute and write the blocks that are missing, or every so many-th of them; how many there were."""
        group, grid = self._open(), self.grid
        names = sorted((*value_type(grid), _SHARE), key=lambda name: name == _LAST)
        last, further = group[_LAST], (0,) * len(grid.orientations.sizes)

        def _is_there(block: tuple[int, ...]) -> bool:
            return Path(self.path, _LAST, last.metadata.encode_chunk_key((*block, *further))).exists()

        blocks = [block for block in grid.blocks if not _is_there(block)][::every]
        done = workers.in_order(computed, blocks, workers.shared(grid), what=f"map of {grid.robot.name}", tell=tell)
        # A chunk exists once it is written, whatever is in it.
        with self.zarr.config.set({"array.write_empty_chunks": True}):
            arrays = {name: self.zarr.open_array(self.path / name, mode="r+") for name in names}
            for block, records in zip(blocks, done, strict=True):
                with system_errors(self.path, "make room and go on with --resume; finished blocks are kept"):
                    for name in names:
                        arrays[name][grid.slices(block)] = share_of(records, grid) if name == _SHARE else records[name]
        return len(blocks)

    def shares(self) -> npt.NDArray[np.float32]:
        """Of each cell the share of orientations that are reached."""
        return np.asarray(self._open()[_SHARE][...])


def share_of(records: Any, grid: MapGrid) -> Any:
    """Of each cell of records, NumPy's or Dask's, the share of orientations that are reached."""
    turns = tuple(range(len(grid.axes), records.ndim))
    return (records[_LAST] > 0).mean(axis=turns, dtype=np.float64).astype(np.float32)
