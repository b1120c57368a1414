"""Equations in plain text as displays of LaTeX: ``theta2 = atan2(y, x)``, lines in blocks of code, rows in brackets."""

import re
import unicodedata
from collections.abc import Iterable

from derive.checking.latex.typography import Spelled, blank, rewritten

CODE = "\ue005"  # on both sides of an equation that stood between backquotes
_LETTER = r"[^\W\d_]"
_NAME = rf"(?:{_LETTER}[\w'\u0307\u0308]{{0,12}}|(?:cos|sin|det)[ \t]*\(?\w+\)?)"
_FUNCTIONS = r"(?:arc|a)?(?:sin|cos|tan|sen|tg)2?"
# Equations in a block of code, one in each line, with nothing that programs alone have.
_SIDES = r"(?:=(?!=)(?:[^=\n#;:\"`.\[\ue005]|(?<=\d)\.(?=\d))+)+"
_LISTED = re.compile(rf"(?:[ \t]*(?:{_NAME}[ \t]*{_SIDES})?\n)+")
_BETWEEN_WORDS = re.compile(rf"{_NAME}[ \t]*{_SIDES}")
# A line that is an equation: a name, an equals sign, and no two words side by side.
_EQUATION = re.compile(
    r"^[ \t]*(?:[-*\u2022][ \t]+|\(?[0-9]{1,2}[.)][ \t]+)?(?:\*\*)?"
    rf"(?P<equation>{_LETTER}(?:et[ \t]|[\w'.,()\[\]^\u0307\u0308]){{0,24}}(?:\*\*)?[ \t]*(?:=(?!=)[ \t]*[^=\n]*)+"
    r"[0-9A-Za-z\u0370-\u03ff)\]'\u00b0\u00b2\u00b3\u2080-\u2089])[ \t]*[.,;\u2713]?[ \t]*$",
    re.MULTILINE,
)
_TYPED = re.compile(
    rf"[\u00b2\u00b3\u2080-\u2089\u221a]|(?:{_FUNCTIONS}|sqrt)\s*\(|(?<!\w)(?:{_FUNCTIONS})[ \t]+[^=\s]"
)
# Rows in brackets, J = [[a, b], [c, d]], behind each other or below each other.
_ROW = r"\[[^\[\]\n=]+\]"
_ROWS = re.compile(rf"\[[ \t]*{_ROW}(?:[ \t]*,?[ \t]*\n?[ \t]*{_ROW})+[ \t]*\]")
_MATRIX = re.compile(
    rf"^(?P<left>[ \t]*{_LETTER}\w{{0,9}}(?:\([\w, ]*\))?[ \t]*=[ \t]*)(?P<rows>{_ROWS.pattern})", re.MULTILINE
)
_BRACKETED = re.compile(r"\[([^\[\]]+)\]")
# Matrices drawn over lines, a row of each on every line, between them on one line what they are: J = [a  b] [u]
_DRAWN = re.compile(r"^(?:[^\[\]\n]*=[ \t]*\n)?(?:[^\[\]\n]*(?:\[[^\[\]\n=]+\][ \t=]*)+(?:\n|\Z)){2,}", re.MULTILINE)
_DIRECTIVE = re.compile(
    r"^(?P<indent>[ \t]*)\.\. math::[ \t]*(?P<line>[^\n]*)\n(?P<body>(?:[ \t]*\n|(?P=indent)[ \t]+\S[^\n]*(?:\n|\Z))*)",
    re.MULTILINE,
)
_PARAGRAPH = re.compile(r"(?:^[^\n]*\S[^\n]*(?:\n|\Z))+", re.MULTILINE)
# A display whose brackets lost their backslashes, and the name that a program shows before a matrix.
_LOST = re.compile(r"^[ \t]*\[[ \t]*\n(?P<body>(?:(?![ \t]*[][][ \t]*$)[^\n]*\n){1,40})[ \t]*\][ \t]*$", re.MULTILINE)
_SHOWN = re.compile(
    r"^(?P<name>[A-Za-z]+[0-9]*)(?:_(?P<sub>\w{1,9}))?[ \t]*=[ \t]*\n\s*(?P<display>\$\$?\s*)(?=\\(left|begin))",
    re.MULTILINE,
)
# Where an arm stands, between words: "at \u03b8\u2081 = 10\u00b0".
_STATED = re.compile(
    r"(?s)\$\$.*?\$\$|\$[^$]*\$|\\\(.*?\\\)|\\\[.*?\\\]|\\begin\{(\w+)\*?\}.*?\\end\{\1\}"
    r"|(?<![\w=])(?P<stated>[\u03b1-\u03c9qd][1-9\u2081-\u2089][ \t]*=[ \t]*[-\u2212]?[0-9][0-9.]*\u00b0?)"
    r"(?![\w=.,][0-9]|[ \t]*[-+*/=\u00b7])"
)
_WORD = re.compile(
    rf"(?<![A-Za-z\\])(?:[A-Za-z]+2?\(|(?P<function>{_FUNCTIONS})[ \t]+(?=[^=\s(])"
    r"|(?P<letter>theta|phi|psi|alpha|beta|gamma|pi|[\u03b1-\u03c9]|[A-Za-z](?=[0-9]*_dd?ot\b))(?P<dots>[\u0307\u0308]?)"
    r"_?(?P<index>[0-9]*)(?:_(?P<rate>dd?)ot\b|(?![A-Za-z])))"
)
_DOTS = {"\u0307": "\\dot", "\u0308": "\\ddot", "d": "\\dot", "dd": "\\ddot"}


