"""The loops of a robot, solved one after the other: where its passive joints are, and how they move.

Around a closed loop the velocities of all joints add up to none. With J_p and J_a the columns of passive and active
joints in as many rows as passive joints, those that no joint of the closure moves,

    J_p qd_p + J_a qd_a = 0,   G = -J_p^-1 J_a,   qd_p = G qd_a,

and once more differentiated along the loop J_p H_k + (d J/d q_k) [1; G] = 0, H_k = d G/d q_k (Khalil and Dombre,
Modeling, Identification and Control of Robots, 2002, chapter 7). G ceases to exist where det J_p = 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations
from typing import Any

import numpy as np

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial
from derive.errors import QuantityError, listed, quoted
from derive.inverse.closed.elementary_solver import Field
from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import GraphWalk, Leaf, SolutionGraph
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.closed.solve import misses, solve
from derive.inverse.loops import closing as closings
from derive.inverse.loops.circuit import Circuit, ThreeRods, circuit, point_graph, rod_graph
from derive.inverse.loops.closing import OPEN, SAMPLES, STEP, Array, Closing, IteratedLoops, Twist, iterated, refused
from derive.inverse.numeric.chain import NumericChain, Problem
from derive.inverse.numeric.newton import fit
from derive.mechanics.chain import Domain
from derive.mechanics.floats import ArrayDomain
from derive.mechanics.vectors import cross, dot
from derive.robot import tree
from derive.robot.description import Joining, Loop, coupling, derivatives, second_derivative
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.names import free_symbols
from derive.robot.robot import Robot

_DRAWS = 16  # numbers of symbols at which a loop is assembled
_TINY = 1e-300  # [m] where nothing is missing
_NEAR = 0.05  # way of a variable from one configuration that is known to the next [rad, or of all lengths together]
_ROUNDS = 4  # of Newton steps: near dead points each of them goes half of the way
_BLOCK = 256  # configurations that are compared with all that are known at once
_RANK = 1e-7  # singular values below this part of the largest are rounding


@dataclass(frozen=True, eq=False, kw_only=True)
class SolvedLoop(Closing):
    """A loop with formulas of the positions of its passive joints."""

    circuit: Circuit | ThreeRods
    graph: SolutionGraph  # of the circuit's arm
    leaf: int  # which of its leaves is the branch that the file asks for

    def walk(
        self,
        domain: Domain[Any],
        field: Field[Any, Any],
        variable: Callable[[int], Any],
        kind: type[GraphWalk[Any, Any]] = GraphWalk,
    ) -> tuple[GraphWalk[Any, Any], Leaf[Any, Any]]:
        """The solution's graph at the pose of the circuit, in a domain that knows the loops before; and its branch."""
        frame = self.circuit.pose(domain)
        pose = [[*frame.rotation[i], frame.position[i]] for i in range(3)]
        given = [variable(self.circuit.places[k]) for k in self.graph.given]
        run = kind(self.graph, field, pose, given)
        return run, list(run.leaves())[self.leaf]


@dataclass(frozen=True)
class Slopes:
    """First and second derivatives of the variables of the passive joints of one loop, numerators over det J_p."""

    determinant: Polynomial
    first: Mapping[str, Polynomial]  # by the names that they have as factors of joints that follow
    second: Mapping[str, Polynomial]  # by name; the first derivatives occur in them


@lru_cache(32)
def linkage(robot: Robot) -> tuple[Closing, ...]:
    """The solved loops of a robot, in the order of the file, those together that no elementary equations solve."""
    found: list[Closing] = []
    waiting: list[tuple[Loop, QuantityError]] = []
    for loop in robot.loops:
        known = [k for one in found for k in one.passive]
        one: Closing | QuantityError | None = waiting[0][1] if waiting else _solved(robot, loop, known)
        if isinstance(one, QuantityError):
            waiting.append((loop, one))
            bare, together = tree.bare(robot), [each for each, _ in waiting]
            one = _of_point(robot, together, found) or iterated(bare, together, known, _Before(bare, tuple(found)))
        if one is not None:
            waiting.clear()
            found.append(one)
            found[-1] = _checked(robot, found)
    if waiting:
        raise waiting[0][1]
    return tuple(found)


@lru_cache(32)
def is_iterated(robot: Robot) -> bool:
    """Whether some of its loops have no formulas."""
    return not all(isinstance(one, SolvedLoop) for one in linkage(robot))


@dataclass(frozen=True)
class _Before:
    """The loops that come before others, equal for equal tables, so that these are searched once."""

    robot: Robot
    loops: tuple[Closing, ...]

    def __call__(self, q: Sequence[Array], values: Mapping[str, float]) -> list[Array]:
        return positions(self.robot, self.loops, q, values)[0]


