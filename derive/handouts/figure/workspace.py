"""The workspace of a robot: positions that its end effector reaches within the joints' limits, and their plot.

The positions are those of random configurations; the plot is a section and a top view, with the outline of what the
positions cover.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from derive.handouts.figure.drawing import Array
from derive.handouts.figure.poses import RobotPoses
from derive.handouts.figure.writers import POINTS_PER_INCH, STYLE, figure_bytes, require_matplotlib

WIDTH = 380.0
"""Width of the plot [pt]."""

AT_A_LIMIT = 0.25
"""Part of the samples of a joint that lie at one of its limits or at zero: the boundary is reached there."""

_CLOUD = (0.55, 0.66, 0.84)
_EDGE = (0.10, 0.22, 0.55)
_SETTINGS = {"font.size": 8.0, "axes.linewidth": 0.6, "lines.linewidth": 0.9}
_SAMPLES_PER_CELL = 10.0
_CELLS = (12, 80)
"""Fewest and most cells of the grid along the longer side of the cloud."""

_ONE_POINT = 1e-9
"""A cloud smaller than this is a point, which gives a plot no scale; a metre is shown then [m]."""


@dataclass(frozen=True, slots=True)
class Assumption:
    """Limits taken for a joint that has none in the file.

    Attributes:
        variable: The joint's variable.
        lower: Lower limit [rad or m].
        upper: Upper limit [rad or m].
        unit: ``rad`` or ``m``.
    """

    variable: str
    lower: float
    upper: float
    unit: str


@dataclass(frozen=True, eq=False)
class Workspace:
    """A cloud of positions.

    Attributes:
        points: (3, samples) seen from the axis of joint 1: z along it, x and y across [m].
        assumed: Limits that the file does not give.
    """

    points: Array
    assumed: tuple[Assumption, ...]


def sample_workspace(poses: RobotPoses, samples: int, seed: int) -> Workspace:
    """Positions at random configurations; the same seed gives the same points.

    Joints without limits turn from -pi to pi, and slide from 0 to the longest length of the arm.

    Args:
        poses: The robot in numbers.
        samples: Number of configurations.
        seed: Of the random numbers.
    """
    ranges, assumed = [], []
    for joint, limits in zip(poses.robot.joints, poses.limits, strict=True):
        if limits is None:
            limits = (-math.pi, math.pi) if joint.is_revolute else (0.0, poses.longest)
            assumed.append(Assumption(joint.variable, *limits, "rad" if joint.is_revolute else "m"))
        ranges.append(limits)
    rng = np.random.default_rng(seed)
    rows = []
    for low, high in ranges:
        values = rng.uniform(low, high, samples)
        special = np.array([low, high, min(max(0.0, low), high)])
        chosen = special[rng.integers(0, len(special), samples)]
        rows.append(np.where(rng.random(samples) < AT_A_LIMIT, chosen, values))
    q = np.stack(rows)
    if poses.robot.joints[0].is_revolute:  # it turns the cloud as a whole
        q[0] = rng.uniform(*ranges[0], samples)
    rotation, origin = poses.first_axis
    points: Array = np.array(rotation).T @ (poses.positions(q) - np.array(origin)[:, None])
    return Workspace(points, tuple(assumed))


def workspace_bytes(points: Array, suffix: str, title: str, scale: float = 1.0) -> bytes:
    """The plot as the contents of a file.

    Args:
        points: (3, samples) positions [m], z along the axis of joint 1.
        suffix: ``.pdf``, ``.svg`` or ``.png``: the form.
        title: What the plot shows.
        scale: How much larger than a page needs.

    Raises:
        DeriveError: matplotlib is not installed.
    """
    matplotlib = require_matplotlib()
    with matplotlib.rc_context({**STYLE, **_SETTINGS}):
        from matplotlib.figure import Figure

        width = scale * WIDTH / POINTS_PER_INCH
        figure = Figure(figsize=(width, 0.56 * width), layout="constrained")
        section, top = figure.subplots(1, 2)
        x, y, z = points
        _panel(section, np.hypot(x, y), z, ("$r$ [m]", "$z$ [m]"), "section")
        _panel(top, x, y, ("$x$ [m]", "$y$ [m]"), "top view")
        return figure_bytes(figure, suffix, title)


def _panel(axes: Any, x: Array, y: Array, labels: tuple[str, str], title: str) -> None:
    axes.scatter(x, y, s=0.6, color=_CLOUD, linewidths=0.0, rasterized=True)
    for line in outline(x, y):
        axes.plot(line[:, 0], line[:, 1], color=_EDGE)
    if max(np.ptp(x), np.ptp(y)) < _ONE_POINT:
        axes.set(xlim=(x[0] - 0.5, x[0] + 0.5), ylim=(y[0] - 0.5, y[0] + 0.5))
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(labels[0])
    axes.set_ylabel(labels[1])
    axes.set_title(title, fontsize=9.0)
    axes.grid(visible=True, color="0.9", linewidth=0.4)
    axes.set_axisbelow(True)
    axes.tick_params(width=0.5, length=2.5)


def outline(x: Array, y: Array) -> list[Array]:
    """Lines around the cells of a grid that hold points, holes included; none around a cloud without area.

    Args:
        x: (samples,) first coordinates.
        y: (samples,) second coordinates.

    Returns:
        Lines (k, 2), each closed.
    """
    spans = np.ptp(x), np.ptp(y)
    if min(spans) < 1e-6 * max(*spans, 1e-12):
        return []
    cells = int(np.clip(np.sqrt(len(x) / _SAMPLES_PER_CELL), *_CELLS))
    size = max(spans) / cells
    counts, x_edges, y_edges = np.histogram2d(x, y, bins=[_edges(x, size), _edges(y, size)])
    from contourpy import contour_generator

    centers = [(edges[:-1] + edges[1:]) / 2 for edges in (x_edges, y_edges)]
    filled = counts > 0
    near = _neighbours(filled.astype(float))
    closed = ((filled & (near >= 2)) | (near >= 5)).astype(float)  # gaps among filled cells belong to the area
    smooth = (_neighbours(closed) + 2 * closed) / 10.0
    lines = contour_generator(x=centers[0], y=centers[1], z=smooth.T).lines(0.5)
    kept = [np.asarray(line, dtype=float) for line in lines]
    return [line for line in kept if len(line) > 8]


def _edges(values: Array, size: float) -> Array:
    """Edges of the cells along one side, with empty cells around the cloud."""
    low = float(values.min()) - 2.5 * size
    count = int(np.ceil((float(values.max()) - low) / size + 2.5))
    edges: Array = low + size * np.arange(count + 1, dtype=float)
    return edges


def _neighbours(values: Array) -> Array:
    """For each cell, the sum of its eight neighbours."""
    padded = np.pad(values, 1)
    rows, columns = values.shape
    shifts = [(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    total: Array = sum((padded[i : i + rows, j : j + columns] for i, j in shifts), np.zeros_like(values))
    return total
