"""The loops of a robot, solved one after the other: where its passive joints are, and how they move.

Around a closed loop the velocities of all joints add up to none. With J_p and J_a the columns of passive and active
joints in as many rows as passive joints, those that no joint of the closure moves,

    J_p qd_p + J_a qd_a = 0,   G = -J_p^-1 J_a,   qd_p = G qd_a,

and once more differentiated along the loop J_p H_k + (d J/d q_k) [1; G] = 0, H_k = d G/d q_k (Khalil and Dombre,
Modeling, Identification and Control of Robots, 2002, chapter 7). G ceases to exist where det J_p = 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial, determinant
from derive.errors import QuantityError, listed, quoted
from derive.inverse.closed.elementary_solver import Field
from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import SolutionGraph
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.closed.solve import misses, solve
from derive.inverse.closed.walk import GraphWalk, Leaf
from derive.inverse.loops.circuit import Circuit, circuit
from derive.inverse.loops.rod import rod_graph
from derive.inverse.numeric.chain import NumericChain, Problem
from derive.inverse.numeric.newton import fit
from derive.mechanics.chain import Chain, Domain, build_chain, way_frame
from derive.mechanics.floats import ArrayDomain
from derive.mechanics.vectors import Frame, S, Vector, column, cross, dot, multiply, scale, subtract, transpose
from derive.robot import tree
from derive.robot.coupling import coupling, derivatives, second_derivative
from derive.robot.description import Joining, Loop
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import Name
from derive.robot.names import free_symbols
from derive.robot.robot import Robot

Array = npt.NDArray[Any]
Twist = tuple[Any, ...]  # linear velocity, then angular velocity, per unit of one rate

_SAMPLES, _DRAWS = 256, 16  # configurations of the variables, and numbers of symbols, at which a loop is assembled
_OPEN = 1e-9  # frames that miss each other by more [m, and entries of rotations] are not joined
_TINY = 1e-300  # [m] where nothing is missing
_RANK = 1e-7  # singular values below this part of the largest are rounding


@dataclass(frozen=True, eq=False)
class SolvedLoop:
    """A loop with the positions of its passive joints."""

    loop: Loop
    circuit: Circuit
    graph: SolutionGraph  # of the circuit's arm
    leaf: int  # which of its leaves is the branch that the file asks for
    passive: tuple[int, ...]  # indices of the joints that it determines
    rows: tuple[int, ...] = ()  # of the twists, that determine the passive rates
    in_frame: bool = False  # whether the twists are in the axes of its first frame, not of where its branches begin

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

    def determinant(self, columns: Mapping[int, Twist]) -> Any:
        """det J_p of the twists of the loop's joints."""
        return determinant([[columns[p][row] for p in self.passive] for row in self.rows])

    def numerators(self, columns: Mapping[int, Twist], right: Sequence[Any]) -> list[Any]:
        """x det J_p of J_p x + right = 0, for each passive joint, by Cramer's rule."""
        rows = [[columns[p][row] for p in self.passive] for row in self.rows]
        replaced = ([[*r[:at], -e, *r[at + 1 :]] for r, e in zip(rows, right, strict=True)] for at in range(len(rows)))
        return [determinant(matrix) for matrix in replaced]

    def first(self, robot: Robot, columns: Mapping[int, Twist], domain: Domain[Any]) -> Iterator[tuple[Name, Any]]:
        """The first derivatives by name, numerators over det J_p."""
        matrix = coupling(robot)
        for k, variable in enumerate(robot.variables):
            shares = [(m, domain.constant(matrix[m][k])) for m in columns if m not in self.passive]
            right = [sum((columns[m][row] * share for m, share in shares), domain.number(0)) for row in self.rows]
            for p, numerator in zip(self.passive, self.numerators(columns, right), strict=True):
                if (name := dict(robot.joints[p].follows).get(variable.variable)) is not None:
                    yield name, numerator


