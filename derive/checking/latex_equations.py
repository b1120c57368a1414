r"""LaTeX as people have it, taken apart: displays, their rows and equations, the sides of each, entries of matrices.

Nothing is understood here but structure. Every side of an equation is a piece of the text with its place; a matrix in
it is one character, and its entries are pieces themselves. Lines broken inside a sum are joined, ``x = a, \quad y = b``
and the columns of ``align`` are separate equations, and ``a = b = c`` has three sides.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from derive.checking.latex_typography import cleaned
from derive.errors import CheckError, Location, listed, quoted
from derive.robot.parser import place

MATRIX_MARK = "\ue000"
"""Stands for a matrix in the text of a side."""

MATRICES = ("bmatrix", "pmatrix", "matrix", "Bmatrix", "vmatrix", "Vmatrix", "array", "smallmatrix", "psmallmatrix")
"""Environments of matrices; with a star too."""

MAX_NESTED = 12
"""Environments inside each other, the text counted."""

DISPLAYS = ("equation", "align", "aligned", "gather", "gathered", "split", "multline", "alignat", "flalign", "eqnarray")
"""Environments of equations that a message names; `_KNOWN` has all of them."""

_KNOWN = frozenset(
    (*DISPLAYS, "alignedat", "multlined", "displaymath", "math", "dmath", "IEEEeqnarray", "subequations")
)
_GRIDS = frozenset((*MATRICES, "bsmallmatrix", "Bsmallmatrix", "vsmallmatrix", "tabular", "cases", "dcases", "rcases"))
_LENGTH = r"(?:\s*\[\s*-?[0-9.]*\s*(?:pt|em|ex|mm|cm|in|\\[a-z]+)\s*\])?"
_BRACES = r"\{(?:[^{}]|\{[^{}]*\})*\}"
_STRUCTURE = re.compile(
    rf"\\begin\s*\{{(?P<begin>[A-Za-z]+)\*?\}}(?:\s*\[[a-z|]*\])?(?P<columns>\s*{_BRACES})?"
    r"|\\end\s*\{(?P<end>[A-Za-z]+)\*?\}"
    rf"|(?P<row>\\\\\*?{_LENGTH}|\\(?:cr|tabularnewline|newline)(?![A-Za-z]){_LENGTH})"
    r"|(?P<cell>(?<!\\)&)"
)
_WITH_COLUMNS = ("array", "alignat", "alignedat", "IEEEeqnarray", "tabular")
_RELATION = re.compile(
    r":\s*=|=\s*:|=|\\(?:coloneqq?|triangleq|equiv|doteq|stackrel\s*\{[^{}]*\}\s*\{\s*=\s*\}|overset\s*\{[^{}]*\}\s*\{\s*=\s*\})(?![A-Za-z])"
)
_WORDS = (
    "and|or|where|with|so|hence|thus|therefore|then|for|if|since|let|yields|gives|dove|con|quindi|per|allora|onde|com|logo|"
    "então|und|mit|wobei|also|avec|donc|où|y|donde"
)
_SEPARATOR = re.compile(
    r"\\(?:qquad|quad|enspace|Rightarrow|Longrightarrow|implies|rightarrow|Leftrightarrow|iff|therefore|land)(?![A-Za-z])"
    r"|\\(?:text|textrm|mathrm|mbox|intertext|shortintertext|textnormal)\s*"
    rf"\{{(?:\s*[,;.]?\s*(?:{_WORDS})\s*[:,]?\s*|[^{{}}A-Za-z]*|\s[^{{}}]*|[^{{}}]*\s|[^{{}}]+\s[^{{}}]+)\}}"
    r"|(?P<mark>[,;])"
)
_NUMBERED = re.compile(r"(?:\\q?quad|\v)[\s\v]*\(\s*[0-9]+(?:\.[0-9]+)*[a-z]?\s*\)[\s\v.,;]*$")
"""The number of an equation that is typed behind it."""

_OPENING, _CLOSING = "([{", ")]}"
_OPERATOR = re.compile(r"[-+*/=]|\\(?:cdot|times|ast)(?![A-Za-z])")
_ENDS_OPEN = re.compile(r"(?:[-+*/=]|\\(?:cdot|times|ast))\s*$")
_PROSE = re.compile(r"(?:[^\W\d_]|(?<=\w)-(?=\w)|[\s.,;:()'\u2019])*")
_FENCE = re.compile(
    r"\\\[(?P<square>.*?)\\\]|\$\$(?P<double>.*?)\$\$|\\\((?P<round>.*?)\\\)|(?<!\\)\$(?P<single>[^$]*)(?<!\\)\$"
    r"|\\(?P<macro>eq|mx|whole)\s*(?=\{)"
    r"|\\begin\s*\{(?P<name>[A-Za-z]+)(?P<star>\*?)\}(?P<display>.*?)\\end\s*\{(?P=name)(?P=star)\}",
    re.DOTALL,
)


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of the text, a side of an equation or an entry of a matrix.

    Attributes:
        text: What stands there, each matrix as one character.
        offset: Where it begins in the whole text.
        matrices: Its matrices, in their order.
    """

    text: str
    offset: int
    matrices: tuple[PrintedMatrix, ...] = ()

    @property
    def start(self) -> int:
        """Where its first sign stands in the whole text."""
        return self.offset + len(self.text) - len(self.text.lstrip())

    @property
    def end(self) -> int:
        """Where its last sign ends in the whole text."""
        return self.offset + len(self.text.rstrip())

    def part(self, begin: int, end: int) -> Piece:
        """A part of it.

        Args:
            begin: Where it begins in this one.
            end: Where it ends.
        """
        first = self.text.count(MATRIX_MARK, 0, begin)
        text = self.text[begin:end]
        return Piece(text, self.offset + begin, self.matrices[first : first + text.count(MATRIX_MARK)])


