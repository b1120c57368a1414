r"""What only moves ink in LaTeX is blanked, and the many ways to write one thing become one; every offset stays.

``\frac{d}{dt} q_1`` becomes ``\dot q_1``, and the argument of ``q_1(t)`` goes, as SymPy, MATLAB and Mathematica write
them. Nothing is shifted: an error in the result is one at the same place of the text as it was typed. Before, what
authors spell in other ways is written as LaTeX: ``ẋ``, ``√(a+b)``, ``\frac l2``, ``\pmatrix{}``, plain text; there
every character of the result knows from which one it comes.
"""

import re
import unicodedata
from collections.abc import Callable, Sequence
from functools import partial

PRIMED = {1: "\ue001", 2: "\ue002"}  # what stands for one and two primes of a function of time, ``q_1'(t)``
# A word between two formulas of which either may hold.
ALTERNATIVE = re.compile(r"\\(?:text|mathrm|mbox|textrm)\s*\{\s*(?:or|oder|ou|oppure|o|\u6216)\s*\}")
_GROUP = r"\{(?:[^{}]|\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\})*\}"
_END = r"(?![A-Za-z])"
_IDLE = (
    "nonumber|notag|displaystyle|textstyle|scriptstyle|scriptscriptstyle|hline|toprule|midrule|bottomrule|limits|nolimits|"
    "strut|mathstrut|space|allowbreak|nobreak|break|null|relax|protect|noindent|centering|par|medskip|bigskip|smallskip|hfill|"
    "normalsize|small|footnotesize|scriptsize|tiny|large|Large|boldmath|thinspace|medspace|thickspace|negthinspace|"
    "ldotp|negmedspace|negthickspace|begingroup|endgroup|bf|rm|bold|cal|it"
)
_INK = re.compile(
    r"(?P<kept>\\\\)"
    rf"|\\(?:label|tag\*?|hspace\*?|vspace\*?|mspace|[hv]?phantom|color|ref|eqref|cite|footnote)\s*{_GROUP}"
    rf"|\\textcolor\s*{_GROUP}"
    rf"|\\(?:left|right|[bB]igg?[lrm]?)\s*\."
    rf"|\\(?:left|right|middle|[bB]igg?[lrm]?){_END}\s?"
    rf"|\\(?:{_IDLE}){_END}"
    rf"|\\(?:underline|smash|cancel|mathop|mathrel|mathbin|mathord|mathopen|mathclose|mathinner|hbox){_END}"
    r"|\\(?:hskip|kern|mkern|mskip)\s*-?[0-9.]+\s*[a-z]{2}"
    r"|\\(?:brk|fac)\s*[0-9]"  # where the handout's fragments may be broken
    rf"|\\in\s*\\?(?:mathbb|mathbf|mathds|R|Re)?\s*\{{?\s*R?\s*\}}?\s*\^\s*(?:{_GROUP}|[0-9])"  # \in R^{{2 x 2}}
    r"|_\s*\{\s*[0-9]\s*\\times\s*[0-9]\s*\}"  # the size of a matrix
    r"|\\[,;:!> /]|~"
    r"|\\(?:mathrm|mathit|mathbf|text|textrm|mbox)\s*\{\s*\}"
    rf"|\\(?:mathrm|text|textrm)\s*\{{\s[a-zA-Z]+\}}\s*\^\s*(?:{_GROUP}|[0-9])"  # a unit, 18.85 \text{{ m}}^2
    # nothing in braces, but where it bears the scripts of the letter behind it: {}^0T_1
    r"|(?<=[A-Za-z0-9)}\]])\{\s*\}(?=\s*\^\s*(?:\{[^{}]*\}|[0-9])(?![_^]|\\?[A-Za-z{]))|\{\s*\}(?!\s*[_^])"
)
# A unit behind a number or a matrix, 1~\mathrm{m}, but no upright letter of a name, which would go on.
_OF_UNIT = re.compile(
    r"(?P<kept>[0-9]|\\pi|\\end\{[bpv]?matrix\})(?:[\s~]|\\[,;: ])*\\(?:mathrm|text|textrm|mbox)\s*\{"
    r"(?:[\s~/.]|\\[,;: ]|\\cdot|(?:[ckm]?m|rad|deg|kg|Nm?|[sJW]|Hz)(?![A-Za-z])(?:\^\{?-?[0-9]\}?)?)+\}"
    r"(?:\^\{?-?[0-9]\}?)?"
    r"(?=[\s~]*(?:$|[,;.$=&)\]\u2248]|\\[\])\\]|\\q?quad|\\end|\\text|\\approx))"
)
_STAR = rf"\^ *(?:\{{ *(?:\*|\\(?:ast|star){_END}) *\}}|\*|\\(?:ast|star){_END})"  # of what moves
_LETTER = r"(?:\\(?:var)?theta|(?<![A-Za-z\\])[csqdxyzpP])"
_SUB = r"(?:\s*_\s*(?:\{\s*\w+\s*\}|\w))"
# theta_2^* = theta_2 - 90 degrees and p_x - l_3 c_alpha = p_x^*, where the star makes another name
_STARRED = re.compile(
    rf"(?P<letter>{_LETTER})(?P<sub>{_SUB}?)\s*{_STAR}(?P<late>{_SUB}?)\s*&?\s*=[^=$\n]*?(?P=letter)(?P=sub)(?P=late)(?!\s*[_^])"
    rf"|(?P<name>{_LETTER}{_SUB}?)(?!\s*[_^])[^=$\n]*=\s*&?\s*(?P=name)\s*{_STAR}"
)
_STARS = re.compile(rf"(?P<kept>(?:(?P<letter>{_LETTER}){_SUB}?\s*)?){_STAR}")
_BRACE = re.compile(rf"\\(?:underbrace|overbrace)\s*(?P<kept>{_GROUP})\s*(?:[_^]\s*(?:{_GROUP}|[A-Za-z0-9]))?")
_BOXED = re.compile(rf"\\(?:boxed|ensuremath|fbox|(?:text)?color\s*\{{\w+\}})\s*\{{(?P<kept>(?:[^{{}}]|{_GROUP})*)\}}")
_D = r"(?:\\(?:mathrm|mathit|text|operatorname)(?:\s*\{\s*d\s*\}|\s+d)|\\partial(?![A-Za-z])|\\dd(?![A-Za-z])|d(?!_))"
_SQUARE = r"\s*\^\s*(?:2|\{\s*2\s*\})"
_RATE = re.compile(
    rf"\\[dtc]?frac\s*\{{\s*{_D}(?P<second>{_SQUARE})?(?P<what>(?:[^{{}}]|{_GROUP})*)\}}\s*\{{\s*{_D}\s*t(?:{_SQUARE})?\s*\}}"
)
_OF_TIME = re.compile(r"(?P<primes>'{0,2})(?P<space>\s*)(?:\{\s*\(\s*t\s*\)\s*\}|\(\s*t\s*\))")
_AT_A_TIME = re.compile(r"((?:\\(?:var)?theta|(?<![A-Za-z\\])q)\}?_\{?[0-9]\}?)\(\s*[0-9.]+\s*\)")  # \theta_1(2.5)
_FONT = re.compile(
    r"\\(?:operatorname\*?|mathrm|mathit|mathbf|mathsf|mathtt|mathnormal|mathcal|boldsymbol|bm|pmb|vec)"
    r"(?=\s*\{(?!\s*[A-Za-z](?:[A-Za-z0-9 ]|\\_)*\}))"
    r"|\\(?:text|textrm|textit|textbf|mbox)(?=\s*\{(?:[^{}_^\\]|\\_)*(?:[_^]|\\[^_]))"
    r"|\\(?:mathbf|boldsymbol|bm|vec)(?=\s*[0-9])|\\(?:mathbf|bm|mathrm|mathit|mathsf|mathcal|boldsymbol|vec)(?=\s+(?![ijkxyz])\\?[A-Za-z])"
)
# Rates as letters behind an index, q_1p for "punto", and as primes, in a text that has accelerations of both kinds.
_LETTERED = re.compile(
    r"(?<![A-Za-z\\])(?P<name>(?:[qxyzv]|\\(?:var)?theta)_)(?P<sub>[0-9]|\{[0-9])(?P<dots>pp?)(?P<end>\}?)(?![A-Za-z])"
)
_PRIMES = re.compile(
    r"\\(?!(?:var)?theta)[A-Za-z]+|(?P<name>q|\\(?:var)?theta)(?P<before>'{0,2})(?P<power>\^2)?"
    r"(?P<sub>_(?:\{[0-9]\}|[0-9]))?(?P<after>'{0,2})"
)
# The centre of mass of a link by its abbreviation, x_{com_1}, and a font of an index.
_CENTRE = re.compile(r"_\{\s*(?:com|CoM|COM|cm|CM|cog|CoG)\s*,?_?\{?(?P<link>[1-9])\}?\s*\}")
_REPEATED = re.compile(r"(?<![A-Za-z\\])([a-z])(?: \1){1,3}(?![A-Za-z])")  # m m m, a name of which a scan makes letters
# An entry in brackets behind a rotation, R_{36}(2,3), R_6^3[2,3] or _6^3R[1,2], which programs count from zero, or
# {}^3_6r_{23}, and a bound of cosines, clamp(c_3, -1, 1).
_SUPER, _LOWER = r"\^\s*\{?[0-9]\}?\s*", r"_\s*\{?[0-9]\}?\s*"
_ENTRY = re.compile(
    rf"(?:(?<![A-Za-z\\])R\s*(?:_\s*\{{(?P<pair>[0-9]{{2}})\}}\s*|{_LOWER}{_SUPER}|{_SUPER}{_LOWER})"
    rf"|(?:\{{\s*\}}\s*|(?<![\w}})\]]))(?:{_LOWER}{_SUPER}|{_SUPER}{_LOWER})(?:R\s*|(?P<indexed>[rR]\s*_\s*)(?=\{{)))"
    r"[(\[{]\s*(?P<row>[0-3])\s*(?(indexed),?|(?:,|\]\s*\[))\s*(?P<column>[0-3])\s*[)\]}]"
)
_CLAMPED = re.compile(
    r"\\(?:operatorname|mathrm|text)\s*\{\s*(?:clamp|clip|sat)\s*\}\s*"
    r"\((?P<kept>(?:[^()]|\([^()]*\))*?),\s*-\s*1\s*,\s*1\s*\)"
)
# What takes full turns off an angle, a label of both branches, what a name may be, what an equation is for, as in
# q_1: ... = 0, and what a formula is near to in an example.
_ASIDE = re.compile(
    r"\\(?:operatorname\*?|mathrm|text)\s*\{\s*(?:wrap|wrapToPi|mod2pi)\s*\}|\^\s*\{\s*\(\s*\\pm\s*\)\s*\}"
    r"|\\?[A-Za-z]+(?:_\w)?\s*\\in\s*\\\{[^{}=$]*\\\}\s*,\s*(?=\\q?quad)"
    r"|(?<=\$)\s*(?:\\(?:var)?theta|[qxy])(?:_\w|_\{\w+\})?\s*:(?!\s*=)(?=[^$:]*=)"
    r"|\\(?:approx|simeq)\s*-?[0-9][0-9.]*(?=[\s,;]*(?:\$|\\\\|\\\]|\\end|\\q?quad|\\text|\.?\s*$))",
    re.MULTILINE,
)
_UNIT = r"\s*[-+]?\s*1\s*"
_SIGN = re.compile(
    rf"(?P<name>\\?[A-Za-z]+(?:_\w)?)\s*\\in\s*\\?\{{(?:{_UNIT},{_UNIT}|\s*\\pm{_UNIT})\\?\}}"
)  # e in {1, -1}
_OPENED = re.compile(r"(?<=[*&)\]] )\{((?:[^{}]|\{[^{}]*\})*[-+;]\s*(?:\\right\.)?\s*)\}")  # of a sum, as scans have it
_SIDESET = re.compile(rf"\\sideset\s*\{{(?P<kept>(?:[^{{}}]|\{{[^{{}}]*\}})*)\}}\s*{_GROUP}")
_WAY = re.compile(  # the way from one point to another, \vec{P_1 P_2} or {}^0P_{1 \to EE}
    r"\\(?:overrightarrow|vec)\s*\{\s*(?P<start>[OoPp]\s*_\s*(?:[0-9]|\{[0-9]\}))\s*(?P<to>[OoPp]\s*_\s*(?:[0-9]|\{[0-9]\}))\s*\}"
    r"|(?:\{\s*\}\s*\^\s*\{?\s*0\s*\}?\s*)?(?:\\(?:vec|mathbf|bm)\s*)?\{?(?P<letter>[PpOord])\}?"
    r"\s*_\s*\{\s*(?P<first>[1-9])\s*\\(?:to|rightarrow)\s*(?P<last>[A-Za-z0-9])\w{0,3}\s*\}"
)
# A point as the sign of a product, c\\alpha.c\\beta, but for the end of a sentence, and a letter with a bar.
_POINTED = re.compile(
    r"(?<=[A-Za-z0-9)}\]])(?<!\\left|right)\.(?=[A-Za-z(]|\\(?!q?quad|text|mathrm|mbox|end)[a-z])"
    r"|(?<=[)}\]\w] )\.(?= (?:\\begin|\\?[A-Z]|\{))"
)
_BAR = re.compile(r"\\(?:bar|tilde|overline)\s*(?:\{\s*(?P<in>\\?[A-Za-z]+)\s*\}|(?P<bare>[A-Za-z]))")
_SCRIPT_L = re.compile(r"\\math(?:scr|cal)\s*(?:\{\s*l\s*\}|\sl(?![A-Za-z]))")  # the Lagrangian in small letters
# The label of a solution in Roman numbers: \\theta_3^{I,II}, in whatever font.
_ROMAN = r"(?:I{1,3}|IV|VI{0,3})"
_SOLUTION = re.compile(
    rf"(?P<kept>(?:\\(?:var)?theta|(?<![A-Za-z\\])q){_SUB}\s*)\^\s*(?:\\[A-Za-z]+\s*)?"
    rf"(?P<label>\{{\s*{_ROMAN}(?:\s*,\s*{_ROMAN})*\s*\}})(?P<end>\s*&?\s*=)?"
)
# What an angle or a cosine depends on, as in \phi(\theta_1) and c_3^2(\theta_1), which are no products.
_DEPENDENT = re.compile(
    rf"(?P<kept>(?:\\(?:(?:var)?phi|psi|alpha|beta|gamma|delta){_SUB}?|(?<![A-Za-z\\])[cs]{_SUB})(?:\^2)?)"
    rf"\(\s*\\(?:var)?theta{_SUB}\s*\)"
)
# A matrix whose rows end with one backslash, as they do where a page has lost every other one.
_GRID = re.compile(
    r"\\begin\s*\{([bpvB]?matrix|cases)\}(?:(?!\\\\|\\begin|\\end).)*\\\s(?:(?!\\\\|\\begin).)*?\\end\s*\{\1\}",
    re.DOTALL,
)
_SIGNED_WORD = re.compile(
    r"\{\s*(?P<sign>\\pm|[-+])?\s*\\rm\s*(?P<middle>\\pm|[-+])?\s*a(?:rc)?(?P<function>cos|sin|tan)\s*\}"
)
_MATHEMATICAL = re.compile("[\U0001d400-\U0001d7ff]")  # italic, bold and script letters, as word processors have them
_SAME = dict.fromkeys("\u2212\u2010\u2011\u2013", "-") | dict.fromkeys("\u00b7\u22c5\u2219\u2022\u00d7\u2217", "*")
_SAME |= dict.fromkeys("\u00a0\u2009\u202f\u2002\u2003\u200a\u2061\u2062\u200b\ufeff\t", " ")
_SAME |= dict.fromkeys("\ue000\ue001\ue002\ue003\ue004", "?")  # signs of our own
_SAME |= dict(zip("\uff0c\uff1b\uff1a\uff08\uff09\uff1d\uff0b\u3002", ",;:()=+.", strict=True))
_SAME |= {"\u2215": "/", "\u2032": "'", "\u2019": "'", "\u2261": "=", "\u2113": "l"}
_SAME |= dict.fromkeys("\u27fa\u21d4\u21d2", ";")  # arrows part equations
# Macros of brackets, and roots with an empty degree.
_PLAIN_SIGNS = {"\\langle": "(", "\\rangle": ")", "\\lbrack": "[", "\\rbrack": "]", "\\sqrt[]": "\\sqrt"}
_MACRO = re.compile("|".join(map(re.escape, _PLAIN_SIGNS)))
_DOT_WORD = re.compile(r"\\(?:textrm|mathrm|text)\{(?P<letter>[a-z])dot\}")  # \textrm{qdot}_1, a rate
_PLAIN = {ord(sign): same for sign, same in _SAME.items()}


