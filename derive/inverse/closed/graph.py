"""A solution of the inverse kinematics as a graph of nodes, and the one interpreter of such graphs.

Every node solves for one unknown (or a few) from equations whose coefficients are polynomials of what is known: the
pose, the geometry, and the cosines, sines and lengths of the nodes before it.

Angles come last, so one walk serves every kind of number: arrays of floats, complex numbers, integers modulo a prime,
symbols, and the values of a program that is being written (`derive.inverse.closed.elementary_solver.Field`).

A node is evaluated once for every combination of the branches that it really depends on: theta_3 of a PUMA does not
depend on theta_1, so that both together cost two evaluations and have four values.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from itertools import product
from math import prod
from typing import Generic

from derive.algebra.domain import MappedDomain
from derive.algebra.ring import Polynomial
from derive.inverse.closed.elementary_solver import ILL, Branch, Field, M, N, Solver
from derive.inverse.closed.nodes import NodeEquation, NodeFormula, NodeKind, Unknown
from derive.inverse.closed.unknowns import InverseDomain, turned
from derive.mechanics.chain import build_chain
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.mechanics.vectors import Frame
from derive.robot.description import Joint
from derive.robot.expression import Expression
from derive.robot.options.inverse import FREEDOMS, ROWS, Task
from derive.robot.robot import Robot

SPECIAL = 4  # isolated solutions at special poses of arms with few joints, where a generic pose has one or two
Plan = Fraction | tuple[int, "Plan", "Plan"]  # a number, or generator * plan + plan


@dataclass(frozen=True)
class Node:
    """One step of a solution."""

    index: int  # its place in the graph
    unknowns: tuple[Unknown, ...]  # what it solves for; more than one for general nodes alone
    formulas: tuple[NodeFormula, ...]  # the chosen one, then others for poses where its leading coefficients vanish
    needs: tuple[int, ...] = ()  # indices of the nodes whose unknowns occur in its formulas
    branches: int = 1  # how many values it has at most for one combination of values of what it needs

    @property
    def unknown(self) -> Unknown:
        """Its only, or first, unknown."""
        return self.unknowns[0]

    @property
    def kind(self) -> NodeKind:
        """The elementary type of the chosen formula."""
        return self.formulas[0].kind


@dataclass(frozen=True, eq=False)
class SolutionGraph:
    """How the joints of one arm follow from the pose."""

    robot: Robot  # the arm
    domain: InverseDomain  # the ring of all polynomials: pose, parameters, cosines, sines and lengths of unknowns
    task: Task  # which numbers of the pose are wanted, rows of `ROWS`
    given: tuple[int, ...]  # indices of the joints that are arguments
    # Generators of the pose that are computed before any node, in order: name -> polynomial of the entries of T and
    # of those before it. An entry of T itself is named ``T[row,column]``.
    definitions: tuple[tuple[str, Polynomial], ...]
    square_reach: Polynomial  # the sum of the squares of all lengths of table and pose: the scale of what is zero
    nodes: tuple[Node, ...]  # in an order in which each needs only nodes before it
    shifts: tuple[Expression, ...]  # the constant angle or length by which each joint's unknown exceeds its variable
    conditions: tuple[NodeEquation, ...] = ()  # what holds at every reachable pose of fewer than six joints
    count: int = 0  # number of complex solutions of a generic reachable pose; 0 where it is not known
    complete: bool = False  # whether that number is certain
    everywhere: bool = False  # whether no pose has more isolated ones, for certain (`solve.Freedom.fills`)
    why_not: str = ""  # why there is no closed form; empty where there is one
    to_end: bool = False  # whether the last matrix ends at the end effector, whose orientation is not told
    from_base: bool = False  # whether the first one begins in the world, for some rows of a turned base

    @property
    def is_closed(self) -> bool:
        """Whether there is a graph at all."""
        return not self.why_not

    @cached_property
    def axes(self) -> tuple[tuple[int, ...], ...]:
        """For each node the nodes with several branches before it that its values depend on, in order."""
        found: list[tuple[int, ...]] = []
        for node in self.nodes:
            choices = {need for need in node.needs if self.nodes[need].branches > 1}
            found.append(tuple(sorted(choices.union(*(found[need] for need in node.needs)))))
        return tuple(found)

    @property
    def choices(self) -> tuple[int, ...]:
        """The nodes with several branches."""
        return tuple(node.index for node in self.nodes if node.branches > 1)

    @property
    def leaves(self) -> int:
        """The product of the numbers of branches at poses where the chosen formulas serve."""
        return prod(node.formulas[0].branches for node in self.nodes)

    @property
    def slots(self) -> int:
        """The product of the numbers of branches, those included that only formulas for special poses have."""
        return prod(node.branches for node in self.nodes)

    @property
    def spare(self) -> int:
        """For how many solutions of special poses there is room beside the branches."""
        return 0 if self.everywhere or not self.is_short else max(0, SPECIAL - self.slots)

    @property
    def is_short(self) -> bool:
        """Whether there are fewer joints than the task has dimensions."""
        return self.robot.n - len(self.given) < sum(FREEDOMS.get(row, 1) for row in self.task)

    @property
    def places(self) -> tuple[tuple[int, int], ...]:
        """The entries of T that the task gives, row and column from 0."""
        return tuple((i - 1, j - 1) for row in self.task for i, j in ROWS[row])


@dataclass(frozen=True)
class Value(Generic[N, M]):
    """What a node yields on one branch."""

    numbers: tuple[tuple[N, ...], ...]  # for each unknown its cosine and sine, or its length
    exists: M  # whether the branch exists
    free: M  # whether no equation determines the unknown at this pose
    boundary: M  # whether two branches coincide
    ill: M  # whether it is ill-conditioned
    doubt: M  # whether rounding decides if it exists, or the nodes after it


@dataclass(frozen=True)
class Leaf(Generic[N, M]):
    """One solution."""

    joints: tuple[tuple[N, ...], ...]  # of each joint's variable plus its shift: cosine and sine, or length
    exists: M  # whether all its nodes exist
    free: tuple[M, ...]  # for each joint whether its node was not determined
    boundary: M  # whether some branches coincide
    ill: M  # whether digits are lost in one of its nodes: if the solution exists it is to be checked
    doubt: M  # whether rounding decides if it exists: if it does not, it is to be looked for nearby


class GraphWalk(Generic[N, M]):
    """One walk over a graph; joints that no equation determines have values ``near``, zero where there are none."""

    def __init__(
        self,
        graph: SolutionGraph,
        field: Field[N, M],
        pose: Sequence[Sequence[N]],
        given: Sequence[N] = (),
        near: Sequence[N] | None = None,
    ) -> None:
        self.graph, self.field, self.pose = graph, field, pose
        self.given, self.near = given, near
        self.known: dict[str, N] = {}
        self._constant = cache(lambda index: field.constant(graph.domain.generators[index].expression))
        self.results: list[dict[tuple[int, ...], list[Value[N, M]]]] = []

    def leaves(self) -> Iterator[Leaf[N, M]]:
        """Every combination of branches, in order; last those that only formulas for special poses have."""
        for i, row in enumerate(self.pose[:3], start=1):
            self.known.update({f"T[{i},{j}]": value for j, value in enumerate(row, start=1)})
        for name, polynomial in self.graph.definitions:
            self.known[name] = self.evaluate(polynomial, self.known)
        self.reach = self.field.sqrt(self.evaluate(self.graph.square_reach, self.known))
        for node in self.graph.nodes:
            self._visit(node)
        graph = self.graph
        found = {u.joints: (node.index, k) for node in graph.nodes for k, u in enumerate(node.unknowns)}
        homes = [found[(i,)] for i in range(graph.robot.n)]
        usual = [graph.nodes[i].formulas[0].branches for i in graph.choices]
        every = product(*(range(graph.nodes[i].branches) for i in graph.choices))
        for branches in sorted(every, key=lambda own: any(k >= most for k, most in zip(own, usual, strict=True))):
            chosen = dict(zip(graph.choices, branches, strict=True))
            values = [self._value(node, chosen) for node in graph.nodes]
            # A leaf is a product of choices: it exists where all its nodes do.
            exists, boundary = self.field.truth(True), self.field.truth(False)
            ill = doubt = boundary
            for value in values:
                exists, boundary = exists & value.exists, boundary | value.boundary
                ill, doubt = ill | value.ill, doubt | value.doubt
            joints = tuple(values[home].numbers[k] for home, k in homes)
            yield Leaf(joints, exists, tuple(values[home].free for home, _ in homes), boundary, ill, doubt)

    def angles(self, leaf: Leaf[N, M]) -> tuple[N, ...]:
        """The joint variables of a solution: angles in (-pi, pi] less their shifts, lengths, and what was given."""
        plain = (self.field.angle(*numbers) if len(numbers) == 2 else numbers[0] for numbers in leaf.joints)
        shifts = map(self.field.constant, self.graph.shifts)
        found = [value - shift for value, shift in zip(plain, shifts, strict=True)]
        for place, number in zip(self.graph.given, self.given, strict=True):
            found[place] = number
        return tuple(found)

    def evaluate(self, p: Polynomial, values: Mapping[str, N]) -> N:
        """The number of a polynomial, by Horner's rule in its most frequent generator."""
        return self._horner(horner(p), values)

    def _visit(self, node: Node) -> None:
        axes = self.graph.axes[node.index]
        table: dict[tuple[int, ...], list[Value[N, M]]] = {}
        no = self.field.truth(False)
        self.results.append(table)
        for branches in product(*(range(self.graph.nodes[axis].branches) for axis in axes)):
            chosen = dict(zip(axes, branches, strict=True))
            scope = dict(self.known)
            for known in map(self.graph.nodes.__getitem__, node.needs):
                for unknown, numbers in zip(known.unknowns, self._value(known, chosen).numbers, strict=True):
                    scope.update(zip(unknown.generators, numbers, strict=True))
            if node.kind is not NodeKind.SUM:
                table[branches] = self._solve(node, scope)
                continue
            # A sum of angles is free where one of them is.
            total: tuple[N, ...] = ()
            for part, sign in node.formulas[0].parts:
                cosine, sine = (scope[name] for name in part.generators)
                signed = (cosine, sine if sign > 0 else -sine)
                total = turned(total, signed) if total else signed
            free = no
            for need in node.needs:
                free = free | self._value(self.graph.nodes[need], chosen).free
            table[branches] = [Value((total,), self.field.truth(True), free, no, no, no)]

    def _value(self, node: Node, chosen: Mapping[int, int]) -> Value[N, M]:
        axes = self.graph.axes[node.index]
        return self.results[node.index][tuple(chosen[axis] for axis in axes)][chosen.get(node.index, 0)]

    def _solve(self, node: Node, scope: Mapping[str, N]) -> list[Value[N, M]]:
        f, yes, no = self.field, self.field.truth(True), self.field.truth(False)
        unknown, first = node.unknown, node.formulas[0]
        if node.kind is NodeKind.GENERAL:
            return [Value(numbers, exists, no, no, yes, no) for numbers, exists in f.general(first, scope)]
        if node.kind is NodeKind.GIVEN:
            return [Value((self._of_variable(unknown.joints[0], self.given),), yes, no, no, no, no)]
        # Elementary: the formulas in turn, each where those before do not determine the unknown.
        solver = Solver(f, lambda p: self.evaluate(p, scope), self.reach)
        values: list[Value[N, M]] = []
        open_ = yes
        for formula in node.formulas:
            lost = solver.degenerate(formula)
            usable = open_ & ~lost
            if not values:
                values = self._merge(node, values, usable, solver.solve(formula))
                # Leading coefficients that nearly vanish cost digits; a quartic always may.
                ill = yes if formula.kind is NodeKind.CONIC else solver.degenerate(formula, ILL)
                values = [replace(value, ill=ill | value.doubt, doubt=lost | value.doubt) for value in values]
            elif not f.never(usable):
                values = self._merge(node, values, usable, solver.solve(formula))
            open_ = open_ & lost
            if f.never(open_):
                return values
        # Where no formula serves the unknown is free, and stays where the caller has it.
        rest = self._of_variable(unknown.joints[0], self.near)
        if len(unknown.joints) > 1:
            rest = (f.number(1), f.number(0))
            for joint, sign in zip(unknown.joints, unknown.signs, strict=True):
                rest = turned(rest, self._of_variable(joint, self.near), sign)
        return [replace(value, free=open_) for value in self._merge(node, values, open_, [Branch(rest, yes, no, no)])]

    def _merge(
        self, node: Node, values: list[Value[N, M]], mask: M, found: Sequence[Branch[N, M]]
    ) -> list[Value[N, M]]:
        """The values where a mask holds replaced by others; branches that these lack do not exist there."""
        f, no = self.field, self.field.truth(False)
        if not values:
            values = [Value((b.numbers,), b.exists, no, b.boundary, no, b.doubt) for b in found]
            return [*values, *[Value(values[0].numbers, no, no, no, no, no)] * (node.branches - len(values))]
        merged = []
        for k, old in enumerate(values):
            new = found[min(k, len(found) - 1)]
            exists = new.exists & mask if k < len(found) else no
            # where a branch is none its numbers are of no account; opposite ones share the angle of the first
            given = new.numbers if k < len(found) else tuple(-number for number in new.numbers)
            numbers = tuple(f.select(mask, a, b) for a, b in zip(given, old.numbers[0], strict=True))
            exists = exists | (old.exists & ~mask)
            boundary = (new.boundary & mask) | (old.boundary & ~mask)
            merged.append(Value((numbers,), exists, no, boundary, old.ill, old.doubt))
        return merged

    def _of_variable(self, joint: int, values: Sequence[N] | None) -> tuple[N, ...]:
        """Cosine and sine, or length, of a joint whose variable has a number; zero where there is none."""
        graph, shift = self.graph, self.field.constant(self.graph.shifts[joint])
        place = graph.given.index(joint) if values is self.given else joint
        number = shift if values is None else values[place] + shift
        return self.field.cosine_sine(number) if graph.robot.joints[joint].is_revolute else (number,)

    def _horner(self, plan: Plan, values: Mapping[str, N]) -> N:
        if isinstance(plan, Fraction):
            return self.field.number(plan)
        index, quotient, rest = plan
        name = self.graph.domain.ring.names[index]
        generator: N = values[name] if name in values else self._constant(index)
        if quotient == 1 or quotient == -1:
            product_ = generator if quotient == 1 else -generator
        else:
            product_ = generator * self._horner(quotient, values)
        return product_ if rest == 0 else product_ + self._horner(rest, values)