def _solved(robot: Robot, loop: Loop, before: Sequence[int]) -> SolvedLoop | QuantityError:
    """A loop with its formulas, or why it has none by itself."""
    unknown = {k for way in tree.around(robot, loop) for k in way if robot.joints[k].follows} - {*before}
    if not unknown:
        found, remedy = "over-constrained: loops above determine all its passive joints", "leave the loop out"
        raise refused(robot, loop, found, remedy=f"{remedy}, or write passive: true on more of its joints")
    if loop.by is Joining.DISTANCE and len(unknown) > 1:
        found = f"{listed(robot.joints[k].variable for k in sorted(unknown))} move it, and a rod determines one joint"
        return refused(robot, loop, found, remedy="write passive on one of them, or close loops of the others first")
    own = circuit(robot, loop, before, opposed=loop.by is Joining.REVOLUTE and closings.are_opposed(robot, loop))
    passive = tuple(k for k in own.places if k in unknown)
    try:
        if loop.by is Joining.DISTANCE:
            graph = rod_graph(own.arm, [not x for x in own.pose(PolynomialDomain(robot, rates=False)).position])
        else:
            graph = solve(own.arm)
    except QuantityError:  # its message is about the arm
        found = f"it does not determine {listed(robot.joints[k].variable for k in passive)}"
        return refused(robot, loop, found, remedy="write passive on fewer of them, or close more loops")
    if not graph.is_closed or any(node.kind is NodeKind.GENERAL for node in graph.nodes):
        why = graph.why_not or "an equation of higher degree remains"
        allowed = "allowed: loops whose passive joints follow from elementary equations one after the other"
        return refused(robot, loop, f"no closed form: {why}", allowed, "close loops with fewer passive joints first")
    return SolvedLoop(loops=(loop,), passive=passive, circuit=own, graph=graph, leaf=_leaf(robot, loop, graph))


def _leaf(robot: Robot, loop: Loop, graph: SolutionGraph) -> int:
    branches = [node.formulas[0].branches for node in graph.nodes if node.formulas[0].branches > 1]
    signs = loop.branch or "+" * len(branches)
    if len(signs) != len(branches) or any(count != 2 for count in branches):
        count = len(branches)
        allowed = f"allowed: {f'a sign for each of {count} choices' if count > 1 else 'one sign for 1 choice'}"
        raise refused(robot, loop, f"branch {quoted(loop.branch)}", allowed if branches else "allowed: none")
    return int("0" + signs.replace("+", "0").replace("-", "1"), 2)


def _of_point(robot: Robot, loops: Sequence[Loop], before: Sequence[Closing]) -> SolvedLoop | None:
    """Three rods to a point that three slides at right angles move; None of other loops."""
    around = [{k for way in tree.around(robot, loop) for k in way if robot.joints[k].follows} for loop in loops]
    passive = sorted({k for own in around for k in own} - {k for one in before for k in one.passive})
    if len(loops) != 3 or len(passive) != 3 or any(loop.by is not Joining.DISTANCE for loop in loops):
        return None
    if any(robot.joints[k].is_revolute for k in passive) or any(not own.issuperset(passive) for own in around):
        return None
    exact = PolynomialDomain(robot, [loop.length for loop in loops], rates=False)
    for loop in loops:
        _, ways = closings.slides(robot, loop, exact, passive)
        if any(dot(u, v) != exact.number(int(u is v)) for u in ways for v in ways):
            return None
    # The coordinate along which the line of the points goes most is found first, and divides the others.
    values, _, full, _ = assembled(robot, before)
    own = ThreeRods(robot, tuple(loops), tuple(passive))
    n, m, _ = zip(*own.pose(ArrayDomain(robot, full, values)).rotation, strict=True)
    along = [float(np.median(np.abs(x))) for x in cross(n, m)]
    own = replace(own, places=tuple(sorted(passive, key=lambda k: along[passive.index(k)])))
    known = own.pose(exact).rows(exact.ring.zero, exact.ring.one)[:3]
    graph = point_graph(own.arm, [[not x for x in row] for row in known])
    signs = {loop.branch for loop in loops if loop.branch}
    chosen = next((loop for loop in loops if loop.branch), loops[-1])
    if len(signs) > 1:
        raise refused(robot, chosen, f"branches {listed(sorted(signs))} of rods together", "allowed: one of them")
    leaf = _leaf(robot, chosen, graph)
    return SolvedLoop(loops=own.loops, passive=tuple(passive), circuit=own, graph=graph, leaf=leaf)


