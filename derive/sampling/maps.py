"""Maps of the workspace: what the postures of a block's poses are worth, and all blocks as a data set or in a store.

The data set of xarray is lazy; a Zarr store is filled block by block and never holds half a block.
"""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.arrays import Array
from derive.errors import OutputError, QuantityError, listed
from derive.inverse.numeric.chain import NumericChain
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import InverseSearch
from derive.publish.atomic_folder import system_errors
from derive.publish.modules import ModuleSources, imported, serving_sources
from derive.robot.task_rows import task_rows
from derive.sampling.clusters import Cluster, Tell, data_module
from derive.sampling.grid import MapGrid
from derive.targets.target import Source
from derive.version import __version__
from derive.workspace.point import TURN

VALUES = {
    "postures": ("1", "postures within the joint limits, counted modulo full turns"),
    "manipulability": ("", "largest sqrt(det(J J^T)) of the postures, J of the task"),
    "margin": (
        "1",
        "largest margin to the limits of the postures: the least over the joints with limits of the distance to the "
        "nearer limit in parts of half the range, full turns chosen best (0 at a limit, 1 in the middle of all ranges "
        "and where no joint has limits)",
    ),
    "conditioning": (
        "1",
        "largest of the postures: the smallest by the largest singular value of J of the task, lengths in parts of the "
        "reach",
    ),
}
"""What a map has, in this order, with units and words; the first are whole numbers, the last is there on request."""

_AT_ONCE = 2048  # poses that are solved at once: their postures fit into the caches of a core
_ROUNDING = 1e-9  # by which a joint may be beyond a limit [rad or m]
_LAST = "postures"  # written last of a block, whose chunk of it says that all of the block is there
_SHARE = "reachability"  # per cell
_SHARED = {"units": "1", "long_name": "share of the orientations in which the cell's centre is reached"}
_NEEDED = "maps"


def value_type(grid: MapGrid) -> dict[str, str]:
    """Names and types of the values of a cell and orientation."""
    names = (name for name in VALUES if name != "conditioning" or grid.conditioning)
    return {name: "u1" if name == "postures" else "f4" for name in names}


