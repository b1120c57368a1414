"""From a robot to the graph of its solutions: which joints are given, which way leads to a graph, how many there are.

The configurations of an arm form one irreducible variety, and so do pairs of configuration and pose: the number of
complex solutions over a generic reachable pose is one number. Every solution passes through all nodes, for their
equations hold at all of them; so there are at most as many as leaves. Run over integers modulo a prime at poses that
the arm reaches, the leaves that lead back to the pose are counted: all of them are there as soon as every square root
of the graph has a value, which is so at one of many poses. Graphs with quartics are run over the complex numbers.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from itertools import combinations
from typing import Any

import numpy as np

from derive.algebra.residues import ResidueDomain, echelon
from derive.errors import QuantityError, listed
from derive.inverse.closed.fields import ComplexField, PrimeField
from derive.inverse.closed.formulas import CoincidenceError, GraphDerivation
from derive.inverse.closed.graph import GraphWalk, Leaf, SolutionGraph, pose_of
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.closed.pool import Links, Pool, frame_atoms
from derive.inverse.closed.unknowns import InverseDomain, baked, shifted, with_numbers
from derive.mechanics.chain import build_chain
from derive.mechanics.forward_kinematics import forward_kinematics, jacobian
from derive.mechanics.vectors import column, cross, subtract
from derive.robot.evaluate import to_float
from derive.robot.expression import ZERO, Expression
from derive.robot.names import free_symbols
from derive.robot.options.inverse import FREEDOMS, ROWS, TASKS, InverseOptions, Task
from derive.robot.robot import Robot

MAX_JOINTS = 10  # longer arms are solved by numbers alone
_TRIED = 4  # choices of given joints that are tried where the file makes none
# Graphs that are kept for those who ask for them again: print, programs and figures of one arm have the same.
_KEPT = 64
_COUNTED = 3  # poses at which leaves are counted
_COMPLEX = 9  # complex poses at which leaves are counted; a few of them may be too ill-conditioned to tell
_CLOSES = 1e-6  # complex leaves that miss the pose by more than this part of its size do not lead there
_SAMPLES = 512  # poses modulo a prime: with seven independent square roots four of them have them all


def solve(robot: Robot, task: Task | None = None, given: Sequence[int] | None = None) -> SolutionGraph:
    """The graph of all solutions of an arm."""
    task = robot.inverse.task if task is None else task
    if isinstance(task, str) or not task or not set(task) <= set(ROWS):
        raise QuantityError(f"the task {task!r} is not valid", allowed=f"allowed: a tuple of {listed(ROWS)}")
    if given is not None and not set(given) <= set(range(robot.n)):
        found = f"the given joints {list(given)!r} are not valid"
        raise QuantityError(found, allowed=f"allowed: indices from 0 to {robot.n - 1}")
    if given is None and robot.inverse.given is not None:
        given = [k for k, joint in enumerate(robot.joints) if joint.variable in robot.inverse.given]
    if robot.n > MAX_JOINTS:
        return refusal(robot, task, tuple(given or ()), f"the arm has more than {MAX_JOINTS} joints")
    try:
        return _derived(robot, tuple(task), None if given is None else tuple(sorted(set(given))))
    except QuantityError as error:
        location = robot.inverse.location
        raise error if location is None else error.at(location) from None


@lru_cache(_KEPT)
def _derived(robot: Robot, task: Task, given: tuple[int, ...] | None) -> SolutionGraph:
    freedom = Freedom(robot, task)
    if not freedom.rank:
        rows = [row for row in ROWS if row not in task and Freedom(robot, (row,)).rank]
        found = f"no joint changes the task {listed(task)}"
        raise QuantityError(found, allowed=f"allowed: {listed(rows)}" if rows else "")
    if given is not None:
        freedom.check(given)
    choices = [given] if given is not None else list(freedom.choices())[:_TRIED]
    for arm in (robot, with_numbers(robot, baked(robot))):
        with suppress(CoincidenceError):
            graph = _solved(arm, task, choices, freedom.wanted - freedom.rank)
            return replace(graph, everywhere=graph.complete and freedom.fills(graph.given))
    return refusal(robot, task, choices[0], "the formulas hold for special numbers of the parameters only")


def usual_task(robot: Robot) -> Task:
    """The task by which textbooks solve an arm: its file's, or of two or three joints as many coordinates."""
    if robot.inverse != InverseOptions() or robot.n not in (2, 3):
        return robot.inverse.task
    moved = tuple(row for row in TASKS["position"] if Freedom(robot, (row,)).rank)
    return moved if len(moved) == robot.n == Freedom(robot, moved).rank else robot.inverse.task