@dataclass(frozen=True)
class Slopes:
    """First and second derivatives of the variables of the passive joints of one loop, numerators over det J_p."""

    determinant: Polynomial
    first: Mapping[str, Polynomial]  # by the names that they have as factors of joints that follow
    second: Mapping[str, Polynomial]  # by name; the first derivatives occur in them


@lru_cache(32)
def linkage(robot: Robot) -> tuple[SolvedLoop, ...]:
    """The solved loops of a robot, in the order of the file."""
    found: list[SolvedLoop] = []
    for loop in robot.loops:
        before = [k for one in found for k in one.passive]
        found.append(_solved(robot, loop, before))
        found[-1] = _checked(robot, found)
    return tuple(found)


def _solved(robot: Robot, loop: Loop, before: Sequence[int]) -> SolvedLoop:
    unknown = {k for way in tree.around(robot, loop) for k in way if robot.joints[k].follows} - {*before}
    if not unknown:
        found, remedy = "over-constrained: loops above determine all its passive joints", "leave the loop out"
        raise _refused(robot, loop, found, remedy=f"{remedy}, or write passive: true on more of its joints")
    if loop.by is Joining.DISTANCE and len(unknown) > 1:
        found = f"{listed(robot.joints[k].variable for k in sorted(unknown))} move it, and a rod determines one joint"
        raise _refused(robot, loop, found, remedy="write passive on one of them, or close loops of the others first")
    own = circuit(robot, loop, before, opposed=loop.by is Joining.REVOLUTE and are_opposed(robot, loop))
    passive = tuple(k for k in own.places if k in unknown)
    try:
        graph = solve(own.arm) if loop.by is not Joining.DISTANCE else _of_rod(robot, own)
    except QuantityError:  # its message is about the arm
        found = f"it does not determine {listed(robot.joints[k].variable for k in passive)}"
        raise _refused(robot, loop, found, remedy="write passive on fewer of them, or close more loops") from None
    if not graph.is_closed or any(node.kind is NodeKind.GENERAL for node in graph.nodes):
        why = graph.why_not or "an equation of higher degree remains"
        allowed = "allowed: loops whose passive joints follow from elementary equations one after the other"
        raise _refused(robot, loop, f"no closed form: {why}", allowed, "close loops with fewer passive joints first")
    branches = [node.formulas[0].branches for node in graph.nodes if node.formulas[0].branches > 1]
    signs = loop.branch or "+" * len(branches)
    if len(signs) != len(branches) or any(count != 2 for count in branches):
        count = len(branches)
        allowed = f"allowed: {f'a sign for each of {count} choices' if count > 1 else 'one sign for 1 choice'}"
        raise _refused(robot, loop, f"branch {quoted(loop.branch)}", allowed if branches else "allowed: none")
    leaf = int("0" + signs.replace("+", "0").replace("-", "1"), 2)
    return SolvedLoop(loop, own, graph, leaf, passive)


def _of_rod(robot: Robot, own: Circuit) -> SolutionGraph:
    position = own.pose(PolynomialDomain(robot, rates=False)).position
    if (graph := rod_graph(own.arm, tuple(not x for x in position))) is None:
        raise QuantityError("the joint does not change the distance of the ends")
    return graph


def _frames(robot: Robot, loop: Loop, domain: Domain[S]) -> tuple[Chain[S], list[Frame[S]], list[Frame[S]]]:
    """The chain, and the joint frames and joined frames of a loop, in the frame on which its branches begin."""
    chain, own = build_chain(robot, domain), {k for branch in tree.around(robot, loop) for k in branch}
    frames: list[Frame[S]] = []
    for i, joint in enumerate(chain.joints):
        # Rows of velocities in axes that turn with the rest of the tree would fail at some of its positions.
        before = frames[joint.parent] if joint.parent in own else chain.unit
        frames.append(before @ (joint.fixed @ joint.motion(chain.zero, chain.one)) if i in own else chain.unit)
    joined: list[Frame[S]] = []
    for carrier, behind in (way_frame(robot, label, domain) for label in loop.join):
        frame = frames[carrier] @ chain.ends[carrier] if carrier >= 0 else chain.unit
        joined.append(frame if behind is None else frame @ behind)
    return chain, frames, joined


