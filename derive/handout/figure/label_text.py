"""The LaTeX of a label as short runs of plain characters, for writers without TeX, and its size on the page."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

LABEL_SIZE = 9.0
"""Size of the letters of a label [pt]."""

SCRIPT_SIZE = 6.5
"""Size of subscripts and superscripts [pt]."""

LABEL_HEIGHT = 9.0
"""Height of a label with a subscript [pt]."""

_GREEK = {
    "alpha": "\N{GREEK SMALL LETTER ALPHA}", "beta": "β", "gamma": "\N{GREEK SMALL LETTER GAMMA}", "delta": "δ",
    "epsilon": "ϵ", "varepsilon": "ε", "zeta": "ζ", "eta": "η", "theta": "θ", "vartheta": "ϑ",
    "iota": "\N{GREEK SMALL LETTER IOTA}", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "\N{GREEK SMALL LETTER NU}",
    "xi": "ξ", "pi": "π", "rho": "\N{GREEK SMALL LETTER RHO}", "sigma": "\N{GREEK SMALL LETTER SIGMA}", "tau": "τ",
    "upsilon": "\N{GREEK SMALL LETTER UPSILON}", "phi": "ϕ", "varphi": "φ", "chi": "χ", "psi": "ψ", "omega": "ω",
    "Gamma": "Γ", "Delta": "Δ", "Theta": "Θ", "Lambda": "Λ", "Xi": "Ξ", "Pi": "Π", "Sigma": "Σ",
    "Upsilon": "\N{GREEK CAPITAL LETTER UPSILON}", "Phi": "Φ", "Psi": "Ψ", "Omega": "Ω",
}  # fmt: skip
_SYMBOLS = {"cdot": "·", "ldots": "…", "circ": "°", "equiv": "≡", "times": "\N{MULTIPLICATION SIGN}", "sqrt": "√"}
_SPACES = {",": "\N{THIN SPACE}", ";": " ", " ": " ", "quad": "  ", "!": ""}
_STYLES = {"mathrm": "upright", "text": "upright", "mathtt": "mono", "operatorname": "upright"}
_ACCENTS = {"dot": "\N{COMBINING DOT ABOVE}", "ddot": "\N{COMBINING DIAERESIS}"}
_TOKEN = re.compile(r"\\[A-Za-z]+ ?|\\.|.", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Run:
    """Characters of one style.

    Attributes:
        text: The characters.
        style: ``italic``, ``upright`` or ``mono``.
        shift: -1 for a subscript, 1 for a superscript, 0 on the line.
    """

    text: str
    style: str = "italic"
    shift: int = 0


def runs(latex: str) -> tuple[Run, ...]:
    """The runs of a label, neighbours of one style joined."""
    joined: list[Run] = []
    for run in _Reader(_TOKEN.findall(latex)).read(Run("")):
        if joined and (joined[-1].style, joined[-1].shift) == (run.style, run.shift):
            joined[-1] = replace(run, text=joined[-1].text + run.text)
        elif run.text:
            joined.append(run)
    return tuple(joined)


def label_width(latex: str) -> float:
    """Width of a label on the page, estimated [pt]."""
    return sum(_run_width(run) for run in runs(latex))


def _run_width(run: Run) -> float:
    size = SCRIPT_SIZE if run.shift else LABEL_SIZE
    narrow = sum(character in ",.\N{THIN SPACE}il1" for character in run.text)
    return size * (0.58 * (len(run.text) - narrow) + 0.36 * narrow)


class _Reader:
    """Reads the LaTeX that our printers write; what it does not know it leaves out."""

    def __init__(self, tokens: list[str]) -> None:
        self._tokens = tokens
        self._next = 0

    def read(self, style: Run) -> Iterator[Run]:
        """All runs up to the end of the group."""
        while self._next < len(self._tokens):
            token = self._take()
            if token == "}":
                return
            yield from self._piece(token, style)

    def _take(self) -> str:
        token = self._tokens[self._next]
        self._next += 1
        return token.rstrip() if token.startswith("\\") and len(token) > 2 else token

    def _piece(self, token: str, style: Run) -> Iterator[Run]:
        if token == "{":
            yield from self.read(style)
        elif token in "_^":
            yield from self._argument(replace(style, shift=-1 if token == "_" else 1))
        elif token.startswith("\\"):
            yield from self._command(token[1:], style)
        elif not token.isspace():
            upright = style.style == "italic" and not token.isalpha()
            shown = "\N{MINUS SIGN}" if token == "-" else token
            yield replace(style, text=shown, style="upright" if upright else style.style)

    def _command(self, name: str, style: Run) -> Iterator[Run]:
        if name in _STYLES:
            yield from self._argument(replace(style, style=_STYLES[name]))
        elif name in _ACCENTS:
            yield from (replace(run, text=run.text + _ACCENTS[name]) for run in self._argument(style))
        elif name == "frac":
            yield from self._argument(style)
            yield replace(style, text="/", style="upright")
            yield from self._argument(style)
        else:
            shown = _GREEK.get(name) or _SYMBOLS.get(name) or _SPACES.get(name, name if len(name) == 1 else "")
            yield replace(style, text=shown, style=style.style if name in _GREEK else "upright", shift=style.shift)

    def _argument(self, style: Run) -> Iterator[Run]:
        if self._next < len(self._tokens):
            yield from self._piece(self._take(), style)
