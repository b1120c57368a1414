"""The plot: nanoseconds per configuration, readable on light and dark pages."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from bench import our_times
from bench.operations_report import SYMBOLS
from bench.peers import pinocchio_cpp, pinocchio_python

ROWS = {
    pinocchio_python.LOOP: "#9a6a12",
    pinocchio_cpp.LABEL: "#d0a13a",
    our_times.NUMPY + our_times.OUT: "#5b8fd6",
    our_times.NATIVE + our_times.OUT: "#2f9e6e",
}
_INK = "#7d8590"
"""Grey that is legible on white and on black."""


def write_plot(timings: dict[str, Any], path: Path) -> None:
    """Bars of all quantities, one panel per robot, logarithmic; the same file for the same results."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "derive", "svg.fonttype": "path", "font.size": 10})
    from matplotlib import pyplot

    robots = timings["robots"]
    page, panels = pyplot.subplots(1, len(robots), figsize=(5.0 * len(robots), 3.6), sharey=True, squeeze=False)
    for panel, entry in zip(panels[0], robots.values(), strict=True):
        _panel(panel, entry)
    panels[0][0].set_ylabel("ns per configuration", color=_INK)
    handles, labels = panels[0][0].get_legend_handles_labels()
    page.legend(handles, labels, loc="upper center", ncols=len(labels), frameon=False, labelcolor=_INK, fontsize=9)
    page.tight_layout(rect=(0, 0, 1, 0.92))
    page.savefig(path, transparent=True, metadata={"Date": None, "Creator": None})
    pyplot.close(page)


def _panel(panel: Any, entry: dict[str, Any]) -> None:
    shown = {label: colour for label, colour in ROWS.items() if label in entry["batch"]}
    width = 0.8 / max(len(shown), 1)
    for k, (label, colour) in enumerate(shown.items()):
        cells = [entry["batch"][label].get(symbol, {}).get("median") for symbol in SYMBOLS]
        places = [i - 0.4 + (k + 0.5) * width for i in range(len(SYMBOLS))]
        pairs = [(place, value) for place, value in zip(places, cells, strict=True) if value]
        panel.bar([p for p, _ in pairs], [v for _, v in pairs], width * 0.92, color=colour, label=label)
        for place, value in pairs:
            panel.text(
                place, value * 1.15, _short(value), ha="center", va="bottom", rotation=90, fontsize=7, color=_INK
            )
    panel.set_yscale("log")
    panel.set_ylim(1, 3e4)
    panel.set_xticks(range(len(SYMBOLS)), SYMBOLS)
    panel.set_title(entry["title"], color=_INK, fontsize=10)
    panel.tick_params(colors=_INK, which="both")
    panel.set_facecolor("none")
    for name, spine in panel.spines.items():
        spine.set_visible(name in ("left", "bottom"))
        spine.set_color(_INK)


def _short(value: float) -> str:
    return f"{value / 1000:.1f}k" if value >= 1000 else f"{value:.0f}"