@dataclass(frozen=True, eq=False)
class MapWork:
    """All that a block needs besides its place; every worker has it once."""

    grid: MapGrid
    sources: ModuleSources
    branches: int  # of the inverse kinematics

    @classmethod
    def of(cls, grid: MapGrid) -> MapWork:
        """That of a grid; arms are refused of which not all postures are found, or that have infinitely many."""
        robot = grid.robot
        program = build_program(robot, Effort.QUICK, names={"manipulability", "jacobian"}, inverse=True)
        solver = program.inverse or program.search
        if solver is None:
            raise QuantityError(f"a map of {robot.name}: {program.without_inverse}")
        if solver.given:
            found = f"a map of {robot.name}, which has more joints than its task {listed(robot.inverse.task)} needs"
            remedy = "write a larger task: into the block inverse: of the robot file, or a table in which a joint rests"
            raise QuantityError(found, allowed="allowed: as many coordinates as joints", remedy=remedy)
        if isinstance(solver, InverseSearch) and not solver.eliminations:
            found = f"a map of {robot.name}, whose inverse kinematics has no way to all solutions"
            raise QuantityError(found, allowed="allowed: arms with formulas, or with solutions by eigenvalues")
        return cls(grid, serving_sources(Source(robot, program, __version__)), solver.branches)

    @cached_property
    def joint_units(self) -> tuple[Array, Array, Array]:
        """(n, 1) each: full turns per unit, middle of the limits, one by half of their distance; zero for none."""
        ways = self.grid.ranges
        low, high = np.array([[way.lower, way.upper] for way in ways]).T
        limited = np.array([not (way.assumed and way.revolute) for way in ways])
        turns = np.array([way.revolute for way in ways]) / TURN
        units = turns, limited * (low + high) / 2.0, limited / ((high - low) / 2.0 + _ROUNDING)
        return units[0][:, None], units[1][:, None], units[2][:, None]

    @cached_property
    def row_units(self) -> Array:
        """What the rows of the Jacobian of the task are measured in, (rows, 1): the reach [m], or 1."""
        reach = NumericChain.of(self.grid.robot).reach
        return np.array([[reach if row < 3 else 1.0] for row in task_rows(self.grid.robot)])

    def values(self, goals: Array) -> tuple[Array, ...]:
        """The values of poses (k, 4, 4), in the order of `VALUES`."""
        module, _folder = imported(self.sources)
        per_turn, middle, per_half = self.joint_units
        # Poses lie along the last axis in memory, along which processors work side by side.
        q = np.empty((self.branches, len(middle), len(goals)))
        by_pose = q.transpose(2, 0, 1)
        module.inverse_kinematics(goals, out=by_pose)
        used = q - middle
        used -= TURN * np.rint(used * per_turn)
        np.abs(used, out=used)
        used *= per_half
        worst = used.max(axis=1)
        within = worst <= 1.0  # not where branches do not exist: they are no numbers
        best = np.empty(within.shape)
        module.manipulability(by_pose, out=best.T)
        found = [np.where(within, best, -np.inf).max(axis=0), 1.0 - np.where(within, worst, np.inf).min(axis=0)]
        if self.grid.conditioning:
            jacobians = module.jacobian(by_pose.transpose(1, 0, 2)[within])[:, task_rows(self.grid.robot)]
            singular, ratio = (
                np.linalg.svd(jacobians / self.row_units, compute_uv=False),
                np.full(within.shape, -np.inf),
            )
            ratio[within] = singular[:, -1] / singular[:, 0]
            found.append(ratio.max(axis=0))
        count = within.sum(axis=0, dtype=np.uint8)
        return count, *(np.where(count > 0, value, np.nan) for value in found)


def computed(block_id: tuple[int, ...], work: MapWork) -> npt.NDArray[Any]:
    """The values of a block, (cells..., orientations...) records; ``block_id`` may go on as that of a Dask array."""
    grid, turns, kinds = work.grid, work.grid.orientations.rotations, value_type(work.grid)
    middles, is_near = grid.cells(block_id[: len(grid.axes)])
    nothing = np.array((0, *[np.nan] * (len(kinds) - 1)), dtype=[*kinds.items()])
    found = np.full((*is_near.shape, len(turns)), nothing)
    places, per = np.argwhere(is_near), max(1, _AT_ONCE // len(turns))
    axes = ["xyz".index(name) for name in grid.axes]
    for start in range(0, len(places), per):
        some = tuple(places[start : start + per].T)
        goals = np.zeros((len(some[0]), len(turns), 4, 4))
        goals[..., :3, :3], goals[..., 3, 3] = turns, 1.0
        goals[:, :, axes, 3] = middles[some][:, None]
        for name, value in zip(kinds, work.values(goals.reshape(-1, 4, 4)), strict=True):
            found[name][some] = value.reshape(len(goals), len(turns))
    return found.reshape(*is_near.shape, *grid.orientations.sizes.values())


def map_dataset(work: MapWork) -> Any:
    """The map as an `xarray.Dataset` of lazy Dask arrays, one chunk for each block."""
    arrays, xarray = data_module("dask.array", _NEEDED), data_module("xarray", _NEEDED)
    grid, sizes, kinds = work.grid, work.grid.orientations.sizes, value_type(work.grid)
    turns = tuple(sizes.values())
    chunks = arrays.core.normalize_chunks((*grid.block_shape, *turns), (*grid.shape, *turns))
    empty = np.empty((0,) * len(chunks), [*kinds.items()])
    records = arrays.map_blocks(computed, work=work, chunks=chunks, dtype=empty.dtype, meta=empty)
    lengths = len(grid.axes) - sum(not way.revolute for way in grid.ranges)  # rows of J in metres, columns by metres
    volume = f"m^{lengths}" if lengths else "1"
    told = {name: {"units": VALUES[name][0] or volume, "long_name": VALUES[name][1]} for name in kinds}
    variables = {name: ((*grid.axes, *sizes), records[name], words) for name, words in told.items()}
    variables[_SHARE] = (grid.axes, share_of(records, grid), _SHARED)
    along = {name: (name, values, {"units": "m"}) for name, values in zip(grid.axes, grid.centres, strict=True)}
    return xarray.Dataset(variables, along | grid.orientations.coordinates, attributes(work))


def attributes(work: MapWork) -> dict[str, Any]:
    """What tells one map from another: the robot file, what was asked, and what answered."""
    grid, robot = work.grid, work.grid.robot
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
        "inverse_kinematics": f"{Path(work.sources.files[-1][0]).stem}, up to {work.branches} postures",
        "derive_version": __version__,
    }


