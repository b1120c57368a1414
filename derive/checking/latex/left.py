r"""Left sides of printed equations taken apart: the scripts, dots, primes and arguments of ``\dot{\mathbf{R}}_6^T``."""

import re
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

from derive.checking.latex.names import FLAT, PRIME
from derive.checking.latex.typography import PRIMED

FONT = re.compile(
    r"\\(?:mathbf|boldsymbol|bm|pmb|mathcal|mathscr|mathrm|mathit|mathsf|mathtt|mathnormal|vec|text|textrm|textbf|textit|"
    r"operatorname\*?|underline|mbox|hat|widehat|overrightarrow)(?![A-Za-z])"
)
_SPACE = re.compile(r"\s|~|\\(?:quad|qquad|enspace)(?![A-Za-z])")
_SCRIPT = re.compile(r"(?P<mark>[_^])(?P<script>\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\}|\\[A-Za-z]+|[A-Za-z0-9*])")
_ARGUMENTS = re.compile(r"\((?:[^()]|\([^()]*\))*\)|\{\((?:[^()]|\([^()]*\))*\)\}")
_OF_PRODUCT = re.compile(r"\\times|\{\}|\\ddot")  # in brackets that are a factor: R (v + omega x p)
AXES = {"x": 1, "y": 2, "z": 3}
# A product, such as k c_1, or a function of what stands behind it.
_NO_NAME = re.compile(r"(?:^|[\s*+(-])[A-Za-z]\s+[A-Za-z]_|^\s*\\(?:arc)?(?:cos|sin|tan)\s+[\\A-Za-z]")
# The derivative of a coordinate of the end effector, an entry of the Jacobian.
_PARTIAL = re.compile(
    r"\\[dt]?frac\{\\partial\{?(?:p_?\{?)?(?P<what>[xyzXYZ]|\\(?:var)?phi)\}?(?:_\{?(?:e|ee|E|EE|t|T)\}?)?\}?\}"
    r"\{\\partial\{?(?P<by>\\(?:var)?theta|q|d)_?\{?(?P<label>[0-9]+)\}*\}"
)


class Turned(StrEnum):
    """What is raised behind a matrix."""

    NOT = ""
    TRANSPOSED = "^T"
    INVERTED = "^-1"
    BOTH = "^-T"


class Scripts(StrEnum):
    """Where the two frames of a transform stand, whose order a document decides as a whole."""

    LEFT = "{}^i_jT"
    RIGHT = "T^i_j"
    PAIR = "T_ij"


Reading = frozenset[Scripts]  # the scripts that a document reads the other way round: {}_i^jT, T_i^j, T_ji is j in i

# The superscript of a transpose or an inverse, another one before it: that of R^{0T} or of (R^0)^T.
_TURNED = re.compile(r"(?P<script>.*?)(?:(?P<inverse>-1)|(?P<both>-T|-top|-intercal)|T|top|intercal)")


