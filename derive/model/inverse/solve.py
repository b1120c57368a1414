"""From a robot to the graph of its solutions: the search decides, exact polynomials say it.

The search works with numbers modulo a prime; here the equations it chose are taken from the exact pool, written in the
one unknown and what is known, and made the formulas of nodes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import cache, cached_property, partial
from itertools import combinations, islice, product
from math import gcd, lcm

import numpy as np

from derive.algebra.generators import Kind as GeneratorKind
from derive.algebra.residues import Residue, ResidueDomain, echelon
from derive.algebra.ring import Polynomial
from derive.errors import QuantityError, listed
from derive.mechanics.chain import ChainJoint, build_chain
from derive.mechanics.forward_kinematics import forward_kinematics, jacobian
from derive.mechanics.vectors import Frame, Matrix, column, cross, dot, hat, matmul, multiply, outer, transpose
from derive.model.inverse.completeness import counted
from derive.model.inverse.conditions import conditions
from derive.model.inverse.elimination_choice import general_formula
from derive.model.inverse.evidence import Evidence
from derive.model.inverse.graph import Node, Plan, SolutionGraph, horner, turned
from derive.model.inverse.nodes import Equation, Exponents, Formula, Kind, Source, Unknown
from derive.model.inverse.numeric import POSE, POSITION
from derive.model.inverse.pairs import without_angle, without_length
from derive.model.inverse.pool import Atoms, Links, Pool, dimension, identity_atoms
from derive.model.inverse.search import Choice, Search, State, Step
from derive.model.inverse.unknowns import ENTRIES, InverseDomain, shifted
from derive.robot.description import Joint
from derive.robot.expression import ZERO, Expression, names, substitute
from derive.robot.inverse_options import FREEDOMS, ROWS, Task
from derive.robot.robot import Robot

_CONSTANTS = (
    GeneratorKind.INVERSE,
    GeneratorKind.ROOT,
    GeneratorKind.PRIME_ROOT,
    GeneratorKind.CONSTANT_SINE,
    GeneratorKind.CONSTANT_COSINE,
    GeneratorKind.PARAMETER,
    GeneratorKind.PI,
)

_ALTERNATIVES = 3
"""Formulas besides the chosen one that a node has for poses at which that one fails."""

MAX_JOINTS = 10
"""Longer arms are solved by numbers alone."""

_TRIED = 4
"""Choices of given joints that are tried where the file makes none."""

_READ = 60
"""Short equations with two unknowns that are written out."""

_PAIRED = 12
"""Equations with the same two unknowns that are taken two by two."""

_LONGEST = 4000
"""Terms of an equation that comes from two; longer ones are not looked at."""

_CONDITIONS = 300
"""Short equations of the pool among which conditions on the pose are looked for."""

_LONG_SUM = 2
"""Operations that a sum of angles as unknown must save for each joint more that it spans."""

_COMPARED = 12
"""Equally simple choices whose formulas are written out to see which is the shortest."""


class Pose:
    """The pose in exact polynomials: entries that are always zero, one or equal are not told apart.

    Args:
        domain: The ring.
        links: The arm in it.
        evidence: Says what is equal wherever the arm reaches.
        constants: See `Evidence.value`.
        allowed: The entries of T that are given, by which others are written where they are equal.
        deep: Whether the higher invariants are taken too.

    Attributes:
        atoms: W and its invariants.
        definitions: Generator -> polynomial of the entries of T and of those defined before.
    """

    def __init__(
        self,
        domain: InverseDomain,
        links: Links[Polynomial],
        evidence: Evidence,
        constants: Mapping[str, Expression],
        allowed: frozenset[tuple[int, int]] = frozenset(),
        *,
        deep: bool = False,
    ) -> None:
        self._domain, self._evidence, self._constants = domain, evidence, constants
        self._known: list[tuple[tuple[int, ...], Polynomial]] = []
        self.definitions: dict[str, Polynomial] = {}
        places = [(i, j) for j in range(4) for i in range(3)]
        first = sorted(places, key=lambda place: (place[0] + 1, place[1] + 1) not in allowed)
        end = self._frame({(i, j): self._entry(f"T[{i + 1},{j + 1}]", None) for i, j in first})
        inner = links.base.inverse @ end @ links.tool.inverse
        self._known.clear()
        flat = {(i, j): inner.position[i] if j == 3 else inner.rotation[i][j] for i, j in places}
        pose = self._frame({(i, j): self._entry(f"W[{i + 1},{j + 1}]", flat[i, j]) for i, j in places})
        r, p = pose.rotation, pose.position
        back = [self._entry(f"u[{k + 1}]", value) for k, value in enumerate(multiply(transpose(r), p))]
        square = self._entry("p.p", dot(p, p))
        moment = reflection = None
        if deep:
            zero = links.zero
            moment = self._matrix("m", matmul(hat(p, zero), r))
            products = outer(p, (back[0], back[1], back[2]))
            rows = [[square * r[i][j] - 2 * products[i][j] for j in range(3)] for i in range(3)]
            reflection = self._matrix("k", _as_matrix(rows))
        self.atoms = Atoms(r, p, (back[0], back[1], back[2]), square, moment, reflection)

    def _matrix(self, name: str, values: Matrix[Polynomial]) -> Matrix[Polynomial]:
        return _as_matrix([[self._entry(f"{name}[{i + 1},{j + 1}]", values[i][j]) for j in range(3)] for i in range(3)])

    @staticmethod
    def _frame(entries: Mapping[tuple[int, int], Polynomial]) -> Frame[Polynomial]:
        rows = [[entries[i, j] for j in range(3)] for i in range(3)]
        return Frame(_as_matrix(rows), (entries[0, 3], entries[1, 3], entries[2, 3]))

    def _entry(self, name: str, value: Polynomial | None) -> Polynomial:
        """An entry: zero, plus or minus one, plus or minus an earlier one, what it is if that is short, or its name."""
        ring, p = self._domain.ring, self._evidence.prime
        residues = self._evidence.number(name, self._constants)
        for number in (0, 1, -1):
            if np.all(residues == number % p):
                return ring.number(number)
        for known, polynomial in self._known:
            if np.all(residues == known):
                return polynomial
            if np.all(residues == (p - np.array(known)) % p):
                return -polynomial
        if value is None or not _is_short(value):
            if value is not None:
                self.definitions[name] = value
            value = ring.generator(name)
        self._known.append((tuple(int(x) for x in residues), value))
        return value


class Derivation:
    """Writes the nodes of one arm.

    Args:
        robot: The robot; its dynamics are not looked at.
        task: The rows of the task, see `ROWS`.
        given: Indices of the joints that are arguments.
        deep: Whether the higher invariants are taken too.
    """

    def __init__(self, robot: Robot, task: Task, given: Sequence[int] = (), *, deep: bool = False) -> None:
        allowed = frozenset(place for row in task for place in ROWS[row])
        self.task, self.given = task, tuple(given)
        keep_tool = not all((i, j) in allowed for i in (1, 2, 3) for j in (1, 2, 3))
        numbers = self.numbers = _baked(robot)
        zeros = {name: value for name, value in numbers.items() if value == ZERO}
        self.robot, self.shifts = shifted(_with_numbers(robot, zeros))
        specimen = _with_numbers(self.robot, numbers)
        self.domain = InverseDomain(self.robot)
        constants = {g.name: substitute(g.expression, numbers) for g in self.domain.generators if g.kind in _CONSTANTS}
        pose_names = {f"{a}{entry}" for a in "TW" for entry in ENTRIES}
        self.constants = {name: e for name, e in constants.items() if name not in pose_names and "[" not in name}
        self.constants.pop("p.p", None)
        sampled = self.sampled = InverseDomain(specimen, self.constants.values())
        if (sampled.groups, sampled.directions) != (self.domain.groups, self.domain.directions):
            self.robot, self.domain = specimen, sampled
        self.links: Links[Polynomial] = Links(self.robot, self.domain, self.domain.joint_turn, keep_tool)
        cuts = list(self.links.cuts())
        self.evidence = Evidence(sampled, cuts, allowed, keep_tool=keep_tool, deep=deep)
        self._special = partial(Evidence, sampled, cuts, allowed, keep_tool=keep_tool, deep=deep, special=True)
        self.pose = Pose(self.domain, self.links, self.evidence, self.constants, allowed, deep=deep)
        self.pool = Pool(self.links, self.pose.atoms)
        self.search = Search(self.evidence, given)
        self.polynomial = cache(self._polynomial)
        self.nodes: list[Node] = []
        self.homes: dict[Unknown, int] = {}

    @cached_property
    def special(self) -> Evidence:
        """The equations at poses where formulas fail."""
        return self._special()

    def graph(self) -> SolutionGraph | None:
        """The graph of one-joint nodes; None where there is no such way."""
        way = self.search.way()
        if way is None:
            return None
        self._begin()
        return self._ended(way, self.search.start)

    def graph_by_pairs(self) -> SolutionGraph | None:
        """The graph whose first node comes from two equations with two unknowns; None where there is none."""
        steps, state = self.search.advance()
        found: list[tuple[tuple[int, int], int, Unknown, Formula, State]] = []
        for (group, parts), numbers in self.search.pairs(state):
            after = state.joined(group, *parts) if group >= 0 else State(state.groups, state.slides | {parts[0]})
            for unknown in self._candidates(group, parts)[:1]:
                for formula in self._eliminations(unknown, numbers, state):
                    rank = (formula.branches, sum(len(p) for p in formula.equations[0].terms.values()))
                    found.append((rank, len(found), unknown, formula, after))
        rests: dict[State, list[Step] | None] = {}
        for _, _, unknown, formula, after in sorted(found, key=lambda row: row[:2]):
            if after not in rests:
                rests[after] = self.search.way(after)
            rest = rests[after]
            if rest is not None:
                self._begin()
                state = self._follow(steps, self.search.start)
                self._append((unknown,), (formula,))
                return self._ended(rest, after)
        return None

    def _eliminations(self, unknown: Unknown, numbers: Sequence[int], state: State) -> Iterator[Formula]:
        """Formulas for one unknown from pairs of equations with the same second one."""
        ring = self.domain.ring
        alike: dict[tuple[str, ...], list[tuple[int, Polynomial]]] = {}
        seen: set[str] = set()
        for number in numbers[:_READ]:
            p = self._rewritten(self.polynomial(number), state, unknown)
            key = p.normalised()[1]
            if key in seen:
                continue
            seen.add(key)
            second = {self._owner(name) for name in _names(p) - set(unknown.generators) if not self._known(name, state)}
            if len(second) == 1 and None not in second:
                alike.setdefault(next(iter(second)).generators, []).append((number, p))  # type: ignore[union-attr]
        places = [ring.index[name] for name in unknown.generators]
        for generators, rows in alike.items():
            for (i, p), (j, q) in combinations(rows[:_PAIRED], 2):
                if len(generators) == 1:
                    found = without_length(ring, generators[0], p, q)
                else:
                    found = without_angle(ring, generators, p, q)
                if not found or len(found) > _LONGEST:
                    continue
                terms = self._terms(found, places)
                degree = max((sum(exponents) for exponents in terms), default=0)
                if 1 <= degree <= 2 and all(self._known(name, state) for p in terms.values() for name in _names(p)):
                    kinds = (Kind.TYPE_2, Kind.CONIC) if unknown.is_angle else (Kind.TYPE_1, Kind.QUADRATIC)
                    yield Formula(kinds[degree - 1], (self._paired(terms, i, j),))

    def _paired(self, terms: Mapping[Exponents, Polynomial], i: int, j: int) -> Equation:
        """An equation from two."""
        sources = [
            Source(cut.first + 1, cut.last + 1, entry, cut.outer_left, cut.outer_right)
            for cut, entry in (self.evidence.equations[k] for k in (i, j))
        ]
        dimensions = [dimension(self.evidence.equations[k][1]) for k in (i, j)]
        factor = _tidy_factor(terms)
        tidy = {exponents: factor * coefficient for exponents, coefficient in terms.items()}
        return Equation(tidy, 2 * sum(dimensions), replace(sources[0], also=sources[1]), abs(factor))

    def _terms(self, p: Polynomial, places: Sequence[int]) -> dict[Exponents, Polynomial]:
        """An equation by powers of its unknown, without what vanishes wherever the arm reaches."""
        parts = self.domain.ring.coefficients(p, places).items()
        return {e: coefficient for e, coefficient in parts if np.any(self.evidence.value(coefficient, self.constants))}

    def _begin(self) -> None:
        """An empty graph but for the joints that are given."""
        self.nodes.clear()
        self.homes.clear()
        for joint in self.given:
            self._append((self.domain.unknown(joint),), (Formula(Kind.GIVEN),))

    def _follow(self, way: Sequence[Step], state: State) -> State:
        """Nodes for the steps of a way."""
        for step in way:
            formulas, unknown = self._formulas(step, state)
            self._append((unknown,), formulas)
            joined = state.joined(step.group, *step.parts) if step.group >= 0 else None
            state = joined or State(state.groups, state.slides | {step.parts[0]})
        return state

    def _ended(self, way: Sequence[Step], state: State) -> SolutionGraph:
        """The graph after its last steps."""
        self._follow(way, state)
        for joint in range(self.robot.n):
            self._ensure(self.domain.unknown(joint))
        return self._finished()

    def general_graph(self) -> SolutionGraph | None:
        """The graph of one general node for all joints that are not given; None where there is none."""
        entries = tuple((i - 1, j - 1) for i, j in sorted({place for row in self.task for place in ROWS[row]}))
        if entries not in (POSE, POSITION):
            return None
        specimen = _with_numbers(self.robot, self.numbers)
        given = [self.domain.unknown(joint) for joint in self.given]
        generators = [unknown.generators for unknown in given]
        formula = general_formula(self.robot, specimen, self.given, generators, entries)
        if formula is None:
            return None
        self.nodes.clear()
        self.homes.clear()
        for unknown in given:
            self._append((unknown,), (Formula(Kind.GIVEN),))
        free = tuple(map(self.domain.unknown, formula.order))
        node = Node(len(given), free, (Formula(Kind.GENERAL, payload=formula),), tuple(range(len(given))))
        self.nodes.append(replace(node, branches=formula.branches))
        count = formula.solution.count
        return replace(self._finished(), count=count, complete=count > 0)

    def with_conditions(self, graph: SolutionGraph, missing: int) -> SolutionGraph:
        """The graph with what its pose must satisfy.

        Args:
            graph: The graph.
            missing: Dimensions of the task less those that the arm reaches.
        """
        if missing <= 0:
            return graph
        order = np.argsort(self.search.lengths, kind="stable")
        numbers = [int(k) for k in order if self.evidence.allowed[k]][:_CONDITIONS]
        cuts = ((k, *self.evidence.equations[k]) for k in numbers)
        pool = ((self.polynomial(k), Source(cut.first + 1, cut.last + 1, entry)) for k, cut, entry in cuts)
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
        return SolutionGraph(
            self.robot,
            self.domain,
            self.task,
            self.given,
            self._definitions(used),
            square_reach(self.robot, self.domain),
            tuple(self.nodes),
            self.shifts,
        )

    # -- nodes

    def _append(self, unknowns: tuple[Unknown, ...], formulas: tuple[Formula, ...]) -> int:
        """A new node, after the sums of angles that it needs."""
        owners: dict[str, Unknown] = {}
        needed = {name for formula in formulas for name in _names_of_formula(formula)}
        for unknown in self._all_unknowns():
            owners.update(dict.fromkeys(unknown.generators, unknown))
        parts = {part for formula in formulas for part, _ in formula.parts}
        wanted = parts | {owners[name] for name in needed if name in owners}
        needs = tuple(sorted({self._ensure(unknown) for unknown in wanted - set(unknowns)}))
        index = len(self.nodes)
        self.nodes.append(Node(index, unknowns, formulas, needs, max(formula.branches for formula in formulas)))
        self.homes.update(dict.fromkeys(unknowns, index))
        return index

    def _ensure(self, unknown: Unknown) -> int:
        """The node of an angle that follows from known ones, a new one if need be."""
        if unknown not in self.homes:
            parts = self._parts(unknown)
            self._append((unknown,), (Formula(Kind.SUM, parts=parts),))
        return self.homes[unknown]

    def _all_unknowns(self) -> Iterator[Unknown]:
        for group in self.domain.groups:
            for u in range(len(group)):
                yield from (self.domain.unknown(*group[u:v]) for v in range(u + 1, len(group) + 1))
        yield from (self.domain.unknown(i) for i, joint in enumerate(self.robot.joints) if not joint.is_revolute)

    def _ends(self, unknown: Unknown) -> tuple[int, int, int]:
        """The group of an angle and the two links that it is between."""
        g = next(k for k, group in enumerate(self.domain.groups) if unknown.joints[0] in group)
        place = self.domain.groups[g].index(unknown.joints[0])
        return g, place, place + len(unknown.joints)

    def _parts(self, unknown: Unknown) -> tuple[tuple[Unknown, int], ...]:
        """An angle as the shortest signed sum of angles that have nodes."""
        g, start, goal = self._ends(unknown)
        alike = [other for other in self.homes if other.is_angle and self._ends(other)[0] == g]
        edges = [(other, *self._ends(other)[1:]) for other in alike]
        ways: dict[int, tuple[tuple[Unknown, int], ...]] = {start: ()}
        queue = [start]
        while queue:
            link = queue.pop(0)
            for other, u, v in edges:
                for a, b in ((u, v), (v, u)):
                    if a == link and b not in ways:
                        ways[b] = (*ways[link], (other, self._sign(other, a < b)))
                        queue.append(b)
        sign = self._sign(unknown, forwards=True)
        return tuple((part, sign * own) for part, own in sorted(ways[goal], key=lambda pair: -pair[1] * sign))

    def _sign(self, unknown: Unknown, forwards: bool) -> int:
        """Whether phi_v - phi_u is the angle or its negative."""
        direction = self.domain.directions[unknown.joints[0]]
        return direction if forwards else -direction

    # -- formulas

    def _formulas(self, step: Step, state: State) -> tuple[tuple[Formula, ...], Unknown]:
        """The formulas of a step, the best one first, and the unknown in which they are written."""
        best = step.best
        alike = [c for c in step.choices if (c.kind, c.cost[0]) == (best.kind, best.cost[0])][:_COMPARED]
        written = [
            (self._cost(formula) + _LONG_SUM * len(unknown.joints), len(unknown.joints), k, formula, unknown, choice)
            for k, (choice, unknown) in enumerate(product(alike, self._candidates(step.group, step.parts)))
            if (formula := self._formula(choice, state, unknown)) is not None
        ]
        if not written:
            raise CoincidenceError
        *_, first, unknown, choice = min(written, key=lambda row: row[:3])
        found = [first]
        if first.degenerate:
            for other in islice(self.search.others(step, choice, self.special), _ALTERNATIVES):
                formula = self._formula(other, state, unknown)
                if formula is not None:
                    found.append(formula)
        return tuple(found), unknown

    def _candidates(self, number: int, parts: tuple[int, int]) -> list[Unknown]:
        """The angles between two parts of a group, those of few joints first; or the slide."""
        if number < 0:
            return [self.domain.unknown(parts[0])]
        group = self.domain.groups[number]
        links = [[k for k in range(len(group) + 1) if part >> k & 1] for part in parts]
        ends = (sorted(pair) for pair in product(*links))
        return [self.domain.unknown(*group[u:v]) for u, v in sorted(ends, key=lambda e: (e[1] - e[0], e))]

    def _formula(self, choice: Choice, state: State, unknown: Unknown) -> Formula | None:
        """A choice in exact polynomials; None where it needs what is not known after all."""
        equations = [self._equation(k, state, unknown) for k in choice.equations]
        if any(equation is None for equation in equations):
            return None
        return Formula(choice.kind, tuple(equation for equation in equations if equation is not None))

    def _equation(self, number: int, state: State, unknown: Unknown) -> Equation | None:
        cut, entry = self.evidence.equations[number]
        p = self._rewritten(self.polynomial(number), state, unknown)
        terms = self._terms(p, [self.domain.ring.index[name] for name in unknown.generators])
        used = {name for coefficient in terms.values() for name in _names(coefficient)}
        if not any(any(exponents) for exponents in terms) or not all(self._known(name, state) for name in used):
            return None
        source = Source(cut.first + 1, cut.last + 1, entry, cut.outer_left, cut.outer_right)
        factor = _tidy_factor(terms)
        tidy = {exponents: factor * coefficient for exponents, coefficient in terms.items()}
        return Equation(tidy, dimension(entry), source, abs(factor))

    def _polynomial(self, number: int) -> Polynomial:
        cut, entry = self.evidence.equations[number]
        inside, around = self.pool.sides(cut)
        return inside.entry(entry) - around.entry(entry)

    def _known(self, name: str, state: State) -> bool:
        """Whether a generator is known: a constant, of the pose, or of an unknown that was found."""
        generator = self.domain.generators[self.domain.ring.index[name]]
        if generator.kind is GeneratorKind.VARIABLE:
            return generator.joint in state.slides
        if generator.kind not in (GeneratorKind.SINE, GeneratorKind.COSINE):
            return True
        g, u, v = self._angle_places[name]
        return any(part >> u & 1 and part >> v & 1 for part in state.groups[g])

    def _owner(self, name: str) -> Unknown | None:
        """The unknown of a generator."""
        return next((unknown for unknown in self._all_unknowns() if name in unknown.generators), None)

    @cached_property
    def _angle_places(self) -> Mapping[str, tuple[int, int, int]]:
        """The group and the links of each cosine and sine."""
        angles = [unknown for unknown in self._all_unknowns() if unknown.is_angle]
        return {name: self._ends(unknown) for unknown in angles for name in unknown.generators}

    def _rewritten(self, p: Polynomial, state: State, unknown: Unknown) -> Polynomial:
        """A polynomial with all angles of a group between parts that are known, counted from one of the unknown's.

        What does not occur after all drops out then, for the angles between the parts are independent.
        """
        domain, ring = self.domain, self.domain.ring
        g, *ends = self._ends(unknown) if unknown.is_angle else (-1,)
        degrees, images, changed = p.degrees(), list(ring.context.gens()), False
        for name, (group, u, v) in self._angle_places.items():
            if not degrees[ring.index[name]] or name in unknown.generators:
                continue
            homes = [next(part for part in state.groups[group] if part >> k & 1) for k in (u, v)]
            if homes[0] == homes[1]:
                continue
            kept = ends if group == g else []
            first, last = (next((k for k in kept if home >> k & 1), _lowest(home)) for home in homes)
            root = ends[0] if group == g else _lowest(state.groups[group][0])
            turn = domain.turn(group, u, first)
            for a, b in ((first, root), (root, last), (last, v)):
                turn = turned(turn, domain.turn(group, a, b))
            other = domain.unknown(*domain.groups[group][u:v])
            value = turn[0] if name == other.generators[0] else self._sign(other, forwards=True) * turn[1]
            images[ring.index[name]], changed = value.raw, True
        return ring.wrap(p.raw.compose(*images)) if changed else p

    def _cost(self, formula: Formula) -> int:
        """Operations of the coefficients, and of sums of angles that have no node yet."""
        operations = sum(_operations(horner(p)) for e in formula.equations for p in e.terms.values())
        used = _names_of_formula(formula)
        missing = {u for u in self._all_unknowns() if u not in self.homes and used & set(u.generators)}
        mixed = len({(e.source.first, e.source.last, e.source.entry[0], e.dimension) for e in formula.equations}) - 1
        return operations + 6 * len(missing) + 6 * mixed


def _lowest(part: int) -> int:
    """The first link of a set."""
    return (part & -part).bit_length() - 1


def _operations(plan: Plan) -> int:
    if isinstance(plan, Fraction):
        return 0
    _, quotient, rest = plan
    return (quotient not in (1, -1)) + _operations(quotient) + (rest != 0) + _operations(rest)


def _tidy_factor(terms: Mapping[Exponents, Polynomial]) -> Fraction:
    """What makes the numbers of an equation whole and most coefficients of its unknown positive."""
    numbers = [coefficient for p in terms.values() for _, coefficient in p.terms()]
    common = Fraction(gcd(*(x.numerator for x in numbers)), lcm(*(x.denominator for x in numbers)))
    signs = [1 if coefficient > 0 else -1 for e, p in terms.items() if any(e) for _, coefficient in p.terms()]
    return 1 / common if sum(signs) >= 0 else -1 / common


def _names(p: Polynomial) -> set[str]:
    return {name for name, degree in zip(p.ring.names, p.degrees(), strict=True) if degree}


def _names_of_formula(formula: Formula) -> set[str]:
    return {name for equation in formula.equations for p in equation.terms.values() for name in _names(p)}


def _is_short(p: Polynomial) -> bool:
    """Whether a polynomial is a number, or plus or minus one generator."""
    if p.is_constant:
        return True
    (exponents, coefficient), *others = p.terms()
    return not others and sum(exponents) == 1 and abs(coefficient) == 1


def _as_matrix(rows: Sequence[Sequence[Polynomial]]) -> Matrix[Polynomial]:
    a, b, c = ((row[0], row[1], row[2]) for row in rows)
    return (a, b, c)


def _baked(robot: Robot) -> dict[str, Expression]:
    """The numbers of the parameters that are no arguments of generated functions."""
    found: dict[str, Expression] = {}
    for name, value in robot.parameters:
        if name not in robot.runtime:
            found[name] = substitute(value, found)
    return {name: value for name, value in found.items() if not any(True for _ in names(value))}


def _with_numbers(robot: Robot, numbers: Mapping[str, Expression]) -> Robot:
    """The arm alone, with numbers in place of some names."""

    def _cell(e: Expression) -> Expression:
        return substitute(e, numbers)

    def _joint(joint: Joint) -> Joint:
        return replace(joint, theta=_cell(joint.theta), d=_cell(joint.d), a=_cell(joint.a), alpha=_cell(joint.alpha))

    base, tool = (tuple(tuple(map(_cell, row)) for row in matrix) for matrix in (robot.base, robot.tool))
    joints = tuple(map(_joint, robot.joints))
    return replace(robot, joints=joints, base=base, tool=tool, links=(), gravity=None)


def solve(robot: Robot, task: Task | None = None, given: Sequence[int] | None = None) -> SolutionGraph:
    """The graph of all solutions of an arm.

    Args:
        robot: The robot.
        task: The rows of the task; default as the file says.
        given: Indices of the joints that are arguments; default as the file says, else as many as there are too many.

    Returns:
        The graph; where there is none, `SolutionGraph.why_not` says so.

    Raises:
        QuantityError: Joints that are given leave others that move the arm without moving its end.
    """
    task = robot.inverse.task if task is None else task
    if given is None and robot.inverse.given is not None:
        given = [k for k, joint in enumerate(robot.joints) if joint.variable in robot.inverse.given]
    if robot.n > MAX_JOINTS:
        return refusal(robot, task, tuple(given or ()), f"an arm of more than {MAX_JOINTS} joints")
    freedom = Freedom(robot, task)
    if given is not None:
        freedom.check(given)
    choices = [tuple(given)] if given is not None else list(freedom.choices())[:_TRIED]
    wanted = sum(FREEDOMS.get(row, 1) for row in task)
    for arm in (robot, _with_numbers(robot, _baked(robot))):
        with suppress(CoincidenceError):
            return _solved(arm, task, choices, wanted - freedom.rank)
    return refusal(robot, task, choices[0], "parameters whose numbers coincide with what no symbol says")


class CoincidenceError(Exception):
    """An equation that is as short as it seems for the numbers of the parameters alone, not for all of them."""


def _solved(robot: Robot, task: Task, choices: Sequence[tuple[int, ...]], missing: int) -> SolutionGraph:
    """The graph of an arm by the simplest way that leads anywhere, with its conditions and count."""
    for way, deep in ((Derivation.graph, False), (Derivation.graph, True), (Derivation.graph_by_pairs, False)):
        for choice in choices:
            derivation = Derivation(robot, task, choice, deep=deep)
            graph = way(derivation)
            if graph is not None:
                graph = derivation.with_conditions(graph, missing)
                return counted(graph, derivation.sampled, derivation.numbers)
    general = Derivation(robot, task, choices[0]).general_graph()
    if general is not None:
        return general
    reason = "no order of the joints in which each follows by itself from the pose and the joints before it"
    return refusal(robot, task, choices[0], reason)


def refusal(robot: Robot, task: Task, given: Sequence[int], reason: str) -> SolutionGraph:
    """A graph without nodes.

    Args:
        robot: The robot.
        task: The rows of the task.
        given: Indices of the joints that are arguments.
        reason: Why there is no closed form.
    """
    plain, shifts = shifted(_with_numbers(robot, {}))
    domain = InverseDomain(plain)
    reach = square_reach(plain, domain)
    return SolutionGraph(plain, domain, task, tuple(given), (), reach, (), shifts, why_not=reason)


def square_reach(robot: Robot, domain: InverseDomain) -> Polynomial:
    """The squares of all lengths of the table and of the position.

    Args:
        robot: The robot.
        domain: Its ring.
    """
    cells = [cell for joint in robot.joints for cell in (joint.a, joint.d)]
    cells += [row[3] for matrix in (robot.base, robot.tool) for row in matrix[:3]]
    lengths = [domain.constant(cell) for cell in cells] + [domain.ring.generator(f"T[{k},4]") for k in (1, 2, 3)]
    return sum((x * x for x in lengths), domain.ring.zero)


class Freedom:
    """Which joints move the end effector in the sense of a task, by ranks modulo a prime at a random configuration.

    Args:
        robot: The robot.
        task: The rows of the task.
    """

    def __init__(self, robot: Robot, task: Task) -> None:
        numbers = _baked(robot)
        self.robot = _with_numbers(shifted(_with_numbers(robot, numbers))[0], numbers)
        domain = InverseDomain(self.robot)
        residues = ResidueDomain(domain, 1, seed=3)
        chain = build_chain(self.robot, residues)
        rotation = forward_kinematics(chain).rotation
        columns = list(zip(*jacobian(chain), strict=True))
        rows = []
        for i, j in (place for row in task for place in ROWS[row]):
            moved = [v[i - 1] if j == 4 else cross(v[3:], column(rotation, j - 1))[i - 1] for v in columns]
            rows.append([int(np.broadcast_to(x.values, (1, 1))[0, 0]) for x in moved])
        self._table, self._prime = np.array(rows, dtype=np.int64), residues.prime
        self.rank = self._rank(range(robot.n))
        links = Links(self.robot, residues, lambda k, _: self._motion(chain.joints[k]))
        self._pool = Pool(links, identity_atoms(links, deep=False))

    def _motion(self, joint: ChainJoint[Residue]) -> tuple[Residue, ...]:
        return (joint.cosine, joint.sine) if joint.revolute else (joint.offset,)

    def _rank(self, joints: Iterable[int]) -> int:
        return len(echelon(self._table[:, list(joints)], self._prime)[0])

    def check(self, given: Sequence[int]) -> None:
        """Refuse given joints that leave others free.

        Args:
            given: Their indices.

        Raises:
            QuantityError: The others move the arm without moving its end.
        """
        rest = [k for k in range(self.robot.n) if k not in given]
        if self._rank(rest) == len(rest):
            return
        variables = [joint.variable for joint in self.robot.joints]
        more = [variables[k] for k in rest if self._rank([j for j in rest if j != k]) == self._rank(rest)]
        count = len(rest) - self._rank(rest)
        raise QuantityError(
            f"with {listed([variables[k] for k in given]) or 'no joint'} given the others are not determined",
            allowed=f"{count} joint{'s' if count > 1 else ''} more to be given of {listed(more)}",
        )

    def choices(self) -> Iterator[tuple[int, ...]]:
        """Which joints may be given so that the task determines the others, the usual choice first.

        With a shoulder and a wrist of three axes through one point each, seven joints have their elbow's swivel as
        third joint; else the last joints are given.
        """
        n, extra = self.robot.n, self.robot.n - self.rank
        sets = sorted(combinations(range(n), extra), key=lambda joints: tuple(-k for k in reversed(joints)))
        if extra == 1 and n == 7 and self._meet(0) and self._meet(4):
            sets.sort(key=lambda joints: joints != (2,))
        for joints in sets:
            rest = [k for k in range(n) if k not in joints]
            if self._rank(rest) == len(rest):
                yield joints

    def _meet(self, first: int) -> bool:
        """Whether the axes of three joints meet in one point."""
        if not all(joint.is_revolute for joint in self.robot.joints[first : first + 3]):
            return False
        position = self._pool.inside(first, first + 2).position
        return not any(np.any(x.values) for x in position)