def begin_store(path: Path, work: MapWork) -> None:
    """Make a store without blocks, or find one of the same map, of which interrupted writes are removed."""
    if not os.path.lexists(path):
        whole, kinds = map_dataset(work), value_type(work.grid)
        fills = {name: {"fill_value": 0 if kind == "u1" else np.nan} for name, kind in kinds.items()}
        with system_errors(path, "choose another place"):
            path.parent.mkdir(parents=True, exist_ok=True)
            with TemporaryDirectory(prefix=".derive-", dir=path.parent) as staging, warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)  # other readers may not know consolidated metadata
                encoding = fills | {_SHARE: {"fill_value": 0.0}}
                whole.to_zarr(made := Path(staging, path.name), compute=False, zarr_format=3, encoding=encoding)
                made.rename(path)
    remedy = "choose another name, or leave out what differs"
    try:
        there = data_module("zarr", _NEEDED).open_group(path, mode="r").attrs
    except (OSError, ValueError) as error:
        raise OutputError(f"{path} is not the store of a map", remedy=remedy) from error
    if differing := [name for name, value in attributes(work).items() if there.get(name) != value]:
        raise OutputError(f"{path} is the store of another map: {listed(differing)} differ", remedy=remedy)
    for file in path.rglob("*.partial"):
        file.unlink()


def fill_store(path: Path, work: MapWork, workers: Cluster, tell: Tell | None = None, every: int = 1) -> int:
    """Compute and write the blocks that are missing, or every so many-th of them; how many there were."""
    grid, zarr = work.grid, data_module("zarr", _NEEDED)
    names = [*[*value_type(grid)][1:], _SHARE, _LAST]
    with zarr.config.set({"array.write_empty_chunks": True}):  # a chunk exists once it is written, whatever is in it
        arrays = {name: zarr.open_array(path / name, mode="r+") for name in names}
        key_of, turns = arrays[_LAST].metadata.encode_chunk_key, [0] * len(grid.orientations.sizes)
        blocks = [each for each in grid.blocks if not (path / _LAST / key_of((*each, *turns))).exists()][::every]
        done = workers.in_order(computed, blocks, workers.shared(work), what=f"map of {grid.robot.name}", tell=tell)
        for block, records in zip(blocks, done, strict=True):
            with system_errors(path, "make room and go on with --resume; finished blocks are kept"):
                for name in names:
                    arrays[name][grid.slices(block)] = share_of(records, grid) if name == _SHARE else records[name]
    return len(blocks)


def stored_shares(path: Path) -> npt.NDArray[np.float32]:
    """Of each cell the share of orientations that are reached."""
    return np.asarray(data_module("zarr", _NEEDED).open_array(path / _SHARE, mode="r")[...])


def share_of(records: Any, grid: MapGrid) -> Any:
    """Of each cell of records, NumPy's or Dask's, the share of orientations that are reached."""
    turns = tuple(range(len(grid.axes), records.ndim))
    return (records[_LAST] > 0).mean(axis=turns, dtype=np.float64).astype(np.float32)