@dataclass(frozen=True, slots=True)
class PrintedMatrix:
    """A matrix in the text.

    Attributes:
        rows: Its entries.
        is_determinant: Whether it stands between bars, or behind ``det``.
    """

    rows: tuple[tuple[Piece, ...], ...]
    is_determinant: bool = False


@dataclass(frozen=True, slots=True)
class Equation:
    """What stands between equals signs; a lone formula has one side.

    Attributes:
        sides: From left to right.
    """

    sides: tuple[Piece, ...]


@dataclass(slots=True)
class _Environment:
    """An environment while it is read: what it is, where it begins, and the row ends and cell marks of its own."""

    name: str
    begin: tuple[int, int]
    marks: list[tuple[int, int, str]] = field(default_factory=list)
    children: list[_Environment] = field(default_factory=list)
    end: tuple[int, int] = (0, 0)


def equations(text: str, start: Location, *, document: bool = False, time: bool = True) -> Iterator[Equation]:
    """The equations of a text.

    Args:
        text: LaTeX: a formula, an equation, a display, or a document.
        start: Where its first character stands, for errors.
        document: Whether prose and environments of other kinds may stand around the displays.
        time: Whether t is time, so that q(t) is q.

    Yields:
        The equations, in their order.

    Raises:
        CheckError: An environment that is no display and no matrix, or one that does not end.
    """
    plain = cleaned(text, time)
    for begin, end in _displays(plain, start, document):
        try:
            whole = _read(plain, begin, end, text, start)
        except CheckError:
            if document:
                continue
            raise
        yield from _equations(whole)


def _displays(plain: str, start: Location, document: bool) -> Iterator[tuple[int, int]]:
    """Where mathematics begins and ends; the whole text where nothing marks it."""
    fences: list[tuple[int, int]] = []
    begin_document = plain.find("\\begin{document}") + len("\\begin{document}") if document else 0
    position = begin_document if document and "\\begin{document}" in plain else 0
    while match := _FENCE.search(plain, position):
        name = match["name"]
        if match["macro"]:  # of the handout's fragments; the second group of \\mx says the same entry by entry
            closing = _closing(plain, match.end())
            fences.append((match.end() + 1, closing))
            is_pair = match["macro"] == "mx" and plain.startswith("{", closing + 1)
            position = _closing(plain, closing + 1) if is_pair else closing
        elif name is None or name in _KNOWN:
            if match.lastgroup and not (document and match["single"] is not None):
                fences.append((match.start(), match.end()))
            position = match.end()
        elif document:
            position = match.start() + len("\\begin")
        else:
            position = match.end()
    outside, last = [], 0
    for begin, end in (*fences, (len(plain), len(plain))):
        outside.append((last, plain[last:begin]))
        last = end
    strange = [(offset, text) for offset, text in outside if not _PROSE.fullmatch(text)]
    if document or (fences and not strange):
        yield from fences
        return
    if fences and any(plain.startswith(("$", "\\[", "\\("), begin) for begin, _ in fences):
        offset, text = strange[0]
        where = place(plain, offset + len(text) - len(text.lstrip()), start)
        raise CheckError("formula partly outside the dollar signs", remedy="enclose all of it", location=where)
    yield 0, len(plain)


def _closing(text: str, opening: int) -> int:
    """Where the brace is that closes the one at a place; the end of the text where there is none."""
    depth = 0
    for match in re.compile(r"\\.|[{}]", re.DOTALL).finditer(text, opening):
        depth += {"{": 1, "}": -1}.get(match[0], 0)
        if depth == 0:
            return match.start()
    return len(text)