@dataclass(frozen=True, slots=True)
class Left:
    """A left side taken apart."""

    head: str  # its letter or word
    sub: str = ""  # its subscript on the line, letters, digits and commas
    sup: str = ""  # its superscript
    before: str = ""  # what stands raised before it, as 0 in ``{}^0T_6``
    before_sub: str = ""  # what stands lowered before it
    dots: int = 0  # derivatives with respect to time
    primes: int = 0
    arguments: str = ""  # what follows in brackets, such as q
    is_determinant: bool = False  # whether a determinant is meant
    factor: str = ""  # a vector that it is multiplied with, as in C(q, qd) qd
    turned: Turned = Turned.NOT  # whether its transpose or its inverse is meant

    @property
    def is_plain(self) -> bool:
        """Whether it is a letter or word with at most a subscript, as names are."""
        raised = self.sup or self.before or self.before_sub
        return not (raised or self.dots or self.primes or self.is_determinant or self.factor or self.turned)

    @property
    def scripts(self) -> Scripts | None:
        """How two frames are written; None where there are not two, or their places say which is which."""
        if self.before and self.before_sub and not self.sub + self.sup:
            return Scripts.LEFT
        if self.sub and self.sup and not self.before + self.before_sub:
            return Scripts.RIGHT
        pair = re.fullmatch(r"[0-9A-Za-z],?[0-9A-Za-z]", self.sub)
        return Scripts.PAIR if pair and not self.sup + self.before + self.before_sub else None

    @property
    def is_point(self) -> bool:
        """Whether it is a coordinate of a point of some link, such as x_2, or its speed."""
        is_component = self.head in ("p", "P", "v") and re.fullmatch(r"[cCgG]?[1-9],?[xyz]", self.sub)
        is_whole = self.head in (*AXES, "v") and self.sub.isdigit()
        return bool(is_component or is_whole) and not self.sup + self.before

    @property
    def labelled(self) -> str:
        r"""An entry of a pose with the number of another frame, ``{}^1r_{11}`` as r11^1; empty of anything else."""
        name = f"{self.flat}^{self.before or self.sup}"
        return name if re.fullmatch(r"(?:r[1-3]{2}|[nsoapP][xyz])\^[1-9]", name) and not self.dots else ""

    @property
    def is_vague(self) -> bool:
        """Whether it is a letter for anything, without indices that say what it is, or a point of some link."""
        is_angle = self.head in ("phi", "theta", "psi") and not self.sub
        is_alone = self.head in {*"AKHXPELWY"} and not self.sub + self.sup + self.before
        # velocities, energies of links, speeds, forces on a body
        is_motion = self.head in ("v", "xi", "nu") or self.flat in ("k", "u")
        is_motion = is_motion or (self.head in {*"VFfuhk"} and len(self.sub) == 1 and self.sub.isdigit())
        is_place = self.is_point or self.sub.lower() in ("elbow", "wrist") or self.sup == "2D"
        return is_place or is_angle or is_alone or is_motion

    @property
    def is_of_parameters(self) -> bool:
        """Whether it is a function of numbers and lengths, such as the T(alpha, a, d, theta) of a row of the table."""
        arguments = self.arguments.strip("{}").removeprefix("(").removesuffix(")").split(",")
        plain = re.compile(
            r"|(?:\\d*dot)?[{]?(?:\\boldsymbol|\\mathbf|\\vec)?[{]?(?:q|\\(?:var)?[tT]heta|\\omega|d|t)[}]?(?:_?[{]?[0-9a-z]+[}]?)?[}]?|\\[cl]?dots"
        )
        return len(arguments) > 1 and not all(plain.fullmatch(argument) for argument in arguments)

    @property
    def flat(self) -> str:
        """Letter, primes and subscript as one name."""
        return self.head + PRIME * self.primes + self.sub.replace(",", "")


