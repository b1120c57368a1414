"""A map as a lazy data set of xarray, and as a Zarr store that is filled block by block and never half a block."""

from __future__ import annotations

import os
import secrets
import shutil
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.errors import OutputError, listed
from derive.publish.atomic_folder import system_errors
from derive.sampling.clusters import Cluster, Tell, data_module
from derive.sampling.grid import MapGrid
from derive.sampling.reach import VALUES, computed, functions_of, value_names, value_type
from derive.version import __version__

_LAST = "postures"  # written last of a block, whose chunk of it says that all of the block is there
_SHARE = "reachability"  # per cell
_WORDS = "share of the orientations in which the cell's centre is reached"
_NEEDED = "maps"


def map_dataset(grid: MapGrid) -> Any:
    """The map as an `xarray.Dataset` of lazy Dask arrays, one chunk for each block."""
    arrays, xarray = data_module("dask.array", _NEEDED), data_module("xarray", _NEEDED)
    sizes = grid.orientations.sizes
    names = (*grid.axes, *sizes)
    sides = zip(grid.block_shape, grid.shape, strict=True)
    chunks = [(side,) * (count // side) + (count % side,) * (count % side > 0) for side, count in sides]
    kind = value_type(grid)
    records = arrays.map_blocks(
        _block,
        grid=grid,
        chunks=(*chunks, *((size,) for size in sizes.values())),
        dtype=kind,
        meta=np.empty((0,) * len(names), kind),
    )
    lengths = len(grid.axes) - sum(not way.revolute for way in grid.ranges)  # rows of J in metres, columns by metres
    volume = f"m^{lengths}" if lengths else "1"
    variables = {
        name: (names, records[name], {"units": VALUES[name].unit or volume, "long_name": VALUES[name].words})
        for name in value_names(grid)
    }
    variables[_SHARE] = (grid.axes, share_of(records, grid), {"units": "1", "long_name": _WORDS})
    along = {name: (name, values, {"units": "m"}) for name, values in zip(grid.axes, grid.centres, strict=True)}
    turned = {
        name: (dimension, values, {"units": "rad" if name == dimension else "1"})
        for name, (dimension, values) in grid.orientations.coordinates.items()
    }
    return xarray.Dataset(variables, along | turned, attributes(grid))


def _block(grid: MapGrid, block_id: tuple[int, ...] = ()) -> npt.NDArray[Any]:
    return computed(tuple(block_id[: len(grid.axes)]), grid)


def attributes(grid: MapGrid) -> dict[str, Any]:
    """What tells one map from another: the robot file, what was asked, and what answered."""
    robot, solver = grid.robot, functions_of(grid)
    limits = ("none" if way.assumed and way.revolute else way.interval for way in grid.ranges)
    return {
        "title": f"workspace of {robot.name}",
        "robot": robot.name,
        "robot_file_sha256": robot.digest,
        "task": listed(robot.inverse.task),
        "joint_limits": "; ".join(f"{way.variable}: {text}" for way, text in zip(grid.ranges, limits, strict=True)),
        "values": listed(value_names(grid)),
        "cell_m": grid.step,
        "first_cell": list(grid.first),
        "reach_middle_m": grid.extent.middle.round(6).tolist(),
        "reach_radius_m": round(grid.extent.radius, 6),
        "inverse_kinematics": f"{'compiled' if solver.is_compiled else 'NumPy'}, up to {solver.branches} postures",
        "derive_version": __version__,
    }


class MapStore:
    """A Zarr store that holds a map, or the finished blocks of one."""

    def __init__(self, path: Path, grid: MapGrid) -> None:
        self.path, self.grid = path, grid

    def begin(self, *, resume: bool) -> None:
        """Make a store without blocks, or find one of the same map, of which interrupted writes are removed."""
        if not os.path.lexists(self.path):
            self._create()
        elif not resume:
            remedy = "choose another name, remove it, or go on with it by --resume"
            raise OutputError(f"{self.path} exists already", remedy=remedy)
        self._require_same()
        for file in self.path.rglob("*.partial"):
            file.unlink()

    def _create(self) -> None:
        names = (*value_names(self.grid), _SHARE)
        nothing = {name: {"fill_value": VALUES[name].nothing if name in VALUES else 0.0} for name in names}
        staging = self.path.with_name(f".derive-{secrets.token_hex(4)}-{self.path.name}")
        with system_errors(self.path, "choose another place"):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            try:
                with warnings.catch_warnings():  # other readers than Zarr's may not know consolidated metadata
                    warnings.simplefilter("ignore", UserWarning)
                    map_dataset(self.grid).to_zarr(staging, compute=False, zarr_format=3, encoding=nothing)
                staging.rename(self.path)
            finally:
                shutil.rmtree(staging, ignore_errors=True)

    def _require_same(self) -> None:
        """Refuse the store of another robot, grid or set of orientations."""
        remedy = "choose another name, or leave out what differs"
        try:
            there = self._open()
            own = map_dataset(self.grid)
            shapes = {name: there[name].shape for name in (*own.variables,)}
        except (KeyError, OSError, ValueError) as error:
            raise OutputError(f"{self.path} is not the store of this map", remedy=remedy) from error
        differing = [name for name, value in own.attrs.items() if there.attrs.get(name) != value]
        differing += [name for name, shape in shapes.items() if own[name].shape != shape]
        if differing:
            raise OutputError(f"{self.path} is the store of another map: {listed(differing)} differ", remedy=remedy)

    def _open(self) -> Any:
        return data_module("zarr", _NEEDED).open_group(self.path, mode="r+")

    def fill(self, workers: Cluster, tell: Tell | None = None, every: int = 1) -> int:
        """Compute and write the blocks that are missing, or every so many-th of them; how many there were."""
        zarr, group, grid = data_module("zarr", _NEEDED), self._open(), self.grid
        names = sorted((*value_names(grid), _SHARE), key=lambda name: name == _LAST)
        last, further = group[_LAST], (0,) * len(grid.orientations.sizes)

        def _is_there(block: tuple[int, ...]) -> bool:
            return Path(self.path, _LAST, last.metadata.encode_chunk_key((*block, *further))).exists()

        blocks = [block for block in grid.blocks if not _is_there(block)][::every]
        done = workers.in_order(computed, blocks, workers.shared(grid), what=f"map of {grid.robot.name}", tell=tell)
        # A chunk exists once it is written, whatever is in it.
        with zarr.config.set({"array.write_empty_chunks": True}):
            arrays = {name: zarr.open_array(self.path / name, mode="r+") for name in names}
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
    return (records["postures"] > 0).mean(axis=turns, dtype=np.float64).astype(np.float32)
