r"""LaTeX against a robot: every equation of a text, matrices entry by entry, each with a verdict of its own.

Of an equation such as ``\mathbf{T}_2^0 = \mathbf{A}_1 \mathbf{A}_2 = [...]`` the sides that name quantities are
compared with those that are formulas or matrices. A name that the robot does not know and that a side defines
(``h = -m_2 a_1 l_2 s_2``) may stand in all others.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice

from derive.checking.formulas.diagnosis import Question, other_orders
from derive.checking.formulas.findings import FileReport, Finding, Role, Skipped, compared, undecidable
from derive.checking.latex.equations import Sides, equations
from derive.checking.latex.formula import LatexReader
from derive.checking.latex.left import Left, Target, is_scalar, taken_apart
from derive.checking.latex.matrices import Entry, Table
from derive.checking.latex.meanings import EntryNames, Meanings, Right
from derive.checking.latex.pieces import MATRIX_MARK, LatexPiece
from derive.errors import CheckError, Location, UnknownNameError, quoted
from derive.lecture.shorthand import notation_text
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.model import Model
from derive.robot.expression import Call, Expression, Name, is_constant
from derive.robot.names import robot_symbols

MAX_EQUATIONS = 1_500  # equations of one text; a whole handout of a 6R arm has some 600
MAX_SIDES = 20  # sides of one equation
MAX_PASSES = 12  # how often definitions are gone through that need one that stands behind them
# Letters that are a quantity's with an index, and just as often a short name for a part of a formula.
_LENT = frozenset("uvwhkexyzfFQ")
_ANY = frozenset("fFhkKuvwQeVLWS")  # letters for anything: they contradict no quantity that is asked about
_ROWS = re.compile(r"\\\\|&")

# Transforms side by side.
_PRODUCT = re.compile(
    r"(?:(?:[_^]\s*(?:\{[^{}]*\}|\w)\s*)*(?:\\(?:mathbf|boldsymbol|bm|mathrm)\s*\{\s*[TAHRJ]\s*\}|\{\s*[TAHRJ]\s*\}|[TAHRJ])"
    r"\s*(?:[_^]\s*(?:\{[^{}]*\}|\w)\s*)*(?:\([^()]*\))?\s*(?:\\cdot|\*)?\s*){2,}"
)
# A Christoffel symbol with letters for its indices.
_SYMBOL = re.compile(r"(?:\\\w+\{)?(?:\\?[A-Za-z]+)\}?_\{?([a-z],?[a-z],?[a-z])\}?(?:\(.*\))?")
# A partial derivative that is subtracted, and the index of its variable.
_SUBTRACTED = re.compile(
    r"-\s*(?:\\[dt]?frac\s*\{\s*\\partial(?:[^{}]|\{[^{}]*\})*\}\s*\{\s*\\partial\s*(?:q|\\theta)\s*_\s*\{?\s*([a-z])\s*\}?\s*\})"
)


@dataclass(frozen=True, slots=True)
class LatexReport:
    """What was compared in a text and what was not."""

    findings: tuple[Finding, ...]  # one for each formula and each entry of a matrix, in the order of the text
    skipped: tuple[Skipped, ...] = ()  # equations about which nothing is said

    def file_report(self, source: str, robot: str) -> FileReport:
        """The comparisons as those of a file."""
        return FileReport(source, robot, self.findings, tuple(f"{s.location}: {s.reason}" for s in self.skipped))


def check_latex(
    model: Model, text: str, quantity: str = "", start: Location | None = None, *, document: bool = False
) -> LatexReport:
    """Compare the equations of a LaTeX text with what follows from the robot's table."""
    where = start or Location("<latex>")
    document = document or "\\documentclass" in text or "\\begin{document}" in text
    if quantity:
        model.quantity(quantity)  # refused before anything is read
    check = _Check(model, text, quantity, where, document)
    findings = tuple(check.findings())
    if not findings:
        skipped = check.skipped[0] if check.skipped else Skipped(where, "no formula, or only names are defined")
        remedy = "write left sides such as T_3^0 = or b_{11} =, or give the quantity"
        raise CheckError(f"no formula that can be checked: {skipped.reason}", remedy=remedy, location=skipped.location)
    return LatexReport(findings, tuple(check.skipped))


