"""Why a LaTeX formula was refused, in words."""

from __future__ import annotations

import re

from derive.errors import CheckError, Location
from derive.robot.expression import Expression, Number, Product
from derive.robot.limits import FORMULA_LIMITS
from derive.robot.tokens import place
from derive.robot.wording import near_miss, quoted

MAX_LENGTH = 40_000
"""Characters of one formula; a printed page holds some 4,000."""

MACROS = (
    *("cos", "sin", "tan", "sqrt", "frac", "tfrac", "dfrac", "left", "right", "dot", "ddot", "cdot", "times", "quad"),
    *("alpha", "beta", "gamma", "delta", "epsilon", "theta", "vartheta", "lambda", "mu", "nu", "xi", "pi", "rho"),
    *("sigma", "tau", "phi", "varphi", "chi", "psi", "omega", "ell", "mathrm", "text", "operatorname", "mathbf"),
)

_MACRO = re.compile(r"\\[A-Za-z]+|\\.")
_LONG_SCRIPT = re.compile(r"([_^])\s*([A-Za-z0-9][0-9]+)")
_REMEDIES = {
    "=": "write only the right-hand side",
    "'": "primes have no meaning here; remove it",
    "^": "write an exponent as ^2 or ^{2}, that of a function as \\cos^2\\theta_1 or (\\cos\\theta_1)^2",
    "&": "check one entry at a time",
    "$": "dollar signs may only stand around the whole formula",
    "|": "use brackets",
}


def check_size(text: str, start: Location) -> None:
    """Refuse what is too long or nested too deeply, before anything is parsed.

    Raises:
        CheckError: Beyond a limit.
    """
    if len(text) > MAX_LENGTH:
        raise CheckError(f"formula of {len(text)} characters", allowed=f"at most {MAX_LENGTH}", location=start)
    if not text.strip(" \t\r\n$"):
        raise CheckError("empty formula", remedy="write the right-hand side", location=start)
    depth = 0
    for offset, character in enumerate(text):
        depth += (character in "([{") - (character in ")]}")
        if depth > FORMULA_LIMITS.depth:
            where = place(text, offset, start)
            raise CheckError("brackets nested too deeply", allowed=f"at most {FORMULA_LIMITS.depth}", location=where)


def bounded(e: Expression) -> Expression:
    """The tree itself; no folded number may outgrow a float.

    Raises:
        CheckError: It does.
    """
    first = e.factors[0] if isinstance(e, Product) else e
    if isinstance(first, Number):
        bits = max(first.value.numerator.bit_length(), first.value.denominator.bit_length())
        if bits > FORMULA_LIMITS.number_bits:
            raise CheckError("number too large or too fine", allowed=f"at most {FORMULA_LIMITS.number_bits} bits")
    return e


def refusal(text: str, offset: int, start: Location) -> CheckError:
    """The message for text that the grammar does not know."""
    where = place(text, offset, start)
    rest = text[offset:]
    if not rest.strip():
        return CheckError("formula ends too early", remedy="check brackets and braces", location=where)
    if match := _LONG_SCRIPT.match(text, _script_before(text, offset)):
        where = place(text, match.start(), start)
        mark, script = match[1], match[2]
        shown = f"LaTeX prints only {script[0]!r} of {mark}{script} as a script"
        return CheckError(shown, remedy=f"write {mark}{{{script}}}", location=where)
    if match := _MACRO.match(rest):
        if match[0][1:] in MACROS:
            return CheckError(f"{match[0]} at a place where it has no meaning", location=where)
        hint = near_miss(match[0][1:], MACROS).replace("'", "\\", 1).replace("'", "")
        return CheckError(f"unknown macro {quoted(match[0])}".replace("\\\\", "\\"), remedy=hint, location=where)
    return CheckError(f"unexpected {quoted(rest[0])}", remedy=_REMEDIES.get(rest[0], "check it"), location=where)


def _script_before(text: str, offset: int) -> int:
    """Where the script begins in whose middle the reading stopped; the place itself if in none."""
    before = text[:offset].rstrip()
    return len(before) - 1 if before.endswith(("_", "^")) else offset
