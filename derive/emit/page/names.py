"""Names of entries without mathematics, for a list to choose from."""

from __future__ import annotations

import re

_NAMES = (
    "alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi pi rho sigma tau "
    "upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega"
)
_GREEK = dict(
    zip(
        _NAMES.split(" "),
        "αβγδϵεζηθϑικλμνξπρστυϕφχψωΓΔΘΛΞΠΣΥΦΨΩ",
        strict=True,
    )
)
_ACCENTS = {"dot": "\u0307", "ddot": "\u0308", "hat": "\u0302", "bar": "\u0304", "tilde": "\u0303"}
_SUBSCRIPTS = str.maketrans("0123456789+-=()aehijklmnoprstuvx", "₀₁₂₃₄₅₆₇₈₉₊₋₌₍₎ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ")
_SUPERSCRIPTS = str.maketrans("0123456789+-=()iTn", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁼⁽⁾ⁱᵀⁿ")
_ACCENTED = re.compile(r"\\(dot|ddot|hat|bar|tilde)\s*(?:\{([^{}]*)\}|(\\[A-Za-z]+|\S))")
_INDEX = re.compile(r"([_^])(?:\{([^{}]*)\}|(\\[A-Za-z]+|\S))")
_COMMAND = re.compile(r"\\([A-Za-z]+)\s?")
_SPACES = re.compile(r"\\[,;:! ]|[{}]|~")


def plain(latex: str) -> str:
    """LaTeX of a symbol in letters of Unicode: ``b_{12}`` as b₁₂; what has no letter stays as it is."""
    text = _ACCENTED.sub(_accented, latex)
    text = _INDEX.sub(_index, text)
    text = _COMMAND.sub(_command, text)
    return _SPACES.sub("", text).strip()


def _command(found: re.Match[str]) -> str:
    return _GREEK.get(found[1], "")


def _accented(found: re.Match[str]) -> str:
    base = _COMMAND.sub(_command, found[2] or found[3])
    return base[:1] + _ACCENTS[found[1]] + base[1:]


def _index(found: re.Match[str]) -> str:
    table = _SUBSCRIPTS if found[1] == "_" else _SUPERSCRIPTS
    text = _SPACES.sub("", _COMMAND.sub(_command, found[2] or found[3]))
    small = text.translate(table)
    changed = all(ord(letter) in table for letter in text)
    return small if changed else f"{found[1]}{text}"
