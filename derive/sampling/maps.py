"""Maps of the workspace: cells within reach, orientations, and what the postures of their poses are worth.

The data set of xarray is lazy; a Zarr store is filled block by block and never holds half a block.
"""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.arrays import Array, Flags
from derive.errors import DeriveError, OutputError, QuantityError, listed, optional
from derive.inverse.numeric.chain import NumericChain
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import InverseSearch
from derive.publish.atomic_folder import system_errors
from derive.publish.modules import ModuleSources, imported, serving_sources
from derive.robot.options.inverse import POSE, InverseOptions, Task
from derive.robot.robot import Robot
from derive.robot.task_rows import task_rows
from derive.robot.tree import require_chain
from derive.sampling.clusters import Cluster, Tell
from derive.targets.target import Source
from derive.version import __version__
from derive.workspace.point import TURN, Range, joint_ranges
from derive.workspace.poses import RobotPoses

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
_SLACK = 1e-9  # by which a joint may be beyond a limit [rad or m]
_LAST = "postures"  # written last of a block, whose chunk of it says that all of the block is there
_SHARE = "reachability"  # per cell
_SHARED = {"units": "1", "long_name": "share of the orientations in which the cell's centre is reached"}
_ZARR = ("zarr", "maps need zarr", "data")

_MOST = 2**19  # poses of a block: half a second of compiled code, and a few megabytes
_ROUNDING = 1e-6  # parts of a cell by which the arm's box may be in the next one
_GOLDEN = math.pi * (3.0 - math.sqrt(5.0))  # the angle from one direction to the next
_STARTS = 64  # random configurations from which the farthest ones are looked for
_SWEEPS = 200  # most times that every joint is moved to its best place
_SETTLED = 1e-12  # a sweep that gains less than this part of the arm's size squared is the last one
_BEYOND = 1e-9  # by which box and ball are larger than what was found, in parts of the ball
_THIRDS = TURN / 3.0 * np.arange(3.0)
_RADIANS = {"units": "rad"}


# By name the dimension along which values lie, the values, and their unit, as xarray takes them.
Coordinates = dict[str, tuple[str, Array, dict[str, str]]]


def orientations_of(task: Task, count: int, rolls: int) -> tuple[Array, dict[str, int], Coordinates]:
    """Directions of z on a Fibonacci sphere and rolls about it, or angles about the world's z, as a task has them.

    Rotations (m, 3, 3), names and lengths of their dimensions, whose product is m, and what lies along these.
    """
    if "phi" in task:
        angle = TURN / count * np.arange(count, dtype=float)
        return _about_z(angle), {"angle": count}, {"angle": ("angle", angle, _RADIANS)}
    if not {"approach", "orientation"} & set(task):
        return np.eye(3)[None], {}, {}
    places = np.arange(count, dtype=float)
    tilt = _about_z(np.arccos(1.0 - (2.0 * places + 1.0) / count))[:, [1, 2, 0]][:, :, [1, 2, 0]]  # about y
    directed = _about_z(_GOLDEN * places) @ tilt
    known = {f"direction_{name}": ("direction", directed[:, k, 2], {"units": "1"}) for k, name in enumerate("xyz")}
    if "approach" in task:
        return directed, {"direction": count}, known
    roll = TURN / rolls * np.arange(rolls, dtype=float)
    turns = (directed[:, None] @ _about_z(roll)).reshape(-1, 3, 3)
    return turns, {"direction": count, "roll": rolls}, known | {"roll": ("roll", roll, _RADIANS)}


def _about_z(angle: Array) -> Array:
    """Rotations (k, 3, 3) about z."""
    c, s, no = np.cos(angle), np.sin(angle), np.zeros(len(angle))
    return np.stack([c, -s, no, s, c, no, no, no, no + 1.0], axis=-1).reshape(-1, 3, 3)