def are_opposed(robot: Robot, loop: Loop) -> bool:
    """Whether the z axes of the joined frames are opposed wherever the joints are: so is then that of the pin."""
    source = np.random.default_rng(3)
    values = parameter_values(robot, {name: source.uniform(0.2, 1.0) for name in free_symbols(robot)})
    _, _, joined = _frames(robot, loop, ArrayDomain(robot, list(source.uniform(-2, 2, (robot.n, _SAMPLES))), values))
    one, other = (column(frame.rotation, 2) for frame in joined)
    return bool(np.all(np.abs(dot(one, other) + 1.0) < _OPEN))


def _columns(
    robot: Robot, one: SolvedLoop, values: Mapping[str, float], full: Sequence[Array]
) -> tuple[dict[int, Array], list[Array]]:
    """Twists of the joints of a loop and of its closure where it is assembled, (configurations, 6) each."""
    found, closing = twists(robot, one, ArrayDomain(robot, full, values))
    unit = max(np.abs(x).max() for twist in found.values() for x in twist[:3]) or 1.0  # of lengths

    def _column(twist: Twist) -> Array:
        lengths = np.where(np.arange(6) < 3, unit, 1.0)
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


def _checked(robot: Robot, loops: Sequence[SolvedLoop]) -> SolvedLoop:
    """The last loop with the rows that determine its rates, if it can be assembled and is neither loose nor locked."""
    one, (values, _, full, missing) = loops[-1], assembled(robot, loops)
    columns, closing = _columns(robot, one, values, full)
    passive = [*closing, *(columns[k] for k in one.passive)]
    rank = _rank(passive)
    if locked := _rank([*closing, *columns.values()]) - rank:
        active = [robot.joints[k].variable for k, column in columns.items() if _rank([*passive, column]) > rank]
        found = f"over-constrained: {locked} of {listed(active)} depend{'s' * (locked == 1)} on the others"
        remedy = f"write passive: true on {locked} more joint{'s' * (locked > 1)}"
        raise _refused(robot, one.loop, found, remedy=f"{remedy}, correct frames, or leave the loop out")
    if missing > 0.0:
        found = "no closed form: it closes where its elementary equations have no solution"
        if missing > _OPEN:
            found = f"it cannot be assembled: at best {missing:.3g} m are missing"
        raise _refused(robot, one.loop, found, remedy="correct lengths, frames or limits")
    choices: list[tuple[float, SolvedLoop]] = []
    for in_frame in (False, True):
        turned = replace(one, in_frame=in_frame)
        columns, closing = _columns(robot, turned, values, full)
        own = [columns[k] for k in one.passive]
        # Rows in which the closure has no part, and which determine the rates of the passive joints.
        free = [row for row in range(6) if all(np.abs(column[:, row]).max() < _RANK for column in closing)]
        for rows in combinations(free, len(own)):
            if _rank([column[:, list(rows)] for column in own]) == len(own):
                choices.append((_fidelity(rows, own, closing), replace(turned, rows=rows)))
    if choices:
        return max(choices, key=lambda choice: choice[0])[1]  # the first of the best
    found = "no velocities are free of the joint that closes it"
    raise _refused(robot, one.loop, found, remedy="write that joint as a row of the table, and close by: fixed")


