"""Words and formulas of an inverse kinematics: where equations come from, names of branches, and displays."""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from typing import Any

import sympy

from derive.handouts.layout.lines import INDENTS, break_lines, equated
from derive.handouts.notation.derivation import LONGEST_PAIR, derivation_python, formula
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.pieces import EMPTY, Box, Break, TexPiece, bracketed, concatenate, joined, script
from derive.handouts.notation.solution_printer import SignLatexPrinter, with_names, with_signs
from derive.handouts.parts.table import BASE, tool_of
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Entry, Rows, SheetFormula
from derive.handouts.sheet.language import Text
from derive.inverse.words.derivation import Origin, OriginForm, PrintedEquation
from derive.inverse.words.elementary import PrintedLine
from derive.inverse.words.postures import Word
from derive.inverse.words.solutions import InverseKinematics
from derive.robot.description import IDENTITY

_INVERSE = Box("-1", 11.0)
_NUMBER = re.compile(r"#(\d+)")
_SIDE_OF_ZERO = re.compile(r"(\w+) ([<>]) 0")


def sources(context: Context, equations: Iterable[PrintedEquation]) -> str:
    """Which entries of which product some equations are."""
    groups: dict[tuple[OriginForm, str], list[Origin]] = {}
    for equation in equations:
        for origin in equation.origins:
            groups.setdefault((origin.form, _product(context, origin)), []).append(origin)
    phrases = [_phrase(context, form, matrix, found) for (form, matrix), found in groups.items()]
    if any(len(equation.origins) > 1 for equation in equations):
        phrases.append(context.text("the other unknown eliminated"))
    return "; ".join(dict.fromkeys(phrases))


def _phrase(context: Context, form: OriginForm, matrix: str, origins: Sequence[Origin]) -> str:
    _, first, last = context.text, origins[0].first, origins[0].last
    places = list(dict.fromkeys(entry for origin in origins for entry in origin.entries))
    entries = and_list(_, [f"$({','.join(map(str, place))})$" for place in places])
    given: dict[str, object] = {"entries": entries, "matrix": matrix, "first": first, "last": last}
    match form:
        case OriginForm.SQUARES:
            return _("entries %(entries)s of %(matrix)s, squared and added", **given)
        case OriginForm.ENTRY if len(places) > 1:
            return _("entries %(entries)s of %(matrix)s", **given)
        case OriginForm.ENTRY:
            return _("entry %(entries)s of %(matrix)s", **given)
        case OriginForm.COMPONENT:
            given["components"] = and_list(_, [f"${'xyz'[place[0] - 1]}$" for place in places])
            given["joint"] = last if origins[0].inverse else first
            if first == last:
                return _("component %(components)s of what joint %(joint)s adds to the position, in its frame", **given)
            return _(
                "component %(components)s of the vector between axes %(first)s and %(last)s, in the frame of joint "
                "%(joint)s",
                **given,
            )
        case OriginForm.DISTANCE:
            return _("the squared distance between axes %(first)s and %(last)s", **given)
        case OriginForm.ROD:
            if origins[0].last > origins[0].first:
                return _("the squared distances between the ends of the rods")
            return _("the squared distance between the ends of the rod")
        case OriginForm.DIRECTIONS:
            return _("entry %(entries)s of the rotation between axes %(first)s and %(last)s", **given)
        case OriginForm.MOMENT:
            return _("entry %(entries)s of the moments of %(matrix)s (Raghavan and Roth)", **given)


def _product(context: Context, origin: Origin) -> str:
    r"""``$(\mathbf{T}_3^0)^{-1}\mathbf{T} = \mathbf{T}_6^3$``: what the joints from first to last are, both ways."""
    robot, frame = context.robot, context.symbols.frame
    first, last, n = origin.first, origin.last, context.robot.n
    left = [_inverted(_between(context, 0, first - 1))] if first > 1 else []
    left += [_inverted(BASE)] if robot.base != IDENTITY and not origin.has_base else []
    right = [_inverted(tool_of(context.end))] if robot.tool != IDENTITY and not origin.has_tool else []
    right += [_inverted(_between(context, last, n))] if last < n else []
    own = _between(context, first - 1, last) if last >= first else Box("\\mathbf{I}", 8.0)
    if not left and not right and not origin.inverse:
        return f"${context.symbols.of_end('T').tex}$"
    whole = concatenate(*left, context.symbols.of_end("T"), *right)
    if first == 1 and last == n and not origin.inverse:
        own = frame("T", n, 0)
    base = [BASE] if origin.has_base and robot.base != IDENTITY else []
    tool = [tool_of(context.end)] if origin.has_tool and robot.tool != IDENTITY else []
    own = concatenate(*base, own, *tool)
    if origin.inverse:
        whole, own = (_inverted(whole) if left or right else script(whole, sup=_INVERSE)), _inverted(own)
    return f"${whole.tex} = {own.tex}$"


def _between(context: Context, start: int, end: int) -> Box:
    """The transform from one frame to a later one: that of a row where they are neighbours."""
    return context.symbols.frame("A" if end == start + 1 else "T", end, start)


def _inverted(box: Box) -> Box:
    return script(bracketed(box), EMPTY, _INVERSE)


