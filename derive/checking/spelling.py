r"""What authors spell in other ways, written as LaTeX: ``ẋ``, ``√(a+b)``, ``\frac l2``, ``\pmatrix{}``, plain text.

Every character of the result knows from which one it comes.
"""

import re
import unicodedata
from collections.abc import Callable, Sequence

_DOTTED = re.compile("([A-Za-z\u0370-\u03ff])([\u0307\u0308])|[\u1e8b\u1e8f\u017c\u1e59\u1e57\u1e8d\u00ff\u1e97]")
_ONE = r"(?:\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\}|\\[A-Za-z]+|[A-Za-z0-9])"
_FRACTION = re.compile(rf"(\\[tdc]?frac)(?![A-Za-z])\s*({_ONE})\s*({_ONE})")
# A condition: a joint angle that is nearly a multiple of a right angle.
_NEARLY = re.compile(
    r"((?:\\(?:var)?theta|(?<![A-Za-z\\])[qCScs])\s*_\s*\{?[0-9]{1,2}\}?\s*)\\(?:approx|simeq)(\s*-?\s*(?:0|1|90|180|\\pi)(?![0-9.]))"
)
_OLD_MATRIX = re.compile(r"\\(p?matrix)\s*\{((?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*)\}")

_ROW_END, _TWO = re.compile(r"\\cr(?![A-Za-z])"), r"\\\\"

# A line of plain text that is an equation: a name, an equals sign, and no two words side by side.
_EQUATION = re.compile(
    r"^[ \t]*(?:[-*\u2022][ \t]+|\(?[0-9]{1,2}[.)][ \t]+)?"
    r"(?P<equation>[A-Za-z\u0370-\u03ff][\w'.,()\[\]^]{0,24}[ \t]*=[ \t]*[^=\n]*"
    r"[0-9A-Za-z\u0370-\u03ff)\]'\u00b2\u00b3])[ \t]*[.,;]?[ \t]*$",
    re.MULTILINE,
)
_DIRECTIVE = re.compile(
    r"^(?P<indent>[ \t]*)\.\. math::[ \t]*(?P<line>[^\n]*)\n(?P<body>(?:[ \t]*\n|(?P=indent)[ \t]+\S[^\n]*(?:\n|\Z))*)",
    re.MULTILINE,
)
# A display whose brackets lost their backslashes, and the name that a program shows before a matrix.
_LOST = re.compile(r"^[ \t]*\[[ \t]*\n(?P<body>(?:(?![ \t]*[][][ \t]*$)[^\n]*\n){1,40})[ \t]*\][ \t]*$", re.MULTILINE)
_SHOWN = re.compile(
    r"^(?P<name>[A-Za-z]+[0-9]*)(?:_(?P<sub>\w{1,9}))?[ \t]*=[ \t]*\n\s*(?P<display>\$\$?\s*)(?=\\(left|begin))",
    re.MULTILINE,
)
_WORD = re.compile(
    r"(?<![A-Za-z\\])(?:[A-Za-z]+2?\(|(?P<greek>theta|phi|psi|alpha|beta|gamma|pi)_?(?P<index>[0-9]*)(?![A-Za-z]))"
)

Spelled = tuple[str, Sequence[int]]  # a text, and for each character the offset from which it comes


def spelled(text: str) -> Spelled:
    """The text in LaTeX."""
    found: Spelled = text, range(len(text))
    for pattern, write in _WAYS:
        found = _rewritten(found, pattern, write)
    return found


def from_plain_text(text: str) -> Spelled:
    """The equations of a text without mathematics between signs, each a display: ``theta2 = atan2(y, x)``."""
    found = _rewritten((text, range(len(text))), _DIRECTIVE, _display)
    found = _rewritten(found, _LOST, _restored)
    found = _rewritten(found, _SHOWN, lambda m: f"{m['display']}{m['name']}_{{{m['sub']}}} = ".replace("_{None}", ""))
    if re.search(r"\$|\\\(|\\\[|\\begin", found[0]):
        return found

    def display(match: re.Match[str]) -> str:
        equation = match["equation"]
        is_prose = re.search(r"(?<![\w\\])[^\W\d_]{2,}[ \t]+[^\W\d_]{2,}", equation)
        return match[0] if is_prose else f"$${_WORD.sub(_macro, equation)}$$"

    return _rewritten((text, range(len(text))), _EQUATION, display)


def _display(match: re.Match[str]) -> str:
    """A block of mathematics of reStructuredText as displays, one for each paragraph."""
    body = re.sub(r"(?m)^[ \t]+:[a-z]+:[^\n]*$", "", f"{match['line']}\n{match['body']}").strip("\n")
    return "$$" + re.sub(r"\n[ \t]*\n(?=[ \t]*\S)", "$$\n\n$$", body) + "$$\n\n"


def _restored(match: re.Match[str]) -> str:
    """A display between brackets on lines of their own, outside of other mathematics."""
    before = match.string[: match.start()]
    is_inside = before.count("\\[") > before.count("\\]") or before.count("$$") % 2 or "\\" not in match["body"]
    return match[0] if is_inside else f"$${match['body']}$$"


def _macro(match: re.Match[str]) -> str:
    r"""A function or a Greek letter of plain text: ``\operatorname{atan2}(``, ``\theta_{12}``."""
    if match["greek"]:
        return f"\\{match['greek']}" + (f"_{{{match['index']}}}" if match["index"] else " ")
    name = match[0][:-1]
    known = {"sqrt", "sin", "cos", "tan", "atan", "acos", "asin", "atan2", "arctan", "arccos", "arcsin", "sgn", "sign"}
    return f"\\operatorname{{{name}}}(" if name.casefold() in known else match[0]