def cleaned(text: str, time: bool = True) -> str:
    r"""The text with blanks for everything that only moves ink; as long as before, line by line."""
    text = _MATHEMATICAL.sub(lambda m: unicodedata.normalize("NFKC", m[0]), text)
    text = without_comments(text.translate(_PLAIN))
    text = _CENTRE.sub(lambda m: f"_{{c{m['link']}".ljust(len(m[0]) - 1) + "}", text)
    text = re.sub(r"(?:\\[:;]\s*){2,}(?=[^=\n$]*=)", lambda m: ",".ljust(len(m[0])), text)
    text = _GRID.sub(lambda m: re.sub(r"(?<![\\&])\\ (?!\s*&)", r"\\\\", m[0]), text)
    text = text.replace("\\wedge ", "\\times ").replace("\\dot{}", "\\cdot ").replace("\\&", " ,")
    text = _SCRIPT_L.sub(lambda m: "L".rjust(len(m[0])), text).replace("\\dot{\\partial}", "\\partial\\dot ")
    text = _DEPENDENT.sub(lambda m: m["kept"].ljust(len(m[0])), _SOLUTION.sub(_of_solution, text))
    text = _MACRO.sub(lambda m: _PLAIN_SIGNS[m[0]].rjust(len(m[0])), text)
    text = re.sub(r"\{([-+=])\}", r" \1 ", text)  # an operator in braces
    text = re.sub(r"(\\(?:var)?theta) ([1-9])(?![0-9.])", r"\1_\2", text)  # a name, not a product
    text = re.sub(r"(?<=[0-9}])\[([RTA])\]", r"  \1", text)  # ^0_3[R]
    text = _DOT_WORD.sub(lambda m: rf"\dot{{{m['letter']}}}".ljust(len(m[0])), text)
    text = _POINTED.sub(_times, re.sub("<?=+>", lambda m: ";".rjust(len(m[0])), text))
    text = _SIGN.sub(lambda m: rf"{m['name']}=\pm 1".ljust(len(m[0])), _OPENED.sub(r" \1 ", text))
    text = _ASIDE.sub(lambda m: blank(m[0]), re.sub(r"(?<!\\)\\l_", " l_", text))
    text = _BAR.sub(lambda m: f" {m['in'] or m['bare']}'".ljust(len(m[0])), text)
    text = _WAY.sub(_difference, text).replace("\\overrightarrow", "\\vec".ljust(15))
    text = re.sub(r"(\\vec\s*\{\s*[xyz])(\s*_\s*(?:[0-9]|\{[0-9]\}))\s*\}", r"\1}\2", text)
    text = _SIGNED_WORD.sub(lambda m: rf"{m['sign'] or m['middle'] or ''}\arc{m['function']}".ljust(len(m[0])), text)
    text = re.sub(r"(?<=_)\\(?:mathrm|text|textrm|mathit|mathbf|rm)(?=\s*\{)", lambda m: blank(m[0]), text)
    text = _SIDESET.sub(lambda m: ("{}" + m["kept"]).rjust(m.end("kept") - m.start()).ljust(len(m[0])), text)
    text = re.sub(r"(?<=[_^]\{)\\[a-z]+\{[^{}$\\]*\}", lambda m: re.sub("[,-]", " ", m[0]), text)  # {\text{a-b}}
    text = _CLAMPED.sub(_within, text)
    text = _counted_from_one(text)
    text = _REPEATED.sub(lambda m: m[0].replace(" ", "").ljust(len(m[0])), text)
    text = re.sub(r"\\Delta (?=[A-Za-z](?![A-Za-z]))([A-Za-z])", r"\\bm{D\1} ", text)
    if re.search(r"(?:q|theta)_\{?[0-9]pp?\}?(?![A-Za-z])", text):
        text = _LETTERED.sub(lambda m: _marked(m, m["name"] + m["sub"] + m["end"], len(m["dots"])), text)
    if re.search(r"(?:q|theta)(?:_\{?[0-9]\}?)?''", text):
        text = _PRIMES.sub(
            lambda m: _marked(m, (m[1] or m[0]) + (m[4] or ""), len((m[2] or "") + (m[5] or "")), m[3]), text
        )
    while (braced := _BOXED.sub(_within, _BRACE.sub(_term, text))) != text:
        text = braced
    others = {re.split(r"[\s_^]", m[0])[0] for m in _STARRED.finditer(text)}  # letters of which it makes other names
    others |= set("cs" if others & {"q", r"\theta", r"\vartheta"} else "")
    text = _STARS.sub(lambda m: (m["kept"] + "''" * (m["letter"] in others)).ljust(len(m[0])), text)
    text = re.sub(r"(\\\\)|\\(?=_[0-9{])", lambda m: m[1] or " ", text)  # \_ for an index, as Markdown needs it
    text = re.sub(r"(\\\\)|\\\n", lambda m: m[1] or r"\\", text)  # a row end that lost a backslash on its way
    text = re.sub(r"([-+=])(?=\s*\\\\\s*(?:\[[^]]*\])?[\s&]*\1)", " ", text)  # a sign at both sides of a break
    text = _OF_UNIT.sub(lambda m: m["kept"] + blank(m[0][len(m["kept"]) :]), text)
    text = re.sub(r"\\approx(?=\s*\\begin\{[bp]matrix\}[-0-9.&\\\s]+\\end)", lambda m: "=".rjust(len(m[0])), text)
    text = _INK.sub(lambda m: m[0] if m["kept"] else blank(m[0]), text)
    text = _RATE.sub(_rate, text)
    if time:
        if re.search(r"_\{?[0-9]\}?\s*\(t\)", text):
            text = _AT_A_TIME.sub(lambda m: m[1].ljust(len(m[0])), text)
        text = _OF_TIME.sub(lambda m: PRIMED.get(len(m["primes"]), "").ljust(len(m[0])), text)
    return _FONT.sub(lambda m: blank(m[0]), text)