def and_list(text: Text, words: Sequence[str], *, either: bool = False) -> str:
    """Words with commas, the last one behind an *and*, or an *or*."""
    if len(words) == 1:
        return words[0]
    others, last = ", ".join(words[:-1]), words[-1]
    if either:
        return text("%(others)s or %(last)s", others=others, last=last)
    return text("%(others)s and %(last)s", others=others, last=last)


def words_alone(name: str) -> str:
    """The name of a branch without its number, which tells it from others where words do not."""
    return ", ".join(part for part in name.split(", ") if not _NUMBER.fullmatch(part))


def branch_name(text: Text, notation: Notation, name: str, plain: Callable[[str], str] | None = None) -> str:
    """The name of a branch in the reader's language; ``plain`` writes its symbols in running text, None: as LaTeX."""
    _ = text
    words: dict[str, str] = {
        Word.SHOULDER_RIGHT: _("shoulder right"),
        Word.SHOULDER_LEFT: _("shoulder left"),
        Word.ELBOW_UP: _("elbow up"),
        Word.ELBOW_DOWN: _("elbow down"),
        Word.ELBOW_LEFT: _("elbow left"),
        Word.ELBOW_RIGHT: _("elbow right"),
        Word.WRIST: _("wrist not flipped"),
        Word.WRIST_FLIPPED: _("wrist flipped"),
    }
    parts = []
    for part in name.split(", "):
        if side := _SIDE_OF_ZERO.fullmatch(part):
            symbol = notation.glyph(side[1]).box.tex.strip()
            parts.append(f"${symbol} {side[2]} 0$" if plain is None else f"{plain(symbol)} {side[2]} 0")
        elif number := _NUMBER.fullmatch(part):
            parts.append(text("branch %(number)s", number=number[1]))
        else:
            parts.append(words.get(part, part))
    return ", ".join(parts)


# -- formulas as displays: broken into lines, to be copied, blank in an exercise

WIDEST_QUOTIENT = 170.0  # widest sum above a divisor [pt], which a narrow column holds
WIDEST_LEFT = 200.0  # widest left side of an equation whose right side is broken alone [pt]
_LETTER_WIDTH = 6.0  # of running text in mathematics [pt]


def formulas(context: Context) -> Iterator[SheetFormula]:
    """The formulas, a block for what the pose is named and one for each unknown."""
    found = context.entries.model.inverse
    writer = FormulaWriter(context, found)
    for lines in (found.definitions, *(step.lines for step in found.steps)):
        if lines:
            yield writer.formula(lines)


class FormulaWriter:
    """Writes the formulas of one arm, with the signs and names of its derivation."""

    def __init__(self, context: Context, found: InverseKinematics) -> None:
        self._context, self._found = context, found
        self.printer = SignLatexPrinter(with_names(context.notation, found), found, WIDEST_QUOTIENT)

    def tex(self, e: Any) -> str:
        """An expression on one line."""
        return self.printer.latex(e).strip()

    def math(self, e: Any) -> str:
        """An expression in running text."""
        return f"${self.tex(e)}$"

    def formula(self, lines: Sequence[PrintedLine], task: str = "", *, is_each_asked: bool = False) -> SheetFormula:
        """Lines of a solution as one formula."""
        rows = tuple(row for line in lines for row in self.rows(line))
        names = tuple(self.tex(line.symbol) for line in lines)
        blanks = (names if is_each_asked else names[-1:]) if task else ()
        return SheetFormula((Rows(rows),), entries=lambda: map(self.entry, lines), task=task, blanks=blanks)

    def entry(self, line: PrintedLine) -> Entry:
        """A formula to be copied."""
        either = f" \\text{{ {self._context.text('or')} }} "
        left, _, right = formula(line, self.tex, " = ", either, " + \\pi").partition(" = ")
        return Entry(left, right, self._assignments[line])

    @cached_property
    def _assignments(self) -> dict[PrintedLine, str]:
        return dict(zip(self._found.lines, derivation_python(self._found), strict=True))

    def rows(self, line: PrintedLine) -> list[str]:
        """A formula on as many lines as it needs; of two values written apart one below the other."""
        first, *others = line.alternatives
        rows = self.broken(self.printer.pieces(line.symbol), first)
        if others:
            word = self._context.text("or")
            either = Box(f"\\ \\text{{{word}}}\\ ", 8.0 + _LETTER_WIDTH * len(word))
            is_short = sum(value.count_ops() for value in line.alternatives) < LONGEST_PAIR
            second = others[0] if is_short else line.symbol + sympy.pi
            rows += break_lines(concatenate(INDENTS[0], either), self.printer.pieces(second))
        return [with_signs(row) for row in rows]

    def broken(self, left: Sequence[TexPiece], right: Any) -> list[str]:
        """An equation on as many lines as it needs, its left side broken, too, where it is long."""
        head, pieces = equated(joined(left)), self.printer.pieces(right)
        if head.width < WIDEST_LEFT:
            rows = break_lines(head, pieces)
        else:
            rows = break_lines(EMPTY, [*left, TexPiece(Box("= ", 12.0), Break.BINARY), *pieces])
        return [with_signs(row) for row in rows]
