r"""Matrices and vectors that a formula names: ``{}^2_1R\,{}^1\omega_1 + \dot\theta_2\hat Z_2`` is a sum of columns.

A name may mean several matrices: T_1 is the pose of frame 1, or the matrix of the first row of the table. So a formula
has several values. It is right if one of them equals what the formula stands beside; if none does, nothing is known.
"""

import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cache, reduce
from itertools import chain, islice, product

import numpy as np

from derive.checking.latex.equations import Sides, listed
from derive.checking.latex.formula import LatexReader, derivative
from derive.checking.latex.left import AXES, Turned, taken_apart
from derive.checking.latex.matrices import Entry, Table, joined_blocks
from derive.checking.latex.meanings import ALIKE, Meanings, at_a_point
from derive.checking.latex.names import Symbol
from derive.checking.latex.pieces import AROUND, MATRIX_MARK, LatexPiece
from derive.checking.latex.poses import names_of_pose
from derive.checking.latex.quantities import WRENCH
from derive.checking.latex.targets import Target
from derive.errors import CheckError
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.robot.expression import ZERO, Call, Expression, Name, is_constant, negate, number

MAX_WAYS = 32  # values of one formula that are tried, of each size
MAX_NAMES = 20  # names of matrices in one formula
_SCRIPT = r"[_^]\s*(?:\{[^{}]*(?:\{[^{}]*\}[^{}]*)*\}|\\[a-z]+|\w)"
_FONTS = r"\\(?:hat|widehat|mathbf|boldsymbol|bm|mathrm|mathit|mathcal|vec|text)"
_PLAIN = r"\\(?:omega|alpha)(?![A-Za-z])|(?:(?<![A-Za-z\\])|(?<=\^T))[A-Za-z](?![A-Za-z])"
_LETTER = rf"(?:{_FONTS}\s*\{{\s*[A-Za-z]\s*\}}|{_FONTS}\s+[A-Za-z]|{_PLAIN})"
_DOTTED = rf"\\d?dot\s*(?:\{{\s*(?:{_LETTER}|\\theta)\s*\}}|{_LETTER}|\\theta(?![A-Za-z]))"
_BRACKETS = r"\((?:[^()]|\([^()]*\))*\)"
_ONE = (  # scripts before a letter are not those behind another one
    rf"(?:(?<![A-Za-z0-9}}])|(?![_^]))(?:\{{\s*(?:{_SCRIPT}\s*)*\}}\s*)?(?:{_SCRIPT}\s*)*(?:{_DOTTED}|{_LETTER})(?:{_SCRIPT})*"
    rf"(?:\s*\((?:[\\A-Za-z,\s{{}}]|_[0-9])*\)(?:{_SCRIPT})*)?"
)
_NAME = re.compile(rf"[\[(]\s*{_ONE}\s*[\])]\s*\^\s*(?:\{{[^{{}}]*\}}|T)|{_ONE}")
# A turn or a shift along one axis, or a shift by three numbers: R_z(\theta_1), Rot(x, \alpha), Trans(a, 0, 0), T_{z,d}.
_ELEMENTARY = re.compile(
    r"(?<![A-Za-z\\])(?:\\(?:text|mathrm|operatorname|mathbf|mathit|boldsymbol)\s*\{\s*)?(?:(?P<turn>R(?:ot)?|rot)|T(?:r(?:ans(?:l)?)?)?|trans|D)\s*\}?"
    rf"\s*(?:_\s*(?:\{{\s*)?\\?(?:hat\s*\{{)?(?P<axis>[xyzXYZ])\}}?(?:\s*,\s*(?P<below>(?:[^{{}}]|\{{[^{{}}]*\}})+))?\s*\}}?)?"
    rf"\s*(?P<arguments>{_BRACKETS})?"
)
_BODY = re.compile("(?:[clCG]|cm)?([1-9])")
_BRACED = re.compile(r"(?<![_^\w])\{(\s*\^(?:[^{}]|\{[^{}]*\})*)\}")
_UNIT = re.compile(
    r"(?:\{\s*\}\s*\^\s*(?:\{\s*(?P<seen>[0-9])\s*\}|(?P<from>[0-9]))\s*)?"
    rf"(?:\\(?:hat|widehat|vec|boldsymbol)\s*(?:\{{\s*)?(?:{_FONTS}\s*)?(?P<axis>[xyzXYZijkIJK0])|\\(?:mathbf|bm)\s*\{{\s*(?P<bold>[ijk]))\s*\}}?\s*(?:_\s*\{{?\s*(?P<frame>[0-9])\s*\}}{{0,2}})?"
)


