"""The plot of a workspace: each of its views with what is reached and what is dexterous, as a file."""

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np

from derive.handouts.figure.writers import POINTS_PER_INCH, STYLE, figure_bytes, require_matplotlib
from derive.workspace.point import Picture
from derive.workspace.region import Region, shapely
from derive.workspace.views import WorkspaceView

WIDTH = 380.0  # width of the plot [pt]
_REACHABLE = (0.80, 0.86, 0.94)
# For parts that are reached in different numbers of postures, the fewest first.
_MORE = ((0.72, 0.88, 0.76), (0.98, 0.90, 0.66), (0.95, 0.78, 0.72), (0.85, 0.77, 0.90))
_DEXTEROUS = (0.56, 0.69, 0.88)
_EDGE = (0.10, 0.22, 0.55)
_INNER_EDGE = (0.20, 0.36, 0.68)
_SETTINGS = {"font.size": 8.0, "axes.linewidth": 0.6, "lines.linewidth": 0.9}
_AXES = {Picture.SECTION: ("r", "z"), Picture.TOP: ("x", "y"), Picture.SIDE: ("x", "z")}

_MARGIN = 0.06
_ONE_POINT = 1e-9  # a workspace smaller than this is a point, which gives a plot no scale; a metre is shown then [m]


def workspace_bytes(views: Sequence[WorkspaceView], suffix: str, title: str, scale: float = 1.0) -> bytes:
    """The plot as the contents of a file."""
    with require_matplotlib().rc_context({**STYLE, **_SETTINGS}):
        from matplotlib.figure import Figure

        width = scale * WIDTH / POINTS_PER_INCH
        figure = Figure(figsize=(width, (0.56 if len(views) > 1 else 0.8) * width), layout="constrained")
        panels = figure.subplots(1, len(views), squeeze=False)[0]
        for axes, view in zip(panels, views, strict=True):
            _panel(axes, view)
        if any(view.dexterous is not None or len(view.by_number) > 1 for view in views):
            handles, names = panels[0].get_legend_handles_labels()
            figure.legend(handles, names, loc="outside lower center", ncols=len(names), frameon=False)
        return figure_bytes(figure, suffix, title)


def _panel(axes: Any, view: WorkspaceView) -> None:
    if len(view.by_number) > 1:
        for (number, part), color in zip(view.by_number, cycle(_MORE), strict=False):
            _fill(axes, part, view.picture, color, _EDGE, f"{number} posture{'s' if number > 1 else ''}")
    else:
        _fill(axes, view.reachable.region, view.picture, _REACHABLE, _EDGE, "reachable")
    if view.dexterous is not None and not view.dexterous.region.is_empty:
        _fill(axes, view.dexterous.region, view.picture, _DEXTEROUS, _INNER_EDGE, "dexterous")
    if len(view.path):
        axes.plot(*view.path.T, color=_EDGE, marker="." if np.ptp(view.path, axis=0).max() < _ONE_POINT else "")
    # The same scale on both axes; the axis of symmetry of a section where the workspace is near it.
    bounds = view.reachable.region.bounds if not len(view.path) else (*view.path.min(axis=0), *view.path.max(axis=0))
    left, low, right, high = bounds
    margin = _MARGIN * max(right - left, high - low)
    margin = margin if margin >= _ONE_POINT else 0.5
    if view.picture is Picture.SECTION and left < 0.5 * right:
        axes.axvline(0.0, color="0.35", linewidth=0.5, linestyle=(0, (8, 2, 1.5, 2)))
        left = 0.0
    axes.set(xlim=(left - margin, right + margin), ylim=(low - margin, high + margin))
    axes.set_aspect("equal", adjustable="box")
    across, up = _AXES[view.picture]
    axes.set(xlabel=f"${across}$ [m]", ylabel=f"${up}$ [m]")
    axes.set_title(str(view.picture), fontsize=9.0)
    axes.grid(visible=True, color="0.9", linewidth=0.4)
    axes.set_axisbelow(True)
    axes.tick_params(width=0.5, length=2.5)


def _fill(axes: Any, region: Region, picture: Picture, color: Any, edge: Any, name: str) -> None:
    """An area with its holes; its border is drawn but for the axis of a section, which lies inside of the workspace."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    package = shapely()
    parts = [part for part in package.get_parts(region) if not part.is_empty]
    if not (rings := [ring for part in parts for ring in (part.exterior, *part.interiors)]):
        return
    corners = [np.asarray(ring.coords) for ring in rings]
    codes = [np.r_[Path.MOVETO, np.full(len(ring) - 2, Path.LINETO), Path.CLOSEPOLY] for ring in corners]
    area = Path(np.concatenate(corners), np.concatenate(codes))
    axes.add_patch(PathPatch(area, facecolor=color, edgecolor="none", label=name))
    _, low, right, high = region.bounds
    strip = package.box(-right, low - right, 1e-4 * right, high + right) if picture is Picture.SECTION else None
    for ring in rings:
        for line in package.get_parts(ring if strip is None else ring.difference(strip)):
            axes.plot(*np.asarray(line.coords).T, color=edge, solid_joinstyle="round")
