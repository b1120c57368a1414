"""Products of transforms in print, ``T_1^0 T_2^1`` or ``^0_1T^1_2T``: their factors, and the frames that they join."""

import re
from itertools import pairwise

from derive.checking.latex.left import FONT, Left, Turned, taken_apart
from derive.checking.latex.meanings import Meanings
from derive.checking.latex.targets import Target
from derive.robot.description import IDENTITY
from derive.robot.robot import Robot

_SCRIPTS = r"(?:[_^]\s*(?:\{[^{}]*(?:\{[^{}]*\}[^{}]*)*\}|\\?\w+?|')\s*)*"
_LETTER = r"(?:\\(?:mathbf|boldsymbol|bm|mathrm|mathit)\s*\{\s*[TAHR]\s*\}|\{\s*[TAHR]\s*\}|[TAHR])"
_TIGHT = _SCRIPTS.replace(r"\s*)*", ")*")  # what is blank behind a letter parts it from the scripts of the next one
_ONE = rf"(?:\{{\s*\}})?\s*{_SCRIPTS}{_LETTER}{_TIGHT}(?:\([^()]*\))?"
_SCRIPTED_ONE = re.compile(
    r"(?:\{\s*\})?\s*(?:[_^]\s*(?:\{\s*\w+\s*\}|\w)\s*){2}(?:\\[a-z]+\s*\{\s*[A-Z]\s*\}|[A-Z])\s*"
)
_SCRIPTED = re.compile(f"(?:{_SCRIPTED_ONE.pattern})+")
_FACTOR = re.compile(rf"\s*(?:\\cdot|\\times|\*|(?:\\[,;:! ]\s*)+)?\s*((?:\(\s*{_ONE}\s*\)\s*{_SCRIPTS})|(?:{_ONE}))")
_INNER = r"(?:[^{}]|\{[^{}]*\})*"
_BRACED = re.compile(
    rf"\{{\s*(?P<seen>[_^]{_INNER}[TAHR]{_INNER})\}}|(?<![A-Za-z_^])\{{\s*(?P<plain>{_LETTER}\s*[_^]{_INNER})\}}"
)
_FRAMES = re.compile(r"(?P<kind>[AT]|base|tool|end)(?:\[(?P<first>[0-9]+)(?:,(?P<second>[0-9]+))?\])?")
_EXPONENTIAL = r"e\^\{\[?\{?(?:S|\\xi)\}?_\{?K\}?\]?\\theta_\{?K\}?\}"  # e^{[S_K] theta_K}, of a screw axis


def factors(text: str) -> tuple[Left, ...]:
    """The transforms that stand side by side in a product; none where it is something else."""
    found: list[Left] = []
    # {A_1}^{-1} T_6 in brackets of its own; behind {^0_1T^{-1}} other scripts begin
    text = _BRACED.sub(lambda m: f" {m['seen']} " if m["seen"] else f"({m['plain']})", text)
    position, text = 0, text.strip()
    if _SCRIPTED.fullmatch(text):  # ^0_1T^1_2T, of which no letter has scripts behind it
        lefts = [taken_apart(match[0]) for match in _SCRIPTED_ONE.finditer(text)]
        return tuple(filter(None, lefts)) if len(lefts) > 1 else ()
    while match := _FACTOR.match(text, position):
        if (left := taken_apart(re.sub(r"\{\s*\}", "", match[1]))) is None:
            return ()
        found.append(left)
        position = match.end()
    return tuple(found) if len(found) > 1 and not text[position:].strip() else ()


def chained(meanings: Meanings, lefts: tuple[Left, ...]) -> tuple[int, int] | None:
    """The frames from which and to which a product of transforms leads; None where one does not follow the other."""
    robot = meanings.robot
    labels = [left.sub if left.is_plain and left.head in "TAH" else "" for left in lefts]
    first = int(labels[0]) if labels[0].isdigit() else 0
    if 0 < first <= robot.n + 1 - len(labels) and labels == [str(first + k) for k in range(len(labels))]:  # T_1 T_2 T_3
        return first - 1, first + len(labels) - 1
    steps = [next((pair for t in meanings.targets(left) if (pair := frames_of(t, robot))), None) for left in lefts]
    pairs = [pair for pair in steps if pair is not None]
    if len(pairs) < len(steps) or any(one[1] != other[0] for one, other in pairwise(pairs)):
        return None
    return pairs[0][0], pairs[-1][1]


def frames_of(target: Target, robot: Robot) -> tuple[int, int] | None:
    """The two frames of a transform or a rotation, -1 the world before a base, n + 1 a tool; None of others."""
    match = _FRAMES.fullmatch(target.quantity)
    if match is None or target.columns == (4,) or target.turned is Turned.BOTH:
        return None
    first, second = (int(match[name]) if match[name] else None for name in ("first", "second"))
    world, last = -1 if robot.base != IDENTITY else 0, robot.n + 1 if robot.tool != IDENTITY else robot.n
    pairs = {
        "A": (first - 1, first) if first else None,
        "T": (first, second) if second is not None else (world, last if first is None else first),
        "base": (-1, 0),
        "tool": (robot.n, robot.n + 1),
        "end": (first, last),
    }
    is_rotation = target.rows in ((1, 2, 3), (1, 2)) and target.rows == target.columns
    start, stop = pairs[match["kind"]] or (None, None)
    if start is None or stop is None or (target.turned is Turned.TRANSPOSED and not is_rotation):
        return None
    return (start, stop) if target.turned is Turned.NOT else (stop, start)


def between(start: int, stop: int, robot: Robot) -> str:
    """The transform between two frames, which may be the world before a base or a tool."""
    if (start, stop) == (-1 if robot.base != IDENTITY else 0, robot.n + 1):
        return "T"
    if stop > robot.n:
        return "tool" if start == robot.n else f"end[{start}]"
    return f"T[{start},{stop}]" if start >= 0 else f"T[{stop}]"


def has_all_exponentials(text: str, n: int) -> bool:
    r"""Whether a product has all screw axes, ``e^{[S_1]\theta_1} ... M``, or all rows, ``\prod_{i=1}^6 A_i``."""
    tight = "".join(FONT.sub("", text).split()).replace("\\hat", "")
    steps = r"\^i-1[AT]_i|\^i-1_i[AT]|[AT]_i\^i-1|[AT]\^i-1_i|A_i"
    if re.fullmatch(rf"\\prod(?:\^{n}_i=1|_i=1\^{n})(?:{steps})(?:\(\w+\))?", re.sub("[{}]", "", tight)):
        return True
    every, *some = ("".join(_EXPONENTIAL.replace("K", str(k)) for k in range(1, m + 1)) for m in (n, 1, 2))
    last, home = _EXPONENTIAL.replace("K", f"(?:n|N|{n})"), r"(?:M|g_\{?\w+\}?\(0\)|T\(0\))"
    product = rf"(?:{every}|(?:{'|'.join(some)})(?:\\[cl]?dots|\.\.+){last})"
    return re.fullmatch(product + home + "|M" + product.replace("(?:S|", "(?:B|"), tight) is not None