def _counted_from_one(text: str) -> str:
    """The text with R_{36,23} for entries in brackets, and M_{11} for the first entry where it is M_{00}."""
    first = int(all(m["indexed"] or "0" not in (m["row"], m["column"]) for m in _ENTRY.finditer(text)))
    text = _ENTRY.sub(partial(_entry, first=first), text)
    if counted := "".join({*re.findall(r"(?<![A-Za-z\\])([MmDdHhBbCc])_\{?0,?0\}?(?![0-9])", text)}):
        entries = re.compile(rf"(?<![A-Za-z\\])([{counted}]_\{{?)([0-8])(,?)([0-8])(?![0-9])")  # M_{00}, the first one
        return entries.sub(lambda m: f"{m[1]}{int(m[2]) + 1}{m[3]}{int(m[4]) + 1}", text)
    return text


def without_comments(text: str) -> str:
    """The text with blanks for comments."""
    return re.sub(r"\\\\|\\%|%[^\n]*", lambda m: m[0] if m[0].startswith("\\") else blank(m[0]), text)


def blank(text: str) -> str:
    """Blanks in place of a text, line by line."""
    return re.sub(r"[^\n]", " ", text)


def _marked(match: re.Match[str], name: str, dots: int, behind: str | None = None) -> str:
    """A name with the mark of its derivative and what stands behind it, as long as before."""
    return (name + PRIMED.get(dots, "") + (behind or "")).ljust(len(match[0]))