def _solved(robot: Robot, task: Task, choices: Sequence[tuple[int, ...]], missing: int) -> SolutionGraph:
    """The graph of an arm by the simplest way that leads anywhere, with its conditions and count."""
    by_one, by_pairs = GraphDerivation.graph, GraphDerivation.graph_by_pairs
    for way, deep in ((by_one, False), (by_one, True), (by_pairs, False)):
        for choice in choices:
            derivation = GraphDerivation(robot, task, choice, deep=deep)
            if (graph := way(derivation)) is not None:
                return counted(derivation.with_conditions(graph, missing), derivation.sampled, derivation.numbers)
    general = GraphDerivation(robot, task, choices[0]).general_graph()
    return general or refusal(robot, task, choices[0], "the joints cannot be solved for one after the other")


def refusal(robot: Robot, task: Task, given: Sequence[int], reason: str) -> SolutionGraph:
    """A graph without nodes."""
    plain, shifts = shifted(with_numbers(robot, {}))
    domain = InverseDomain(plain)
    return SolutionGraph(plain, domain, task, tuple(given), (), domain.square_reach, (), shifts, why_not=reason)


def counted(graph: SolutionGraph, sampled: InverseDomain, numbers: Mapping[str, Expression]) -> SolutionGraph:
    """A graph with the number of its solutions."""
    # joint variables are counted from where their cells have no constants: an angle has no value modulo a prime
    graph, original = replace(graph, shifts=(ZERO,) * graph.robot.n), graph
    has_quartic = any(node.kind is NodeKind.CONIC for node in graph.nodes)
    count = (0 if has_quartic else _modulo_prime(graph, sampled, numbers)) or _over_complex(graph, numbers)
    return replace(original, count=count, complete=count > 0)


def _modulo_prime(graph: SolutionGraph, sampled: InverseDomain, numbers: Mapping[str, Expression]) -> int:
    """The number of leaves that lead to the pose; 0 where some square root is missing at every sample."""
    residues = ResidueDomain(sampled, _SAMPLES, seed=2)
    field = PrimeField(residues, numbers)
    frame = forward_kinematics(build_chain(sampled.robot, residues))
    pose = [[*frame.rotation[i], frame.position[i]] for i in range(3)]
    given = []
    for k in graph.given:
        if (row := sampled.robot.joints[k]).is_revolute:
            given.append(field.angle(*map(residues.value, sampled.cosine_sine_of(k))))
        else:
            given.append(residues.value(sampled.ring.generator(row.variable)))
    run = GraphWalk(graph, field, pose, given)
    leaves = list(run.leaves())
    everything = np.ones((_SAMPLES, 1), dtype=bool)
    for leaf in leaves:
        everything &= leaf.exists
    good = np.flatnonzero(everything[:, 0])
    if not good.size:
        return 0
    closing = []
    for leaf in leaves:
        closes = everything.copy()
        for miss in misses(run, leaf):
            closes &= miss.values == 0
        flat = [np.broadcast_to(x.values, (_SAMPLES, 1))[:, 0] for own in leaf.joints for x in own]
        closing.append((closes[:, 0], np.stack(flat, axis=1)))
    # Of leaves that lead to the pose each different one counts.
    return max(len({tuple(leaf[k].tolist()) for closes, leaf in closing if closes[k]}) for k in good[:_COUNTED])


