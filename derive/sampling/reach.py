"""Blocks of a map: the inverse kinematics of every cell and orientation, and what its postures are worth."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from threading import Lock
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.arrays import Array
from derive.errors import QuantityError, listed
from derive.inverse.numeric.chain import NumericChain
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import Inverse, InverseSearch, Program
from derive.publish.modules import loaded
from derive.robot.robot import Robot
from derive.robot.task_rows import task_rows
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
        bare = replace(grid.robot, title="", digest="", source="", remarks=())
        return _functions_of(bare, grid.ranges)


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