def _entry(match: re.Match[str], first: int) -> str:
    """An entry of a rotation; first is the number of the first row."""
    frames = match["pair"] or "".join(re.findall(rf"\{mark}\s*\{{?([0-9])", match[0])[0] for mark in "^_")
    row, column = (int(match[name]) + 1 - first for name in ("row", "column"))
    return f"R_{{{frames},{row}{column}".ljust(len(match[0]) - 1) + "}"


def _of_solution(match: re.Match[str]) -> str:
    """A joint variable with the label of a solution where it is what an equation gives, without it in formulas."""
    before = match.string[max(match.start() - 8, 0) : match.start()].rstrip()
    is_one = match["end"] and len(re.findall("[0-9]", match["kept"])) == 1  # but theta_{23}, and a sum or a sine of it
    is_one = is_one and not before.endswith(("sin", "cos", "tan", "+", "-", "("))
    label = f"^{match['label']}{match['end']}" if is_one else match["end"] or ""
    return match["kept"] + label.rjust(match.end() - match.end("kept"))


def _difference(match: re.Match[str]) -> str:
    """A way as the difference of two places."""
    letter = match["letter"]
    ends = (f"{letter}_{match['last']}", f"{letter}_{match['first']}") if letter else (match["to"], match["start"])
    return "({}-{})".format(*ends).ljust(len(match[0]))