@dataclass(frozen=True, slots=True)
class _Side:
    """A side of an equation: the quantities that it may name, and what it says or why it says nothing."""

    piece: LatexPiece
    left: Left | None = None
    targets: tuple[Target, ...] = ()
    value: Expression | Table | None = None
    error: CheckError | None = None


class _Check:
    """The comparison of one text."""

    def __init__(self, model: Model, text: str, quantity: str, start: Location, document: bool) -> None:
        self.model, self.robot, self.text, self.asked, self.start = model, model.robot, text, quantity, start
        self.document = document
        has_time = "t" not in robot_symbols(self.robot)
        found = islice(equations(text, start, document=document, time=has_time), MAX_EQUATIONS + 1)
        self.equations = tuple(found)
        if len(self.equations) > MAX_EQUATIONS or any(len(e) > MAX_SIDES for e in self.equations):
            allowed = f"allowed: at most {MAX_EQUATIONS} with {MAX_SIDES} sides each"
            raise CheckError("too many equations in one text", allowed=allowed, location=start)
        if not self.equations:
            raise CheckError("empty formula", remedy="write a formula or an equation", location=start)
        # what the text defines is read first: the order of Christoffel indices, then abbreviations
        self.orders = {i: order for i, e in enumerate(self.equations) if (order := self._torque_index(e)) is not None}
        self.meanings = Meanings(model, next(iter(self.orders.values()), 0))
        self.plain = LatexReader(self.robot, text, start)
        self.skipped: list[Skipped] = []
        self.definitions: dict[str, list[tuple[int, Expression]]] = {}
        self.defining: set[int] = set()
        self.names: set[tuple[int, int]] = set()
        self._define()
        self.reader = self._reader(0)
        self.defining |= self.orders.keys()
        self.lone = len(self.equations) - len(self.defining) == 1

    def findings(self) -> Iterator[Finding]:
        """One for each formula and each entry of a matrix."""
        for index, equation in enumerate(self.equations):
            if index in self.defining:
                continue
            if any(len(meanings) > 1 for meanings in self.definitions.values()):
                self.reader = self._reader(index)
            try:
                found = tuple(self._equation(index, equation))
            except CheckError as error:
                if not self.document:
                    raise
                self._skip(equation[0], error)
                continue
            unknown = next((finding.unknown for finding in found if finding.unknown), None)
            if unknown is not None and self.document:
                self._skip(equation[0], unknown)
            else:
                yield from found

    def _skip(self, side: LatexPiece, error: CheckError) -> None:
        where = error.location or self.plain.location(side.start)
        self.skipped.append(Skipped(where, error.found, self._typed(side)))

    def _typed(self, side: LatexPiece) -> str:
        return " ".join(_ROWS.sub(" ", self.text[side.start : side.end]).split())

    # -- definitions

    def _torque_index(self, equation: Sides) -> int | None:
        """Which index of a Christoffel symbol is that of the torque, where the equation defines the symbol.

        It is that of the variable in the derivative that is subtracted, as in -(partial d_ij)/(partial q_k).
        """
        first, *others = (self.text[side.start : side.end] for side in equation)
        symbol = _SYMBOL.fullmatch("".join(first.split()))
        minus = next(filter(None, map(_SUBTRACTED.search, others)), None)
        if symbol is None or minus is None:
            return None
        letters = symbol[1].replace(",", "")
        return letters.index(minus[1]) if minus[1] in letters else None

    def _define(self) -> None:
        """Names that sides define; a definition may need another one that stands before or behind it."""
        several = [(i, e) for i, e in enumerate(self.equations) if len(e) > 1]
        named = [(i, e, tuple(self._new_name(side, i, side is e[0]) for side in e)) for i, e in several]
        waiting = [some for some in named if any(some[2])]
        for _ in range(MAX_PASSES):
            left = [some for some in waiting if not self._defines(*some)]
            if len(left) == len(waiting):
                return
            waiting = left

    def _defines(self, index: int, equation: Sides, names: tuple[str, ...]) -> bool:
        """Whether an equation gives a new name to a formula that can be read by now."""
        name, reader = next(filter(None, names)), self._reader(index)
        for side, its_name in zip(equation, names, strict=True):
            with suppress(CheckError):
                if not its_name:
                    meaning = reader.formula(side)
                    self.definitions.setdefault(name, []).append((index, meaning))
                    self.defining |= {index} if names[0] else set()
                    self.names |= {(index, s.offset) for s, n in zip(equation, names, strict=True) if n == name}
                    return True
        return False

    def _reader(self, index: int) -> LatexReader:
        """Reads an equation with the names that are defined at it or before it, else behind it."""
        meanings = {}
        for name, defined in self.definitions.items():
            # the last definition before the equation, else the first one behind it
            ordered = sorted(defined, key=lambda pair: (pair[0] > index, abs(pair[0] - index)))
            meanings[name] = ordered[0][1]
        return LatexReader(self.robot, self.text, self.start, meanings, EntryNames(self.meanings))

    def _new_name(self, side: LatexPiece, index: int, is_first: bool) -> str:
        """The name that a side is, where the robot does not know it and it is no quantity; otherwise empty."""
        left = None if side.matrices else taken_apart(side.text)
        if left is None or not left.is_plain or left.arguments or self._is_own(left):
            return ""
        if not any(is_scalar(target) for target in self.meanings.targets(left)):
            return left.flat
        if not (is_first and left.sub and left.head in _LENT):
            return ""
        others = (part for i, e in enumerate(self.equations) if i != index for part in e[1:])
        return left.flat if any(side.text.strip() in text for part in others for text in part.texts) else ""

    def _is_own(self, left: Left) -> bool:
        """Whether a left side is a name of the robot itself, such as a_1 or c_{12}."""
        return left.is_plain and self.plain.names.knows(left.flat)

    # -- one equation

    def _equation(self, index: int, equation: Sides) -> Iterator[Finding]:
        pieces = [piece for piece in equation if (index, piece.offset) not in self.names]
        sides = [self._side(piece, len(pieces) > 1) for piece in pieces]
        if len(sides) > 1 and all(side.value is None and side.error is None for side in sides):  # b_{12} = b_{21}
            turned = any(target.turned for side in sides for target in side.targets)
            sides[1:] = [self._said(side, turned) for side in sides[1:]]
        first, *others = sides
        if len(sides) == 2 and (cells := self._named_cells(*sides)):
            for name, entry in cells:
                yield from self._compared(name, Table(((entry,),)), entry.offset)
            return
        # sides that name quantities, and what the others say about them
        named = [side for side in sides if side.targets and (side.value is None or (side is first and others))]
        named = [side for side in named if side.left is not None and side.left.head not in _ANY] or named
        said = [side for side in sides if side.value is not None and side not in named]
        for side in sides if len(sides) == 1 else others:
            if side.error is not None and side not in named:
                yield from self._unread(side, named, side is sides[-1])
        if not named and not self.asked and len(said) > 1:
            yield from self._identities(said)
            return
        if not named and not self.asked and (said or first.error is None):
            remedy = "write its left side, such as T_3^0 = or b_{11} =, or give the quantity"
            found = f"{quoted(self._typed(first.piece))} names no quantity of this robot" if others else "formula alone"
            raise CheckError(found, remedy=remedy, location=self.plain.location(first.piece.start))
        if not named and others and first in said:
            said.remove(first)  # a name of the robot itself before what is asked
        for side in said:
            table = side.value if isinstance(side.value, Table) else Table(((self._whole(side),),))
            for name in named or [_Side(first.piece)]:
                yield from self._compared(name, table, side.piece.start)

    def _side(self, piece: LatexPiece, may_name: bool) -> _Side:
        left = None if piece.matrices else taken_apart(piece.text)
        targets = self.meanings.targets(left) if left else ()
        if may_name and _PRODUCT.fullmatch(piece.text.strip()) and left is None:
            where = self.plain.location(piece.start)
            return _Side(piece, error=CheckError("a product of matrices", remedy="multiply it out", location=where))
        if may_name and left is not None and targets and not self._is_own(left):
            return _Side(piece, left, targets)
        try:
            return _Side(piece, left, targets, self.reader.value(piece))
        except CheckError as error:
            return _Side(piece, left, targets, error=error)

    def _said(self, side: _Side, derived: bool) -> _Side:
        """What a side says that names a quantity, too: its formula, or else what is derived for it."""
        read = self._side(side.piece, False)
        if read.value is not None or not derived:
            return read
        rights = (self.meanings.right(target) for target in side.targets)
        value = next((right.value for right in rights if right is not None), None)
        if value is None:
            return read
        rows = value.tolist()
        table = Table(tuple(tuple(Entry(expression_from_sympy(entry)) for entry in row) for row in rows))
        return _Side(side.piece, value=table)

    def _whole(self, side: _Side) -> Entry:
        assert side.value is not None
        assert not isinstance(side.value, Table)
        return Entry(side.value, self._typed(side.piece), side.piece.start)

    def _unread(self, side: _Side, named: list[_Side], is_last: bool) -> Iterator[Finding]:
        """What becomes of a side that cannot be read: one between others is passed over, the last one is refused."""
        error = side.error
        assert error is not None
        if not is_last:
            self._skip(side.piece, error)
        elif isinstance(error, UnknownNameError) and not self.lone and (named or self.asked):
            target = named[0].targets[0] if named else Target(self.asked)
            place = (*target.rows, 0, 0)[:1] + (*target.columns, 0)[:1]
            yield undecidable(
                target.quantity, (place[0], place[1]), Role.PRINTED, self._typed(side.piece), error, False
            )
        else:
            raise error

    def _named_cells(self, first: _Side, second: _Side) -> list[tuple[_Side, Entry]]:
        """Cells of a matrix of names beside those of the matrix that says what they are."""
        matrices = first.piece.matrices
        if len(matrices) != 1 or first.piece.text.strip() != MATRIX_MARK or not isinstance(second.value, Table):
            return []
        cells = [cell for row in matrices[0].rows for cell in row]
        lefts = [taken_apart(cell.text) for cell in cells]
        entries = [entry for row in second.value.rows for entry in row]
        if len(cells) != len(entries):
            return []
        targets = [tuple(filter(is_scalar, self.meanings.targets(left))) if left else () for left in lefts]
        if not all(targets):
            return []
        return [(_Side(c, x, t), e) for c, x, t, e in zip(cells, lefts, targets, entries, strict=True)]

    def _identities(self, said: list[_Side]) -> Iterator[Finding]:
        """Sides that say the same, or should."""
        first = said[0]
        joints = {joint.variable for joint in self.robot.joints}
        is_parameter = isinstance(first.value, Name) and first.value.name not in joints
        is_name = isinstance(first.value, Name | Call)
        constant = any(not isinstance(s.value, Table) and s.value and is_constant(s.value) for s in said[1:])
        if is_parameter or (is_name and constant):
            what = "a symbol of the robot" if is_parameter else "given a number, a condition"
            where = self.plain.location(first.piece.start)
            remedy = "write a quantity such as T_3^0 = or b_{11} = on the left"
            raise CheckError(f"{quoted(self._typed(first.piece))} is {what}", remedy=remedy, location=where)
        for side in said[1:]:
            if isinstance(first.value, Table) or isinstance(side.value, Table) or not first.value or not side.value:
                raise CheckError("matrices on both sides", location=self.plain.location(side.piece.start))
            where = self.plain.location(side.piece.start)
            question = Question(self.robot, side.value, first.value)
            left, right = self._typed(first.piece), self._typed(side.piece)
            yield compared(question, left, (0, 0), Role.IDENTITY, right, left, where)

    # -- comparisons

    def _compared(self, name: _Side, table: Table, offset: int) -> Iterator[Finding]:
        """The findings for the first quantity that is meant of which everything is right; else for the first one."""
        # a letter means several things: the candidate that the printed formula equals decides, else the likeliest
        chosen: tuple[Finding, ...] = ()
        rights = tuple(self._meant(name))
        for right in rights:
            if (fitting := right.fitting(table)) is not None:
                found = tuple(self._entries(right, fitting, offset))
                if all(finding.unknown or finding.verdict.equal for finding in found):
                    chosen = found
                    break
                chosen = chosen or found
        is_right = bool(chosen) and all(finding.verdict.equal for finding in chosen)
        if isinstance(name.value, Call) and table.shape == (1, 1) and not is_right:  # c_{12}, which is a cosine too
            (entry,) = table.rows[0]
            side = _Side(LatexPiece(entry.text, entry.offset), value=entry.formula)
            identity = tuple(self._identities([name, side]))
            is_token = name.left is not None and name.left.head in ("c", "s")
            chosen = identity if not chosen or is_token or identity[0].verdict.equal else chosen
        if not chosen and not rights:
            where, allowed = self.plain.location(name.piece.start), "inverses of transforms and of at most 3 rows"
            raise CheckError(f"{quoted(self._typed(name.piece))} is not derived", allowed=allowed, location=where)
        if not chosen:
            shapes = " or ".join(dict.fromkeys(f"{r.value.shape[0]}x{r.value.shape[1]}" for r in rights))
            quantity = rights[0].quantity if rights else self.asked
            printed = f"{quantity} printed as {table.shape[0]}x{table.shape[1]}"
            raise CheckError(printed, allowed=f"allowed: {shapes}", location=self.plain.location(offset))
        yield from chosen

    def _meant(self, name: _Side) -> Iterator[Right]:
        """What a left side may mean, of that only what is asked about, if something is."""
        meant = (right for target in name.targets if (right := self.meanings.right(target)) is not None)
        if not self.asked:
            yield from meant
            return
        asked = tuple(self.meanings.asked(self.asked))
        if not name.targets:
            yield from asked
            return
        all_meant = tuple(meant)
        agreeing = [
            right if same.value.shape != right.value.shape else same
            for right in all_meant
            if (same := next((other for other in asked if right.agrees(other)), None))
        ]
        if not agreeing and all_meant and name.left is not None and name.left.head not in _ANY:
            text, means = self._typed(name.piece), all_meant[0]
            raise CheckError(
                f"left side {quoted(text)} means {means.shown}, but the quantity asked about is {self.asked}",
                remedy="leave one of them out",
                location=self.plain.location(name.piece.start),
            )
        yield from agreeing or asked

    def _entries(self, right: Right, table: Table, offset: int) -> Iterator[Finding]:
        for i, row in enumerate(table.rows):
            for j, entry in enumerate(row):
                place = right.rows[i], right.columns[j]
                text = entry.text or notation_text(entry.formula, self.robot)
                if entry.unknown is not None:
                    yield undecidable(right.quantity, place, Role.PRINTED, text, entry.unknown, False)
                    continue
                where = self.plain.location(entry.offset or offset)
                derived = right.value[i, j]
                others = other_orders(self.model, right.quantity)
                question = Question(self.robot, entry.formula, expression_from_sympy(derived), others=others)
                yield compared(question, right.quantity, place, Role.PRINTED, text, derived, where)