def _columns(
    robot: Robot, one: Closing, values: Mapping[str, float], full: Sequence[Array]
) -> tuple[dict[int, Array], list[Array]]:
    """Twists of the joints of a loop and of its closure where it is assembled, (configurations, 6) each."""
    found, closing = closings.twists(robot, one, ArrayDomain(robot, full, values))
    linear = [x for twist in found.values() for k, x in enumerate(twist) if k % 6 < 3]
    unit = max(np.abs(x).max() for x in linear) or 1.0  # of lengths

    def _column(twist: Twist) -> Array:
        lengths = np.where(np.arange(len(twist)) % 6 < 3, unit, 1.0)
        return np.stack([np.broadcast_to(x, len(full[0])) for x in twist], axis=-1) / lengths

    return {k: _column(twist) for k, twist in found.items()}, [_column(twist) for twist in closing]


def _rank(columns: Sequence[Array]) -> int:
    """At most configurations."""
    return int(np.median(np.linalg.matrix_rank(np.stack(columns, axis=-1), rtol=_RANK)))


def _fidelity(rows: Sequence[int], passive: Sequence[Array], closing: Sequence[Array]) -> float:
    """1 where the determinant of rows is zero only where joints are loose: where it is a part of their volume.

    Of over-constrained loops, as that of Bennett, some rows are also dependent elsewhere.
    """
    part = _volume([column[:, list(rows)] for column in passive]) * _volume(closing)
    whole = _volume([*passive, *closing])
    share = part[whole > _RANK] / whole[whole > _RANK]
    return round(float(share.min() / share.max()), 2) if share.size else 0.0


def _volume(columns: Sequence[Array]) -> Array:
    """Of the parallelepiped of columns, which are nowhere more than they have entries; of none 1."""
    if not columns:
        return np.ones(1)
    return np.asarray(np.prod(np.linalg.svd(np.stack(columns, axis=-1), compute_uv=False), axis=-1))


def _checked(robot: Robot, loops: Sequence[Closing]) -> Closing:
    """The last loop with the rows that determine its rates, if it can be assembled and is neither loose nor locked."""
    one, (values, _, full, missing) = loops[-1], assembled(robot, loops)
    columns, closing = _columns(robot, one, values, full)
    passive = [*closing, *(columns[k] for k in one.passive)]
    rank = _rank(passive)
    if locked := _rank([*closing, *columns.values()]) - rank:
        active = [robot.joints[k].variable for k, column in columns.items() if _rank([*passive, column]) > rank]
        found = f"over-constrained: {locked} of {listed(active)} depend{'s' * (locked == 1)} on the others"
        remedy = f"write passive: true on {locked} more joint{'s' * (locked > 1)}"
        raise refused(robot, one.loop, found, remedy=f"{remedy}, correct frames, or leave the loop out")
    if missing > 0.0:
        found = "no closed form: it closes where its elementary equations have no solution"
        if missing > OPEN:
            found = f"it cannot be assembled: at best {missing:.3g} m are missing"
        raise refused(robot, one.loop, found, remedy="correct lengths, frames or limits")
    choices: list[tuple[float, Closing]] = []
    for in_frame in (False, True):
        turned = replace(one, in_frame=in_frame)
        columns, closing = _columns(robot, turned, values, full)
        own = [columns[k] for k in one.passive]
        # Rows in which the closure has no part, and which determine the rates of the passive joints.
        free = [
            row for row in range(6 * len(one.loops)) if all(np.abs(column[:, row]).max() < _RANK for column in closing)
        ]
        for rows in combinations(free, len(own)):
            if _rank([column[:, list(rows)] for column in own]) == len(own):
                choices.append((_fidelity(rows, own, closing), replace(turned, rows=rows)))
    if choices:
        return max(choices, key=lambda choice: choice[0])[1]  # the first of the best
    found = "no velocities are free of the joint that closes it"
    raise refused(robot, one.loop, found, remedy="write that joint as a row of the table, and close by: fixed")


