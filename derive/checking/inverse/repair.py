"""The smallest change that makes a line of a printed solution right.

The changes are those of `edits` in the line and the quantities that it needs, and a plus-minus that is missing, or an
atan2 for an arc function. One is tried where the line fails, and kept if it is right at all other configurations too.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations, product

from derive.checking.formulas.branches import SIGN, other_leg
from derive.checking.formulas.diagnosis import PAIRED
from derive.checking.formulas.edits import Edit, Replacements, SlipKind, Spot, edits, spots
from derive.checking.inverse.printed import Place, PrintedFormula, PrintedInverse, PrintedLine
from derive.errors import CheckError
from derive.robot import expression as tree
from derive.robot.expression import Call, Expression, Name, Number, Power, Product, Sum

MAX_TRIED = 6_000  # changes that are tried for one line
MAX_PAIRS = 6_000  # pairs of changes of one kind that are tried
LONGEST_SUM = 8  # terms of a sum of which neighbouring ones are squared
MISSING = Name(f"{SIGN}new")  # a plus-minus that is put in
Site = tuple[PrintedLine, PrintedFormula]  # a line, and which of its formulas


@dataclass(frozen=True)
class InverseRepair:
    """What makes a line right."""

    line: PrintedLine  # the line that is changed: the one that is wrong, or a quantity that it needs
    formula: PrintedFormula  # which of its formulas
    edits: tuple[Edit, ...]  # the changes, of which the last one has the formula as it is then


class Repairer:
    """The search for what repairs some lines."""

    def __init__(
        self, printed: PrintedInverse, lines: Sequence[PrintedLine], places: Sequence[Place], known: Sequence[str]
    ) -> None:
        self._printed, self._lines, self._places = printed, lines, places
        self._tried = 0
        # what may lack: sine or cosine of one joint, a length as factor or divisor; a length, its square or an angle
        angles = tuple(joint.variable for joint in printed.robot.joints if joint.is_revolute)
        tokens = [Call(f, (Name(angle),)) for angle in angles for f in ("cos", "sin")]
        lengths = [Name(name) for name in known if name not in angles]
        squares = [tree.power(length, 2) for length in lengths]
        factors = (*tokens, *lengths, *(tree.power(length, -1) for length in lengths))
        terms = tuple(term for x in (*lengths, *squares, *map(Name, angles)) for term in (x, tree.negate(x)))
        self._may = Replacements(tuple(known), angles, factors, terms)

    def first(self, kinds: Sequence[SlipKind], sites: Sequence[Site]) -> InverseRepair | None:
        """The first change, of the first kind that has one; then two changes of one kind."""
        for kind, site in product(kinds, sites):
            if repair := self._least(site, [(edit,) for edit in self._edits(site[1].expression, kind)]):
                return repair
        for kind, site in product((kind for kind in kinds if kind in PAIRED), sites):
            firsts = list(self._edits(site[1].expression, kind))
            if len(firsts) ** 2 <= MAX_PAIRS:
                pairs = [(one, two) for one in firsts for two in self._edits(one.formula, kind)]
                if repair := self._least(site, pairs):
                    return repair
        return None

    def _edits(self, e: Expression, kind: SlipKind) -> Iterator[Edit]:
        for spot in spots(e):
            yield from edits(spot, self._may, kind)
            if kind is SlipKind.PLUS_MINUS and not isinstance(spot.parent, Product | Power):
                yield from _plus_minus(spot)
            if kind is SlipKind.ATAN2:
                yield from _atan2(spot)
            if kind is SlipKind.SYMBOL and isinstance(spot.node, Number):
                # a name read as a digit, 1 for l; the sign before it stays
                sign = tree.number(-1 if spot.node.value < 0 else 1)
                meant = (tree.multiply(sign, Name(name)) for name in self._may.names if name not in self._may.angles)
                yield from (Edit(kind, spot, name, spot.node, name) for name in meant)
            if kind is SlipKind.EXPONENT and isinstance(spot.node, Sum):
                # neighbouring terms squared: what (a1 + a2)**2 - x**2 was without its first exponent
                terms = spot.node.terms
                for i, j in combinations(range(min(len(terms), LONGEST_SUM) + 1), 2):
                    if 1 < j - i < len(terms):
                        part = tree.add(*terms[i:j])
                        square = tree.power(part, 2)
                        yield Edit(kind, spot, tree.add(*terms[:i], square, *terms[j:]), part, square)

    def _least(self, site: Site, candidates: Sequence[tuple[Edit, ...]]) -> InverseRepair | None:
        """The candidate that touches least, of those that are right."""
        found: list[tuple[int, int, int, InverseRepair]] = []
        for made in candidates:
            self._tried += 1
            if self._tried > MAX_TRIED:  # of all kinds together
                break
            changed = self._printed.changed(*site, made[-1].formula)
            lines = [changed.lines[self._printed.lines.index(x)] for x in self._lines]
            with suppress(CheckError):
                if not all(changed.hit_together(lines, place) for place in self._places):
                    continue
                size = sum(1 for edit in made for _ in spots(edit.old))
                found.append((size, made[0].place.depth, len(found), InverseRepair(*site, made)))
        return min(found)[-1] if found else None


def _plus_minus(spot: Spot) -> Iterator[Edit]:
    """A plus-minus before a term, an argument, or a half turn more for the second solution."""
    node = spot.node
    if not isinstance(node, Number) and not any(name[0] == SIGN for name in tree.names(node)):
        yield Edit(SlipKind.PLUS_MINUS, spot, tree.multiply(MISSING, node), node, tree.multiply(MISSING, node))
    factors = node.factors if isinstance(node, Product) else ()
    for i, factor in enumerate(factors):
        if isinstance(factor, Call) and factor.function == "sqrt":
            new = tree.multiply(*factors[:i], tree.multiply(MISSING, factor), *factors[i + 1 :])
            yield Edit(SlipKind.PLUS_MINUS, spot, new, factor, tree.multiply(MISSING, factor))


def _atan2(spot: Spot) -> Iterator[Edit]:
    """An atan2 in the place of an arc function."""
    if not isinstance(spot.node, Call) or spot.node.function not in ("acos", "asin", "atan"):
        return
    (u,) = spot.node.arguments
    # sin^2 + cos^2 = 1: the other argument is +-sqrt(1 - u^2); of a tangent only the quotient is known
    other = other_leg(u)
    ways = [(tree.multiply(MISSING, other), u), (other, u)]
    match spot.node.function:
        case "atan":
            above, below = _quotient(u)
            ways = [(above, below), (tree.negate(above), tree.negate(below))]
            ways += [(tree.multiply(MISSING, above), below), (above, tree.multiply(MISSING, below))]
        case "asin":
            ways = [(y, x) for x, y in ways]
    for y, x in ways:
        new = Call("atan2", (y, x))
        yield Edit(SlipKind.ATAN2, spot, new, spot.node, new)


def _quotient(e: Expression) -> tuple[Expression, Expression]:
    factors = e.factors if isinstance(e, Product) else (e,)
    below = [tree.power(f.base, -f.exponent) for f in factors if isinstance(f, Power) and f.exponent < 0]
    above = [f for f in factors if not (isinstance(f, Power) and f.exponent < 0)]
    fraction = next((f.value for f in above if isinstance(f, Number)), None)
    if fraction is not None and fraction.denominator != 1:
        above = [tree.number(f.value.numerator) if isinstance(f, Number) else f for f in above]
        below.append(tree.number(fraction.denominator))
    return tree.multiply(*above), tree.multiply(*below)