@lru_cache(10_000)  # a text is gone through several times
def taken_apart(text: str) -> Left | None:
    """A left side as letter, scripts and dots; None where it is no single symbol."""
    tight = "".join(FONT.sub("", text).split())
    if re.fullmatch(
        r"\\sqrt\{(?:\\det|\|)[({]*J(?:_\{?\w+\}?)?(?:\(\w+\))?\}?\{?J(?:_\{?\w+\}?)?(?:\(\w+\))?\}?\^\{*(?:T|\\top|\\intercal|\\mathsf\{T)\}*(?:\(\w+\))?[)}|]*\}"
        r"|\|\\det[({]*J(?:_\{?\w+\}?)?(?:\(\w+\))?[)}]*\|",
        tight,
    ):
        return Left("manipulability")
    if partial := _PARTIAL.fullmatch(tight):
        row = {**AXES, "phi": 6}[partial["what"].removeprefix("\\").removeprefix("var").lower()]
        return Left("J", f"{row},{partial['label']}", arguments=f"(\u2202{partial['by']})")
    if _NO_NAME.search(text):
        return None
    marks = sum(dots for dots, mark in PRIMED.items() if mark in text)
    text = text.translate(dict.fromkeys(map(ord, PRIMED.values())))
    # from left to right: scripts before the letter, dots, the letter, scripts, arguments, a velocity behind it
    rest, determinant = _undressed(text)
    rest = re.sub(r"^\{(\\d?dot\{?[A-Za-z]\}?)\}(?=\()", r"\1", rest)  # \mathbf{\dot{J}}(q)
    before, rest = _scripts(rest)
    dots = marks
    if match := re.match(r"\\(d?)dot", rest):
        dots, rest = dots + 1 + bool(match[1]), rest[match.end() :]
    rest = re.sub(r"^\{([A-Za-z]_\{[^{}]*\})\}", r"\1", rest) if dots else rest  # \dot{p_{\theta_1}}
    while (match := re.match(r"[{(\[]([^{}()\[\]]*)[)}\]]", rest)) and match[1]:
        if inner := re.match(r"\\(d?)dot", match[1]):
            dots += 1 + bool(inner[1])
        rest = re.sub(r"^\\d?dot", "", match[1]) + rest[match.end() :]
    match = re.match(r"\\[A-Za-z]+|[A-Za-z\u0391-\u03c9]+", rest)
    if match is None or match[0] in ("\\pm", "\\mp"):
        return None
    head = FLAT.get(match[0].removeprefix("\\"), match[0].removeprefix("\\"))
    rest = rest[match.end() :]
    if digits := re.match(r"[0-9]+", rest):
        rest = "_{" + digits[0] + "}" + rest[digits.end() :]
    after, rest = _scripts(rest)
    arguments = factor = ""
    if (match := _ARGUMENTS.match(rest)) and not _OF_PRODUCT.search(match[0]):
        arguments, rest = match[0], rest[match.end() :]
        more, rest = _scripts(rest)
        after = {mark: after.get(mark, "") + more.get(mark, "") for mark in "_^'"}
    if match := re.fullmatch(r"\\(d{0,2})dot\{?(?:q|\\theta)\}?(?:\([^()]*\))?", rest):
        factor, rest = match[1] + "d", ""
    if rest:
        return None
    # of what is raised the end may be a transpose or an inverse, and the beginning the frame: R^{0T}
    raised, turned = after.get("^", ""), Turned.NOT
    if match := _TURNED.fullmatch(raised):
        turned = Turned.INVERTED if match["inverse"] else Turned.BOTH if match["both"] else Turned.TRANSPOSED
        raised = match["script"]
    sub, primes, sup, lowered = after.get("_", ""), len(after.get("'", "")), before.get("^", ""), before.get("_", "")
    return Left(head, sub, raised, sup, lowered, dots, primes, arguments, determinant, factor, turned)


def _undressed(text: str) -> tuple[str, bool]:
    """A side without fonts, blanks and brackets around all of it, and whether it is a determinant."""
    rest = FONT.sub("", _SPACE.sub(" ", text)).replace(" ", "").replace("\\prime", "'")
    determinant = False
    if match := re.fullmatch(r"(?:\\det|det|\{det\})(.*)", rest) or re.fullmatch(r"\|(.*)\|", rest):
        rest, determinant = match[1], True
        while (inner := re.fullmatch(r"[({](.*)[)}]", rest)) and _ARGUMENTS.fullmatch("(" + inner[1] + ")"):
            rest = inner[1]
    while (single := re.sub(r"\{\{([^{}]*)\}\}", r"{\1}", rest)) != rest:
        rest = single
    if (whole := re.match(r"\((?!\\d?dot)(.*)\)(?=[_^][^()]*$)", rest)) and _ARGUMENTS.fullmatch(f"({whole[1]})"):
        rest = whole[1] + rest[whole.end() :]
    rest = whole[1] or whole[2] if (whole := re.fullmatch(r"\[([^][]+)\]|\{((?:[^{}]|\{[^{}]*\})+)\}", rest)) else rest
    rest = re.sub(r"^\{\}|^\{((?:[_^](?:\{\w+\}|\w))+)\}", r"\1", rest)
    return rest, determinant


def _scripts(text: str) -> tuple[dict[str, str], str]:
    """Scripts at the beginning, and what follows them."""
    found: dict[str, str] = {}
    while text:
        if text[0] == "'":
            found["'"], text = found.get("'", "") + "'", text[1:]
        elif match := _SCRIPT.match(text):
            script = re.sub(r"\\([A-Za-z]+)", lambda m: FLAT.get(m[1], m[1]), match["script"])
            framed = re.fullmatch(r"\{(\w+),?\((\d)\)\}", script) if match["mark"] == "_" else None
            if framed is not None:  # z_{2(1)}, seen in frame 1
                found["^"], script = framed[2], framed[1]
            script = re.sub(r"[_^{}()\\]", "", script)
            mark = "'" if script and not script.strip("'") else match["mark"]
            found[mark], text = found.get(mark, "") + script, text[match.end() :]
        else:
            break
    return found, text
