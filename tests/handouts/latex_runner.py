"""Runs pdflatex once and reads its log."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from derive.handouts.pdf import LatexLog


def require_latex() -> None:
    if shutil.which("pdflatex") is None:
        assert os.environ.get("DERIVE_REQUIRE_LATEX") != "1", "pdflatex is required here and missing"
        pytest.skip("pdflatex is not installed")


def run_latex(text: str, folder: Path) -> LatexLog:
    require_latex()
    (folder / "sheet.tex").write_text(text, encoding="utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", "sheet.tex"]
    done = subprocess.run(command, cwd=folder, capture_output=True, timeout=120, check=False, stdin=subprocess.DEVNULL)
    return LatexLog((folder / "sheet.log").read_text(encoding="latin-1"), done.returncode)
