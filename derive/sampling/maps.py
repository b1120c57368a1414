"""Maps of the workspace: what the postures of a block's poses are worth, and all blocks as a data set or in a store.

The data set of xarray is lazy; a Zarr store is filled block by block and never holds half a block.
"""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.arrays import Array
from derive.errors import OutputError, QuantityError, listed
from derive.inverse.numeric.chain import NumericChain
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import Inverse, InverseSearch, Program
from derive.publish.atomic_folder import system_errors
from derive.publish.modules import loaded
from derive.robot.robot import Robot
from derive.robot.task_rows import task_rows
from derive.sampling.clusters import Cluster, Tell, data_module
from derive.sampling.grid import MapGrid
from derive.targets.target import Source
from derive.version import __version__
from derive.workspace.point import TURN, Range

_MARGIN = (
    "the least over the joints with limits of the distance to the nearer limit in parts of half the range, full turns "
    "chosen best (0 at a limit, 1 in the middle of all ranges and where no joint has limits)"
)
_CONDITION = "the smallest by the largest singular value of J of the task, lengths in parts of the reach"
VALUES = {
    "postures": ("1", "postures within the joint limits, counted modulo full turns"),
    "manipulability": ("", "largest sqrt(det(J J^T)) of the postures, J of the task"),
    "margin": ("1", f"largest margin to the limits of the postures: {_MARGIN}"),
    "conditioning": ("1", f"largest of the postures: {_CONDITION}"),
}
"""What a map has, in this order, with units and words; the first are whole numbers, the last is there on request."""

_AT_ONCE = 2048  # poses that are solved at once: their postures fit into the caches of a core
_ROUNDING = 1e-9  # by which a joint may be beyond a limit [rad or m]
_NAMES = frozenset({"manipulability", "jacobian"})
_one_at_a_time = Lock()  # threads that need the same library do not compile it twice
_LAST = "postures"  # written last of a block, whose chunk of it says that all of the block is there
_SHARE = "reachability"  # per cell
_SHARED = {"units": "1", "long_name": "share of the orientations in which the cell's centre is reached"}
_NEEDED = "maps"


def value_type(grid: MapGrid) -> dict[str, str]:
    """Names and types of the values of a cell and orientation."""
    names = (name for name in VALUES if name != "conditioning" or grid.conditioning)
    return {name: "u1" if name == "postures" else "f4" for name in names}


@dataclass(frozen=True, eq=False)
class MapFunctions:
    """The functions of an arm in this process, and its limits."""

    module: Any  # `model_native` or `model_numpy`
    folder: Any  # which holds the module as long as this is kept
    branches: int  # of the inverse kinematics
    per_turn: Array  # (n,) full turns per unit of a joint variable: zero for slides
    middle: Array  # (n,) middle of the limits; zero without
    per_half: Array  # (n,) one by half of the way between the limits; zero without
    rows: tuple[int, ...]  # of the Jacobian, those of the task
    units: Array  # (rows, 1) what these rows are measured in: the reach [m], or 1

    def values(self, goals: Array, *, conditioning: bool = False) -> tuple[Array, ...]:
        """The values of poses (k, 4, 4), in the order of `VALUES`."""
        # Poses lie along the last axis in memory, along which processors work side by side.
        q = np.empty((self.branches, len(self.middle), len(goals)))
        by_pose = q.transpose(2, 0, 1)
        self.module.inverse_kinematics(goals, out=by_pose)
        used = q - self.middle[:, None]
        used -= TURN * np.rint(used * self.per_turn[:, None])
        np.abs(used, out=used)
        used *= self.per_half[:, None]
        worst = used.max(axis=1)
        within = worst <= 1.0  # not where branches do not exist: they are no numbers
        best = np.empty(within.shape)
        self.module.manipulability(by_pose, out=best.T)
        found = [np.where(within, best, -np.inf).max(axis=0), 1.0 - np.where(within, worst, np.inf).min(axis=0)]
        if conditioning:
            jacobians = self.module.jacobian(by_pose.transpose(1, 0, 2)[within])[:, self.rows] / self.units
            singular, ratio = np.linalg.svd(jacobians, compute_uv=False), np.full(within.shape, -np.inf)
            ratio[within] = singular[:, -1] / singular[:, 0]
            found.append(ratio.max(axis=0))
        count = within.sum(axis=0, dtype=np.uint8)
        return count, *(np.where(count > 0, value, np.nan) for value in found)