def _times(match: re.Match[str]) -> str:
    """A sign of multiplication for a point, but in a subscript such as l_{c.m.}."""
    before = match.string[max(match.start() - 40, 0) : match.start()]
    return "." if before.rfind("_{") > before.rfind("}") else "*"


def _within(match: re.Match[str]) -> str:
    """Only what is braced stays."""
    before, kept, after = match.start("kept") - match.start(), match["kept"], match.end() - match.end("kept")
    return blank(match[0][:before]) + kept + blank(match[0][len(match[0]) - after :] if after else "")


def _term(match: re.Match[str]) -> str:
    """What stands over or under a brace; a term with a sign goes on with the sum before it."""
    has_sign, kept = match["kept"][1:].lstrip()[:1] in "+-", _within(match)
    return re.sub(r"\{(\s*[-+].*)\}", r" \1 ", kept, flags=re.DOTALL) if has_sign else kept


def _rate(match: re.Match[str]) -> str:
    r"""A derivative as dots: those of ``\frac{d}{dt}`` stand over what follows."""
    dots, start = "\\ddot" if match["second"] else "\\dot", match.start("what") - match.start()
    if not match["what"].strip():
        return dots.ljust(len(match[0]))
    end = start + len(match["what"])
    return f"{dots.ljust(start - 1)}{{{match['what']}}}".ljust(end + 1) + " " * (len(match[0]) - end - 1)