def _read(plain: str, begin: int, end: int, typed: str, start: Location) -> Piece:
    """A display as one piece, in which row ends and cell marks of its own are left."""
    root = _Environment("", (begin, begin))
    open_now = [root]
    for match in _STRUCTURE.finditer(plain, begin, end):
        if match["begin"]:
            name = match["begin"]
            if name not in _KNOWN and name not in _GRIDS:
                allowed = f"allowed: {listed((*MATRICES[:-1], *DISPLAYS))}"
                found = f"environment {quoted(name)}"
                raise CheckError(found, allowed=allowed, location=place(typed, match.start(), start))
            stop = match.end() if name in _WITH_COLUMNS or not match["columns"] else match.start("columns")
            child = _Environment(name, (match.start(), stop))
            open_now[-1].children.append(child)
            open_now.append(child)
            if len(open_now) > MAX_NESTED:
                where = place(typed, match.start(), start)
                raise CheckError("environments nested too deeply", allowed=f"at most {MAX_NESTED - 1}", location=where)
        elif match["end"]:
            if match["end"] != open_now[-1].name:
                where = place(typed, match.start(), start)
                raise CheckError(f"\\end{{{match['end']}}} without its \\begin", remedy="check it", location=where)
            open_now.pop().end = match.span()
        else:
            open_now[-1].marks.append((*match.span(), "row" if match["row"] else "cell"))
    if len(open_now) > 1:
        where = place(typed, open_now[-1].begin[0], start)
        raise CheckError(f"\\begin{{{open_now[-1].name}}} without its \\end", remedy="add it", location=where)
    root.end = (end, end)
    return _flattened(plain, root)


def _flattened(plain: str, environment: _Environment) -> Piece:
    """What an environment holds: matrices inside are one character, row ends form feeds, cell marks vertical tabs."""
    begin, end = environment.begin[1], environment.end[0]
    letters = list(plain[begin:end])
    found: list[tuple[int, PrintedMatrix]] = []
    waiting = [(environment, False)]
    while waiting:
        node, is_inner = waiting.pop()
        signs = [(mark[:2], " " if is_inner else _SIGNS[mark[2]]) for mark in node.marks]
        for child in node.children:
            if child.name in _GRIDS and not _holds_equations(plain, child):
                found.append(
                    (child.begin[0], PrintedMatrix(tuple(_rows(_flattened(plain, child))), child.name[0] in "vV"))
                )
                signs.append(((child.begin[0], child.end[1]), MATRIX_MARK))
            else:
                signs += [(child.begin, " "), (child.end, " ")]
                waiting.append((child, is_inner or environment.name in _GRIDS))
        for (first, last), sign in signs:
            # a matrix stands where it begins, an entry begins behind what ends another
            length = last - first
            letters[first - begin : last - begin] = (sign.ljust if sign == MATRIX_MARK else sign.rjust)(length)
    matrices = tuple(matrix for _, matrix in sorted(found, key=lambda pair: pair[0]))
    piece = Piece("".join(letters), begin, matrices)
    return _determinants(piece) if matrices else piece


_SIGNS = {"row": "\f", "cell": "\v"}


def _holds_equations(plain: str, node: _Environment) -> bool:
    """Whether an array is a list of equations rather than a matrix."""
    inner = plain[node.begin[1] : node.end[0]]
    for child in reversed(node.children):
        inner = inner[: child.begin[0] - node.begin[1]] + inner[child.end[1] - node.begin[1] :]
    return _RELATION.search(inner) is not None


def _determinants(piece: Piece) -> Piece:
    r"""Bars around a matrix, and ``\det`` before it, belong to the matrix."""
    text, matrices, position = piece.text, list(piece.matrices), -1
    for index in range(len(matrices)):
        position = text.index(MATRIX_MARK, position + 1)
        before, after = text[:position].rstrip(), text[position + 1 :]
        if before.endswith("|") and after.lstrip().startswith("|"):
            bars = (len(before) - 1, position + 1 + len(after) - len(after.lstrip()))
            text = "".join(" " if i in bars else letter for i, letter in enumerate(text))
        elif match := re.search(r"\\det\s*\(?\s*$|\\(?:mathrm|operatorname)\{det\}\s*$", text[:position]):
            bracket = "(" in match[0]
            text = (
                text[: match.start()]
                + " " * len(match[0].rstrip("( "))
                + text[match.start() + len(match[0].rstrip("( ")) :]
            )
            if bracket and not after.lstrip().startswith(")"):
                continue
        else:
            continue
        matrices[index] = PrintedMatrix(matrices[index].rows, True)
    return Piece(text, piece.offset, tuple(matrices))


def _rows(piece: Piece) -> Iterator[tuple[Piece, ...]]:
    """The entries of a matrix; a row end behind the last row adds none."""
    for row in _split(piece, "\f"):
        if row.text.strip("\v \n\r"):
            yield tuple(_split(row, "\v"))


