"""Maps of the workspace from Python: a lazy data set, or a Zarr store that is filled block by block."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from derive.api.robots import RobotLike, load
from derive.errors import DeriveError, OutputError, listed
from derive.handouts.figure.writers import SUFFIXES, figure_bytes, require_matplotlib
from derive.publish.atomic_folder import ending_of, refuse_taken, write_files
from derive.sampling.clusters import cluster
from derive.sampling.maps import MapGrid, begin_store, fill_store, map_dataset

if TYPE_CHECKING:
    import xarray

_MOST = 10**10  # poses of a map that nobody is asked about
_SECONDS = 1e-6  # for a pose of an arm with formulas, compiled
_SLICED = "y"  # the axis that a picture of a map of three leaves out, which is across an arm that stretches along x


@dataclass(frozen=True, slots=True)
class WrittenMap:
    """A map that was written.

    Attributes:
        robot: Name of the robot.
        path: The Zarr store.
        cells: Number of cells of the grid.
        poses: Cells times orientations.
        computed: Blocks that were computed now.
        blocks: Blocks within reach.
        reached: Cells that are reached in some orientation.
        everywhere: Cells that are reached in all orientations.
        remarks: What was assumed, and what the picture shows.
    """

    robot: str
    path: Path
    cells: int
    poses: int
    computed: int
    blocks: int
    reached: int
    everywhere: int
    remarks: tuple[str, ...]


def map(
    robot: RobotLike,
    *,
    grid: float = 0.05,
    orientations: int = 64,
    rolls: int = 12,
    box: Sequence[float] | None = None,
    conditioning: bool = False,
) -> xarray.Dataset:
    """The map of a workspace, lazily: nothing is computed before it is asked for.

    Each cell is tried at its middle, in directions of the end effector's z axis on a Fibonacci sphere and rolls about
    it, or in what else the task prescribes, within the joint limits. Dask computes the blocks.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue; all symbols have numbers.
        grid: Side of a cell [m].
        orientations: Directions, or angles of a task with ``phi``.
        rolls: Turns about each direction.
        box: Lower and upper end along each coordinate of the task [m]; None for all that the arm reaches.
        conditioning: Whether the condition of the Jacobian is computed, too, which takes as long as everything else.

    Returns:
        ``postures`` (0 where a pose is out of reach), ``manipulability``, ``margin`` and, on request, ``conditioning``,
        each along x, y, z [m], direction and roll [rad] (or what the task has of them), and ``reachability``, the
        share of orientations, of each cell. Attributes say units and definitions.

    Raises:
        DeriveError: A grid or box that is none.
        QuantityError: An arm of which not all solutions are found, or that has infinitely many.
        TargetError: Dask or xarray is not installed.
    """
    chosen = load(robot, remarks_on_bodies=False)
    return map_dataset(MapGrid.of(chosen, grid, orientations, rolls, box, conditioning=conditioning))


def write_map(
    robot: RobotLike,
    path: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    resume: bool = False,
    large: bool = False,
    picture: str | Path | None = None,
    force: bool = False,
    progress: Callable[[str, str], None] | None = None,
    **asked: Any,
) -> WrittenMap:
    """Write the map of a workspace to a Zarr store, as ``derive map`` does.

    Args:
        robot: As of `map`.
        path: The store.
        workers: Threads; None for one for each core.
        scheduler: Address of a Dask scheduler whose workers compute instead.
        resume: Whether blocks that the store has already are kept.
        large: Whether more than 10^10 poses are computed unasked.
        picture: File of a slice, ending in .pdf, .svg or .png.
        force: Whether a picture that exists is overwritten; a store never is.
        progress: Called with what is computed, and how far it is.
        asked: ``grid``, ``orientations``, ``rolls``, ``box`` and ``conditioning``, as of `map`.

    Returns:
        What was written.

    Raises:
        OutputError: There is such a store, or with ``resume`` it is of another map, or it cannot be written.
        DeriveError: Besides what `map` refuses: too many poses, or a scheduler that does not answer.
    """
    path, pictures = Path(path), [] if picture is None else [Path(picture)]
    if os.path.lexists(path) and not resume:
        remedy = "choose another name, remove it, or go on with it by --resume"
        raise OutputError(f"{path} exists already", remedy=remedy)
    if pictures:
        require_matplotlib()
    refuse_taken(pictures, force=force)
    suffixes = [ending_of(name, SUFFIXES) for name in pictures]
    grid = MapGrid.of(load(robot, remarks_on_bodies=False), **asked)
    poses = math.prod(grid.shape) * len(grid.rotations)
    if poses > _MOST and not large:
        size = poses * sum(int(kind[1]) for kind in grid.kinds.values()) / 1e9
        raise DeriveError(
            f"a map of {poses:.3g} poses: up to {size:.3g} GB and about {poses * _SECONDS / 3600:.2g} h of one core",
            allowed=f"allowed: {_MOST:.0e} unasked",
            remedy="take a larger --grid, fewer --orientations or a --box, or say --yes",
        )
    with cluster(workers, scheduler) as found:
        begin_store(path, grid)
        computed, shares = fill_store(path, grid, found, progress)
    turning = [way.variable for way in grid.ranges if way.assumed and way.revolute]
    sliding = [f"{way.variable} {way.interval}" for way in grid.ranges if way.assumed and not way.revolute]
    remarks = [f"without limits: {listed(turning)}, full turns"] if turning else []
    remarks += [f"limits assumed: {listed(sliding)}"] if sliding else []
    for name, suffix in zip(pictures, suffixes, strict=True):
        data, title = _slice_picture(grid, shares, suffix)
        write_files({name: data}, force=force)
        remarks.append(f"{name}: {title}")
    counts = shares.size, poses, computed, len(grid.blocks), int((shares > 0.0).sum()), int((shares == 1.0).sum())
    return WrittenMap(grid.robot.name, path, *counts, tuple(remarks))


def _slice_picture(grid: MapGrid, shares: npt.NDArray[np.float32], suffix: str) -> tuple[bytes, str]:
    """The contents of a file of that ending, and what it shows: a slice through the middle."""
    axes, centres, where = list(grid.axes), list(grid.centres), ""
    if len(axes) == 3:
        k = axes.index(_SLICED)
        place = int(np.abs(centres[k]).argmin())
        shares, where = np.take(shares, place, axis=k), f" at {_SLICED} = {centres[k][place]:.4g} m"
        del axes[k], centres[k]
    if len(axes) == 1:
        axes, centres, shares = [*axes, ""], [*centres, np.zeros(1)], shares[:, None]
    title = f"{grid.robot.name}: share of orientations reached{where}"
    with require_matplotlib().rc_context({"svg.hashsalt": grid.robot.name}):
        from matplotlib.figure import Figure

        figure = Figure(figsize=(6.0, 5.0), layout="constrained")
        labels = dict(zip(("xlabel", "ylabel"), (name and f"{name} [m]" for name in axes), strict=True))
        panel = figure.add_subplot(aspect="equal" if axes[1] else "auto", title=title, **labels)
        left, right, low, high = (a[end] + way * grid.step for a in centres for end, way in ((0, -0.5), (-1, 0.5)))
        figure.colorbar(panel.imshow(shares.T, origin="lower", extent=(left, right, low, high), vmin=0.0, vmax=1.0))
        return figure_bytes(figure, suffix, title), title