class Posture(MappedDomain[N]):
    """An arm at one of its solutions, as scalars of the mechanics."""

    def __init__(self, run: GraphWalk[N, M], joints: Sequence[Sequence[N]]) -> None:
        super().__init__(run.graph.domain, lambda p: run.evaluate(p, {}))
        self._joints = joints

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[N, N]:
        """Cosine and sine of ``sign*q + theta``."""
        cosine, sine = self._joints[index]
        return turned((cosine, sine if joint.sign > 0 else -sine), self.cosine_sine(joint.theta))

    def joint_offset(self, index: int, joint: Joint) -> N:
        """The offset ``sign*q + d`` [m]."""
        (length,) = self._joints[index]
        return (length if joint.sign > 0 else -length) + self.constant(joint.d)


def pose_of(run: GraphWalk[N, M], joints: Sequence[Sequence[N]]) -> Frame[N]:
    """The pose of an arm at one of its solutions."""
    return forward_kinematics(build_chain(run.graph.robot, Posture(run, joints)))


@cache
def horner(p: Polynomial) -> Plan:
    """A polynomial by Horner's rule, in the generator that most of its terms have, again and again."""
    return _horner_plan(dict(p.terms()))


def _horner_plan(terms: Mapping[tuple[int, ...], Fraction]) -> Plan:
    # The generator in most terms; in equal numbers the first one, for one order on every machine.
    if not (counts := Counter(i for exponents in terms for i, e in enumerate(exponents) if e)):
        return next(iter(terms.values()), Fraction(0))
    best = max(counts, key=lambda i: (counts[i], -i))
    # p = x q + r with r free of x.
    inside = {(*x[:best], x[best] - 1, *x[best + 1 :]): k for x, k in terms.items() if x[best]}
    outside = {x: k for x, k in terms.items() if not x[best]}
    return best, _horner_plan(inside), _horner_plan(outside) if outside else Fraction(0)