@dataclass(frozen=True, eq=False)
class MapGrid:
    """The cells of a map, each from k to k + 1 steps along every axis of its task, and the orientations."""

    robot: Robot  # the arm, with the task of the map
    ranges: tuple[Range, ...]  # the way of every joint
    axes: tuple[str, ...]  # the coordinates that the task has, of x, y and z
    step: float  # side of a cell [m]
    first: tuple[int, ...]  # k of the first cell along each axis
    shape: tuple[int, ...]  # how many cells there are along each axis
    block_shape: tuple[int, ...]  # cells of a block along each axis, where no end of the grid cuts it
    middle: Array  # (axes,) of the ball that holds all positions [m]
    radius: float  # of this ball [m]
    rotations: Array  # (m, 3, 3) the orientations in which each cell is tried
    sizes: dict[str, int]  # names and lengths of their dimensions, whose product is m
    coordinates: Coordinates  # what lies along these
    conditioning: bool = False  # whether the condition of the Jacobian is wanted, too

    @classmethod
    def of(
        cls,
        robot: Robot,
        grid: float = 0.05,
        orientations: int = 64,
        rolls: int = 12,
        box: Sequence[float] | None = None,
        *,
        conditioning: bool = False,
    ) -> MapGrid:
        """The grid over what an arm reaches, or a box, with so many directions (or angles) and rolls."""
        if not 0.0 < grid < math.inf:
            raise DeriveError(f"a grid of {grid:g} m", allowed="allowed: the side of a cell in metres, above zero")
        if (least := min(orientations, rolls)) < 1:
            raise DeriveError(f"{least} orientations", allowed="allowed: whole numbers from 1 on")
        require_chain(robot, "the map")
        task = map_task(robot)
        chosen = InverseOptions(task, robot.inverse.given, robot.inverse.location)
        arm = replace(robot, inverse=chosen, links=(), gravity=None, runtime=())
        ranges, axes = joint_ranges(RobotPoses(arm)), tuple(name for name in "xyz" if name in task)
        low, high, radius = extent(NumericChain.of(arm), ranges, ["xyz".index(name) for name in axes])
        middle = (low + high) / 2.0
        if box is not None:
            low, high = _within(low, high, axes, box)
        first = np.floor(low / grid + _ROUNDING).astype(int)
        count = np.maximum(np.ceil(high / grid - _ROUNDING).astype(int) - first, 1)
        turns = orientations_of(task, orientations, rolls)
        most = min(count.max(), (_MOST / len(turns[0])) ** (1.0 / len(axes)))
        sides = np.minimum(count, 2 ** int(math.log2(max(1.0, most))))
        whole = tuple(first.tolist()), tuple(count.tolist()), tuple(sides.tolist())
        return cls(arm, ranges, axes, grid, *whole, middle, radius, *turns, conditioning)

    @property
    def centres(self) -> tuple[Array, ...]:
        """The middles of the cells along each axis [m]."""
        pairs = zip(self.first, self.shape, strict=True)
        return tuple((first + 0.5 + np.arange(count, dtype=float)) * self.step for first, count in pairs)

    def slices(self, block: Sequence[int]) -> tuple[slice, ...]:
        """The cells of a block, which has a place along each axis."""
        sides = zip(block, self.block_shape, self.shape, strict=True)
        return tuple(slice(k * side, min((k + 1) * side, count)) for k, side, count in sides)

    def cells(self, block: Sequence[int]) -> tuple[Array, Flags]:
        """Middles of the cells of a block (..., axes), and whether they are within reach (...)."""
        along = (values[part] for values, part in zip(self.centres, self.slices(block), strict=True))
        middles = np.stack(np.meshgrid(*along, indexing="ij"), axis=-1)
        return middles, np.linalg.norm(middles - self.middle, axis=-1) <= self.radius

    @cached_property
    def blocks(self) -> tuple[tuple[int, ...], ...]:
        """The blocks with a cell within reach."""
        counts = (range(-(-count // side)) for count, side in zip(self.shape, self.block_shape, strict=True))
        return tuple(block for block in product(*counts) if self.cells(block)[1].any())

    @property
    def kinds(self) -> dict[str, str]:
        """Names and types of the values of a cell and orientation."""
        names = (name for name in VALUES if name != "conditioning" or self.conditioning)
        return {name: "u1" if name == "postures" else "f4" for name in names}

    # -- the arm

    @cached_property
    def solver(self) -> tuple[ModuleSources, int]:
        """Its functions, and branches of the inverse kinematics; refused where these are not all that there are."""
        robot = self.robot
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
        return serving_sources(Source(robot, program, __version__)), solver.branches

    @cached_property
    def joint_units(self) -> tuple[Array, Array, Array]:
        """(n, 1) each: full turns per unit, middle of the limits, one by half of their distance; zero for none."""
        low, high = np.array([[way.lower, way.upper] for way in self.ranges]).T
        limited = np.array([not (way.assumed and way.revolute) for way in self.ranges])
        turns = np.array([way.revolute for way in self.ranges]) / TURN
        units = turns, limited * (low + high) / 2.0, limited / ((high - low) / 2.0 + _SLACK)
        return units[0][:, None], units[1][:, None], units[2][:, None]

    @cached_property
    def row_units(self) -> Array:
        """What the rows of the Jacobian of the task are measured in, (rows, 1): the reach [m], or 1."""
        reach = NumericChain.of(self.robot).reach
        return np.array([[reach if row < 3 else 1.0] for row in task_rows(self.robot)])

    def values(self, goals: Array) -> tuple[Array, ...]:
        """The values of poses (k, 4, 4), in the order of `VALUES`."""
        module, _folder = imported(self.solver[0])
        per_turn, middle, per_half = self.joint_units
        # Poses lie along the last axis in memory, along which processors work side by side.
        q = np.empty((self.solver[1], len(middle), len(goals)))
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
        if self.conditioning:
            rows = module.jacobian(by_pose.transpose(1, 0, 2)[within])[:, task_rows(self.robot)] / self.row_units
            singular, ratio = np.linalg.svd(rows, compute_uv=False), np.full(within.shape, -np.inf)
            ratio[within] = singular[:, -1] / singular[:, 0]
            found.append(ratio.max(axis=0))
        count = within.sum(axis=0, dtype=np.uint8)
        return count, *(np.where(count > 0, value, np.nan) for value in found)


def map_task(robot: Robot) -> Task:
    """The task of the file, else all coordinates that the arm moves independently, as its manipulability has them."""
    rows = task_rows(robot)
    words = tuple("xyz"[row] for row in rows if row < 3)
    words += ("phi",) if 5 in rows and 3 not in rows else ("orientation",) if 5 in rows else ()
    task = words if robot.inverse.task == POSE else robot.inverse.task
    if not {"x", "y", "z"} & set(task):
        raise QuantityError(
            f"a map of {robot.name}, whose task {listed(task)} has no position",
            allowed="allowed: a task with x, y or z",
            remedy="write task: into the block inverse: of the robot file",
            location=robot.inverse.location,
        )
    return task


def _within(low: Array, high: Array, axes: Sequence[str], box: Sequence[float]) -> tuple[Array, Array]:
    """Corners of what is in the user's box of that of the arm."""
    if len(box) == 2 * len(axes) and np.isfinite(box).all():
        lower, upper = np.maximum(low, box[::2]), np.minimum(high, box[1::2])
        if (lower < upper).all():
            return lower, upper
    ways = zip(axes, low, high, strict=True)
    allowed = listed(f"{name} from {least:.4g} to {most:.4g} m" for name, least, most in ways)
    found = f"the box {', '.join(f'{value:g}' for value in box)} is not one that the arm reaches"
    ends = ",".join(f"{name}0,{name}1" for name in axes)
    raise DeriveError(found, allowed=f"allowed: {ends} within {allowed}, the lower end first")


def extent(chain: NumericChain, ranges: Sequence[Range], axes: Sequence[int]) -> tuple[Array, Array, float]:
    """Corners of a box and the radius of a ball about its middle [m] that hold all positions along some axes."""
    sides = np.concatenate([np.eye(3)[axes], -np.eye(3)[axes]])
    most = _most(chain, ranges, lambda p: np.sum(p * sides, axis=-1), len(sides))
    high, low = most[: len(axes)], -most[len(axes) :]
    middle = (low + high) / 2.0
    (square,) = _most(chain, ranges, lambda p: np.sum((p[..., axes] - middle) ** 2, axis=-1), 1)
    radius = float(square**0.5)
    room = _BEYOND * (radius or 1.0)
    return low - room, high + room, radius + room


def _most(chain: NumericChain, ranges: Sequence[Range], value: Callable[[Array], Array], groups: int) -> Array:
    """The largest values (groups,) that functions of positions (..., groups, 3) -> (..., groups) take in the ranges.

    One joint after the other goes to its best place: coordinates and squared distances are a + b cos(q) + c sin(q) of
    a joint that turns, and largest at an end of one that slides, whose further place does no harm.
    """
    lower, upper = np.array([[way.lower, way.upper] for way in ranges]).T
    q = np.random.default_rng(0).uniform(lower, upper, (_STARTS, groups, len(ranges)))
    best = np.full(groups, -np.inf)
    for _ in range(_SWEEPS):
        before = best
        for joint, (low, high) in enumerate(zip(lower, upper, strict=True)):
            tried = np.stack([q] * 3)
            tried[..., joint] = _THIRDS[:, None, None]
            samples = value(chain.pose_and_jacobian(tried)[0][..., :3, 3])
            s, c = (np.tensordot(wave(_THIRDS), samples, 1) for wave in (np.sin, np.cos))
            top = low + (np.arctan2(s, c) - low) % TURN
            for one, place in zip(tried, (low, high, np.where(top > high, low, top)), strict=True):
                one[..., joint] = place
            found = value(chain.pose_and_jacobian(tried)[0][..., :3, 3])
            q = np.take_along_axis(tried, found.argmax(axis=0)[None, ..., None], axis=0)[0]
        best = found.max(axis=(0, 1))
        if np.all(best - before <= _SETTLED * max(chain.reach, 1.0) ** 2):
            break
    return best


def computed(block_id: tuple[int, ...], grid: MapGrid) -> npt.NDArray[Any]:
    """The values of a block, (cells..., orientations...) records; ``block_id`` may go on as that of a Dask array."""
    turns, kinds = grid.rotations, grid.kinds
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
        for name, value in zip(kinds, grid.values(goals.reshape(-1, 4, 4)), strict=True):
            found[name][some] = value.reshape(len(goals), len(turns))
    return found.reshape(*is_near.shape, *grid.sizes.values())


def map_dataset(grid: MapGrid) -> Any:
    """The map as an `xarray.Dataset` of lazy Dask arrays, one chunk for each block."""
    arrays = optional("dask.array", "maps need dask", "data")
    xarray = optional("xarray", "maps need xarray", "data")
    sizes, kinds = grid.sizes, grid.kinds
    turns, about = tuple(sizes.values()), attributes(grid)  # the grid goes to the workers with its solver
    chunks = arrays.core.normalize_chunks((*grid.block_shape, *turns), (*grid.shape, *turns))
    empty = np.empty((0,) * len(chunks), [*kinds.items()])
    records = arrays.map_blocks(computed, grid=grid, chunks=chunks, dtype=empty.dtype, meta=empty)
    lengths = len(grid.axes) - sum(not way.revolute for way in grid.ranges)  # rows of J in metres, columns by metres
    volume = f"m^{lengths}" if lengths else "1"
    told = {name: {"units": VALUES[name][0] or volume, "long_name": VALUES[name][1]} for name in kinds}
    variables = {name: ((*grid.axes, *sizes), records[name], words) for name, words in told.items()}
    variables[_SHARE] = (grid.axes, share_of(records, grid), _SHARED)
    along = {name: (name, values, {"units": "m"}) for name, values in zip(grid.axes, grid.centres, strict=True)}
    return xarray.Dataset(variables, along | grid.coordinates, about)


def attributes(grid: MapGrid) -> dict[str, Any]:
    """What tells one map from another: the robot file, what was asked, and what answered."""
    robot, (sources, branches) = grid.robot, grid.solver
    limits = ("none" if way.assumed and way.revolute else way.interval for way in grid.ranges)
    return {
        "robot": robot.name,
        "robot_file_sha256": robot.digest,
        "task": listed(robot.inverse.task),
        "joint_limits": "; ".join(f"{way.variable}: {text}" for way, text in zip(grid.ranges, limits, strict=True)),
        "values": listed(grid.kinds),
        "cell_m": grid.step,
        "first_cell": list(grid.first),
        "cells": list(grid.shape),
        "orientations": dict(grid.sizes),
        "inverse_kinematics": f"{Path(sources.files[-1][0]).stem}, up to {branches} postures",
        "derive_version": __version__,
    }


def begin_store(path: Path, grid: MapGrid) -> None:
    """Make a store without blocks, or find one of the same map, of which interrupted writes are removed."""
    if not os.path.lexists(path):
        whole, kinds = map_dataset(grid), grid.kinds
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
        there = optional(*_ZARR).open_group(path, mode="r").attrs
    except (OSError, ValueError) as error:
        raise OutputError(f"{path} is not the store of a map", remedy=remedy) from error
    if differing := [name for name, value in attributes(grid).items() if there.get(name) != value]:
        raise OutputError(f"{path} is the store of another map: {listed(differing)} differ", remedy=remedy)
    for file in path.rglob("*.partial"):
        file.unlink()


def fill_store(
    path: Path, grid: MapGrid, workers: Cluster, tell: Tell | None = None, every: int = 1
) -> tuple[int, npt.NDArray[np.float32]]:
    """Compute and write missing blocks, or every so many-th; how many there were, and what share each cell has now."""
    zarr = optional(*_ZARR)
    names = [*[*grid.kinds][1:], _SHARE, _LAST]
    with zarr.config.set({"array.write_empty_chunks": True}):  # a chunk exists once it is written, whatever is in it
        arrays = {name: zarr.open_array(path / name, mode="r+") for name in names}
        key_of, turns = arrays[_LAST].metadata.encode_chunk_key, [0] * len(grid.sizes)
        blocks = [each for each in grid.blocks if not (path / _LAST / key_of((*each, *turns))).exists()][::every]
        done = workers.in_order(computed, blocks, workers.shared(grid), what=f"map of {grid.robot.name}", tell=tell)
        for block, records in zip(blocks, done, strict=True):
            with system_errors(path, "make room and go on with --resume; finished blocks are kept"):
                for name in names:
                    arrays[name][grid.slices(block)] = share_of(records, grid) if name == _SHARE else records[name]
        return len(blocks), np.asarray(arrays[_SHARE][...])


def share_of(records: Any, grid: MapGrid) -> Any:
    """Of each cell of records, NumPy's or Dask's, the share of orientations that are reached."""
    turns = tuple(range(len(grid.axes), records.ndim))
    return (records[_LAST] > 0).mean(axis=turns, dtype=np.float64).astype(np.float32)