def functions_of(grid: MapGrid) -> MapFunctions:
    """What computes a map here; compiled where there is a compiler."""
    with _one_at_a_time:
        return _functions_of(replace(grid.robot, title="", digest="", source="", remarks=()), grid.ranges)


@lru_cache(8)
def _functions_of(robot: Robot, ranges: tuple[Range, ...]) -> MapFunctions:
    program = build_program(robot, Effort.QUICK, names=_NAMES, inverse=True)
    branches = _solver(robot, program).branches
    module, folder = loaded(Source(robot, program, __version__), compiled=True)
    limits = np.array([(-np.inf, np.inf) if way.assumed and way.revolute else (way.lower, way.upper) for way in ranges])
    is_limited = np.isfinite(limits).all(axis=-1)
    low, high = np.where(is_limited[:, None], limits, 0.0).T
    turning = np.array([way.revolute for way in ranges])
    per_half = np.where(is_limited, 1.0 / ((high - low) / 2.0 + _ROUNDING), 0.0)
    rows, reach = task_rows(robot), NumericChain.of(robot).reach
    units = np.array([[reach if row < 3 else 1.0] for row in rows])
    return MapFunctions(module, folder, branches, turning / TURN, (low + high) / 2.0, per_half, rows, units)


def _solver(robot: Robot, program: Program) -> Inverse | InverseSearch:
    """What finds all solutions; arms are refused of which not all are found, or that have infinitely many."""
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
    return solver


def computed(block_id: tuple[int, ...], grid: MapGrid) -> npt.NDArray[Any]:
    """The values of a block, (cells..., orientations...) records; ``block_id`` may go on as that of a Dask array."""
    functions, turns, kinds = functions_of(grid), grid.orientations.rotations, value_type(grid)
    middles, is_near = grid.cells(block_id[: len(grid.axes)])
    found = np.zeros((*is_near.shape, len(turns)), dtype=[*kinds.items()])
    for name in [*kinds][1:]:
        found[name] = np.nan
    places, per = np.argwhere(is_near), max(1, _AT_ONCE // len(turns))
    axes = ["xyz".index(name) for name in grid.axes]
    for start in range(0, len(places), per):
        some = tuple(places[start : start + per].T)
        goals = np.zeros((len(some[0]), len(turns), 4, 4))
        goals[..., :3, :3], goals[..., 3, 3] = turns, 1.0
        goals[:, :, axes, 3] = middles[some][:, None]
        values = functions.values(goals.reshape(-1, 4, 4), conditioning=grid.conditioning)
        for name, value in zip(kinds, values, strict=True):
            found[name][some] = value.reshape(len(goals), len(turns))
    return found.reshape(*is_near.shape, *grid.orientations.sizes.values())


def map_dataset(grid: MapGrid) -> Any:
    """The map as an `xarray.Dataset` of lazy Dask arrays, one chunk for each block."""
    arrays, xarray = data_module("dask.array", _NEEDED), data_module("xarray", _NEEDED)
    sizes, kinds = grid.orientations.sizes, value_type(grid)
    turns = tuple(sizes.values())
    chunks = arrays.core.normalize_chunks((*grid.block_shape, *turns), (*grid.shape, *turns))
    empty = np.empty((0,) * len(chunks), [*kinds.items()])
    records = arrays.map_blocks(computed, grid=grid, chunks=chunks, dtype=empty.dtype, meta=empty)
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
        grid, key_of = self.grid, self._open()[_LAST].metadata.encode_chunk_key
        names = sorted((*value_type(grid), _SHARE), key=lambda name: name == _LAST)
        keys = {block: key_of((*block, *[0] * len(grid.orientations.sizes))) for block in grid.blocks}
        blocks = [block for block, key in keys.items() if not Path(self.path, _LAST, key).exists()][::every]
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