_DOTTED = re.compile("([A-Za-z\u0370-\u03ff])([\u0307\u0308])|[\u1e8b\u1e8f\u017c\u1e59\u1e57\u1e8d\u00ff\u1e97]")
_ONE = r"(?:\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\}|\\[A-Za-z]+|[A-Za-z0-9])"
_FRACTION = re.compile(rf"(\\[tdc]?frac)(?![A-Za-z])\s*({_ONE})\s*({_ONE})")
# A condition: a joint angle that is nearly a multiple of a right angle.
_NEARLY = re.compile(
    r"((?:\\(?:var)?theta|(?<![A-Za-z\\])[qCScs])\s*_\s*\{?[0-9]{1,2}\}?\s*)\\(?:approx|simeq)(\s*-?\s*(?:0|1|90|180|\\pi)(?![0-9.]))"
)
_OLD_MATRIX = re.compile(r"\\(p?matrix)\s*\{((?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*)\}")

_ROW_END, _TWO = re.compile(r"\\cr(?![A-Za-z])"), r"\\\\"

Spelled = tuple[str, Sequence[int]]  # a text, and for each character the offset from which it comes


def spelled(text: str) -> Spelled:
    """The text in LaTeX."""
    found: Spelled = text, range(len(text))
    for pattern, write in _WAYS:
        found = rewritten(found, pattern, write)
    return found


