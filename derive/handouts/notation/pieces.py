"""A printed expression as a row of pieces, each with the width that TeX will give it, to be measured and broken.

A box is a piece of LaTeX with the width it takes in points, from the metrics of Computer Modern at 10 pt (cmmi10 and
cmr10, Knuth). Widths are rounded up and hold a little slack for italic corrections, so that what fits here fits on
paper.

Numbers are boxes too. A robot given by decimals is printed in decimals, any other in fractions. A number with more
than six significant digits is rounded in print (`derive.robot.rounding`); the sheet states the rule.
"""

from collections.abc import Iterable
from enum import IntEnum
from fractions import Fraction
from functools import cache
from typing import NamedTuple

from derive.robot.rounding import DIGITS, shown

SCRIPT = 0.85  # width at script size (7 pt) over width at 10 pt; the largest ratio of any letter
SCRIPT_SPACE = 0.5  # space that plain TeX and LaTeX put after a subscript or superscript [pt]
ITALIC_SLACK = 0.5  # more than the italic correction of any lower-case letter [pt]
BINARY_WIDTH = 12.3  # a binary plus or minus with its spaces [pt]
RELATION_WIDTH = 13.4  # an equals sign with its spaces [pt]
MINUS_WIDTH = 7.8  # a minus sign in front of a term [pt]
DOT_WIDTH = 7.3  # a centred dot between factors with its spaces [pt]
BRACKET_WIDTH = 5.0  # any bracket of normal size [pt]
MONOSPACE_WIDTH = 5.3  # any character of cmtt10 [pt]
_ITALIC = {
    "A": 750, "B": 759, "C": 715, "D": 828, "E": 738, "F": 643, "G": 786, "H": 831, "I": 440, "J": 555, "K": 849,
    "L": 681, "M": 970, "N": 803, "O": 763, "P": 642, "Q": 791, "R": 759, "S": 613, "T": 584, "U": 683, "V": 583,
    "W": 944, "X": 828, "Y": 581, "Z": 683, "a": 529, "b": 429, "c": 433, "d": 520, "e": 466, "f": 490, "g": 477,
    "h": 576, "i": 345, "j": 412, "k": 521, "l": 298, "m": 878, "n": 600, "o": 485, "p": 503, "q": 446, "r": 451,
    "s": 469, "t": 361, "u": 572, "v": 485, "w": 716, "x": 572, "y": 490, "z": 465,
}  # fmt: skip
_UPRIGHT = {
    "A": 750, "B": 708, "C": 722, "D": 764, "E": 681, "F": 653, "G": 785, "H": 750, "I": 361, "J": 514, "K": 778,
    "L": 625, "M": 917, "N": 750, "O": 778, "P": 681, "Q": 778, "R": 736, "S": 556, "T": 722, "U": 750, "V": 750,
    "W": 1028, "X": 750, "Y": 750, "Z": 611, "a": 500, "b": 556, "c": 444, "d": 556, "e": 444, "f": 306, "g": 500,
    "h": 556, "i": 278, "j": 306, "k": 528, "l": 278, "m": 833, "n": 556, "o": 500, "p": 556, "q": 528, "r": 392,
    "s": 394, "t": 389, "u": 556, "v": 528, "w": 722, "x": 528, "y": 528, "z": 444, ",": 444, ".": 278,
}  # fmt: skip
# Greek letters that LaTeX has as commands, with their widths in thousandths of the font size.
GREEK = {
    "alpha": 640, "beta": 566, "gamma": 518, "delta": 444, "epsilon": 406, "varepsilon": 466, "zeta": 438, "eta": 497,
    "theta": 469, "vartheta": 591, "iota": 354, "kappa": 576, "lambda": 583, "mu": 603, "nu": 494, "xi": 438,
    "rho": 517, "sigma": 571, "tau": 437, "upsilon": 540, "phi": 596, "varphi": 654, "chi": 626, "psi": 651,
    "omega": 622, "Gamma": 625, "Delta": 833, "Theta": 778, "Lambda": 694, "Xi": 667, "Sigma": 722, "Upsilon": 778,
    "Phi": 722, "Psi": 778, "Omega": 722, "pi": 570, "Pi": 750,
}  # fmt: skip


class Box(NamedTuple):
    """A piece of LaTeX in mathematics mode."""

    tex: str  # the LaTeX source
    width: float  # width at 10 pt [pt], rounded up


EMPTY = Box("", 0.0)


@cache
def italic(text: str) -> Box:
    """Letters and digits as mathematics sets them."""
    return Box(text, sum(_ITALIC.get(char, 500) / 100 for char in text) + ITALIC_SLACK)


@cache
def upright(text: str) -> Box:
    """A word in roman letters."""
    return Box("\\mathrm{" + text.replace("_", "\\_") + "}", sum(_UPRIGHT.get(char, 500) / 100 for char in text))


@cache
def greek(name: str) -> Box:
    """A Greek letter."""
    return Box(f"\\{name} ", GREEK[name] / 100 + ITALIC_SLACK)