def assembled(robot: Robot, loops: Sequence[SolvedLoop]) -> tuple[dict[str, float], list[Array], list[Array], float]:
    """Numbers of all symbols, positions of variables and joints in configurations in which the loops close, and zero.

    Where there are none, some others and what is missing at best [m].
    """
    source, symbols = np.random.default_rng(7), free_symbols(robot)
    for _ in range(_DRAWS if symbols else 1):
        values = parameter_values(robot, {name: source.uniform(0.2, 1.0) for name in symbols})
        q, way = [], reach(robot, values)
        for variable in robot.variables:
            most = math.pi if variable.is_revolute else way
            low, high = (to_float(limit, values) for limit in variable.limits) if variable.limits else (-most, most)
            q.append(source.uniform(low, high, _SAMPLES))
        full, exists = positions(robot, loops, q, values)
        numbers = {name: float(value) for name, value in values.items()}
        if exists.any():
            return numbers, [x[exists] for x in q], [x[exists] for x in full], 0.0
    if loops[-1].loop.by is Joining.DISTANCE:
        missing = float(np.abs(_stretch(robot, loops[-1].loop, full, values)).min()) + _TINY
        return numbers, q, list(source.uniform(-2, 2, (robot.n, _SAMPLES))), missing
    frame = loops[-1].circuit.pose(ArrayDomain(robot, full, values))
    entries = [np.broadcast_to(x, _SAMPLES) for row in frame.rows(np.float64(0), np.float64(1)) for x in row]
    arm = Problem(NumericChain.of(loops[-1].circuit.arm, numbers), np.stack(entries, axis=-1).reshape(-1, 4, 4))
    arm = replace(arm, free=np.array([k not in loops[-1].graph.given for k in range(arm.chain.n)]))
    closest, _ = fit(arm, np.full((_SAMPLES, arm.chain.n), 0.7))
    missing = float((arm.residual(closest) * arm.unit).min()) + _TINY
    return numbers, q, list(source.uniform(-2, 2, (robot.n, _SAMPLES))), missing


def reach(robot: Robot, values: Mapping[str, Any]) -> float:
    """The lengths of all rows together [m], further than which no slide goes; 1 where there are none."""
    cells = [cell for joint in robot.joints for cell in (joint.a, joint.d)] + tree.lengths(robot)
    cells += [loop.length for loop in robot.loops]
    return sum(abs(to_float(cell, values)) for cell in cells) or 1.0


def gaps(robot: Robot, loop: Loop, domain: Domain[S]) -> Vector[S]:
    """The way between the origins of the joined frames, zero where they are one."""
    _, _, (one, other) = _frames(robot, loop, domain)
    return subtract(one.position, other.position)


def _stretch(robot: Robot, loop: Loop, full: Sequence[Array], values: Mapping[str, Any]) -> Array:
    """By how much the way between the ends of a rod is longer than it is [m]."""
    way = gaps(robot, loop, ArrayDomain(robot, full, values))
    return np.asarray(np.sqrt(dot(way, way)) - to_float(loop.length, values))


def _refused(robot: Robot, loop: Loop, found: str, allowed: str = "", remedy: str = "") -> QuantityError:
    what = f"the loop of {robot.name} that joins {listed(loop.join)}: {found}"
    return QuantityError(what, allowed=allowed, remedy=remedy, location=loop.location)


def positions(
    robot: Robot, loops: Sequence[SolvedLoop], q: Sequence[Array], values: Mapping[str, Any] | None = None
) -> tuple[list[Array], Array]:
    """Of all joints, in arrays of configurations of the variables [rad or m], and where they can be assembled."""
    values = parameter_values(robot) if values is None else values
    shape = np.shape(q[0])
    full = [sum((s * x for s, x in zip(row, q, strict=True)), np.zeros(shape)) for row in constant_rows(robot, values)]
    missing = np.zeros(shape)
    for one in loops:
        run, leaf = one.walk(ArrayDomain(robot, full, values), FloatField(values), full.__getitem__)
        # The formulas hold at poses that the arm reaches: lengths may be short, planes apart, and axes opposed.
        for miss in misses(run, leaf):
            missing = np.maximum(missing, np.abs(miss))
        for place, angle in zip(one.circuit.places, run.angles(leaf), strict=True):
            if place in one.passive:
                full[place] = np.broadcast_to(angle, shape)
        if one.loop.by is Joining.DISTANCE:  # no entry of a pose
            missing = np.maximum(missing, np.abs(_stretch(robot, one.loop, full, values)))
    return full, missing < _OPEN


