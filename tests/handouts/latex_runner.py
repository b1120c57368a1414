"""Runs pdflatex once and reads its log."""

import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

from derive.handouts.notation.pieces import Box
from derive.handouts.pdf import LatexRun

_OVERFULL = re.compile(
    r"^Overfull \\[hv]box \((?P<size>[0-9.]+)pt too (?:wide|high)\)(?:.*?lines? (?P<line>\d+))?", re.M
)


def overfull_boxes(log: LatexRun) -> list[tuple[float, int]]:
    """What is too large for its place: by how much [pt], and the line where its paragraph begins, 0 for none."""
    return [(float(match["size"]), int(match["line"] or 0)) for match in _OVERFULL.finditer(log.text)]


def overfull(log: LatexRun) -> float:
    """The worst overfull box [pt]; 0 if there is none."""
    return max((size for size, _ in overfull_boxes(log)), default=0.0)


def require_latex() -> None:
    if shutil.which("pdflatex") is None:
        assert os.environ.get("DERIVE_REQUIRE_LATEX") != "1", "pdflatex is required here and missing"
        pytest.skip("pdflatex is not installed")


def run_latex(text: str, folder: Path) -> LatexRun:
    require_latex()
    (folder / "sheet.tex").write_text(text, encoding="utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", "sheet.tex"]
    subprocess.run(command, cwd=folder, capture_output=True, timeout=120, check=False, stdin=subprocess.DEVNULL)
    return LatexRun((folder / "sheet.log").read_text(encoding="latin-1"))


def run_clean(text: str, folder: Path) -> LatexRun:
    """As `run_latex`, of what has no error and nothing outside of the margins."""
    log = run_latex(text, folder)
    assert not log.faults
    assert log.pages
    assert overfull(log) <= 1.0
    return log


def assert_widths(boxes: Sequence[Box], folder: Path) -> None:
    """The model of widths never says too little, and at most a quarter too much."""
    lines = [rf"\setbox0\hbox{{${box.tex}$}}\typeout{{WIDTH \the\wd0}}" for box in boxes]
    text = "\n".join([r"\documentclass{article}\usepackage{amsmath}\begin{document}", *lines, r"x\end{document}"])
    log = run_latex(text, folder)
    assert not log.faults
    found = [float(width) for width in re.findall(r"WIDTH ([0-9.]+)pt", log.text)]
    for box, width in zip(boxes, found, strict=True):
        assert width - 0.5 <= box.width <= 1.25 * width + 6.0, (box, width)
