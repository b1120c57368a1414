"""A picture of a map: how many orientations are reached, in a slice through the middle."""

import numpy as np
import numpy.typing as npt

from derive.handouts.figure.writers import figure_bytes, require_matplotlib
from derive.sampling.grid import MapGrid

_SLICED = "y"  # the axis that a map of three leaves out, which is across an arm that stretches along x


def slice_picture(grid: MapGrid, shares: npt.NDArray[np.float32], suffix: str) -> tuple[bytes, str]:
    """The contents of a file of that ending, and what it shows."""
    axes, centres, where = list(grid.axes), list(grid.centres), ""
    if len(axes) == 3:
        k = axes.index(_SLICED)
        place = int(np.abs(centres[k]).argmin())
        shares, where = shares[(slice(None),) * k + (place,)], f" at {_SLICED} = {centres[k][place]:.4g} m"
        del axes[k], centres[k]
    if len(axes) == 1:
        axes, centres, shares = [*axes, ""], [*centres, np.zeros(1)], shares[:, None]
    title = f"{grid.robot.name}: share of orientations reached{where}"
    with require_matplotlib().rc_context({"svg.hashsalt": grid.robot.name}):
        from matplotlib.figure import Figure

        figure = Figure(figsize=(6.0, 5.0), layout="constrained")
        panel = figure.add_subplot(aspect="equal" if axes[1] else "auto", title=title)
        half = grid.step / 2.0
        left, right, low, high = (value for a in centres for value in (a[0] - half, a[-1] + half))
        image = panel.imshow(
            shares.T, origin="lower", extent=(left, right, low, high), vmin=0.0, vmax=1.0, cmap="viridis"
        )
        panel.set(xlabel=f"{axes[0]} [m]", ylabel=f"{axes[1]} [m]" if axes[1] else "")
        figure.colorbar(image)
        return figure_bytes(figure, suffix, title), title
