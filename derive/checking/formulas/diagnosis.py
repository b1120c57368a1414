"""The smallest change that repairs a wrong formula.

Every single change at every place of the printed tree is tried at one point, which costs a few float operations each;
what hits the right value there is decided exactly. Where no single change helps, two of one kind are tried.
"""

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import chain, islice

from derive.checking.formulas import edits as slips
from derive.checking.formulas.edits import NO_VALUE, Edit, SlipKind, Spot, float_value, is_token, nodes
from derive.errors import DeriveError
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.dynamic_model import DynamicModel
from derive.model.equality import compare, same_form, samples
from derive.model.quantity_names import parse
from derive.robot.expression import Call, Expression, Name, Product, Sum, multiply, names, negate, substitute
from derive.robot.names import acceleration_name, robot_symbols, velocity_name
from derive.robot.robot import Robot

MAX_WORK = 4_000_000  # float operations, about, spent on one formula; beyond them no change is named
WORK_OF_EDIT = 8  # float operations of one change beside those on the way to the root, about
MAX_LACKING_TERMS = 400  # terms of the right formula that a printed one may lack
MAX_PROOFS = 20  # candidates of one kind that are decided exactly: what is right to nine digits rarely fails
CLOSE = 1e-9  # relative difference of two values that count as the same
POINTS = 40  # points that are tried until both formulas have a value
MAX_SINGLE_ANGLES = 12  # joints whose sine and cosine a term may lack; of longer arms only those that occur are tried
PAIRED = (SlipKind.SIGN, SlipKind.FUNCTION, SlipKind.EXPONENT, SlipKind.INDEX)  # kinds of which two changes are tried
RENAMED = frozenset([SlipKind.INDEX, SlipKind.SYMBOL])  # one name for another


@dataclass(frozen=True, eq=False)
class Question:
    """A wrong formula and what it should be."""

    robot: Robot  # whose formula it is
    printed: Expression  # the printed tree, in which definitions may still stand as names
    right: Expression  # what it should be
    definitions: Mapping[str, Expression] = field(default_factory=dict)  # what further names stand for
    compared: Callable[[Expression], Expression] | None = None  # what of it must be equal; None for the tree itself
    extra_terms: tuple[Expression, ...] = ()  # further terms that may be missing
    others: Mapping[str, Expression] = field(default_factory=dict)  # other quantities that it may be right for

    def is_answer(self, formula: Expression) -> bool:
        """Whether a formula is right, decided exactly."""
        whole = substitute(self.compared(formula) if self.compared else formula, self.definitions)
        with suppress(DeriveError):
            return same_form(self.right, whole) or compare(self.robot, self.right, whole).equal
        return False


@dataclass(frozen=True, slots=True)
class Repair:
    """What makes a wrong formula right."""

    kinds: tuple[SlipKind, ...]  # the kind of each change
    text: str  # the changes in words
    formula: Expression  # the printed formula with the changes made


def other_orders(model: DynamicModel, quantity: str) -> Mapping[str, Expression]:
    """Christoffel symbols with the indices of one in another order, as Spong writes c_ijk for our c_kij."""
    if not quantity.startswith("christoffel["):
        return {}
    i, j, k = parse(model, quantity)[1]
    names = {f"christoffel[{a},{b},{c}]": model.christoffel(a, b, c) for a, b, c in ((j, i, k), (k, i, j)) if a != i}
    return {name: expression_from_sympy(value) for name, value in names.items() if value != 0}


def diagnose(question: Question) -> Repair | None:
    """The least change that repairs a formula, one or two of one kind, or what else it is right for; None if none."""
    repair = _smallest_change(question)
    # beside any repair: the formula as it stands may be right for the same symbol with its indices in another order
    others, printed = question.others.items(), question.printed
    meant = next((name for name, value in others if replace(question, right=value).is_answer(printed)), None)
    if meant is not None:
        text = f"other order of the indices: it is {meant}"
        repair = replace(repair, text=f"{repair.text}; or {text}") if repair else Repair((), text, question.right)
    return repair


def _smallest_change(question: Question) -> Repair | None:
    """The first change of those of `_Search` at a point where both formulas have a value."""
    robot = question.robot
    variables = [joint.variable for joint in robot.movers]
    rates = [rename(v) for rename in (velocity_name, acceleration_name) for v in variables]
    # a rate may stand for another one only in formulas that have rates at all
    moving = set(rates).intersection((*names(question.printed), *names(question.right)))
    defined = [n for meaning in (*question.definitions.values(), question.right) for n in names(meaning)]
    known = [*robot_symbols(robot), *variables, *(rates if moving else ()), *question.definitions, *defined]
    wanted = dict.fromkeys([*known, *names(question.printed), *names(question.right)])
    for values in islice(_points(robot, [*wanted]), POINTS):
        try:
            for name, meaning in question.definitions.items():
                values[name] = float_value(meaning, values)
            search = _Search(question, values, [*dict.fromkeys(known)])
        except NO_VALUE:  # a definition or one of the formulas has no value at this point
            continue
        if found := search.changes():
            return Repair(tuple(edit.kind for edit in found), slips.changes_text(found, robot), found[-1].formula)
        break
    return None


