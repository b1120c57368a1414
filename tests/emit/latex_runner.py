"""Runs pdflatex and reads its log."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

_OVERFULL = re.compile(r"^Overfull \\[hv]box \(([0-9.]+)pt too (?:wide|high)\)", re.MULTILINE)
_PAGES = re.compile(r"Output written on [^(]*\((\d+) page")


@dataclass(frozen=True)
class Log:
    """What a run of pdflatex said.

    Attributes:
        text: The whole log.
        status: Exit status.
    """

    text: str
    status: int

    @property
    def errors(self) -> list[str]:
        """Lines that report an error."""
        return [line for line in self.text.splitlines() if line.startswith("!")]

    @property
    def overfull(self) -> float:
        """The worst overfull box [pt]."""
        return max((float(size) for size in _OVERFULL.findall(self.text)), default=0.0)

    @property
    def pages(self) -> int:
        """Pages of the document."""
        match = _PAGES.search(self.text.replace("\n", ""))
        return int(match.group(1)) if match else 0


def require_latex() -> None:
    """Skips without pdflatex, except where it must be there."""
    if shutil.which("pdflatex") is None:
        assert os.environ.get("DERIVE_REQUIRE_LATEX") != "1", "pdflatex is required here and missing"
        pytest.skip("pdflatex is not installed")


def run_latex(text: str, folder: Path) -> Log:
    """Compiles a document once."""
    require_latex()
    (folder / "sheet.tex").write_text(text, encoding="utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", "sheet.tex"]
    done = subprocess.run(command, cwd=folder, capture_output=True, timeout=120, check=False, stdin=subprocess.DEVNULL)
    log = (folder / "sheet.log").read_text(encoding="latin-1")
    return Log(log, done.returncode)
