"""Drawings as PDF, SVG or PNG through matplotlib; the same drawing gives the same bytes."""

from __future__ import annotations

from io import BytesIO
from typing import Any

from derive.errors import DeriveError
from derive.handouts.figure.drawing import LABEL_SIZE, Drawing, Path

SUFFIXES = (".pdf", ".png", ".svg")

POINTS_PER_INCH = 72.27

RESOLUTION = 300
"""Of a PNG [dots per inch]."""

CREATOR = "derive"

STYLE = {
    "svg.hashsalt": "derive",
    "svg.fonttype": "path",
    "pdf.fonttype": 3,
    "mathtext.fontset": "cm",
    "font.family": "serif",
    "path.simplify": False,
}

_ALIGN_X = {-1: "left", 0: "center", 1: "right"}
_ALIGN_Y = {-1: "bottom", 0: "center", 1: "top"}


def require_matplotlib() -> Any:
    """The module matplotlib, set to draw into files.

    Raises:
        DeriveError: It is not installed.
    """
    try:
        import matplotlib
    except ImportError:
        raise DeriveError(
            "figures need matplotlib, which is not installed", remedy="pip install 'derive-robot[handout]'"
        ) from None
    matplotlib.use("agg")
    return matplotlib


def drawing_bytes(drawing: Drawing, suffix: str, scale: float = 1.0) -> bytes:
    """A drawing as the contents of a file.

    Args:
        drawing: What to draw.
        suffix: ``.pdf``, ``.svg`` or ``.png``: the form.
        scale: How much larger than in the drawing.

    Raises:
        DeriveError: matplotlib is not installed.
    """
    matplotlib = require_matplotlib()
    with matplotlib.rc_context(STYLE):
        from matplotlib.figure import Figure
        from matplotlib.patches import Polygon

        figure = Figure(figsize=(scale * drawing.width / POINTS_PER_INCH, scale * drawing.height / POINTS_PER_INCH))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_xlim(0.0, drawing.width)
        axes.set_ylim(0.0, drawing.height)
        axes.set_axis_off()
        for order, item in enumerate(drawing.items):
            if isinstance(item, Path):
                outline = Polygon(
                    item.points,
                    closed=item.closed,
                    fill=item.fill is not None,
                    facecolor=item.fill or "none",
                    edgecolor=item.stroke or "none",
                    linewidth=item.width * scale if item.stroke else 0.0,
                    linestyle=(0, (4, 2.5)) if item.dashed else "solid",
                    joinstyle="round",
                    capstyle="round",
                    zorder=order,
                )
                axes.add_patch(outline)
            else:
                axes.text(
                    *item.at,
                    f"${item.latex}$",
                    fontsize=LABEL_SIZE * scale,
                    color=item.color,
                    ha=_ALIGN_X[item.anchor[0]],
                    va=_ALIGN_Y[item.anchor[1]],
                    zorder=order,
                    clip_on=False,
                )
        return figure_bytes(figure, suffix, drawing.title)


def figure_bytes(figure: Any, suffix: str, title: str) -> bytes:
    """A figure of matplotlib as the contents of a file, without date or version in it.

    Args:
        figure: A ``matplotlib.figure.Figure``.
        suffix: ``.pdf``, ``.svg`` or ``.png``: the form.
        title: What it shows, for readers who cannot see it.
    """
    form = suffix.removeprefix(".")
    metadata = {
        "svg": {"Date": None, "Creator": CREATOR, "Title": title},
        "pdf": {"CreationDate": None, "Creator": CREATOR, "Producer": None, "Title": title},
        "png": {"Software": CREATOR, "Title": title},
    }[form]
    file = BytesIO()
    figure.savefig(file, format=form, dpi=RESOLUTION, metadata=metadata, facecolor="white")
    return file.getvalue()