def _points(robot: Robot, wanted: list[str]) -> Iterator[dict[str, float]]:
    """Points at which changes are tried; of closed loops configurations, where other formulas are right as well."""
    if robot.passive:
        yield from ({name: float(value) for name, value in point.items()} for point in samples(robot, wanted))
    rng = random.Random(7)  # numbers of either sign, all of the size of 1: no term vanishes beside another
    while True:
        yield {name: rng.choice((-1, 1)) * rng.uniform(0.3, 1.7) for name in wanted}


class _Search:
    """The search at one point; ArithmeticError, ValueError or KeyError where a formula has no value there."""

    def __init__(self, question: Question, values: Mapping[str, float], known_names: Sequence[str]) -> None:
        self.question, self.values, self.work = question, values, 0
        self.outer = question.compared(Name("(printed)")) if question.compared else None
        self.target = float_value(question.right, values)
        self._compared_value(float_value(question.printed, values))  # it must have a value there, too
        angles = tuple(joint.variable for joint in question.robot.movers if joint.is_revolute)
        # a factor that is missing: any name, and the sines and cosines of both formulas and of single joints; a term
        # that is missing: one of the right formula, with either sign
        tokens = [node for node in (*nodes(question.printed), *nodes(question.right)) if is_token(node)]
        singles = [Call(f, (Name(angle),)) for angle in angles[:MAX_SINGLE_ANGLES] for f in ("cos", "sin")]
        whole = () if isinstance(question.right, Sum) else (question.right,)
        terms = [*question.extra_terms, *islice(chain(whole, _terms_inside(question.right)), MAX_LACKING_TERMS)]
        factors = dict.fromkeys([*tokens, *singles, *map(Name, known_names)])
        terms = [*dict.fromkeys([*terms, *map(negate, terms)])]
        self.may = slips.Replacements(tuple(known_names), angles, tuple(factors), tuple(terms))
        self.known: dict[Expression, float] = {}  # values of nodes of which changed formulas are made
        for e in (*reversed([*nodes(question.printed)]), *self.may.factors, *self.may.terms):
            with suppress(*NO_VALUE):
                self.known[e] = float_value(e, values, self.known)

    def _compared_value(self, value: float) -> float:
        """What is compared, for a value of the printed formula."""
        return float_value(self.outer, {**self.values, "(printed)": value}) if self.outer else value

    def changes(self) -> tuple[Edit, ...] | None:
        """One change, of the first kind that has one; else two changes of one kind."""
        places = self._places(self.question.printed)
        for kind in SlipKind:
            if found := self._least_right([(edit,) for edit in self._hits(places, kind)]):
                return found
        for kind in PAIRED:
            firsts = [edit for place in places for edit in slips.edits(place, self.may, kind)]
            if len(firsts) ** 2 * (WORK_OF_EDIT + len(places)) > MAX_WORK:  # about as many second changes as first ones
                continue
            pairs = [(one, two) for one in firsts for two in self._hits(self._places(one.formula), kind)]
            if found := self._least_right(pairs):
                return found
        return None

    def _least_right(self, candidates: Sequence[tuple[Edit, ...]]) -> tuple[Edit, ...] | None:
        """The candidate that touches least, of those that are right."""
        # the fewest nodes replaced, then the nearest to the root; proofs are exact and slow, so that they come last
        sizes = [sum(1 for edit in made for _ in nodes(edit.old)) for made in candidates]
        ranked = sorted(zip(sizes, candidates, strict=True), key=lambda pair: (pair[0], pair[1][0].place.depth))
        return next((made for _, made in ranked[:MAX_PROOFS] if self.question.is_answer(made[-1].formula)), None)

    def _places(self, formula: Expression) -> list[Spot]:
        with suppress(*NO_VALUE):
            return list(slips.spots(formula, self.values, self.known))
        return []

    def _hits(self, places: Sequence[Spot], kind: SlipKind) -> Iterator[Edit]:
        """The changes that give the right value at the point."""
        for place in places:
            for edit in slips.edits(place, self.may, kind):
                self.work += place.cost + WORK_OF_EDIT
                if self.work > MAX_WORK:
                    return
                with suppress(*NO_VALUE, TypeError):
                    value = self._compared_value(place.value(float_value(edit.node, self.values, self.known)))
                    if abs(value - self.target) <= CLOSE * (1 + abs(self.target)):
                        yield edit


def _terms_inside(e: Expression) -> Iterator[Expression]:
    """Terms of all sums of a formula, each as it stands and multiplied with what stands before its brackets."""
    match e:
        case Sum(terms):
            for term in terms:
                yield term
                yield from _terms_inside(term)
        case Product(factors):
            for i, factor in enumerate(factors):
                for term in _terms_inside(factor):
                    yield term
                    yield multiply(*factors[:i], *factors[i + 1 :], term)
