r"""Equations that TeX breaks itself, for a document whose line is not known here.

A printed equation is read again as the atoms that the printers make, and marks are put where a line may end: ``\brk0``
before a sign outside of brackets, ``\brk1`` inside of one and so on, ``\fac1`` between two factors. What the marks cost
say their definitions in ``templates/handout/fragment.tex.jinja``; TeX finds the cheapest breaks for its own line.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import Enum
from itertools import groupby

from derive.handouts.layout.lines import INDENTS

_DEEPEST = 3  # levels of brackets that are told apart
_FACTORS = 6  # factors that always fit on a line: only behind so many one may be broken off
_TOKEN = re.compile(
    r"\\begin\{bmatrix\}.*?\\end\{bmatrix\}|\\[bB]ig[lr]\\?.|\\[A-Za-z]+ ?|\\.|\s+|[0-9](?:[0-9.]|\{,\})*|.", re.DOTALL
)
_ENDS_IN_NAME = re.compile(r"\\[A-Za-z]+$")
_ROW_END = re.compile(r"\\\\(?:\[[^]&]*\])?")
_MATRIX = re.compile(r"(?P<left>.*?) = \\begin\{bmatrix\}(?P<body>.*?)\\end\{bmatrix\}", re.DOTALL)
_PHANTOM = re.compile(r"\\phantom\{(.*)\}")


class _Kind(Enum):
    """What an atom is for the breaking of lines, and how it is written; of several kinds the first counts."""

    OPENING = re.compile(r"[(\[]|\\\{|\\[bB]igl\\?.")
    CLOSING = re.compile(r"([)\]]|\\\}|\\[bB]igr\\?.).*", re.DOTALL)
    SIGN = re.compile(r"[+-]|\\times ?|\\cdot ?")
    RELATION = re.compile(r"[=<>]|\\(iff|approx|neq|leq|geq|colon) ?")
    COMMA = re.compile(",")
    GAP = re.compile(r"\\qquad ?")
    SPACE = re.compile(r"\s+|\\[,;: ]|\\quad ?")
    OPERATOR = re.compile(r"\\(cos|sin|tan|det|sum|partial|Delta|pm|operatorname)(?![A-Za-z]).*", re.DOTALL)
    COEFFICIENT = re.compile(r"(?:[0-9.]|\{,\})+|\\tfrac.*")
    NAME = re.compile(r"(\\(math|boldsymbol|text)|[A-Za-z]$).*", re.DOTALL)
    ATOM = re.compile(".*", re.DOTALL)


_WIDE = ("\\ ", "\\quad ")  # spaces at which a line may end
_FACTOR = (_Kind.ATOM, _Kind.NAME, _Kind.OPERATOR, _Kind.CLOSING)


def whole_equations(lines: Iterable[str]) -> list[str]:
    """Equations as they were before they were broken over lines or put side by side."""
    joined: list[str] = []
    for line in lines:
        indent = next((box.tex for box in reversed(INDENTS) if joined and line.startswith(box.tex)), None)
        if indent is None:
            joined.append(line)
        else:
            whole = joined[-1].rstrip()
            space = "  " if _ENDS_IN_NAME.search(whole) else " "  # a name takes one: the sign behind it has its own
            # what shows that a line continues another: ``{}`` before a sign, ``{}\\cdot`` before a factor
            rest = line.removeprefix(indent).removeprefix("{}\\cdot ").removeprefix("{}")
            joined[-1] = f"{whole}{space}{rest}"
    equations: list[str] = []
    for line in joined:
        parts = groupby(_atoms(line), lambda atom: atom[0] is _Kind.GAP)
        equations += ("".join(text for _, text in part).strip() for is_gap, part in parts if not is_gap)
    return equations


def breakable(equation: str) -> str:
    """An equation with marks where a line may end."""
    size = "Big" if "\\frac" in equation else "big"
    equation = equation.replace("\\left", f"\\{size}l").replace("\\right", f"\\{size}r")
    written: list[str] = []
    depth, run, is_right, previous, after = 0, 0, False, _Kind.OPENING, ""
    for kind, text in _atoms(equation):
        mark = ""
        if kind is _Kind.SPACE:
            written.append(text)
            if previous is _Kind.COMMA and text != "\\,":
                mark = "\\brk"
            elif text == "\\," and after == ")":
                mark = "\\fac"
            elif text in _WIDE:
                mark = "\\brk"
        else:
            depth -= kind is _Kind.CLOSING
            mark = _mark(previous, after, kind, run + _FACTORS * (is_right and kind is _Kind.RELATION))
            is_right = is_right or kind is _Kind.RELATION
        written += [f"{mark}{min(depth, _DEEPEST)} "] if mark else []
        after, run = text, 0 if mark else run
        if kind is not _Kind.SPACE:
            written.append(text)
            depth += kind is _Kind.OPENING
            previous, run = kind, run + 1 if kind in _FACTOR else 0
    return "".join(written)


def _mark(previous: _Kind, after: str, kind: _Kind, run: int) -> str:
    """What stands before an atom that follows so many without a mark: a break before a sign, one between factors."""
    if previous not in (_Kind.ATOM, _Kind.NAME, _Kind.CLOSING):
        return "\\brk" if previous is _Kind.COEFFICIENT and kind is _Kind.SIGN else ""
    if kind is _Kind.SIGN or (kind is _Kind.RELATION and run >= _FACTORS):
        return "\\brk" if after.isspace() else ""
    is_applied = kind is _Kind.OPENING and previous is _Kind.NAME
    is_factor = (kind in _FACTOR or kind is _Kind.OPENING) and not is_applied
    return "\\fac" if is_factor and run >= _FACTORS and after != "\\," else ""


def _atoms(equation: str) -> Iterator[tuple[_Kind, str]]:
    """Symbols with their scripts and arguments, signs, brackets and spaces, outside of braces."""
    atom, braces, awaits = "", 0, False
    for token in _TOKEN.findall(equation):
        is_part = braces > 0 or awaits or token in ("{", "_", "^", "'")
        if atom and not is_part:
            yield _kind(atom), atom
            atom = ""
        atom += token
        braces += (token == "{") - (token == "}")
        awaits = token in ("_", "^") and not braces
    if atom:
        yield _kind(atom), atom


def _kind(atom: str) -> _Kind:
    return next(kind for kind in _Kind if kind.value.fullmatch(atom))


@dataclass(frozen=True, slots=True)
class MatrixEquation:
    """A symbol and the matrix that it stands for."""

    symbol: str  # LaTeX of the symbol
    cells: tuple[tuple[str, ...], ...]  # LaTeX of the entries, row by row

    @property
    def is_symmetric(self) -> bool:
        """Whether the entries below the diagonal repeat those above."""
        return len(self.cells) > 1 and self.cells == tuple(zip(*self.cells, strict=True))

    def entries(self) -> list[str]:
        """Each entry that is not zero as an equation; of a symmetric matrix those above the diagonal alone."""
        names = "({})_{{{}}}" if len(self.cells[0]) == 1 else "({})_{{{}{}{}}}"
        comma = "," if max(len(self.cells), len(self.cells[0])) > 9 else ""
        cells = ((i, j, cell) for i, row in enumerate(self.cells, 1) for j, cell in enumerate(row, 1) if cell != "0")
        shown = ((i, j, cell) for i, j, cell in cells if i <= j or not self.is_symmetric)
        return [f"{names.format(self.symbol, i, comma, j)} = {cell}" for i, j, cell in shown]


def matrix_equation(equation: str) -> MatrixEquation | None:
    """An equation whose right side is one matrix; None for any other equation."""
    if (match := _MATRIX.fullmatch(equation)) is None or "bmatrix" in match["left"] + match["body"]:
        return None
    rows = (tuple(cell.strip() for cell in row.split("&")) for row in _ROW_END.split(match["body"]))
    return MatrixEquation(_PHANTOM.sub(r"\1", match["left"].partition(" = ")[0].strip()), tuple(rows))
