"""The LaTeX of a symbol as HTML: for controls and captions, where a whole formula would be too much."""

from __future__ import annotations

from derive.emit.escape import html_text
from derive.emit.figure.label_text import Run, runs

_STYLES = {"italic": "i", "mono": "code"}
_SHIFTS = {-1: "sub", 1: "sup"}


def html_symbol(latex: str) -> str:
    r"""``\theta_{1}`` is an italic theta with index 1."""
    return "".join(_run(run) for run in runs(latex))


def _run(run: Run) -> str:
    body = html_text(run.text)
    for tag in (_STYLES.get(run.style), _SHIFTS.get(run.shift)):
        body = f"<{tag}>{body}</{tag}>" if tag else body
    return body