def _split(piece: Piece, sign: str) -> list[Piece]:
    ends = [i for i, letter in enumerate(piece.text) if letter == sign]
    return [piece.part(a, b) for a, b in zip((0, *(i + 1 for i in ends)), (*ends, len(piece.text)), strict=True)]


# -- from a display to its equations


def _equations(display: Piece) -> Iterator[Equation]:
    text = _without_fences(display.text)
    spans = _joined(text, [span for row in _spans(text, "\f") for span in _row_parts(text, row)])
    shown, text = text, text.replace("\f", " ").replace("\v", " ")
    for begin, end in spans:
        whole = Piece(text, display.offset, display.matrices)
        if number := _NUMBERED.search(shown[begin:end]):
            end = begin + number.start()
        printed = text[begin:end].rstrip()
        end = begin + len(printed if printed.endswith("...") else printed.rstrip(" \n\r.,;:"))
        ends = [begin, *(edge for span in _relations(text, begin, end) for edge in span), end]
        sides = [whole.part(a, b) for a, b in zip(ends[::2], ends[1::2], strict=True)]
        sides = [_without_separators(side) for side in sides]
        if any(side.text.strip() for side in sides):
            yield Equation(tuple(side for side in sides if side.text.strip()))


def _without_fences(text: str) -> str:
    """Blanks for what marks a display, and for the one brace before a system of equations."""
    text = re.sub(r"\\\[|\\\]|\\\(|\\\)|\$\$?", lambda m: " " * len(m[0]), text)
    if text.count("\\{") != text.count("\\}"):
        text = text.replace("\\{", "  ")
    return text


def _spans(text: str, sign: str, begin: int = 0, end: int | None = None) -> Iterator[tuple[int, int]]:
    end = len(text) if end is None else end
    cuts = [i for i in range(begin, end) if text[i] == sign]
    yield from zip((begin, *(i + 1 for i in cuts)), (*cuts, end), strict=True)


def _depths(text: str, begin: int, end: int) -> int:
    """How many brackets are open at the end."""
    part = text[begin:end]
    return sum(map(part.count, _OPENING)) - sum(map(part.count, _CLOSING))


def _relations(text: str, begin: int, end: int) -> list[tuple[int, int]]:
    """Equals signs outside of brackets."""
    found, depth, last = [], 0, begin
    for match in _RELATION.finditer(text, begin, end):
        depth, last = depth + _depths(text, last, match.start()), match.end()
        if depth <= 0:
            found.append(match.span())
    return found


def _row_parts(text: str, row: tuple[int, int]) -> Iterator[tuple[int, int]]:
    """The equations that stand side by side in one row."""
    begin, end = row
    cuts: list[tuple[int, int]] = []
    depth, last = 0, begin
    marks = [(m.start(), m.end()) for m in _SEPARATOR.finditer(text, begin, end)]
    marks += [(i, i + 1) for i in range(begin, end) if text[i] == "\v"]
    for first, stop in sorted(marks):
        depth, last = depth + _depths(text, last, first), stop
        if depth > 0:
            continue
        here = cuts[-1][1] if cuts else begin
        done, rest = _relations(text, here, first), _relations(text, stop, end)
        is_mark = text[first] in "\v,;"
        complete = bool(done) and bool(text[done[-1][1] : first].strip(" \v\n\r"))
        words = not is_mark and not re.match(r"\\q?quad|\\enspace", text[first:stop])
        if not complete and not (words and not done):
            continue
        left = text[stop : rest[0][0]].strip(" \v\n\r") if rest else ""
        left = _SEPARATOR.sub(" ", left).strip(" \v\n\r")
        if left and not _OPERATOR.match(left):
            cuts.append((first, stop))
    edges = [begin, *(edge for cut in cuts for edge in cut), end]
    yield from zip(edges[::2], edges[1::2], strict=True)


def _joined(text: str, parts: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Parts of one equation that stand on several lines, together."""
    found: list[tuple[int, int]] = []
    for begin, end in parts:
        part = text[begin:end].strip(" \v\n\r")
        if not part:
            continue
        if found:
            first, last = found[-1]
            before = text[first:last].rstrip(" \v\n\r")
            relations = _relations(text, begin, end)
            continues = (
                _OPERATOR.match(part)
                or _ENDS_OPEN.search(before)
                or _depths(text, first, last) > 0
                or (not relations and _relations(text, first, last))
            )
            if continues:
                found[-1] = (first, end)
                continue
        found.append((begin, end))
    return found


def _without_separators(side: Piece) -> Piece:
    """Spaces and words that part nothing are blank; commas stay, for a formula must not have one."""
    text = _SEPARATOR.sub(lambda m: m[0] if m["mark"] else " " * len(m[0]), side.text)
    return Piece(text, side.offset, side.matrices)