def is_equation(code: str) -> bool:
    """Whether code inside a line is an equation of the text, not of a program."""
    return bool(_BETWEEN_WORDS.fullmatch(code) and (_TYPED.search(code) or re.search("[\u03b1-\u03c9]", code)))


def is_listed(block: str) -> bool:
    """Whether a block of code is a list of equations."""
    return bool(_LISTED.fullmatch(_DRAWN.sub("M = M\n", _ROWS.sub("M", block))))


def from_plain_text(text: str) -> Spelled:
    """The equations of a text without mathematics between signs, each a display."""
    found = rewritten((text, range(len(text))), _DIRECTIVE, _display)
    found = rewritten(found, _LOST, _restored)
    found = rewritten(found, _SHOWN, lambda m: f"{m['display']}{m['name']}_{{{m['sub']}}} = ".replace("_{None}", ""))
    is_signed = re.search(r"\$|\\\(|\\\[|\\begin\{(?!\w?matrix|array|cases)", found[0])
    if not is_signed and "\\begin" in found[0]:  # LaTeX that was copied without the marks around it
        return rewritten(found, _PARAGRAPH, lambda m: f"$${m[0].strip()}$$\n" if "=" in m[0] else m[0])
    found = rewritten(found, _DRAWN, _drawn)
    found = rewritten(found, _MATRIX, lambda m: f"$${m['left'].strip()} {_matrix(_BRACKETED.findall(m['rows']))}$$")
    outside = re.sub(r"(?s)\$\$.*?\$\$|\\\[.*?\\\]|\\begin\{(\w+)\*?\}.*?\\end\{\1\}", lambda m: blank(m[0]), found[0])

    def display(match: re.Match[str]) -> str:
        equation = match["equation"]
        is_prose = bool(re.search(rf"(?<![\w\\]){_LETTER}{{2,}}[ \t]+{_LETTER}{{2,}}", _WORD.sub(" ", equation)))
        if is_signed:  # outside of mathematics, with an index, a root or a function as plain text has them
            is_prose |= outside[match.start("equation")] == " " or not _TYPED.search(equation)
            is_prose |= bool(re.search(r"[\\$&`#;]|\w\*\*\w", equation))
        equation = re.sub(r"\*\*(?=[ \t]*=)", "", equation)
        return match[0] if is_prose else f"$${_WORD.sub(_macro, equation)}$$"

    found = rewritten(found, _EQUATION, display)
    found = rewritten(found, _STATED, lambda m: f"${_WORD.sub(_macro, m['stated'])}$" if m["stated"] else m[0])
    return rewritten(found, re.compile(f"{CODE}([^{CODE}]+){CODE}"), lambda m: f"${_WORD.sub(_macro, m[1])}$")


def _display(match: re.Match[str]) -> str:
    """A block of mathematics of reStructuredText as displays, one for each paragraph."""
    body = re.sub(r"(?m)^[ \t]+:[a-z]+:[^\n]*$", "", f"{match['line']}\n{match['body']}").strip("\n")
    return "$$" + re.sub(r"\n[ \t]*\n(?=[ \t]*\S)", "$$\n\n$$", body) + "$$\n\n"


def _restored(match: re.Match[str]) -> str:
    """A display between brackets on lines of their own, outside of other mathematics."""
    before = match.string[: match.start()]
    is_inside = before.count("\\[") > before.count("\\]") or before.count("$$") % 2 or "\\" not in match["body"]
    return match[0] if is_inside else f"$${match['body']}$$"


def _drawn(match: re.Match[str]) -> str:
    """Matrices drawn over lines as one equation."""
    lines = match[0].rstrip("\n").split("\n")
    head = "" if "[" in lines[0] else lines.pop(0)
    rows = [_BRACKETED.findall(line) for line in lines]
    beside = [" ".join(_BRACKETED.sub("[]", line).split()) for line in lines]
    own = [text for text in beside if text.strip("[] ")] or beside[:1]
    said = head + own[0]
    if len(own) > 1 or len({*map(len, rows)}) > 1 or said.count("=") != 1 or re.search(r"[\\$]", match[0]):
        return match[0]
    matrices = (*map(_matrix, zip(*rows, strict=True)), "")
    parts = _WORD.sub(_macro, said).split("[]")
    return "$$" + "".join(part + matrix for part, matrix in zip(parts, matrices, strict=True)) + "$$\n"


def _matrix(rows: Iterable[str]) -> str:
    """A matrix of rows, whose entries commas part, or two spaces."""
    parted = (re.sub(r",(?![^(]*\))[ \t]*|[ \t]{2,}", " & ", row.strip()) for row in rows)
    return "\\begin{bmatrix}" + _WORD.sub(_macro, "\\\\\n".join(parted)) + "\\end{bmatrix}"


def _macro(match: re.Match[str]) -> str:
    r"""A function or a Greek letter of plain text: ``\operatorname{atan2}(``, ``\theta_{12}``."""
    if match["function"]:
        return f"\\operatorname{{{match['function']}}} "
    if letter := match["letter"]:
        name = letter if letter.isascii() else unicodedata.name(letter).split()[-1].lower()
        plain, dotted = name if len(name) == 1 else f"\\{name}", _DOTS.get(match["rate"] or match["dots"], "")
        return (f"{dotted}{{{plain}}}" if dotted else plain) + (f"_{{{match['index']}}}" if match["index"] else " ")
    name = match[0][:-1]
    known = {"sqrt", "sin", "cos", "tan", "atan", "acos", "asin", "atan2", "arctan", "arccos", "arcsin", "sgn", "sign"}
    return f"\\operatorname{{{name}}}(" if name.casefold() in known | {"sen", "tg"} else match[0]