def assembled(robot: Robot, loops: Sequence[Closing]) -> tuple[dict[str, float], list[Array], list[Array], float]:
    """Numbers of all symbols, positions of variables and joints in configurations in which the loops close, and zero.

    Where there are none, some others and what is missing at best [m].
    """
    source, symbols = np.random.default_rng(7), free_symbols(robot)
    for _ in range(_DRAWS if symbols else 1):
        values = parameter_values(robot, {name: source.uniform(0.2, 1.0) for name in symbols})
        q = closings.drawn(robot, robot.variables, values, source, SAMPLES)
        full, exists = positions(robot, loops, q, values)
        numbers = {name: float(value) for name, value in values.items()}
        if exists.any():
            return numbers, [x[exists] for x in q], [x[exists] for x in full], 0.0
    if isinstance(last := loops[-1], IteratedLoops):
        missing = last.searched(numbers)[2]
    elif last.loop.by is Joining.DISTANCE:
        missing = _stretch(robot, last, full, values)
    else:
        assert isinstance(last, SolvedLoop)
        frame = last.circuit.pose(ArrayDomain(robot, full, values))
        entries = [np.broadcast_to(x, SAMPLES) for row in frame.rows(np.float64(0), np.float64(1)) for x in row]
        arm = Problem(NumericChain.of(last.circuit.arm, numbers), np.stack(entries, axis=-1).reshape(-1, 4, 4))
        arm = replace(arm, free=np.array([k not in last.graph.given for k in range(arm.chain.n)]))
        closest, _ = fit(arm, np.full((SAMPLES, arm.chain.n), 0.7))
        missing = arm.residual(closest) * arm.unit
    return numbers, q, list(source.uniform(-2, 2, (robot.n, SAMPLES))), float(missing.min()) + _TINY


def _stretch(robot: Robot, one: Closing, full: Sequence[Array], values: Mapping[str, Any]) -> Array:
    """By how much the way between the ends of a rod is longer or shorter than it is, the most of several [m]."""
    ways = [(closings.gaps(robot, loop, ArrayDomain(robot, full, values)), loop.length) for loop in one.loops]
    stretched = [np.abs(np.sqrt(dot(way, way)) - to_float(length, values)) for way, length in ways]
    return np.asarray(np.max(stretched, axis=0))


def positions(
    robot: Robot, loops: Sequence[Closing], q: Sequence[Array], values: Mapping[str, Any] | None = None
) -> tuple[list[Array], Array]:
    """Of all joints, in arrays of configurations of the variables [rad or m], and where they can be assembled."""
    values = parameter_values(robot) if values is None else values
    shape = np.shape(q[0])
    full = [sum((s * x for s, x in zip(row, q, strict=True)), np.zeros(shape)) for row in constant_rows(robot, values)]
    missing = np.zeros(shape)
    for one in loops:
        if isinstance(one, IteratedLoops):
            found, gap = one.positions(q, values)
            missing = np.maximum(missing, gap)
            for place, x in zip(one.passive, found, strict=True):
                full[place] = x
            continue
        assert isinstance(one, SolvedLoop)
        run, leaf = one.walk(ArrayDomain(robot, full, values), FloatField(values), full.__getitem__)
        # The formulas hold at poses that the arm reaches: lengths may be short, planes apart, and axes opposed.
        for miss in misses(run, leaf):
            missing = np.maximum(missing, np.abs(miss))
        for place, angle in zip(one.circuit.places, run.angles(leaf), strict=True):
            if place in one.passive:
                full[place] = np.broadcast_to(angle, shape)
        if one.loop.by is Joining.DISTANCE:  # no entry of a pose
            missing = np.maximum(missing, _stretch(robot, one, full, values))
    return full, missing < OPEN


