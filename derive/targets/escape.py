"""Users' text in generated files: one function per language, after which it is text and nothing else."""

import html
import json
import re
import unicodedata

_LETTERS = {"ß": "ss", "æ": "ae", "Æ": "AE", "œ": "oe", "Œ": "OE", "ø": "o", "Ø": "O", "ł": "l", "Ł": "L"}
_LATEX = {
    "\\": r"\textbackslash{}",
    **{character: f"\\{character}" for character in "{}$&#%_"},
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\char34{}",
    **{character: f"{character}{{}}" for character in "'`-"},
    **{character: f"{{{character}}}" for character in "[]*"},
    "\N{MICRO SIGN}": r"\ensuremath{\mu}",
    "\N{DEGREE SIGN}": r"\ensuremath{{}^\circ}",
    "\N{MULTIPLICATION SIGN}": r"\ensuremath{\times}",
    "\N{RIGHTWARDS ARROW}": r"\ensuremath{\rightarrow}",
    "\N{EN DASH}": "--",
    "\N{EM DASH}": "---",
    **{letter: f"\\{name}{{}}" for letter, name in _LETTERS.items()},
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
_GREEK_WORDS = (
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon phi chi psi "
    "omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega"
)
GREEK_LETTERS = frozenset(_GREEK_WORDS.split(" "))  # letters that LaTeX has as commands
_MARKDOWN = {
    **{character: f"\\{character}" for character in "\\`*_[]{}|~$#!^"},
    **{"&": "&amp;", "<": "&lt;", ">": "&gt;"},
}
_MARKDOWN_START = re.compile(r"[-+=>]|([0-9]+)(?=[.)])")
_MARKDOWN_LINK = re.compile(r"(?i)(?<=www)\.|:(?=//)|@|(?<=mailto):")

_C_PAIR = re.compile(r"\*(?=/)|/(?=\*)|\?(?=\?)")  # pairs that end or open a C comment or begin a trigraph
_MATLAB_NAME_LENGTH = 63  # characters of a name that MATLAB tells apart
# Keywords, Octave's among them, that have underscores.
_MATLAB_KEYWORDS = frozenset({"end_try_catch", "end_unwind_protect", "unwind_protect", "unwind_protect_cleanup"})
# How names of functions begin that belong to C's library, now or later (C99 7.26), or to nobody.
_C_RESERVED = re.compile(r"(is|mem|str|to|wcs)[a-z]|[0-9_]")


def one_line(text: str) -> str:
    """Text without anything that moves or hides other text; as it is, for a comment of MATLAB."""
    hidden = ("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp")
    plain = " ".join(text.split())
    return "".join(f"<U+{ord(c):04X}>" if unicodedata.category(c) in hidden else c for c in plain)


def python_string(text: str) -> str:
    """A string literal of Python."""
    literal = ascii(text)
    return f'"{literal[1:-1]}"' if literal[0] == "'" and '"' not in literal and "\\'" not in literal else literal


def python_docstring(text: str) -> str:
    """Text for between triple double quotes."""
    return one_line(text).replace("\\", "\\\\").replace('"', '\\"')


def c_comment(text: str) -> str:
    """Text for a C comment of either kind."""
    return _C_PAIR.sub(lambda match: match[0] + " ", one_line(text).replace("\\", "/"))


def c_prefix(name: str) -> str:
    """A robot's name as the beginning of C identifiers."""
    plain = re.sub(r"[^A-Za-z0-9]", "_", name)
    return f"robot_{plain}_" if _C_RESERVED.match(plain) else f"{plain}_"


def matlab_package(name: str) -> str:
    """A robot's name as that of a package of MATLAB and Octave, whose functions hardly ever have underscores."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    is_free = "_" in plain and plain[0].isalpha() and plain not in _MATLAB_KEYWORDS
    return (plain if is_free else f"robot_{plain}")[:_MATLAB_NAME_LENGTH].rstrip("_")


def matlab_symbol(name: str, place: int) -> str:
    """What a user's symbol is called in the names of variables, behind letters of ours."""
    return name if len(name) < _MATLAB_NAME_LENGTH - 2 else str(place)


def matlab_string(text: str) -> str:
    """A string literal of MATLAB and Octave."""
    return "'" + one_line(text).replace("'", "''") + "'"


def html_text(text: str) -> str:
    """Text for an HTML element or a quoted attribute."""
    if not (body := html.escape(one_line(text))):
        return " " if text else ""
    return f"{' ' if text[0].isspace() else ''}{body}{' ' if text[-1].isspace() else ''}"


def xml_text(text: str) -> str:
    """Text for an XML element or a quoted attribute."""
    escaped = html.escape(text, quote=False).replace('"', "&quot;")
    return re.sub("[\ud800-\udfff\ufffe\uffff]", "\N{REPLACEMENT CHARACTER}", escaped)


def javascript_string(text: str) -> str:
    """A string literal of JavaScript."""
    return json.dumps(text).replace("<", "\\u003c").replace(">", "\\u003e").replace("\x7f", "\\u007f")


def javascript_comment(text: str) -> str:
    """Text for a comment of either kind, also inside an HTML script element."""
    return c_comment(text).replace("<", "< ")


def latex_text(text: str) -> str:
    """Text for a LaTeX paragraph, for any engine and font encoding."""
    return "".join(_latex_character(character) for character in unicodedata.normalize("NFC", one_line(text)))


def _latex_character(character: str) -> str:
    """One character: as it is, by its escape, as a Greek command, as a letter with an accent, or by its code."""
    if character in _LATEX or character.isascii():
        return _LATEX.get(character, character)
    if (name := unicodedata.name(character, "")).startswith("GREEK ") and " LETTER " in name:
        size, _, letter = name.removeprefix("GREEK ").partition(" LETTER ")
        word = letter.lower().replace("lamda", "lambda")
        if (command := word.capitalize() if size == "CAPITAL" else word) in GREEK_LETTERS:
            return f"\\ensuremath{{\\{command}}}"
    base, *marks = tuple(unicodedata.normalize("NFD", character))
    if base.isascii() and base.isalpha() and len(marks) == 1 and marks[0] in _ACCENTS:
        letter = "\\" + base + "{}" if base in "ij" and marks[0] not in "\N{COMBINING CEDILLA}" else base
        return f"\\{_ACCENTS[marks[0]]}{{{letter}}}"
    return f"{{[}}U+{ord(character):04X}{{]}}"


def markdown_text(text: str) -> str:
    """Text for a Markdown paragraph, heading or table cell."""
    escaped = "".join(_MARKDOWN.get(character, character) for character in one_line(text))
    unlinked = _MARKDOWN_LINK.sub(lambda found: "\\" + found.group(), escaped)
    if (start := _MARKDOWN_START.match(unlinked)) is None:
        return unlinked
    at = start.end(1) if start[1] else 0  # "1. " would begin a list
    return unlinked[:at] + "\\" + unlinked[at:]