def _over_complex(graph: SolutionGraph, numbers: Mapping[str, Expression]) -> int:
    """The number of leaves that lead to random complex poses; 0 where it is not the same at most of them."""
    rng = np.random.default_rng(4)
    values: dict[str, Fraction | float] = {name: to_float(value, {}) for name, value in numbers.items()}
    values |= {name: float(rng.uniform(0.3, 1)) for name in free_symbols(graph.robot) if name not in values}
    field = ComplexField(values)
    angles = rng.uniform(-3, 3, (graph.robot.n, _COMPLEX)) + 1j * rng.uniform(-0.4, 0.4, (graph.robot.n, _COMPLEX))
    rows = zip(graph.robot.joints, angles, strict=True)
    joints = [(np.cos(q), np.sin(q)) if joint.is_revolute else (q,) for joint, q in rows]
    start: GraphWalk[Any, Any] = GraphWalk(graph, field, [])
    frame = pose_of(start, joints)
    pose = [[*frame.rotation[i], frame.position[i]] for i in range(3)]
    run: GraphWalk[Any, Any] = GraphWalk(graph, field, pose, [angles[k] for k in graph.given])
    solutions: list[list[Any]] = [[] for _ in range(_COMPLEX)]
    size = max(float(np.max(np.abs(x))) for row in pose for x in row)
    for leaf in run.leaves():
        miss = np.maximum.reduce([np.abs(x) + np.zeros(_COMPLEX) for x in misses(run, leaf)])
        flat = np.stack([np.broadcast_to(x, (_COMPLEX,)) for own in leaf.joints for x in own])
        for k in np.flatnonzero(miss < _CLOSES * size):
            if all(np.abs(flat[:, k] - other).max() > _CLOSES for other in solutions[k]):
                solutions[k].append(flat[:, k])
    counts = sorted(len(found) for found in solutions)
    middle = counts[len(counts) // 2]
    return middle if counts.count(middle) > len(counts) // 2 else 0


def misses(run: GraphWalk[Any, Any], leaf: Leaf[Any, Any]) -> list[Any]:
    """What a leaf misses of the wanted entries, and of c^2 + s^2 = 1: a pose may be right with pairs of no angle."""
    again = pose_of(run, leaf.joints)
    rows = [[*again.rotation[i], again.position[i]] for i in range(3)]
    missed = [rows[i][j] - run.pose[i][j] for i, j in run.graph.places]
    return missed + [pair[0] * pair[0] + pair[1] * pair[1] - 1 for pair in leaf.joints if len(pair) == 2]


class Freedom:
    """Which joints move the end effector in the sense of a task, by ranks modulo a prime at a random configuration."""

    def __init__(self, robot: Robot, task: Task) -> None:
        numbers = baked(robot)
        self.robot = with_numbers(shifted(with_numbers(robot, numbers))[0], numbers)
        residues = ResidueDomain(InverseDomain(self.robot), 1, seed=3)
        chain = build_chain(self.robot, residues)
        rotation = forward_kinematics(chain).rotation
        columns = list(zip(*jacobian(chain), strict=True))
        rows = []
        for i, j in (place for row in task for place in ROWS[row]):
            # Velocity of an entry of T by each joint: that of the origin, or omega x the column of R.
            moved = [v[i - 1] if j == 4 else cross(v[3:], column(rotation, j - 1))[i - 1] for v in columns]
            rows.append([int(x.values.item()) for x in moved])
        self._table, self._prime = np.array(rows, dtype=np.int64), residues.prime
        self.wanted = sum(FREEDOMS.get(row, 1) for row in task)
        self._twists = [[int(x.values.item()) for x in v] for v in columns]
        self.rank = self._rank(range(robot.n))
        motions = [(joint.cosine, joint.sine) if joint.revolute else (joint.offset,) for joint in chain.joints]
        links = Links(self.robot, residues, lambda k, _: motions[k])
        self._pool = Pool(links, frame_atoms(links.unit, links.zero, deep=False))

    def _rank(self, joints: Iterable[int]) -> int:
        return len(echelon(self._table[:, list(joints)], self._prime)[0])

    def check(self, given: Sequence[int]) -> None:
        """Refuse given joints that leave others free."""
        rest = [k for k in range(self.robot.n) if k not in given]
        if self._rank(rest) == len(rest):
            return
        variables = [joint.variable for joint in self.robot.joints]
        more = [variables[k] for k in rest if self._rank([j for j in rest if j != k]) == self._rank(rest)]
        count = len(rest) - self._rank(rest)
        known = f" with {listed([variables[k] for k in given])} given" if given else ""
        found = f"the task does not determine all joints{known}"
        raise QuantityError(found, remedy=f"give {count} more of {listed(more)}")

    def fills(self, given: Sequence[int]) -> bool:
        """Whether no pose has more isolated solutions than a generic one, as far as that is proven."""
        twists = [own for k, own in enumerate(self._twists) if k not in given]
        return len(twists) == self.wanted or (self.wanted == 6 and self._stand_alone(twists))

    def _stand_alone(self, twists: Sequence[Sequence[int]]) -> bool:
        """Whether no pose of joints with these twists has more isolated solutions than a generic one."""
        # So it is where the joints map onto a smooth variety of their own dimension, by Zariski's main theorem
        # (Hartshorne, Algebraic Geometry, III.11.4): onto a group of motions, whose Lie algebra the twists generate; of
        # two joints, whose motions are equal at rest alone; and where the first or last joint has one value at each
        # pose, because none of its motions is one of the group of the others. Where other arms reach, poses may meet.
        if len(twists) <= 2 or len(self._generated(twists)) == len(twists):
            return True
        # A first or last joint outside of the group of the others has one value at each pose: it may be left out.
        for one, rest in ((twists[0], twists[1:]), (twists[-1], twists[:-1])):
            group = self._generated(rest)
            if len(self._basis([*group, one])) > len(group) and self._stand_alone(rest):
                return True
        return False

    def _generated(self, twists: Sequence[Sequence[int]]) -> list[list[int]]:
        """A basis of the Lie algebra of some twists, velocities of a point before angular velocities."""
        basis, before = self._basis(twists), 0
        while before < len(basis):
            before, brackets = len(basis), []
            for a, b in combinations(basis, 2):  # closed under Lie brackets
                (va, wa), (vb, wb) = (((x[0], x[1], x[2]), (x[3], x[4], x[5])) for x in (a, b))
                brackets.append([x % self._prime for x in (*subtract(cross(wa, vb), cross(wb, va)), *cross(wa, wb))])
            basis = self._basis([*basis, *brackets])
        return basis

    def _basis(self, twists: Sequence[Sequence[int]]) -> list[list[int]]:
        return list(echelon(np.array(twists, dtype=np.int64), self._prime)[1].tolist())

    def choices(self) -> Iterator[tuple[int, ...]]:
        """Which joints may be given so that the task determines the others, the usual choice first."""
        # With a shoulder and a wrist of three axes through one point each, seven joints have their elbow's swivel as
        # third joint; else the last joints are given.
        n, extra = self.robot.n, self.robot.n - self.rank
        sets = sorted(combinations(range(n), extra), key=lambda joints: tuple(-k for k in reversed(joints)))
        if extra == 1 and n == 7 and self.meet(0) and self.meet(4):
            sets.sort(key=lambda joints: joints != (2,))
        for joints in sets:
            rest = [k for k in range(n) if k not in joints]
            if self._rank(rest) == len(rest):
                yield joints

    def meet(self, first: int) -> bool:
        """Whether the axes of three joints meet in one point."""
        if not all(joint.is_revolute for joint in self.robot.joints[first : first + 3]):
            return False
        return not any(np.any(x.values) for x in self._pool.inside(first, first + 2).position)