@cache
def monospace(text: str) -> Box:
    """Any name, character by character."""
    return Box("\\mathtt{" + text.replace("_", "\\_") + "}", MONOSPACE_WIDTH * len(text))


def operator(name: str) -> Box:
    """A function's name such as cos, with the thin space that follows."""
    tex = f"\\{name} " if name in {"cos", "sin", "tan"} else f"\\operatorname{{{name}}}"
    return Box(tex, upright(name).width + 2 * 1.7)


def script(nucleus: Box, sub: Box = EMPTY, sup: Box = EMPTY) -> Box:
    """A nucleus with a subscript, a superscript or both, one above the other."""
    if not (sub.tex or sup.tex):
        return nucleus
    marked = (f"{mark}{{{box.tex.rstrip()}}}" for mark, box in (("_", sub), ("^", sup)) if box.tex)
    # One stands above the other: the wider one counts, at 7 pt, with TeX's \scriptspace behind both.
    width = nucleus.width + max(sub.width, sup.width) * SCRIPT + SCRIPT_SPACE
    return Box(nucleus.tex.rstrip() + "".join(marked), width)


def fraction(numerator: Box, denominator: Box, small: bool = False) -> Box:
    """A fraction."""
    command, scale = ("tfrac", SCRIPT) if small else ("frac", 1.0)
    width = max(numerator.width, denominator.width) * scale + 2.5
    return Box(f"\\{command}{{{numerator.tex.rstrip()}}}{{{denominator.tex.rstrip()}}}", width)


def concatenate(*boxes: Box) -> Box:
    """Boxes side by side."""
    return Box("".join(box.tex for box in boxes), sum(box.width for box in boxes))


def bracketed(*boxes: Box) -> Box:
    """Boxes side by side in a bracket of normal size."""
    return concatenate(Box("(", BRACKET_WIDTH), *boxes, Box(")", BRACKET_WIDTH))


def minus(box: Box) -> Box:
    """A box with a minus sign in front of it."""
    return Box(f"-{box.tex}", MINUS_WIDTH + box.width)


Break = IntEnum("Break", {"NEVER": 0, "BINARY": 1, "FACTOR": 2, "COMMA": 3})  # with what a line may start at a piece


class TexPiece(NamedTuple):
    """A part of an expression that stays on one line."""

    box: Box  # its LaTeX
    before: Break = Break.NEVER  # whether a line may be broken before it
    depth: int = 0  # how many brackets it stands in
    nest: int = 0  # height of the bracket that it opens or closes, 0 for other pieces


MINUS = TexPiece(Box("-", MINUS_WIDTH))


def binary(sign: str, depth: int) -> TexPiece:
    """Plus or minus between two terms."""
    return TexPiece(Box(f" {sign} ", BINARY_WIDTH), Break.BINARY, depth)


def signed_sum(terms: Iterable[tuple[bool, Iterable[TexPiece]]], depth: int = 0) -> list[TexPiece]:
    """A sum of terms: of each whether it is subtracted, and its absolute value."""
    row: list[TexPiece] = []
    for negative, pieces in terms:
        if row:
            row.append(binary("-" if negative else "+", depth))
        elif negative:
            row.append(MINUS)
        row += pieces
    return row


def joined(pieces: Iterable[TexPiece]) -> Box:
    """All pieces on one line."""
    return concatenate(*(piece.box for piece in pieces))


# -- numbers

DECIMAL_COMMA = "{,}"  # in braces, so that no space follows it


def list_separator(pieces: Iterable[TexPiece]) -> Box:
    """What stands between the members of a list: a comma, or a semicolon where a number has one inside."""
    return Box(";\\, " if any(DECIMAL_COMMA in piece.box.tex for piece in pieces) else ",\\, ", 6.0)


_DIGIT_WIDTH = 5.0
_TEN_WIDTH = 10.5


def magnitude(value: Fraction, decimals: bool, *, digits: int | None = DIGITS, comma: bool = False) -> Box:
    """The absolute value of a rational number in print, with so many significant digits, None for all."""
    found, mark = shown(abs(value), decimals=decimals, digits=digits), DECIMAL_COMMA if comma else "."
    if isinstance(found, Fraction):
        numerator, denominator = italic(str(found.numerator)), italic(str(found.denominator))
        return numerator if found.denominator == 1 else fraction(numerator, denominator, small=True)
    # As people write decimals: plainly between 0.0001 and as many digits as are shown, else m 10^e.
    exponent = found.adjusted()
    if -4 <= exponent <= (digits or DIGITS):
        plain = f"{found:f}"
        return Box(plain.replace(".", mark), _DIGIT_WIDTH * len(plain))
    power = f"10^{{{exponent}}}"
    power_width = _TEN_WIDTH + italic(str(exponent)).width * SCRIPT
    if (mantissa := f"{found:e}".partition("e")[0]) == "1":
        return Box(power, power_width)
    width = _DIGIT_WIDTH * len(mantissa) + DOT_WIDTH + power_width
    return Box(f"{mantissa.replace('.', mark)} \\cdot {power}", width)
