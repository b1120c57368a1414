r"""Pieces of a LaTeX text, and its environments: a matrix is one character, its entries are pieces themselves."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from derive.errors import CheckError, Location, listed, quoted
from derive.robot.parser import place

MATRIX_MARK = "\ue000"  # stands for a matrix in the text of a side
AROUND = "()[] \n"  # what may stand around a matrix without changing it
# Environments of matrices; with a star too.
MATRICES = ("bmatrix", "pmatrix", "matrix", "Bmatrix", "vmatrix", "Vmatrix", "array", "smallmatrix", "psmallmatrix")
MAX_NESTED = 12  # environments inside each other, the text counted
# Environments of equations that a message names; `EQUATION_ENVIRONMENTS` has all of them.
DISPLAYS = ("equation", "align", "aligned", "gather", "gathered", "split", "multline", "alignat", "flalign", "eqnarray")
# All environments that hold equations.
EQUATION_ENVIRONMENTS = frozenset(
    (*DISPLAYS, "alignedat", "multlined", "displaymath", "math", "dmath", "IEEEeqnarray", "empheq", "subequations")
)
_GRIDS = frozenset((*MATRICES, "bsmallmatrix", "Bsmallmatrix", "vsmallmatrix", "tabular", "cases", "dcases", "rcases"))
_LENGTH = r"(?:\s*\[\s*-?[0-9.]*\s*(?:pt|em|ex|mm|cm|in|\\[a-z]+)\s*\])?"
_BRACES = r"\{(?:[^{}]|\{[^{}]*\})*\}"
_STRUCTURE = re.compile(
    rf"\\begin\s*\{{(?P<begin>[A-Za-z]+)\*?\}}(?:\s*\[(?:[a-z|]*|[a-z]+=[^][]*)\])?(?P<columns>\s*{_BRACES})?"
    r"|\\end\s*\{(?P<end>[A-Za-z]+)\*?\}"
    rf"|(?P<row>\\\\\*?{_LENGTH}|\\(?:cr|tabularnewline|newline)(?![A-Za-z]){_LENGTH})"
    r"|(?P<cell>(?<!(?<!\\)\\)&)"
)
_WITH_COLUMNS = ("array", "alignat", "alignedat", "IEEEeqnarray", "empheq", "tabular")
# Signs between the sides of an equation.
RELATION = re.compile(
    r":\s*=|=\s*:|=|\\(?:coloneqq?|triangleq|equiv|doteq|stackrel\s*\{[^{}]*\}\s*\{\s*=\s*\}|overset\s*\{[^{}]*\}\s*\{\s*=\s*\})(?![A-Za-z])"
)


@dataclass(frozen=True, slots=True)
class LatexPiece:
    """A part of the text, a side of an equation or an entry of a matrix."""

    text: str  # what stands there, each matrix as one character
    offset: int  # where it begins in the whole text
    matrices: tuple[PrintedMatrix, ...] = ()  # its matrices, in their order
    inline: bool = False  # whether it stands in a line of prose

    @property
    def start(self) -> int:
        """Where its first sign stands in the whole text."""
        return self.offset + len(self.text) - len(self.text.lstrip())

    @property
    def end(self) -> int:
        """Where its last sign ends in the whole text."""
        return self.offset + len(self.text.rstrip())

    @property
    def cells(self) -> tuple[LatexPiece, ...]:
        """The entries of its matrices."""
        return tuple(cell for matrix in self.matrices for row in matrix.rows for cell in row)

    @property
    def texts(self) -> Iterator[str]:
        """Its text and those of the entries of its matrices."""
        yield self.text
        for cell in self.cells:
            yield from cell.texts

    def part(self, begin: int, end: int) -> LatexPiece:
        """A part of it."""
        first = self.text.count(MATRIX_MARK, 0, begin)
        text = self.text[begin:end]
        matrices = self.matrices[first : first + text.count(MATRIX_MARK)]
        return LatexPiece(text, self.offset + begin, matrices, self.inline)

    def split(self, sign: str) -> list[LatexPiece]:
        """The parts of it between some signs."""
        ends = [i for i, letter in enumerate(self.text) if letter == sign]
        starts = (0, *(i + 1 for i in ends))
        return [self.part(begin, end) for begin, end in zip(starts, (*ends, len(self.text)), strict=True)]


@dataclass(frozen=True, slots=True)
class PrintedMatrix:
    """A matrix in the text."""

    rows: tuple[tuple[LatexPiece, ...], ...]  # its entries
    is_determinant: bool = False  # whether it stands between bars, or behind ``det``
    is_cases: bool = False  # whether its rows are alternatives, each with its condition


@dataclass(slots=True)
class _Environment:
    """An environment while it is read: what it is, where it begins, and the row ends and cell marks of its own."""

    name: str
    begin: tuple[int, int]
    marks: list[tuple[int, int, str]] = field(default_factory=list)
    children: list[_Environment] = field(default_factory=list)
    end: tuple[int, int] = (0, 0)


def display_piece(plain: str, begin: int, end: int, typed: str, start: Location) -> LatexPiece:
    """A display as one piece, in which row ends and cell marks of its own are form feeds and vertical tabs."""

    def refused(offset: int, found: str, allowed: str = "", remedy: str = "") -> CheckError:
        return CheckError(found, allowed=allowed, remedy=remedy, location=place(typed, offset, start))

    root = _Environment("", (begin, begin))
    open_now = [root]
    for match in _STRUCTURE.finditer(plain, begin, end):
        if match["begin"]:
            if (name := match["begin"]) not in EQUATION_ENVIRONMENTS and name not in _GRIDS:
                allowed = f"allowed: {listed((*MATRICES[:-1], *DISPLAYS))}"
                raise refused(match.start(), f"environment {quoted(name)}", allowed)
            stop = match.end() if name in _WITH_COLUMNS or not match["columns"] else match.start("columns")
            child = _Environment(name, (match.start(), stop))
            open_now[-1].children.append(child)
            open_now.append(child)
            if len(open_now) > MAX_NESTED:
                allowed = f"allowed: at most {MAX_NESTED - 1}"
                raise refused(match.start(), "environments nested too deeply", allowed)
        elif match["end"]:
            if match["end"] != open_now[-1].name:
                raise refused(match.start(), f"\\end{{{match['end']}}} without its \\begin", remedy="check it")
            open_now.pop().end = match.span()
        else:
            open_now[-1].marks.append((*match.span(), "\f" if match["row"] else "\v"))
    if len(open_now) > 1:
        raise refused(open_now[-1].begin[0], f"\\begin{{{open_now[-1].name}}} without its \\end", remedy="add it")
    root.end = (end, end)
    return _flattened(plain, root)


def _flattened(plain: str, environment: _Environment) -> LatexPiece:
    """What an environment holds: matrices inside are one character, row ends form feeds, cell marks vertical tabs."""
    begin, end = environment.begin[1], environment.end[0]
    letters = list(plain[begin:end])
    found: list[tuple[int, PrintedMatrix]] = []
    waiting = [(environment, False)]
    while waiting:
        node, is_inner = waiting.pop()
        # marks of environments inside a matrix mean nothing for the display; its own part rows and cells
        signs = [((first, last), " " if is_inner else sign) for first, last, sign in node.marks]
        for child in node.children:
            if child.name in _GRIDS and not _holds_equations(plain, child):
                inner = _flattened(plain, child).split("\f")  # a row end behind the last row adds none
                cells = [row.split("\v") for row in inner if row.text.strip("\v \n\r")]
                columns = enumerate(zip(*cells, strict=False))  # one that is blank in all rows is a gap
                gaps = {j for j, column in columns if not any(cell.text.strip() for cell in column)}
                rows = tuple(tuple(cell for j, cell in enumerate(row) if j not in gaps) for row in cells)
                found.append((child.begin[0], PrintedMatrix(rows, child.name[0] in "vV", child.name.endswith("cases"))))
                signs.append(((child.begin[0], child.end[1]), MATRIX_MARK))
            else:
                signs += [(child.begin, " "), (child.end, " ")]
                waiting.append((child, is_inner or environment.name in _GRIDS))
        for (first, last), sign in signs:
            length = last - first  # a matrix stands where it begins, an entry begins behind what ends another
            letters[first - begin : last - begin] = (sign.ljust if sign == MATRIX_MARK else sign.rjust)(length)
    matrices = tuple(matrix for _, matrix in sorted(found, key=lambda pair: pair[0]))
    piece = LatexPiece("".join(letters), begin, matrices)
    return _determinants(piece) if matrices else piece


def _holds_equations(plain: str, node: _Environment) -> bool:
    """Whether an array is a list of equations rather than a matrix."""
    inner = plain[node.begin[1] : node.end[0]]
    if node.name.endswith("cases"):  # an equals sign behind the mark of a row belongs to its condition
        rows = (row.partition("&") for row in inner.split("\\\\"))
        inner = "\n".join(first + (rest if RELATION.match(rest.lstrip()) else "") for first, _, rest in rows)
        return RELATION.search(inner) is not None
    for child in reversed(node.children):
        inner = inner[: child.begin[0] - node.begin[1]] + inner[child.end[1] - node.begin[1] :]
    return RELATION.search(inner) is not None or any(child.name in EQUATION_ENVIRONMENTS for child in node.children)


def _determinants(piece: LatexPiece) -> LatexPiece:
    r"""Bars around a matrix, and ``\det`` before it, belong to the matrix."""
    text, matrices, position = piece.text, list(piece.matrices), -1
    for index in range(len(matrices)):
        position = text.index(MATRIX_MARK, position + 1)
        before, after = text[:position].rstrip(), text[position + 1 :]
        if before.endswith("|") and after.lstrip().startswith("|"):
            bars = (len(before) - 1, position + 1 + len(after) - len(after.lstrip()))
            text = "".join(" " if i in bars else letter for i, letter in enumerate(text))
        elif match := re.search(r"\\det\s*\(?\s*$|\\(?:mathrm|operatorname)\{det\}\s*$", text[:position]):
            word = match[0].rstrip("( ")
            text = text[: match.start()] + " " * len(word) + text[match.start() + len(word) :]
            if "(" in match[0] and not after.lstrip().startswith(")"):
                continue
        else:
            continue
        matrices[index] = PrintedMatrix(matrices[index].rows, True)
    return LatexPiece(text, piece.offset, tuple(matrices))
