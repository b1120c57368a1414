"""What a map of the workspace asks for: cells within reach, orientations, and the blocks in which they are computed."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
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
from derive.workspace.point import TURN, Range, joint_ranges
from derive.workspace.poses import RobotPoses

_MOST = 2**19  # poses of a block: half a second of compiled code, and a few megabytes
_ROUNDING = 1e-6  # parts of a cell by which the arm's box may be in the next one
_GOLDEN = math.pi * (3.0 - math.sqrt(5.0))  # the angle from one direction to the next
_STARTS = 64  # random configurations from which the farthest ones are looked for
_SWEEPS = 200  # most times that every joint is moved to its best place
_SETTLED = 1e-12  # a sweep that gains less than this part of the arm's size squared is the last one
_BEYOND = 1e-9  # by which box and ball are larger than what was found, in parts of the ball
_THIRDS = TURN / 3.0 * np.arange(3.0)
_RADIANS = {"units": "rad"}


@dataclass(frozen=True, eq=False)
class Orientations:
    """The orientations in which each cell is tried."""

    rotations: Array  # (m, 3, 3)
    sizes: Mapping[str, int]  # names and lengths of their dimensions, whose product is m
    # By name: the dimension along which they lie, their values, and the unit, as xarray takes them.
    coordinates: dict[str, tuple[str, Array, dict[str, str]]]

    @classmethod
    def of(cls, task: Task, count: int, rolls: int) -> Orientations:
        """Those of a task: directions of z on a Fibonacci sphere and rolls about it, or angles about the world's z."""
        if "phi" in task:
            angle = TURN / count * np.arange(count, dtype=float)
            return cls(_about_z(angle), {"angle": count}, {"angle": ("angle", angle, _RADIANS)})
        if not {"approach", "orientation"} & set(task):
            return cls(np.eye(3)[None], {}, {})
        places = np.arange(count, dtype=float)
        tilt = _about_z(np.arccos(1.0 - (2.0 * places + 1.0) / count))[:, [1, 2, 0]][:, :, [1, 2, 0]]  # about y
        directed = _about_z(_GOLDEN * places) @ tilt
        known = {f"direction_{name}": ("direction", directed[:, k, 2], {"units": "1"}) for k, name in enumerate("xyz")}
        if "approach" in task:
            return cls(directed, {"direction": count}, known)
        roll = TURN / rolls * np.arange(rolls, dtype=float)
        turns = directed[:, None] @ _about_z(roll)
        known["roll"] = ("roll", roll, _RADIANS)
        return cls(turns.reshape(-1, 3, 3), {"direction": count, "roll": rolls}, known)


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
    orientations: Orientations
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
        turns = Orientations.of(task, orientations, rolls)
        most = min(count.max(), (_MOST / len(turns.rotations)) ** (1.0 / len(axes)))
        sides = np.minimum(count, 2 ** int(math.log2(max(1.0, most))))
        whole = tuple(first.tolist()), tuple(count.tolist()), tuple(sides.tolist())
        return cls(arm, ranges, axes, grid, *whole, middle, radius, turns, conditioning)

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