def _rewritten(found: Spelled, pattern: re.Pattern[str], write: Callable[[re.Match[str]], str]) -> Spelled:
    text, origins = found
    pieces, places, last = list[str](), list[int](), 0
    for match in pattern.finditer(text):
        new = write(match)
        pieces += [text[last : match.start()], new]
        places += origins[last : match.start()]
        at = 0
        for letter in new:  # what is written comes from the characters of the old text in the same order
            at = max(at, match[0].find(letter, at))
            places.append(origins[match.start() + at])
        last = match.end()
    return ("".join([*pieces, text[last:]]), [*places, *origins[last:]]) if pieces else found


def _dotted(match: re.Match[str]) -> str:
    plain = unicodedata.normalize("NFD", match[0])
    return f"\\{'dot' if plain[1] == chr(0x307) else 'ddot'}{{{plain[0]}}}"


def _fraction(match: re.Match[str]) -> str:
    parts = [part if part.startswith("{") else f"{{{part}}}" for part in match.groups()[1:]]
    return match[0] if all(part.startswith("{") for part in match.groups()[1:]) else match[1] + "".join(parts)


_OVER = re.compile(
    r"\{\s*(\\partial(?![A-Za-z])(?:[^{}]|\{[^{}]*\})*?)\\over(?![A-Za-z])((?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*)\}"
)
_SLOPE = re.compile(rf"(\\partial\s*{_ONE}(?:_{_ONE})?)\s*/\s*(\\partial\s*{_ONE}(?:_{_ONE})?)")
# The square of a vector's length.
_NORM = re.compile(
    r"(?:\\left\s*)?\\(?:\||[lr]?Vert)\s*((?:(?!\\\||\\[lr]?Vert|\\right|\^\{?0)[^$])*?)(?:\^\{?0\}?)?\s*"
    r"(?:\\right\s*)?\\(?:\||[lr]?Vert)\s*\^\s*(?:2|\{\s*2\s*\})"
)
_INNER = r"\{((?:[^{}]|\{[^{}]*\})*)\}"
_BEFORE = re.compile(rf"\\(?:sideset\s*{_INNER}\s*{_INNER}|prescript\s*{_INNER}\s*{_INNER})")  # scripts before a letter
_NESTED = r"(?:[^()$]|\((?:[^()$]|\([^()$]*\))*\))*"
_WAYS: tuple[tuple[re.Pattern[str], Callable[[re.Match[str]], str]], ...] = (
    (_DOTTED, _dotted),
    (re.compile(r"\u221a\s*(?:\(((?:[^()]|\([^()]*\))*)\)|(\w+))"), lambda m: f"\\sqrt{{{m[1] or m[2]}}}"),
    (re.compile(rf"\\sqrt\s*\(({_NESTED})\)"), lambda m: f"\\sqrt{{{m[1]}}}"),
    (_FRACTION, _fraction),
    (_BEFORE, lambda m: "{}" + re.sub(r"[_^]\{\}", "", m[1] + m[2] if m[4] is None else f"^{{{m[3]}}}_{{{m[4]}}}")),
    (re.compile(r"\\langle((?:(?!\\[lr]angle|\|)[^$])*,(?:(?!\\[lr]angle|\|)[^$])*)\\rangle"), lambda m: f"({m[1]})"),
    (re.compile(r"\\_(?=[0-9A-Za-z{])"), lambda m: "_"),
    (re.compile(r"(?<![A-Za-z\\])([csCS])_([0-9]{2,3})(?![0-9])"), lambda m: f"{m[1]}_{{{m[2]}}}"),  # as it is meant
    (_OVER, lambda m: f"\\frac{{{m[1]}}}{{{m[2]}}}"),
    (_SLOPE, lambda m: f"\\frac{{{m[1]}}}{{{m[2]}}}"),
    # pandoc's indices and exponents, a~1~^2^, and a display in dollar signs of a line
    (re.compile(r"(?<=[A-Za-z0-9*^}])~([0-9]{1,3})~"), lambda m: f"_{{{m[1]}}}"),
    (re.compile(r"(?<=[A-Za-z0-9*}\s])\^([0-9*])\^"), lambda m: f"^{{{m[1]}}}"),
    (re.compile(r"(?<!\$)\$\s*(\\begin\{(equation|align)(\*?)\}[^$]*\\end\{\2\3\})\s*\$"), lambda m: m[1]),
    # a point or its velocity by its coordinates, P_1(l_1 c_1, l_1 s_1)
    (re.compile(r"\$([PV]_\{?\w\}?)(\((?=[^=$]*,)[^=$]*\\(?:sin|cos)[^=$]*\))\$"), lambda m: f"${m[1]} = {m[2]}$"),
    (_NORM, lambda m: f"{m[1]}^T {m[1]}"),
    (_NEARLY, lambda m: f"{m[1]}={m[2]}"),
    (re.compile(r"(?<![A-Za-z\\])([csCS])\{([0-9]{1,4})\}"), lambda m: f"{m[1]}_{{{m[2]}}}"),
    (_OLD_MATRIX, lambda m: f"\\begin{{{m[1]}}}{_ROW_END.sub(_TWO, m[2])}\\end{{{m[1]}}}"),
)
