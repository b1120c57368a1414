"""Users' text in generated files: one function per language, after which it is text and nothing else."""

from __future__ import annotations

import html
import json
import re
import unicodedata

_LATEX = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "$": r"\$",
    "&": r"\&",
    "#": r"\#",
    "%": r"\%",
    "_": r"\_",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\char34{}",
    "'": r"'{}",
    "`": r"`{}",
    "-": r"-{}",
    "[": "{[}",
    "]": "{]}",
    "*": r"{*}",
    "\N{MICRO SIGN}": r"\ensuremath{\mu}",
    "\N{DEGREE SIGN}": r"\ensuremath{{}^\circ}",
    "\N{MULTIPLICATION SIGN}": r"\ensuremath{\times}",
    "\N{EN DASH}": "--",
    "\N{EM DASH}": "---",
    "\N{LATIN SMALL LETTER SHARP S}": r"\ss{}",
    "\N{LATIN SMALL LETTER AE}": r"\ae{}",
    "\N{LATIN CAPITAL LETTER AE}": r"\AE{}",
    "\N{LATIN SMALL LIGATURE OE}": r"\oe{}",
    "\N{LATIN CAPITAL LIGATURE OE}": r"\OE{}",
    "\N{LATIN SMALL LETTER O WITH STROKE}": r"\o{}",
    "\N{LATIN CAPITAL LETTER O WITH STROKE}": r"\O{}",
    "\N{LATIN SMALL LETTER L WITH STROKE}": r"\l{}",
    "\N{LATIN CAPITAL LETTER L WITH STROKE}": r"\L{}",
    "\N{LATIN SMALL LETTER DOTLESS I}": r"\i{}",
}
_ACCENTS = {
    "\N{COMBINING GRAVE ACCENT}": "`",
    "\N{COMBINING ACUTE ACCENT}": "'",
    "\N{COMBINING CIRCUMFLEX ACCENT}": "^",
    "\N{COMBINING TILDE}": "~",
    "\N{COMBINING DIAERESIS}": '"',
    "\N{COMBINING MACRON}": "=",
    "\N{COMBINING BREVE}": "u",
    "\N{COMBINING CARON}": "v",
    "\N{COMBINING DOUBLE ACUTE ACCENT}": "H",
    "\N{COMBINING CEDILLA}": "c",
    "\N{COMBINING DOT ABOVE}": ".",
    "\N{COMBINING RING ABOVE}": "r",
}
_MARKDOWN = frozenset("\\`*_[]{}|~$#!^")
_MARKDOWN_START = re.compile(r"([-+=>]|[0-9]+(?=[.)]))")
_LINK = re.compile(r"(?i)(?<=www)\.|:(?=//)|@|(?<=mailto):")
_GREEK = (
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon phi chi psi "
    "omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega"
)
_GREEK_COMMANDS = frozenset(_GREEK.split(" "))


def one_line(text: str) -> str:
    """All white space as single spaces; controls, direction marks and the like as ``<U+202E>``."""
    return "".join(_visible(character) for character in " ".join(text.split()))


def python_string(text: str) -> str:
    """A string literal, quotes included, in ASCII."""
    literal = ascii(text)
    return f'"{literal[1:-1]}"' if literal[0] == "'" and '"' not in literal and "\\'" not in literal else literal


def python_docstring(text: str) -> str:
    """Text for between triple double quotes, on one line."""
    return one_line(text).replace("\\", "\\\\").replace('"', '\\"')


def python_comment(text: str) -> str:
    """Text for behind ``#``."""
    return one_line(text)


_RISKY_PAIR = re.compile(r"\*(?=/)|/(?=\*)|\?(?=\?)")
"""First letters of the pairs that end or open a C comment or begin a trigraph."""


def c_comment(text: str) -> str:
    """Text for a C comment of either kind; no end of comment, no trigraph, no continued line."""
    return _RISKY_PAIR.sub(lambda match: match[0] + " ", one_line(text).replace("\\", "/"))


_RESERVED_START = re.compile(r"(is|mem|str|to|wcs)[a-z]|[0-9_]")
"""How names of functions begin that belong to C's library, now or later (C99 7.26), or to nobody."""


def c_prefix(name: str) -> str:
    """A robot's name as the beginning of C identifiers, its underscore at the end included."""
    plain = re.sub(r"[^A-Za-z0-9]", "_", name)
    return f"robot_{plain}_" if _RESERVED_START.match(plain) else f"{plain}_"


def html_text(text: str) -> str:
    """Text for an HTML element or a quoted attribute; a space at either end stays."""
    body = html.escape(one_line(text))
    if not body:
        return " " if text else ""
    return f"{' ' if text[0].isspace() else ''}{body}{' ' if text[-1].isspace() else ''}"


def javascript_string(text: str) -> str:
    """A string literal, quotes included, in ASCII; inert inside an HTML script element, too."""
    return json.dumps(text).replace("<", "\\u003c").replace(">", "\\u003e").replace("\x7f", "\\u007f")


def javascript_name(name: str) -> str:
    """The variable that holds a user's symbol: a namespace of its own, clear of keywords and of our names."""
    return f"p_{name}"


def javascript_comment(text: str) -> str:
    """Text for a comment of either kind, also inside an HTML script element."""
    return c_comment(text).replace("<", "< ")


def latex_text(text: str) -> str:
    """Text for a LaTeX paragraph, for any engine and font encoding; letters no font has appear as their code."""
    return "".join(_latex_character(character) for character in unicodedata.normalize("NFC", one_line(text)))


def markdown_text(text: str) -> str:
    """Text for a Markdown paragraph, heading or table cell; neither markup nor HTML nor a link."""
    escaped = "".join(_markdown_character(character) for character in one_line(text))
    unlinked = _LINK.sub(lambda found: "\\" + found.group(), escaped)
    start = _MARKDOWN_START.match(unlinked)
    if start is None:
        return unlinked
    digits = start.group().isdigit()
    at = start.end() if digits else 0
    return unlinked[:at] + "\\" + unlinked[at:]


def _visible(character: str) -> str:
    hidden = unicodedata.category(character) in ("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp")
    return f"<U+{ord(character):04X}>" if hidden else character


def _latex_character(character: str) -> str:
    if character in _LATEX:
        return _LATEX[character]
    if character.isascii():
        return character
    name = unicodedata.name(character, "")
    if name.startswith("GREEK ") and " LETTER " in name:
        return _greek(name) or _code(character)
    base, *marks = tuple(unicodedata.normalize("NFD", character))
    if base.isascii() and base.isalpha() and len(marks) == 1 and marks[0] in _ACCENTS:
        letter = "\\" + base + "{}" if base in "ij" and marks[0] not in "\N{COMBINING CEDILLA}" else base
        return f"\\{_ACCENTS[marks[0]]}{{{letter}}}"
    return _code(character)


def _greek(name: str) -> str:
    """A Greek letter that LaTeX has as a command, or nothing."""
    size, _, letter = name.removeprefix("GREEK ").partition(" LETTER ")
    word = letter.lower().replace("lamda", "lambda")
    command = word.capitalize() if size == "CAPITAL" else word
    return f"\\ensuremath{{\\{command}}}" if command in _GREEK_COMMANDS else ""


def _code(character: str) -> str:
    return f"{{[}}U+{ord(character):04X}{{]}}"


def _markdown_character(character: str) -> str:
    if character == "&":
        return "&amp;"
    if character == "<":
        return "&lt;"
    if character == ">":
        return "&gt;"
    return "\\" + character if character in _MARKDOWN else character
