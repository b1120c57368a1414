"""The smallest change that repairs a wrong formula.

Every single change at every place of the printed tree is tried at one point, which costs a few float operations each;
what hits the right value there is decided exactly. Where no single change helps, two of one kind are tried.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice

from derive.check.edits import Edit, Kind, Vocabulary, changes_text, edits
from derive.check.spots import Evaluator, Spot, is_token, spots
from derive.errors import DeriveError
from derive.model.equality import compare
from derive.robot.expression import Call, Expression, Name, Product, Sum, children, multiply, names, negate, substitute
from derive.robot.names import acceleration_name, robot_symbols, velocity_name
from derive.robot.robot import Robot

MAX_WORK = 4_000_000
"""Float operations, about, spent on one formula; beyond them no change is named."""

MAX_TERMS = 400
"""Terms of the right formula that a printed one may lack."""

MAX_PROOFS = 20
"""Candidates of one kind that are decided exactly: what is right at one point to nine digits rarely fails."""

WORK_OF_EDIT = 8
CLOSE = 1e-9
POINTS = 40
PAIRED = (Kind.SIGN, Kind.FUNCTION, Kind.EXPONENT, Kind.INDEX)
"""Kinds of which two changes are tried."""

_BAD = (ArithmeticError, ValueError, KeyError)


def _itself(e: Expression) -> Expression:
    return e


@dataclass(frozen=True, eq=False)
class Question:
    """A wrong formula and what it should be.

    Attributes:
        robot: Whose formula it is.
        printed: The printed tree, in which definitions may still stand as names.
        right: What it should be.
        definitions: What further names stand for.
        compared: What of a printed tree must equal the right one; the tree itself by default.
        extra_terms: Further terms that may be missing.
    """

    robot: Robot
    printed: Expression
    right: Expression
    definitions: Mapping[str, Expression] = field(default_factory=dict)
    compared: Callable[[Expression], Expression] = _itself
    extra_terms: tuple[Expression, ...] = ()

    @property
    def is_plain(self) -> bool:
        """Whether the printed tree itself is what must be equal."""
        return self.compared is _itself

    def is_answer(self, formula: Expression) -> bool:
        """Whether a formula is right, decided exactly."""
        whole = substitute(self.compared(formula), dict(self.definitions))
        try:
            return compare(self.robot, self.right, whole).equal
        except DeriveError:
            return False


@dataclass(frozen=True, slots=True)
class Repair:
    """What makes a wrong formula right.

    Attributes:
        kinds: The kind of each change.
        text: The changes in words.
        formula: The printed formula with the changes made.
    """

    kinds: tuple[Kind, ...]
    text: str
    formula: Expression


def diagnose(question: Question) -> Repair | None:
    """The smallest change that repairs a formula, or None if no single change and no two of one kind do."""
    search = _Search.of(question)
    if search is None:
        return None
    found = search.single() or search.double()
    if found is None:
        return None
    return Repair(tuple(edit.kind for edit in found), changes_text(found, question.robot), _changed(found[-1]))


class _Search:
    def __init__(self, question: Question, evaluate: Evaluator, target: float, whole: Callable[[float], float]) -> None:
        self.question = question
        self.evaluate = evaluate
        self.target = target
        self.whole = whole
        self.words = _vocabulary(question)
        self.work = 0

    @classmethod
    def of(cls, question: Question) -> _Search | None:
        """A search at the first point where both formulas have values; None without one."""
        for evaluate in _evaluators(question):
            try:
                target = evaluate(question.right)
                whole = _compared_value(question, evaluate)
                whole(evaluate(question.printed))
            except _BAD:
                continue
            return cls(question, evaluate, target, whole)
        return None

    def single(self) -> tuple[Edit, ...] | None:
        """One change, of the first kind that has one."""
        places = self.places(self.question.printed)
        for kind in Kind:
            if found := self.right([(edit,) for edit in self.hits(places, kind)]):
                return found
        return None

    def double(self) -> tuple[Edit, ...] | None:
        """Two changes of one kind."""
        places = self.places(self.question.printed)
        for kind in PAIRED:
            firsts = [edit for place in places for edit in edits(place, self.words, frozenset({kind}))]
            if len(firsts) ** 2 * (WORK_OF_EDIT + len(places)) > MAX_WORK:
                continue
            pairs: list[tuple[Edit, ...]] = [
                (first, second) for first in firsts for second in self.hits(self.places(_changed(first)), kind)
            ]
            if found := self.right(pairs):
                return found
        return None

    def right(self, candidates: list[tuple[Edit, ...]]) -> tuple[Edit, ...] | None:
        """The candidate that touches least, of those that are right."""
        candidates.sort(key=lambda made: (sum(_size(edit.old) for edit in made), made[0].place.depth))
        return next((made for made in candidates[:MAX_PROOFS] if self.question.is_answer(_changed(made[-1]))), None)

    def places(self, formula: Expression) -> list[Spot]:
        try:
            return list(spots(formula, self.evaluate))
        except _BAD:
            return []

    def hits(self, places: Sequence[Spot], kind: Kind) -> Iterator[Edit]:
        """The changes that give the right value at the point."""
        for place in places:
            for edit in edits(place, self.words, frozenset({kind})):
                self.work += place.cost + WORK_OF_EDIT
                if self.work > MAX_WORK:
                    return
                if self.is_close(edit):
                    yield edit

    def is_close(self, edit: Edit) -> bool:
        try:
            value = self.whole(edit.place.value(self.evaluate(edit.node)))
            return abs(value - self.target) <= CLOSE * (1 + abs(self.target))
        except (*_BAD, TypeError):
            return False


def _compared_value(question: Question, evaluate: Evaluator) -> Callable[[float], float]:
    """What is compared, as a function of the value of the printed formula."""
    if question.is_plain:
        return lambda value: value
    slot = "(printed)"
    outer = question.compared(Name(slot))
    return lambda value: Evaluator({**evaluate.values, slot: value})(outer)


def _evaluators(question: Question) -> Iterator[Evaluator]:
    rng = random.Random(7)
    wanted = dict.fromkeys([*_known_names(question), *names(question.printed), *names(question.right)])
    for _ in range(POINTS):
        values = {name: rng.choice((-1, 1)) * rng.uniform(0.3, 1.7) for name in wanted}
        try:
            for name, meaning in question.definitions.items():
                values[name] = Evaluator(values)(meaning)
        except _BAD:
            continue
        yield Evaluator(values)


def _known_names(question: Question) -> list[str]:
    """What a name may be mistaken for; rates only where the formula is about motion."""
    robot = question.robot
    variables = [joint.variable for joint in robot.joints]
    rates = [rename(v) for rename in (velocity_name, acceleration_name) for v in variables]
    moving = set(rates).intersection((*names(question.printed), *names(question.right)))
    defined = [n for meaning in (*question.definitions.values(), question.right) for n in names(meaning)]
    found = [*robot_symbols(robot), *variables, *(rates if moving else ()), *question.definitions, *defined]
    return list(dict.fromkeys(found))


def _vocabulary(question: Question) -> Vocabulary:
    robot, right = question.robot, question.right
    angles = tuple(joint.variable for joint in robot.joints if joint.is_revolute)
    tokens = [node for node in (*_nodes(question.printed), *_nodes(right)) if is_token(node)]
    singles = [Call(f, (Name(angle),)) for angle in angles[:12] for f in ("cos", "sin")]
    known = tuple(_known_names(question))
    terms = [*question.extra_terms, *islice(_terms(right), MAX_TERMS)]
    return Vocabulary(
        names=known,
        angles=angles,
        factors=tuple(dict.fromkeys([*tokens, *singles, *map(Name, known)])),
        terms=tuple(dict.fromkeys([*terms, *map(negate, terms)])),
    )


def _nodes(e: Expression) -> Iterator[Expression]:
    waiting = [e]
    while waiting:
        node = waiting.pop()
        yield node
        waiting.extend(children(node))


def _terms(e: Expression) -> Iterator[Expression]:
    """Terms of all sums of a formula, each as it stands and multiplied with what stands before its brackets."""
    if not isinstance(e, Sum):
        yield e
    yield from _inner_terms(e)


def _inner_terms(e: Expression) -> Iterator[Expression]:
    match e:
        case Sum(terms):
            for term in terms:
                yield term
                yield from _inner_terms(term)
        case Product(factors):
            for i, factor in enumerate(factors):
                for term in _inner_terms(factor):
                    yield term
                    yield multiply(*factors[:i], *factors[i + 1 :], term)


def _changed(edit: Edit) -> Expression:
    """The whole formula with the change made."""
    return edit.place.formula(edit.node)


def _size(e: Expression) -> int:
    return sum(1 for _ in _nodes(e))