class Reached:
    """Configurations in which loops without formulas were closed, each from one before, the first as in `positions`."""

    def __init__(self, robot: Robot) -> None:
        self._robot, self._q, self._passive = tree.bare(robot), np.empty((0, robot.dof)), np.empty((0, 0))

    def __call__(self, close: Callable[[Array, Array], Array], values: Mapping[str, float], q: Array) -> Array:
        """Passive joints of variables, (..., n), and by how much loops are open; not numbers where they do not close.

        They begin from the nearest configuration that is known, to which others are added on the way.
        """
        rows, whole = q.reshape(-1, q.shape[-1]), closings.reach(self._robot, values)
        unit = [1.0 if x.is_revolute else whole for x in self._robot.variables]
        own = [1.0 if x.is_revolute else whole for x in self._robot.passive]
        if not len(self._q):
            full, _ = positions(self._robot, linkage(self._robot), list(rows[:1].T), values)
            start = [full[k] for k, joint in enumerate(self._robot.joints) if joint.follows]
            self._q, self._passive = rows[:1].copy(), np.stack(start, axis=-1)

        def _closed(at: Array, start: Array) -> Array:
            found = np.hstack([start, np.full((len(at), 1), np.inf)])
            for _ in range(_ROUNDS):
                if (found[:, -1] < OPEN).all():
                    break
                # numbers are faster than arrays of one
                found = close(at, found[:, :-1]) if len(at) > 1 else close(at[0], found[0, :-1])[None]
            way = found[:, :-1] - start
            # angles of formulas jump by full turns
            way = np.where([x.is_revolute for x in self._robot.passive], np.arctan2(np.sin(way), np.cos(way)), way)
            far = (np.abs(way / own) > STEP).any(axis=-1)
            found[far | ~(found[:, -1] < OPEN), :-1] = np.nan
            return found

        answers = []
        for at in np.array_split(rows, range(_BLOCK, len(rows), _BLOCK)):
            tried = np.zeros(len(at), dtype=bool)
            while True:
                off = np.abs((at[:, None] - self._q) / unit).max(axis=-1)
                nearest, way = off.argmin(axis=1), off.min(axis=1)
                if not (outside := np.flatnonzero((way > _NEAR) & ~tried)).size:
                    break
                tried[first := outside[0]] = True
                begin, passive = self._q[nearest[first]], self._passive[nearest[first]]
                for part in np.linspace(0, 1, math.ceil(way[first] / _NEAR) + 1)[1:]:
                    here = begin + (at[first] - begin) * part
                    if np.isnan(passive := _closed(here[None], passive[None])[0, :-1]).any():
                        break
                    self._q, self._passive = np.vstack([self._q, here]), np.vstack([self._passive, passive])
            answers.append(_closed(at, self._passive[nearest]))
            answers[-1][way > _NEAR, :-1] = np.nan
        return np.concatenate(answers).reshape(*q.shape[:-1], -1)


def constant_rows(robot: Robot, values: Mapping[str, Any]) -> list[list[float]]:
    """S in numbers; rows of passive joints are zero."""
    slopes = {*derivatives(robot).values()}
    return coupling(robot, lambda factor: 0.0 if factor in slopes else to_float(factor, values))


def rates(
    robot: Robot, loops: Sequence[Closing], full: Sequence[Any], values: Mapping[str, Any]
) -> tuple[Array, Array]:
    """S where the joints are at ``full``, (joints, n, ...), and how far loops are from dead points, (...).

    That is |det J_p| by its columns' lengths.
    """
    shape = np.shape(full[0])
    matrix, far = np.multiply.outer(np.array(constant_rows(robot, values), dtype=float), np.ones(shape)), np.ones(shape)
    for one in loops:
        columns, _ = closings.twists(robot, one, ArrayDomain(robot, full, values))
        own = [[np.broadcast_to(columns[p][row], shape) for p in one.passive] for row in one.rows]
        # J_p qd_p + J_a qd_a = 0; the rates of its own joints are still zero.
        rest = [sum(columns[m][row] * matrix[m] for m in columns) for row in one.rows]
        left, right = (np.moveaxis(np.array(part, dtype=float), (0, 1), (-2, -1)) for part in (own, rest))
        volume = np.asarray(np.linalg.det(left))
        far = np.minimum(np.abs(volume) / np.linalg.norm(left, axis=-2).prod(axis=-1), far)
        left = np.where(volume[..., None, None] == 0.0, np.nan, left)
        matrix[list(one.passive)] = -np.moveaxis(np.linalg.solve(left, right), (-2, -1), (0, 1))
    return matrix, far


def slopes(robot: Robot, one: Closing, domain: PolynomialDomain) -> Slopes:
    """How the passive joints of a loop follow the variables."""
    (columns, _), zero = closings.twists(robot, one, domain), domain.ring.zero
    first = {name.name: numerator for name, numerator in one.first(robot, columns, domain)}
    second: dict[str, Polynomial] = {}
    names, followed = [each.variable for each in robot.variables], {m: dict(robot.joints[m].follows) for m in columns}
    for k, name in enumerate(names):
        for j, other in enumerate(names[: k + 1]):
            # d/dq_k of all columns, and the second derivatives of joints that loops before determine
            moved = [
                sum((domain.derivative(columns[m][row], k) * domain.coupling[m][j] for m in columns), zero)
                for row in one.rows
            ]
            for m in (m for m in columns if m not in one.passive and {name, other} <= followed[m].keys()):
                bend = domain.constant(second_derivative(robot.joints[m], other, name))
                moved = [x + columns[m][row] * bend for x, row in zip(moved, one.rows, strict=True)]
            pairs = zip(one.passive, one.numerators(columns, moved), strict=True)
            bends = ((robot.joints[p], n) for p, n in pairs if {name, other} <= followed[p].keys())
            second |= {second_derivative(joint, other, name).name: n for joint, n in bends}
    return Slopes(one.determinant(columns), first, second)