def rewritten(found: Spelled, pattern: re.Pattern[str], write: Callable[[re.Match[str]], str]) -> Spelled:
    """A text in which a pattern is written otherwise; each character keeps its place."""
    text, origins = found
    pieces, places, last = list[str](), list[int](), 0
    for match in pattern.finditer(text):
        if (new := write(match)) == match[0]:
            continue
        pieces += [text[last : match.start()], new]
        places += origins[last : match.start()]
        at = 0
        for letter in new:
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
# Of an energy by a variable, written with straight letters.
_STRAIGHT = re.compile(
    r"\\[dt]?frac\s*\{\s*d\s*([A-Z]|(?:\\math[a-z]+\s*)?\{\s*[A-Z]\s*\}|\\mathcal [A-Z])\s*\}\s*"
    r"\{\s*d\s*((?!_|t\s*\})\\?[A-Za-z](?:[^{}+-]|\{[^{}+-]*\})*)\}"
)
# The square of a vector's length.
_NORM = re.compile(
    r"(?:\\left\s*)?\\(?:\||[lr]?Vert)\s*((?:(?!\\\||\\[lr]?Vert|\\right|\^\{?0)[^$])*?)(?:\^\{?0\}?)?\s*"
    r"(?:\\right\s*)?\\(?:\||[lr]?Vert)\s*\^\s*(?:2|\{\s*2\s*\})"
)
_LENGTH = re.compile(
    r"(?:\\left\s*)?\|\s*(\\(?:d?dot|vec|mathbf|boldsymbol|omega)(?![A-Za-z])[^|$=]{1,40}?)\s*(?:\\right\s*)?\|\s*\^\s*(?:2|\{\s*2\s*\})"
)
_INNER = r"\{((?:[^{}]|\{[^{}]*\})*)\}"
_BEFORE = re.compile(rf"\\(?:sideset\s*{_INNER}\s*{_INNER}|prescript\s*{_INNER}\s*{_INNER})")  # scripts before a letter
_NESTED = r"(?:[^()$]|\((?:[^()$]|\([^()$]*\))*\))*"
_WAYS: tuple[tuple[re.Pattern[str], Callable[[re.Match[str]], str]], ...] = (
    (_DOTTED, _dotted),
    (re.compile(r"\u221a\s*(?:\(((?:[^()]|\([^()]*\))*)\)|(\w+))"), lambda m: f"\\sqrt{{{m[1] or m[2]}}}"),
    (re.compile(rf"\\(?:sqrt|operatorname\{{sqrt\}})\s*\(({_NESTED})\)"), lambda m: f"\\sqrt{{{m[1]}}}"),
    (re.compile(r"\\sqrt\s*([0-9])"), lambda m: f"\\sqrt{{{m[1]}}}"),
    (_FRACTION, _fraction),
    (_BEFORE, lambda m: "{}" + re.sub(r"[_^]\{\}", "", m[1] + m[2] if m[4] is None else f"^{{{m[3]}}}_{{{m[4]}}}")),
    (re.compile(r"\\langle((?:(?!\\[lr]angle|\|)[^$])*,(?:(?!\\[lr]angle|\|)[^$])*)\\rangle"), lambda m: f"({m[1]})"),
    (re.compile(r"\\_(?=[0-9A-Za-z{])"), lambda m: "_"),
    (re.compile("\u0394 ?(?=[A-Za-z])"), lambda m: "\\Delta "),
    (re.compile(r"(?<![A-Za-z\\])([csCS])_([0-9]{2,3})(?![0-9])"), lambda m: f"{m[1]}_{{{m[2]}}}"),  # as it is meant
    (re.compile(r"(?<![A-Za-z\\])([mla]_[1-9])([2-9])(?=[A-Za-z\\])"), lambda m: f"{m[1]} {m[2]}"),
    (re.compile(r"(\\end\{[bp]matrix\}\s*)[xX](?=\s*\\begin)"), lambda m: f"{m[1]}\\times "),
    (_OVER, lambda m: f"\\frac{{{m[1]}}}{{{m[2]}}}"),
    # what is left of macros of packages and lectures
    (re.compile(r"\^\s*\{?\s*\\(?:T|tran|trans|transp|transpose|tp)(?![A-Za-z])\s*\}?"), lambda m: "^T"),
    (re.compile(r"\\(dd?)(q|theta)(?![A-Za-z])"), lambda m: f"\\{m[1]}ot{{{'' if m[2] == 'q' else chr(92)}{m[2]}}}"),
    (re.compile(r"\\mqty\s*[(\[]((?:[^()\[\]]|\([^()]*\))*)[)\]]"), lambda m: rf"\pmatrix{{{m[1]}}}"),
    (re.compile(r"\\qty(?=\s*[(\[])"), lambda m: ""),
    (re.compile(r"(?<=[A-Za-z0-9}\])])\.T(?![A-Za-z_^])"), lambda m: "^T"),  # as programs transpose
    (_STRAIGHT, lambda m: f"\\frac{{\\partial {m[1]}}}{{\\partial {m[2]}}}"),
    (_SLOPE, lambda m: f"\\frac{{{m[1]}}}{{{m[2]}}}"),
    # pandoc's indices and exponents, a~1~^2^, and a display in dollar signs of a line
    (re.compile(r"(?<=[A-Za-z0-9*^}])~([0-9]{1,3})~"), lambda m: f"_{{{m[1]}}}"),
    (re.compile(r"(?<=[A-Za-z0-9*}\s])\^([0-9*])\^"), lambda m: f"^{{{m[1]}}}"),
    (re.compile(r"(?<!\$)\$\s*(\\begin\{(equation|align)(\*?)\}[^$]*\\end\{\2\3\})\s*\$"), lambda m: m[1]),
    # a point or its velocity by its coordinates, P_1(l_1 c_1, l_1 s_1)
    (re.compile(r"\$([PV]_\{?\w\}?)(\((?=[^=$]*,)[^=$]*\\(?:sin|cos)[^=$]*\))\$"), lambda m: f"${m[1]} = {m[2]}$"),
    (_NORM, lambda m: f"{m[1]}^T {m[1]}"),
    (_LENGTH, lambda m: f"{m[1]}^T {m[1]}"),
    (_NEARLY, lambda m: f"{m[1]}={m[2]}"),
    (re.compile(r"(?<![A-Za-z\\])([csCS])\{([0-9]{1,4})\}"), lambda m: f"{m[1]}_{{{m[2]}}}"),
    (_OLD_MATRIX, lambda m: f"\\begin{{{m[1]}}}{_ROW_END.sub(_TWO, m[2])}\\end{{{m[1]}}}"),
)
