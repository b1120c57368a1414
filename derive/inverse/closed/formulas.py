"""The formulas of an arm's nodes: the search decides, exact polynomials say it.

The search works with numbers modulo a prime; here the equations it chose are taken from the exact pool, written in the
one unknown and what is known, and made the formulas of nodes.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache, partial
from itertools import combinations, islice, product
from math import gcd, lcm

import numpy as np

from derive.algebra.contraction import paths
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial
from derive.inverse.closed.evidence import Evidence
from derive.inverse.closed.graph import Node, Plan, SolutionGraph, horner
from derive.inverse.closed.nodes import Exponents, NodeEquation, NodeFormula, NodeKind, Provenance, Unknown
from derive.inverse.closed.pool import Links, Pool, dimension
from derive.inverse.closed.pose import Pose, conditions
from derive.inverse.closed.search import Choice, Search, SearchStep
from derive.inverse.closed.unknowns import POSE_NAMES, InverseDomain, State, baked, shifted, with_numbers, without
from derive.inverse.general.choice import general_formula
from derive.inverse.numeric.chain import POSE, POSITION
from derive.robot.expression import ZERO, substitute
from derive.robot.options.inverse import ROWS, Task
from derive.robot.robot import Robot

_OF_JOINTS = {Kind.SINE, Kind.COSINE, Kind.VARIABLE, Kind.RATE, Kind.ACCELERATION}
_ALTERNATIVES = 3  # formulas besides the chosen one that a node has for poses at which that one fails
_READ = 60  # short equations with two unknowns that are written out
_PAIRED = 12  # equations with the same two unknowns that are taken two by two
_LONGEST = 4000  # terms of an equation that comes from two; longer ones are not looked at
_CONDITIONS = 300  # short equations of the pool among which conditions on the pose are looked for
_LONG_SUM = 2  # operations that a sum of angles as unknown must save for each joint more that it spans
_COMPARED = 12  # equally simple choices whose formulas are written out to see which is the shortest


class CoincidenceError(Exception):
    """An equation that is as short as it seems for the numbers of the parameters alone, not for all of them."""


class GraphDerivation:
    """Writes the nodes of one arm."""

    def __init__(self, robot: Robot, task: Task, given: Sequence[int] = (), *, deep: bool = False) -> None:
        allowed = frozenset(place for row in task for place in ROWS[row])
        self.task, self.given = task, tuple(given)
        # Whose rotation is not told: matrices reach to the end effector then, whose position is.
        turned = [(i, j) in allowed for i in (1, 2, 3) for j in (1, 2, 3)]
        numbers = self.numbers = baked(robot)
        zeros = {name: value for name, value in numbers.items() if value == ZERO}
        self.robot, self.shifts = shifted(with_numbers(robot, zeros))
        specimen = with_numbers(self.robot, numbers)
        self.domain = InverseDomain(self.robot)
        # All generators but those of joints, and the entries and invariants of the pose.
        still = (g for g in self.domain.generators if g.kind not in _OF_JOINTS and g.name not in POSE_NAMES)
        self.constants = {g.name: substitute(g.expression, numbers) for g in still}
        sampled = self.sampled = InverseDomain(specimen, self.constants.values())
        if (sampled.groups, sampled.directions) != (self.domain.groups, self.domain.directions):
            self.robot, self.domain = specimen, sampled
        self._gather(allowed, keep_tool=not all(turned), deep=deep)
        if self.to_end and any(turned) and all(column == 3 for _, column in self.evidence.untold(allowed)):
            self._gather(allowed, keep_tool=False, deep=deep)
        untold, rotation = set(self.evidence.untold(allowed)), self.links.base.rotation
        if any(  # the base turns an entry that is told and one of its column that is not into each other
            (i, j) in untold and any((k + 1, j + 1) in allowed and rotation[i][m] and rotation[k][m] for k in range(3))
            for i in range(3)
            for j in range(4)
            for m in range(3)
        ):
            self._gather(allowed, keep_tool=self.to_end, keep_base=True, deep=deep)
        self.pose = Pose(self.domain, self.links, self.evidence, self.constants, allowed, deep=deep)
        self.pool = Pool(self.links, self.pose.atoms)
        self.search = Search(self.evidence, given)
        self.polynomial, self.equation = cache(self._polynomial), cache(self._equation)
        self.nodes: list[Node] = []
        self.homes: dict[Unknown, int] = {}

    def _gather(
        self, allowed: frozenset[tuple[int, int]], *, keep_tool: bool, keep_base: bool = False, deep: bool
    ) -> None:
        """The equations; they reach to the end effector where its orientation is not told, else to the last joint."""
        # They begin at the first joint, but in the world where the base mixes what the task tells with other entries.
        self.to_end = keep_tool
        kept = {"keep_tool": keep_tool, "keep_base": keep_base}
        self.links: Links[Polynomial] = Links(self.robot, self.domain, self.domain.joint_turn, **kept)
        evidence = partial(Evidence, self.sampled, list(self.links.cuts()), allowed, deep=deep, **kept)
        self.evidence = evidence()
        self._special = cache(partial(evidence, special=True))  # the equations at poses where formulas fail

    def graph(self) -> SolutionGraph | None:
        """The graph of one-joint nodes; None where there is no such way."""
        if (way := self.search.way()) is None:
            return None
        self._begin()
        return self._ended(way, self.search.start)

    def graph_by_pairs(self) -> SolutionGraph | None:
        """The graph whose first node comes from two equations with two unknowns; None where there is none."""
        steps, state = self.search.advance()
        found: list[tuple[tuple[int, int], Unknown, NodeFormula, State]] = []
        for (group, parts), numbers in self.search.pairs(state):
            after = state.joined(group, *parts)
            for unknown in self.domain.between(group, parts)[:1]:
                for formula in self._eliminations(unknown, numbers, state):
                    # Fewest branches first, then fewest terms; the rest of the joints must follow one by one.
                    rank = (formula.branches, sum(len(p) for p in formula.equations[0].terms.values()))
                    found.append((rank, unknown, formula, after))
        way = cache(self.search.way)
        for _, unknown, formula, after in sorted(found, key=lambda row: row[0]):
            if (rest := way(after)) is not None:
                self._begin()
                state = self._follow(steps, self.search.start)
                self._append((unknown,), (formula,))
                return self._ended(rest, after)
        return None

    def _eliminations(self, unknown: Unknown, numbers: Sequence[int], state: State) -> Iterator[NodeFormula]:
        """Formulas for one unknown from pairs of equations with the same second one."""
        # Equations by the one other unknown that they hold; that one is eliminated from two of them.
        alike: dict[Unknown, list[tuple[int, Polynomial]]] = {}
        seen: set[str] = set()
        for number in numbers[:_READ]:
            p = self.domain.rewritten(self.polynomial(number), state, unknown)
            if (key := p.normalised()[1]) in seen:
                continue
            seen.add(key)
            unfound = [name for name in _names(p) - set(unknown.generators) if not self.domain.is_known(name, state)]
            second = {self.domain.owner(name) for name in unfound}
            if len(second) == 1 and (other := second.pop()):
                alike.setdefault(other, []).append((number, p))
        kinds = (NodeKind.TYPE_2, NodeKind.CONIC) if unknown.is_angle else (NodeKind.TYPE_1, NodeKind.QUADRATIC)
        for other, rows in alike.items():
            for (i, p), (j, q) in combinations(rows[:_PAIRED], 2):
                found = without(self.domain.ring, other, p, q)
                terms = self._terms(found, state, unknown) if found and len(found) <= _LONGEST else {}
                degree = max(map(sum, terms), default=0)
                if 1 <= degree <= 2:
                    source = replace(self._source(i), also=self._source(j))
                    power = 2 * sum(dimension(self.evidence.equations[k][1]) for k in (i, j))
                    yield NodeFormula(kinds[degree - 1], (_tidied(terms, power, source),))

    def _terms(self, p: Polynomial, state: State, unknown: Unknown) -> dict[Exponents, Polynomial]:
        """An equation by powers of its unknown, without what vanishes at all poses; nothing where another is in it."""
        parts = self.domain.ring.coefficients(p, [self.domain.ring.index[name] for name in unknown.generators]).items()
        terms = {e: k for e, k in parts if np.any(self.evidence.value(k, self.constants))}
        used = {name for coefficient in terms.values() for name in _names(coefficient)}
        return terms if all(self.domain.is_known(name, state) for name in used) else {}

    def _begin(self) -> None:
        """An empty graph but for the joints that are given."""
        self.nodes.clear()
        self.homes.clear()
        for joint in self.given:
            self._append((self.domain.unknown(joint),), (NodeFormula(NodeKind.GIVEN),))

    def _follow(self, way: Sequence[SearchStep], state: State) -> State:
        for step in way:
            best = step.best
            # Of equally good choices the one that is shortest in exact polynomials, not only modulo a prime.
            alike = [c for c in step.choices if (c.kind, c.cost[0]) == (best.kind, best.cost[0])][:_COMPARED]
            written = [
                (formula, unknown, choice)
                for choice, unknown in product(alike, self.domain.between(step.group, step.parts))
                if (formula := self._formula(choice, state, unknown)) is not None
            ]
            if not written:
                raise CoincidenceError
            first, unknown, choice = min(written, key=lambda row: self._cost(*row[:2]))
            found = [first]
            if first.degenerate:
                others = islice(self.search.others(step, choice, self._special()), _ALTERNATIVES)
                found += [formula for other in others if (formula := self._formula(other, state, unknown)) is not None]
            self._append((unknown,), tuple(found))
            state = state.joined(step.group, *step.parts)
        return state

    def _ended(self, way: Sequence[SearchStep], state: State) -> SolutionGraph:
        self._follow(way, state)
        for joint in range(self.robot.n):
            self._ensure(self.domain.unknown(joint))
        return self._finished()

    def general_graph(self) -> SolutionGraph | None:
        """The graph of one general node for all joints that are not given; None where there is none."""
        entries = tuple((i - 1, j - 1) for i, j in sorted({place for row in self.task for place in ROWS[row]}))
        if entries not in (POSE, POSITION):
            return None
        specimen = with_numbers(self.robot, self.numbers)
        generators = [self.domain.unknown(joint).generators for joint in self.given]
        if (formula := general_formula(self.robot, specimen, self.given, generators, entries)) is None:
            return None
        self._begin()
        free = tuple(map(self.domain.unknown, formula.order))
        given = len(self.given)
        node = NodeFormula(NodeKind.GENERAL, payload=formula)
        self.nodes.append(Node(given, free, (node,), tuple(range(given)), formula.branches))
        return replace(self._finished(), count=formula.solution.count, complete=formula.solution.count > 0)

    def with_conditions(self, graph: SolutionGraph, missing: int) -> SolutionGraph:
        """The graph with what its pose must satisfy."""
        if missing <= 0:
            return graph
        order = np.argsort(self.search.lengths, kind="stable")
        numbers = [int(k) for k in order if self.evidence.allowed[k]][:_CONDITIONS]
        cuts = ((k, *self.evidence.equations[k]) for k in numbers)
        pool = [(self.polynomial(k), Provenance(cut.first + 1, cut.last + 1, entry)) for k, cut, entry in cuts]
        homes = {name: (own.is_angle, index) for own, index in self.homes.items() for name in own.generators}

        def _length(row: tuple[Polynomial, Provenance]) -> tuple[int, int]:
            # Terms and slides; and how late in the graph its joints are found.
            found = [homes[name] for name in _names(row[0]) if name in homes]
            return len(row[0].raw) + sum(not turns for turns, _ in found), max((k for _, k in found), default=-1)

        whole = [(p, Provenance(1, self.robot.n, entry)) for entry, p in self.pose.constant.items()]
        pool = [*whole, *sorted(pool, key=_length)]
        complete = replace(graph, definitions=tuple(self.pose.definitions.items()))
        found = conditions(complete, missing, pool, self.evidence, self.constants, self.numbers)
        used = {name for equation in found for name in _names(equation.coefficient())}
        used |= {name for name, _ in graph.definitions}
        return replace(graph, conditions=found, definitions=self._definitions(used))

    def _definitions(self, used: set[str]) -> tuple[tuple[str, Polynomial], ...]:
        """Definitions of some generators of the pose and of those that they need."""
        definitions: list[tuple[str, Polynomial]] = []
        for name, value in reversed(self.pose.definitions.items()):
            if name in used:
                used = used | _names(value)
                definitions.insert(0, (name, value))
        return tuple(definitions)

    def _finished(self) -> SolutionGraph:
        used = {name for node in self.nodes for formula in node.formulas for name in _names_of_formula(formula)}
        own = self.robot, self.domain, self.task, self.given, self._definitions(used), self.domain.square_reach
        from_base = self.links.start is not None
        return SolutionGraph(*own, tuple(self.nodes), self.shifts, to_end=self.to_end, from_base=from_base)

    def _append(self, unknowns: tuple[Unknown, ...], formulas: tuple[NodeFormula, ...]) -> int:
        """A new node, after the sums of angles that it needs, which come in an order that no hash decides."""
        needed = {name for formula in formulas for name in _names_of_formula(formula)}
        parts = {part for formula in formulas for part, _ in formula.parts}
        wanted = (parts | {one for one in self.domain.unknowns() if needed & {*one.generators}}) - {*unknowns}
        needs = tuple(sorted({self._ensure(one) for one in sorted(wanted, key=lambda one: one.joints)}))
        index = len(self.nodes)
        self.nodes.append(Node(index, unknowns, formulas, needs, max(formula.branches for formula in formulas)))
        self.homes.update(dict.fromkeys(unknowns, index))
        return index

    def _ensure(self, unknown: Unknown) -> int:
        """The node of an angle that follows from known ones; a new one is the shortest signed sum of these."""
        if unknown in self.homes:
            return self.homes[unknown]
        g, start, goal = self.domain.ends(unknown)
        # Angles of a group are edges between links: a sum is the shortest path.
        alike = [other for other in self.homes if other.is_angle and self.domain.ends(other)[0] == g]
        way = paths(tuple(self.domain.ends(other)[1:] for other in alike), start)[goal]
        signed = [(alike[k], self.domain.sense(alike[k], along > 0)) for k, along in way.items()]
        sign = self.domain.sense(unknown, forwards=True)
        parts = tuple((part, sign * own) for part, own in sorted(signed, key=lambda pair: -pair[1] * sign))
        return self._append((unknown,), (NodeFormula(NodeKind.SUM, parts=parts),))

    def _formula(self, choice: Choice, state: State, unknown: Unknown) -> NodeFormula | None:
        """A choice in exact polynomials; None where it needs what is not known after all."""
        equations = [self.equation(k, state, unknown) for k in choice.equations]
        known = tuple(equation for equation in equations if equation is not None)
        return NodeFormula(choice.kind, known) if len(known) == len(equations) else None

    def _equation(self, number: int, state: State, unknown: Unknown) -> NodeEquation | None:
        terms = self._terms(self.domain.rewritten(self.polynomial(number), state, unknown), state, unknown)
        if not any(map(any, terms)):
            return None
        source = self._source(number)
        return _tidied(terms, dimension(source.entry), source)

    def _source(self, number: int) -> Provenance:
        cut, entry = self.evidence.equations[number]
        return Provenance(cut.first + 1, cut.last + 1, entry, cut.outer_left, cut.outer_right)

    def _polynomial(self, number: int) -> Polynomial:
        cut, entry = self.evidence.equations[number]
        inside, around = self.pool.sides(cut)
        return inside.entry(entry) - around.entry(entry)

    def _cost(self, formula: NodeFormula, unknown: Unknown) -> tuple[int, int, int]:
        """Operations, also of sums of angles without a node; then few joints; then positions, which seldom fail."""
        operations = sum(_operations(horner(p)) for e in formula.equations for p in e.terms.values())
        used = _names_of_formula(formula)
        missing = {u for u in self.domain.unknowns() if u not in self.homes and used & set(u.generators)}
        mixed = len({(e.source.first, e.source.last, e.source.entry[0], e.dimension) for e in formula.equations}) - 1
        length = operations + 6 * len(missing) + 6 * mixed + _LONG_SUM * len(unknown.joints)
        return length, len(unknown.joints), sum(equation.dimension == 0 for equation in formula.equations)


def _operations(plan: Plan) -> int:
    if isinstance(plan, Fraction):
        return 0
    _, quotient, rest = plan
    return (quotient not in (1, -1)) + _operations(quotient) + (rest != 0) + _operations(rest)


def _tidied(terms: Mapping[Exponents, Polynomial], power: int, source: Provenance) -> NodeEquation:
    """An equation of a power of length, its numbers whole and most coefficients of its unknown positive."""
    numbers = [coefficient for p in terms.values() for _, coefficient in p.terms()]
    common = Fraction(gcd(*(x.numerator for x in numbers)), lcm(*(x.denominator for x in numbers)))
    signs = [1 if coefficient > 0 else -1 for e, p in terms.items() if any(e) for _, coefficient in p.terms()]
    factor = 1 / common if sum(signs) >= 0 else -1 / common
    tidy = {exponents: factor * coefficient for exponents, coefficient in terms.items()}
    return NodeEquation(tidy, power, source, abs(factor))


def _names(p: Polynomial) -> set[str]:
    return {name for name, degree in zip(p.ring.names, p.degrees(), strict=True) if degree}


def _names_of_formula(formula: NodeFormula) -> set[str]:
    return {name for equation in formula.equations for p in equation.terms.values() for name in _names(p)}