class MatrixNames:
    """Reads formulas of one text with the matrices that it names."""

    def __init__(self, meanings: Meanings, reader: LatexReader, equations: Iterable[Sides] = ()) -> None:
        self._meanings, self._reader = meanings, reader
        self._tables: dict[Target, Table] = {}
        self._sides: dict[str, list[LatexPiece]] = {}  # what the text itself says of a letter
        self._said = cache(self._read)
        for first, *others in equations:
            left = taken_apart(first.text) if others and not first.matrices else None
            left = replace(left, sup=left.sup.replace("0", "")) if left is not None else None  # in the axes of the base
            if left is not None and left.is_plain:
                self._sides.setdefault(left.flat, []).extend(others)

    def _read(self, name: str) -> list[Table]:
        """The matrices that the text says a name is."""
        read = list[Table]()
        for side in self._sides.pop(name, ()):  # which may name itself
            with suppress(CheckError):
                made = list(self.values(side)) if _ELEMENTARY.search(side.text) else []
                # a T may be that of a transpose
                found: list[Expression | Table] = [*made] or [self._reader.value(side)]
                read += [t for t in found if isinstance(t, Table) and not any(e.unknown for e in t.entries)]
        return read

    def values(self, piece: LatexPiece) -> Iterator[Table]:
        """The matrices that a formula with names of matrices may be."""
        if piece.text.strip(AROUND) == MATRIX_MARK:
            yield from self._of_blocks(piece)
            return
        # {^2f_2} in braces of its own
        text, found = _BRACED.sub(lambda m: f" {m[1]} ", piece.text), dict[int, list[Table]]()
        text = re.sub(r"\^\s*T(?=[A-Za-z])", "^T ", text)  # v^Tv
        kinds = [(_ELEMENTARY, self._elementary), (_NAME, self._by_text), (_UNIT, self._unit), (_NAME, self._named)]
        for pattern, meaning in kinds:
            for match in pattern.finditer(text):
                if tables := meaning(match, piece.offset):
                    found[match.start()] = tables
                    text = text[: match.start()] + MATRIX_MARK.ljust(len(match[0])) + text[match.end() :]
        if not 0 < len(found) <= MAX_NAMES:
            return
        text = re.sub(rf"\{{(\s*{MATRIX_MARK}\s*)\}}", r" \1 ", text)
        rest = LatexPiece(text, piece.offset, piece.matrices)
        for size in (4, 3, 2):  # transforms, then rotations and vectors, then those of a plane
            fitting = [[t for t in tables if t.shape[0] == size] or tables for tables in found.values()]
            ways = range(min(max(map(len, fitting)), MAX_WAYS))  # all rows of one number, or as many as there are
            alike = ([tables[min(k, len(tables) - 1)] for tables in fitting] for k in ways)
            for chosen in chain(alike, islice(product(*fitting), MAX_WAYS)):
                with suppress(CheckError):
                    value = self._reader.value(rest, dict(zip(found, chosen, strict=True)))
                    yield value if isinstance(value, Table) else Table(((Entry(value),),))  # v^T v

    def _of_blocks(self, piece: LatexPiece) -> Iterator[Table]:
        """A matrix of formulas with names, each with the first of its values: [z_0 x (o_2 - o_0) ...; z_0 ...]."""
        with suppress(CheckError):
            rows = piece.matrices[0].rows
            cells = [[next(self.values(cell), None) or self._reader.value(cell) for cell in row] for row in rows]
            yield from [joined_blocks(cells)] if rows and rows[0] and len({*map(len, rows)}) == 1 else ()

    def _elementary(self, match: re.Match[str], offset: int) -> list[Table]:
        """A turn as a matrix of four rows and of three; a shift as one of four."""
        arguments = listed(LatexPiece(match["arguments"] or "", offset))
        texts = [match["below"]] if match["below"] else [argument.text for argument in arguments]
        if not (axis := (match["axis"] or "").lower()) and len(texts) == 2:
            axis, texts = re.sub(r"\\hat|[^A-Za-z]", "", texts[0]).lower(), texts[1:]
        if not texts or (axis not in AXES and (match["turn"] or len(texts) != len(AXES))):
            return []
        try:
            values = [self._reader.formula(LatexPiece(text, offset)) for text in texts]
        except CheckError:
            return []
        if not match["turn"]:
            shift = values if axis not in AXES else [values[0] if name == axis else ZERO for name in AXES]
            return [_table([[*_unit_row(i)[:3], shift[i]] for i in range(3)] + [_unit_row(3)])]
        k = AXES[axis] - 1  # the two axes behind it turn: [c -s; s c]
        turn, i, j = [_unit_row(row)[:3] for row in range(3)], (k + 1) % 3, (k + 2) % 3
        turn[i][i] = turn[j][j] = Call("cos", (values[0],))
        turn[j][i], turn[i][j] = Call("sin", (values[0],)), negate(Call("sin", (values[0],)))
        return [_table([*([*row, ZERO] for row in turn), _unit_row(3)]), _table(turn)]

    def _unit(self, match: re.Match[str], _: int) -> list[Table]:
        """A unit vector in its own axes, and that of a frame in the base."""
        letter = (match["axis"] or match["bold"]).lower()
        axis = AXES.get(letter) or "0ijk".index(letter)
        own = _table([[number(int(i == axis))] for i in (1, 2, 3)])
        seen = match["seen"] or match["from"]
        if not match["frame"] or seen == match["frame"]:
            return [own]
        found = self._of(Target(f"T[{seen or 0},{match['frame']}]", (1, 2, 3), (axis,)))
        return found if seen else [*found, own]

    def _by_text(self, match: re.Match[str], _: int) -> list[Table]:
        """What the text itself says that a name is."""
        left = taken_apart(match[0])
        is_plain = left is not None and replace(left, dots=0, turned=Turned.NOT).is_plain
        if left is None or not is_plain or left.turned in (Turned.INVERTED, Turned.BOTH):
            return []
        tables, by_time = self._said(left.flat), lambda e: derivative(self._meanings.robot, e, "t")
        if left.dots:  # q = (30 deg, 45 deg) is where the arm stands
            tables = [table for table in tables if not all(is_constant(e.formula) for e in table.entries)]
        with suppress(CheckError):
            tables = [reduce(lambda t, _: t.changed(by_time), range(left.dots), table) for table in tables]
            return [table.transposed if left.turned else table for table in tables]
        return []

    def _named(self, match: re.Match[str], _: int) -> list[Table]:
        left = taken_apart(match[0].replace("[", "(").replace("]", ")"))
        if left is not None and left.head.lower() in AXES and left.sub and left.sub == left.before + left.sup:
            return [_table([[number(int(i == AXES[left.head.lower()]))] for i in (1, 2, 3)])]  # in its own frame
        if left is None:
            return []
        if left.is_plain and left.head in ("F", "f", "W") and not left.sub and self._meanings.forces:
            forces = [Name(force) if force in self._meanings.forces else ZERO for force in WRENCH]
            return [_table([[e] for e in part]) for part in (forces, forces[:3], forces[:2])]
        if left.head == "I" and (body := _BODY.fullmatch(left.sub)) and not left.dots:
            # in the axes of the link, or of the base
            seen = (f"tensor[{body[1]}]", f"tensor[{body[1]},0]")
            return [table for name in seen for table in self._of(Target(name, turned=left.turned))]
        # a name that stands for one formula is no matrix; a coordinate of some point may be an axis as well
        known = self._reader.names
        meaning = known.meaning(Symbol(left.flat, 0)) if known.knows(left.flat) else None
        is_rate = left.dots and isinstance(meaning, Name) and replace(left, dots=0, sup="").is_plain
        is_vector = meaning is None or left.head == "omega" or names_of_pose(meaning)
        if is_rate or (left.is_plain and not (is_vector or left.arguments)):
            return []
        return list(dict.fromkeys(table for target in self._meanings.targets(left) for table in self._of(target)))

    def _of(self, target: Target) -> list[Table]:
        if target not in self._tables:
            right = self._meanings.right(target)
            if right is None or right.value.shape == (1, 1) or 0 in right.value.shape:
                return []
            self._tables[target] = _table([[expression_from_sympy(e) for e in row] for row in right.value.tolist()])
        return [self._tables[target]]


def are_alike(one: Table, other: Table) -> bool:
    """Whether two matrices have the same values at a point."""
    if one.shape != other.shape:
        return False
    values = at_a_point(*(entry.formula for table in (one, other) for entry in table.entries))
    half = len(values) // 2
    return bool(values) and np.allclose(values[:half], values[half:], rtol=ALIKE, atol=ALIKE)


def _table(rows: list[list[Expression]]) -> Table:
    return Table(tuple(tuple(map(Entry, row)) for row in rows))


def _unit_row(i: int) -> list[Expression]:
    return [number(int(i == j)) for j in range(4)]
