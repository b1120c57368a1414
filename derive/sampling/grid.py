"""What a map of the workspace asks for: cells within reach, orientations, and the blocks in which they are computed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from derive.arrays import Array, Flags
from derive.errors import DeriveError, QuantityError, listed
from derive.inverse.numeric.chain import NumericChain
from derive.robot.options.inverse import POSE, InverseOptions, Task
from derive.robot.robot import Robot
from derive.robot.task_rows import task_rows
from derive.robot.tree import require_chain
from derive.sampling.extent import Extent
from derive.workspace.point import TURN, Range, joint_ranges
from derive.workspace.poses import RobotPoses

_MOST = 2**19  # poses of a block: half a second of compiled code, and a few megabytes
_ROUNDING = 1e-6  # parts of a cell by which the arm's box may be in the next one
_GOLDEN = math.pi * (3.0 - math.sqrt(5.0))  # the angle from one direction to the next


@dataclass(frozen=True, eq=False)
class Orientations:
    """The orientations in which each cell is tried."""

    rotations: Array  # (m, 3, 3)
    sizes: Mapping[str, int]  # names and lengths of their dimensions, whose product is m
    coordinates: Mapping[str, tuple[str, Array]]  # by name: the dimension along which they lie, and their values

    @classmethod
    def of(cls, task: Task, count: int, rolls: int) -> Orientations:
        """Those of a task: directions of z on a Fibonacci sphere and rolls about it, or angles about the world's z."""
        if "phi" in task:
            angle = TURN / count * np.arange(count, dtype=float)
            return cls(_about_z(angle), {"angle": count}, {"angle": ("angle", angle)})
        if not {"approach", "orientation"} & set(task):
            return cls(np.eye(3)[None], {}, {})
        places = np.arange(count, dtype=float)
        height, turned = 1.0 - (2.0 * places + 1.0) / count, _GOLDEN * places % TURN
        tilt = _about_z(np.arccos(height))[:, [1, 2, 0]][:, :, [1, 2, 0]]  # about y
        across = np.sqrt(1.0 - height**2)
        ways = zip("xyz", (across * np.cos(turned), across * np.sin(turned), height), strict=True)
        known = {f"direction_{name}": ("direction", values) for name, values in ways}
        directed = _about_z(turned) @ tilt
        if "approach" in task:
            return cls(directed, {"direction": count}, known)
        roll = TURN / rolls * np.arange(rolls, dtype=float)
        turns = directed[:, None] @ _about_z(roll)
        return cls(turns.reshape(-1, 3, 3), {"direction": count, "roll": rolls}, known | {"roll": ("roll", roll)})


def _about_z(angle: Array) -> Array:
    """Rotations (k, 3, 3) about z."""
    found = np.tile(np.eye(3), (len(angle), 1, 1))
    found[:, 0, 0] = found[:, 1, 1] = np.cos(angle)
    found[:, 1, 0] = np.sin(angle)
    found[:, 0, 1] = -found[:, 1, 0]
    return found


@dataclass(frozen=True, eq=False)
class MapGrid:
    """The cells of a map, each from k to k + 1 steps along every axis of its task, and the orientations."""

    robot: Robot  # the arm, with the task of the map
    ranges: tuple[Range, ...]  # the way of every joint
    axes: tuple[str, ...]  # the coordinates that the task has, of x, y and z
    step: float  # side of a cell [m]
    first: tuple[int, ...]  # k of the first cell along each axis
    shape: tuple[int, ...]  # how many cells there are along each axis
    extent: Extent  # of the arm along these axes
    orientations: Orientations
    edge: int  # cells along the side of a block, a power of two
    conditioning: bool = False  # whether the condition of the Jacobian is wanted, too

    @classmethod
    def of(
        cls,
        robot: Robot,
        step: float,
        counts: tuple[int, int],
        box: Sequence[float] | None = None,
        *,
        conditioning: bool = False,
    ) -> MapGrid:
        """The grid over what an arm reaches, or a box, with so many directions (or angles) and rolls."""
        if not 0.0 < step < math.inf:
            raise DeriveError(f"a grid of {step:g} m", allowed="allowed: the side of a cell in metres, above zero")
        if (least := min(counts)) < 1:
            raise DeriveError(f"{least} orientations", allowed="allowed: whole numbers from 1 on")
        require_chain(robot, "the map")
        task = map_task(robot)
        chosen = InverseOptions(task, robot.inverse.given, robot.inverse.location)
        arm = replace(robot, inverse=chosen, links=(), gravity=None, runtime=())
        chain, ranges = NumericChain.of(arm), joint_ranges(RobotPoses(arm))
        axes = tuple(name for name in "xyz" if name in task)
        extent = Extent.of(chain, ranges, ["xyz".index(name) for name in axes])
        low, high = _within(extent, axes, box)
        first = np.floor(low / step + _ROUNDING).astype(int)
        count = np.maximum(np.ceil(high / step - _ROUNDING).astype(int) - first, 1)
        turns = Orientations.of(task, *counts)
        most = min(count.max(), (_MOST / len(turns.rotations)) ** (1.0 / len(axes)))
        edge = 2 ** int(math.log2(max(1.0, most)))
        whole = tuple(first.tolist()), tuple(count.tolist())
        return cls(arm, ranges, axes, step, *whole, extent, turns, edge, conditioning)

    @property
    def block_shape(self) -> tuple[int, ...]:
        """Cells of a block along each axis, where no end of the grid cuts it."""
        return tuple(min(self.edge, count) for count in self.shape)

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
        return middles, np.linalg.norm(middles - self.extent.middle, axis=-1) <= self.extent.radius

    @cached_property
    def blocks(self) -> tuple[tuple[int, ...], ...]:
        """The blocks with a cell within reach."""
        counts = (range(-(-count // side)) for count, side in zip(self.shape, self.block_shape, strict=True))
        return tuple(block for block in product(*counts) if self.cells(block)[1].any())

    @property
    def poses(self) -> int:
        """Cells of the grid times orientations."""
        return math.prod(self.shape) * len(self.orientations.rotations)


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


def _within(extent: Extent, axes: Sequence[str], box: Sequence[float] | None) -> tuple[Array, Array]:
    """Corners of what is mapped: the box of the arm, and of that what is in the user's."""
    low, high = np.array(extent.low), np.array(extent.high)
    if box is None:
        return low, high
    if len(box) == 2 * len(axes) and np.isfinite(box).all():
        wanted = np.reshape(box, (-1, 2))
        low, high = np.maximum(low, wanted[:, 0]), np.minimum(high, wanted[:, 1])
        if (low < high).all():
            return low, high
    ways = zip(axes, extent.low, extent.high, strict=True)
    allowed = listed(f"{name} from {least:.4g} to {most:.4g} m" for name, least, most in ways)
    found = f"the box {', '.join(f'{value:g}' for value in box)} is not one that the arm reaches"
    ends = ",".join(f"{name}0,{name}1" for name in axes)
    raise DeriveError(found, allowed=f"allowed: {ends} within {allowed}, the lower end first")