def constant_rows(robot: Robot, values: Mapping[str, Any]) -> list[list[float]]:
    """S in numbers; rows of passive joints are zero."""
    slopes = {*derivatives(robot).values()}
    return coupling(robot, lambda factor: 0.0 if factor in slopes else to_float(factor, values))


def rates(
    robot: Robot, loops: Sequence[SolvedLoop], full: Sequence[Any], values: Mapping[str, Any]
) -> tuple[Array, Array]:
    """S where the joints are at ``full``, (joints, n, ...), and how far loops are from dead points, (...).

    That is |det J_p| by its columns' lengths.
    """
    shape = np.shape(full[0])
    matrix, far = np.multiply.outer(np.array(constant_rows(robot, values), dtype=float), np.ones(shape)), np.ones(shape)
    for one in loops:
        columns, _ = twists(robot, one, ArrayDomain(robot, full, values))
        own = [[np.broadcast_to(columns[p][row], shape) for p in one.passive] for row in one.rows]
        # J_p qd_p + J_a qd_a = 0; the rates of its own joints are still zero.
        rest = [sum(columns[m][row] * matrix[m] for m in columns) for row in one.rows]
        left, right = (np.moveaxis(np.array(part, dtype=float), (0, 1), (-2, -1)) for part in (own, rest))
        volume = np.asarray(np.linalg.det(left))
        far = np.minimum(np.abs(volume) / np.linalg.norm(left, axis=-2).prod(axis=-1), far)
        left = np.where(volume[..., None, None] == 0.0, np.nan, left)
        matrix[list(one.passive)] = -np.moveaxis(np.linalg.solve(left, right), (-2, -1), (0, 1))
    return matrix, far


def twists(robot: Robot, one: SolvedLoop, domain: Domain[S]) -> tuple[dict[int, Twist], list[Twist]]:
    """Twists of the loop's first frame against the second, per rate of each joint and of those of the closure."""
    loop = one.loop
    chain, frames, joined = _frames(robot, loop, domain)
    end, back, is_slide = joined[0], transpose(joined[0].rotation), loop.by is Joining.PRISMATIC
    # Unless one slides along the other their origins are one point, to which each branch has a way of its own.
    points = [end.position, end.position if is_slide else joined[1].position]
    rod = subtract(*points[::-1]) if loop.by is Joining.DISTANCE else None

    def _in_axes(linear: Vector[S], angular: Vector[S]) -> Twist:
        if rod is not None:  # ball joints leave the velocity along it alone
            return (dot(rod, linear), *chain.null, *chain.null[:2])
        return (*multiply(back, linear), *multiply(back, angular)) if one.in_frame else (*linear, *angular)

    found: dict[int, Twist] = {}
    for branch, way, point in zip(tree.around(robot, loop), (1, -1), points, strict=True):
        for k in branch:
            z = scale(way * robot.joints[k].sign, column(frames[k].rotation, 2))
            turns = chain.joints[k].revolute
            linear = cross(z, subtract(point, frames[k].position)) if turns else z
            found[k] = _in_axes(linear, z if turns else chain.null)
    z = column(end.rotation, 2)
    axes = {Joining.REVOLUTE: [z], Joining.SPHERICAL: [column(end.rotation, i) for i in range(3)]}.get(loop.by, [])
    slides = [_in_axes(z, chain.null)] if is_slide else []
    return found, [*slides, *(_in_axes(chain.null, axis) for axis in axes)]


def slopes(robot: Robot, one: SolvedLoop, domain: PolynomialDomain) -> Slopes:
    """How the passive joints of a loop follow the variables."""
    (columns, _), zero = twists(robot, one, domain), domain.ring.zero
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
