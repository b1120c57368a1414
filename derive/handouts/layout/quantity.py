"""Lays out one quantity: as a matrix if it fits, else entry by entry, the rest by its number of terms.

How much of a closed form is printed says `SheetPolicy`; what is beyond is listed with its number of terms, never
dropped. Where entries are printed one by one, brackets that they share get a symbol of their own, a named intermediate
term.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import accumulate
from typing import Any

import sympy

from derive.handouts.layout.lines import LANDSCAPE_WIDTH, Equation, equated, equation_lines, fits, matrix, pack
from derive.handouts.notation.notation import Glyph
from derive.handouts.notation.pieces import EMPTY, Box, concatenate, joined, magnitude
from derive.handouts.notation.printer import LatexPrinter
from derive.model.entries import Entries


@dataclass(frozen=True, slots=True)
class SheetPolicy:
    """Budgets of the sheet. Terms are those of the multiplied-out polynomial, lines those on paper."""

    flat_terms: int = 200  # longest entry of kinematics that is written at all: a line holds eight terms or so
    grouped_terms: int = 500  # longest entry of dynamics; grouped by inertial parameters a line holds some thirty
    quantity_entries: int = 10  # so many of the longest entries make the longest quantity that is written
    entry_lines: int = 16  # longest entry that is printed: a third of a page is as much as anybody reads
    quantity_lines: int = 190  # longest quantity that is printed, shortest entries first: four pages
    landscape_lines: int = 18  # longest entry that is printed on a page turned on its side
    landscape_total: int = 60  # longest such part of a quantity: two pages
    matrix_terms: int = 300  # longest quantity that can be a matrix: no page is wide enough for more
    compact_terms: int = 60  # longest quantity that is printed multiplied out where a form in named terms exists
    factor_terms: int = 8  # longest entry of a partial product of transforms, where T itself is too long
    closed_form_joints: int = 7  # with each joint the dynamics grow fivefold: of eight hardly an entry would be printed
    named_products: int = 60  # most velocity products per equation of motion written out in named terms


POLICY = SheetPolicy()


SHORTEST = 3  # terms of a bracket that gets a name when it occurs twice
OFTEN = 4  # uses after which a bracket of two products gets one too
MANY = 10**9  # numbers of terms from which on two digits say enough
Namer = Callable[[int, int], Box]  # (row, column), from 1 -> name of an entry
Definition = tuple[Any, Any]  # a symbol and the expression that it stands for


@dataclass(frozen=True, slots=True)
class LaidOut:
    """A quantity on the sheet, as lines of LaTeX."""

    lines: tuple[str, ...]  # the matrix, or the entries one by one
    named: tuple[str, ...] = ()  # definitions of intermediate terms that the entries use
    omitted: tuple[str, ...] = ()  # entries left to the code, with their numbers of terms
    has_zeros: bool = False  # whether entries were left out because they are zero
    symmetric: bool = False  # whether entries below the diagonal were left out
    landscape: tuple[str, ...] = ()  # entries that are too long for an upright page, for one turned on its side
    values: tuple[tuple[Box, Any], ...] = ()  # names and expressions of the printed entries
    blanks: tuple[str, ...] = ()  # left sides alone, for an exercise; none where something is too long to print
    box: Box = EMPTY  # of a small matrix, which may share its line: ``symbol = [...]``


@dataclass(frozen=True, slots=True)
class Item:
    """One entry on its way to the page."""

    name: Box  # its symbol
    terms: int  # number of terms when multiplied out
    write: Callable[[], Any]  # makes the expression; called only for entries within the budget


@dataclass(frozen=True)
class Layouter:
    """Lays out the quantities of one robot."""

    printer: LatexPrinter  # the robot's printer
    policy: SheetPolicy  # what is printed
    term_symbol: Callable[[int, int], Box]  # (group, index) -> name of an intermediate term
    terms_word: str = "terms"  # what terms are called in the language of the page

    def lay_out(
        self, symbol: Box, name: Namer, quantity: Entries, *, group: int = 0, symmetric: bool = False, limit: int = 0
    ) -> LaidOut:
        """One matrix: in brackets if it fits, else entry by entry."""
        if whole := self.small(symbol, name, quantity, symmetric=symmetric):
            return whole
        places = (at for at in quantity.places if at[0] <= at[1] or not symmetric)
        items = [Item(name(*at), quantity.terms(*at), partial(quantity.entry, *at)) for at in places]
        laid_out = self.entries(items, group=group, symmetric=symmetric, limit=limit)
        return replace(laid_out, blanks=(symbol.tex,) if laid_out.blanks else ())

    def small(self, symbol: Box, name: Namer, quantity: Entries, *, symmetric: bool = False) -> LaidOut | None:
        """A matrix in brackets, which may share a line; None if it is too wide or has too many terms."""
        # Only where no page is too narrow for certain: expressions are written and measured for it.
        places = [at for at in quantity.places if at[0] <= at[1] or not symmetric]
        if any(so_far > self.policy.matrix_terms for so_far in accumulate(quantity.terms(*at) for at in places)):
            return None
        entries = {at: quantity.entry(*at) for at in places}
        boxes = {at: joined(self.printer.pieces(entry)) for at, entry in entries.items()}
        rows, columns = (range(1, size + 1) for size in quantity.shape)
        cells = [[boxes[(i, j) if (i, j) in boxes else (j, i)] for j in columns] for i in rows]
        if not fits(box := equated(symbol, matrix(cells)), len(rows)):
            return None
        values = tuple((name(*at), entry) for at, entry in entries.items() if quantity.terms(*at))
        return LaidOut((box.tex,), values=values, blanks=(symbol.tex,), box=box)

    def entries(self, items: Sequence[Item], *, group: int = 0, symmetric: bool = False, limit: int = 0) -> LaidOut:
        """Entries one by one, brackets that they share as named terms."""
        limit = limit or self.policy.flat_terms
        # Terms are counted before anything is multiplied out: what is beyond the budget is never written.
        chosen = _within([item.terms for item in items], limit, limit * self.policy.quantity_entries)
        written = {index: items[index].write() for index in chosen}
        definitions, expressions = _with_shared_brackets_named(list(written.values()))
        named, equations = self._equations(definitions, [items[index].name for index in chosen], expressions, group)
        upright, turned = self._placed(equations)
        if len(upright) < len(chosen):  # what is left needs fewer named terms, and they are numbered anew
            kept = sorted(upright + turned)
            chosen, expressions = [chosen[k] for k in kept], [expressions[k] for k in kept]
            used = _used(definitions, expressions)
            named, equations = self._equations(used, [items[index].name for index in chosen], expressions, group)
            upright, turned = [kept.index(k) for k in upright], [kept.index(k) for k in turned]
        left = [item for index, item in enumerate(items) if item.terms and index not in set(chosen)]
        return LaidOut(
            tuple(equation_lines(equations[k] for k in upright)),
            tuple(equation_lines(named)),
            tuple(pack(omitted(item, self.terms_word, comma=self.printer.notation.comma) for item in left)),
            has_zeros=not all(item.terms for item in items),
            symmetric=symmetric,
            landscape=tuple(equation_lines((equations[k] for k in turned), LANDSCAPE_WIDTH)),
            values=tuple((items[index].name, written[index]) for index in chosen),
            blanks=() if left else tuple(items[index].name.tex for index in chosen),
        )

    def _placed(self, equations: Sequence[Equation]) -> tuple[list[int], list[int]]:
        """Indices of the entries that are printed upright, and of longer ones on a page turned on its side."""
        policy = self.policy
        sizes = [len(equation_lines([equation])) for equation in equations]
        if len(upright := _within(sizes, policy.entry_lines, policy.quantity_lines)) == len(equations):
            return upright, []
        rest = set(range(len(equations))) - set(upright)
        wide = [len(equation_lines([e], LANDSCAPE_WIDTH)) if k in rest else 0 for k, e in enumerate(equations)]
        return upright, _within(wide, policy.landscape_lines, policy.landscape_total)

    def _equations(
        self, definitions: Sequence[Definition], names: Sequence[Box], expressions: Sequence[Any], group: int
    ) -> tuple[list[Equation], list[Equation]]:
        """The named terms, numbered in their order, and the entries in them."""
        symbols = {symbol.name: self.term_symbol(group, k) for k, (symbol, _) in enumerate(definitions, 1)}
        printer = LatexPrinter(self.printer.notation.with_terms({key: Glyph(box) for key, box in symbols.items()}))
        named = [Equation(symbols[symbol.name], tuple(printer.pieces(value))) for symbol, value in definitions]
        return named, [Equation(name, tuple(printer.pieces(e))) for name, e in zip(names, expressions, strict=True)]


def omitted(item: Item, word: str, *, comma: bool = False) -> Box:
    """An entry that is left to the code: its name and its number of terms."""
    count = magnitude(Fraction(item.terms), decimals=True, digits=9 if item.terms < MANY else 2, comma=comma)
    return concatenate(item.name, Box(" \\colon\\ ", 12.0), count, Box(f"\\text{{ {word}}}", 6.0 + 5.0 * len(word)))


def _within(sizes: Sequence[int], longest: int, total: int) -> list[int]:
    """Indices of what is not empty and within the budget, the shortest first until it is used up, in their order."""
    wanted = sorted((size, index) for index, size in enumerate(sizes) if 0 < size <= longest)
    used = accumulate(size for size, _ in wanted)
    return sorted(index for (_, index), so_far in zip(wanted, used, strict=True) if so_far <= total)


def _with_shared_brackets_named(expressions: Sequence[Any]) -> tuple[list[Definition], list[Any]]:
    """Definitions of brackets that several places share, each using earlier symbols only, and the entries in them."""
    uses: Counter[Any] = Counter()
    for expression in expressions:
        _count_brackets(expression, uses, root=True)
    shared = []
    for bracket, count in uses.items():
        # A name pays for a sum of three terms from its second use on, for a sum of two products from its fourth.
        is_long = len(bracket.args) >= SHORTEST
        holds_product = any(len(term.args) >= SHORTEST for term in bracket.args)
        if (is_long and count > 1) or (not is_long and holds_product and count >= OFTEN):
            shared.append(bracket)
    shared.sort(key=_depth)  # inner brackets first: the definition of an outer one uses their names
    names: dict[Any, Any] = {}
    definitions = []
    for index, bracket in enumerate(shared, 1):
        symbol = sympy.Symbol(f"_{index}")  # which no name of a user can be
        definitions.append((symbol, _in_names(bracket, names)))
        names[bracket] = symbol
    return definitions, [_in_names(expression, names) for expression in expressions]


def _used(definitions: Sequence[Definition], expressions: Sequence[Any]) -> list[Definition]:
    """The definitions that some expressions use, directly or through each other."""
    wanted = {symbol for expression in expressions for symbol in expression.free_symbols}
    kept = []
    for symbol, value in reversed(definitions):  # each uses earlier symbols alone, so one pass backwards finds all
        if symbol in wanted:
            kept.append((symbol, value))
            wanted |= value.free_symbols
    return kept[::-1]


def _count_brackets(expression: Any, uses: Counter[Any], root: bool) -> None:
    """Counts brackets; the inside of one that was met before is not counted again."""
    if expression.is_Add and not root:
        uses[expression] += 1
        if uses[expression] > 1:
            return
    for argument in expression.args:
        if argument.args:
            _count_brackets(argument, uses, root=False)


def _depth(expression: Any) -> int:
    """Levels of sums; a bracket is deeper than the brackets in it."""
    return max((_depth(argument) for argument in expression.args), default=0) + bool(expression.is_Add)


def _in_names(expression: Any, names: dict[Any, Any], *, root: bool = True) -> Any:
    """The expression with symbols for the brackets inside it; a sum at the root stays."""
    if not names or not expression.args:
        return expression
    stays = root and expression.is_Add
    if expression in names and not stays:
        return names[expression]
    arguments = tuple(_in_names(argument, names, root=False) for argument in expression.args)
    if not stays and all(new is old for new, old in zip(arguments, expression.args, strict=True)):
        return expression
    if expression.is_Add or expression.is_Mul:  # unevaluated: SymPy would distribute numbers over the names' sums
        return expression.func(*arguments, evaluate=False)
    return expression.func(*arguments)
