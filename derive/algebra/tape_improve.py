"""Cheaper programs for the same values: sums and products taken apart and put together again.

Sums of sums and products of products, where the inner one serves nothing else, are taken as one. In a sum, like terms
are merged and common factors taken out, a*b + a*c -> a*(b + c); in both, what depends on run-time parameters alone
comes first, so that it is done once per call, and the rest is in the order of its making, so that sums that begin
alike share. Then shared parts of sums and products are searched for. A step is kept if it saves operations.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from derive.algebra import tape_constant
from derive.algebra.tape import LEAVES, Layer, Op
from derive.algebra.tape_build import copy_leaf, cost, reachable
from derive.algebra.tape_distribute import distribute
from derive.algebra.tape_graph import ONE, ZERO, Graph, Ref
from derive.algebra.tape_search import EFFORT, share

_ROUNDS = 4
_LARGE = 20_000
"""Operations from which one round must do: the first finds nearly all, and time grows with each."""

_Step = Callable[[Graph, Sequence[Ref]], tuple[Graph, tuple[Ref, ...]]]

_SUMS = (Op.ADD, Op.SUBTRACT)


def improve(graph: Graph, outputs: Sequence[Ref], effort: int = EFFORT) -> tuple[Graph, tuple[Ref, ...]]:
    """The same values for fewer operations.

    Args:
        graph: A graph.
        outputs: References into it.
        effort: How long to search, see `share`.
    """
    best, results, spent = graph, tuple(outputs), cost(graph, outputs)
    large = sum(spent) >= _LARGE
    steps: list[_Step] = [*[_regroup] * (1 if large else _ROUNDS), distribute]
    if not large:
        steps.append(lambda g, refs: share(g, refs, effort))
    for step in steps:
        fresh, moved = step(best, results)
        now = cost(fresh, moved)
        if now < spent:
            best, results, spent = fresh, moved, now
    return best, results


def _regroup(graph: Graph, outputs: Sequence[Ref]) -> tuple[Graph, tuple[Ref, ...]]:
    return _Round(graph, outputs).run()


@dataclass(frozen=True, slots=True)
class Term:
    """A product in a sum: its sign and its factors, references without sign, ascending."""

    negative: bool
    factors: tuple[Ref, ...]


class _Round:
    """One pass over a graph."""

    def __init__(self, graph: Graph, outputs: Sequence[Ref]) -> None:
        self.old = graph
        self.new = Graph()
        self.outputs = outputs
        self.order = reachable(graph, outputs)
        self.moved: dict[int, Ref] = {}
        self.uses: Counter[int] = Counter(ref >> 1 for ref in outputs)
        self.user: dict[int, Op] = {}
        for i in self.order:
            for k in graph.operands[i]:
                self.uses[k] += 1
                self.user[k] = graph.op[i]

    def run(self) -> tuple[Graph, tuple[Ref, ...]]:
        """The new graph and the outputs in it."""
        for i in self.order:
            if not self._absorbed(i):
                self.moved[i] = self._move(i)
        new = self.new
        return new, tuple(new.negate(self.moved[r >> 1]) if r & 1 else self.moved[r >> 1] for r in self.outputs)

    def _absorbed(self, i: int) -> bool:
        """Whether a sum or product is part of a larger one and of nothing else."""
        op, user = self.old.op[i], self.user.get(i)
        if self.uses[i] != 1 or user is None:
            return False
        return (op in _SUMS and user in _SUMS) or (op is Op.MULTIPLY and user in (*_SUMS, Op.MULTIPLY))

    def _move(self, i: int) -> Ref:
        op = self.old.op[i]
        if op in LEAVES:
            return copy_leaf(self.old, i, self.new)
        if op in _SUMS:
            return self._sum([term for term in (self._term(n, k) for n, k in self._summands(i)) if term is not None])
        if op is Op.MULTIPLY:
            term = self._term(False, i)
            return ZERO if term is None else self._product(term)
        return self.new.apply(op, *(self.moved[k] for k in self.old.operands[i]))

    def _summands(self, root: int) -> list[tuple[bool, int]]:
        """Signs and nodes that a sum adds up, from left to right."""
        found: list[tuple[bool, int]] = []
        stack = [(False, root)]
        while stack:
            negative, i = stack.pop()
            if i != root and not (self.old.op[i] in _SUMS and self._absorbed(i)):
                found.append((negative, i))
                continue
            left, right = self.old.operands[i]
            stack.append((negative ^ (self.old.op[i] is Op.SUBTRACT), right))
            stack.append((negative, left))
        return found

    def _term(self, negative: bool, root: int) -> Term | None:
        """A node as a product; None if a factor is zero."""
        factors: list[Ref] = []
        stack = [root]
        while stack:
            i = stack.pop()
            inner = self.old.op[i] is Op.MULTIPLY and (i not in self.moved)
            if inner:
                stack.extend(self.old.operands[i])
                continue
            ref = self.moved[i]
            negative ^= bool(ref & 1)
            factors.append(ref & ~1)
        if ZERO in factors:
            return None
        return Term(negative, tuple(sorted(f for f in factors if f != ONE)))

    def _product(self, term: Term) -> Ref:
        """Multiply out: constants, then parameters, then the rest, each in the order of their making."""
        result = ONE
        for factor in sorted(term.factors, key=self._rank):
            result = self.new.multiply(result, factor)
        return self.new.negate(result) if term.negative else result

    def _rank(self, ref: Ref) -> tuple[int, int]:
        return self.new.layer[ref >> 1], ref

    def _sum(self, terms: list[Term]) -> Ref:
        """Add up: like terms merged, common factors out."""
        terms = self._merged(terms)
        while (factor := self._common(terms)) is not None:
            inside = [Term(t.negative, _without(t.factors, factor)) for t in terms if factor in t.factors]
            rest = [t for t in terms if factor not in t.factors]
            inner = self._sum(inside)
            if inner == ZERO:
                terms = rest
                continue
            factors = tuple(sorted(f for f in (factor, inner & ~1) if f != ONE))
            terms = self._merged([*rest, Term(bool(inner & 1), factors)])
        refs = sorted((self._product(term) for term in terms), key=self._rank)
        result = ZERO
        for ref in refs:
            result = self.new.add(result, ref)
        return result

    def _common(self, terms: list[Term]) -> Ref | None:
        """The factor that saves most when taken out, the oldest of equals."""
        groups: dict[Ref, list[Term]] = {}
        for term in terms:
            for factor in dict.fromkeys(term.factors):
                groups.setdefault(factor, []).append(term)
        gains = [(-self._gain(factor, group), factor) for factor, group in groups.items() if len(group) > 1]
        return min(gains)[1] if gains else None

    def _gain(self, factor: Ref, group: Sequence[Term]) -> int:
        saved = len(group) - 1
        rest = (f for term in group for f in _without(term.factors, factor))
        early = all(self.new.layer[f >> 1] < Layer.BODY for f in rest)
        return 2 * saved if early and self.new.layer[factor >> 1] is Layer.BODY else saved

    def _merged(self, terms: Iterable[Term]) -> list[Term]:
        """Terms that differ in a number alone become one."""
        coefficients: dict[tuple[Ref, ...], tape_constant.Constant] = {}
        for term in terms:
            number: tape_constant.Constant = Fraction(-1 if term.negative else 1)
            factors: list[Ref] = []
            for factor in term.factors:
                value = self.new.constant_of(factor)
                if value is None:
                    factors.append(factor)
                else:
                    number = tape_constant.multiply(number, value)
            key = tuple(factors)
            coefficients[key] = tape_constant.add(coefficients.get(key, Fraction(0)), number)
        return [self._with_number(number, key) for key, number in coefficients.items() if number != 0]

    def _with_number(self, number: tape_constant.Constant, factors: tuple[Ref, ...]) -> Term:
        ref = self.new.number(number)
        numbers = () if ref & ~1 == ONE else (ref & ~1,)
        return Term(bool(ref & 1), tuple(sorted((*numbers, *factors))))


def _without(factors: tuple[Ref, ...], factor: Ref) -> tuple[Ref, ...]:
    """The factors less one occurrence."""
    place = factors.index(factor)
    return factors[:place] + factors[place + 1 :]
