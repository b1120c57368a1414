"""Aspects: the connected sets of configurations without a singularity; arms that change posture within one of them.

In most arms each solution of a pose lies in an aspect of its own: the signs of the factors of det J are its shoulder,
elbow and wrist. A cuspidal arm has two solutions in one aspect, and a path from one to the other on which it is never
singular. Such a path is looked for and, where it is found, verified; that none was found proves nothing.

Sources: Borrel and Liegeois, A study of multiple manipulator inverse kinematic solutions, 1986 (aspects); Wenger,
A new general formalism for the kinematic analysis of all nonredundant manipulators, 1992; Wenger, Cuspidal robots,
2019; Salunkhe et al., Necessary and sufficient condition for a generic 3R serial manipulator to be cuspidal, 2022;
Kavraki et al., Probabilistic roadmaps for path planning in high-dimensional configuration spaces, 1996.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from heapq import heappop, heappush
from itertools import combinations, islice, pairwise, product
from typing import Any

import mpmath
import numpy as np
import sympy

from derive.inverse.closed.branches import InverseSolver
from derive.inverse.numeric.chain import Array, NumericChain
from derive.inverse.words.elementary import Numbers, Sign, array_value, with_lines
from derive.inverse.words.solutions import InverseKinematics, parameter_numbers
from derive.lecture.point import DIGITS, value_of
from derive.lecture.sympy_conversion import Expr
from derive.model.singularities.singularities import Condition, Outcome, SingularFactor, Singularities

POSES = 200  # random poses whose solutions are looked at: few have more than two in an arm that is hardly cuspidal
_LOOKED_AT = 12  # random poses at which the signs of each branch are looked at
MILESTONES = 500  # random configurations by way of which a path is looked for
GRIDS = {1: 4096, 2: 300, 3: 72}  # cells along each joint, for factors of so many joints
SPECK = 2e-4  # sets smaller than this part of a grid lie between its lines where two curves cross
PAIRS = 8  # pairs of solutions between which a path is looked for
_NEIGHBOURS = 12
_STEPS = 48  # places on a straight piece of a path at which it is tried
_HALVINGS = 14
CLEAR = 1e-7  # of a configuration without a singularity det J is larger than this part of its largest value


@dataclass(frozen=True)
class FactorGroup:
    """Joints that stand together in factors of det J."""

    joints: tuple[int, ...]  # their indices, from 0
    factors: tuple[int, ...]  # indices of the factors
    parts: int | None  # into how many connected sets the zeros of the factors cut them; None for too many joints


@dataclass(frozen=True, eq=False)
class Aspects:
    """The aspects of an arm whose joints have no limits."""

    inverse: InverseKinematics  # its inverse kinematics: of the position, for arms of few joints
    factors: tuple[Condition, ...] = ()  # where det J is zero, factor by factor
    groups: tuple[FactorGroup, ...] = ()  # the joints that stand together in them
    why_not: str = ""  # why there are none to be told apart; empty where there are
    solutions: tuple[int, ...] = ()  # how many real solutions each of the poses has that were looked at
    shared: int = 0  # how many of these poses have two solutions with the same signs of all factors
    crossing: Crossing | None = None  # a path between two solutions of one pose; None where none was found
    signs: tuple[tuple[int, ...] | None, ...] = ()  # of the factors in each solution; None where they vary
    values: Mapping[str, float] = field(default_factory=dict)  # the parameters with which the arm was looked at
    task: tuple[str, ...] = ()  # whose determinant is det J; empty for all of J

    @property
    def count(self) -> int | None:
        """How many aspects there are; None where they were not counted."""
        parts = [group.parts for group in self.groups]
        return None if self.why_not or None in parts else math.prod(part for part in parts if part is not None)

    @property
    def is_cuspidal(self) -> bool:
        """Whether the arm changes posture without meeting a singularity; false where no such path was found."""
        return self.crossing is not None


def find_aspects(inverse: InverseKinematics, singular: Singularities, values: Mapping[str, float]) -> Aspects:
    """The aspects of an arm, and whether it changes posture within one of them."""
    if inverse.graph.given:
        return Aspects(inverse, why_not="the arm has more joints than the task needs")
    chain = NumericChain.of(inverse.robot, values)
    if singular.outcome is Outcome.NEVER:
        return Aspects(inverse, why_not="the arm is never singular, all configurations are one aspect")
    determinant = ScaledDeterminant(chain)
    look = None if determinant.basis is None else _Look(inverse, chain, determinant, singular, values)
    if look is None or (not look.is_same and singular.outcome is not Outcome.UNSOLVED):
        return Aspects(inverse, why_not="no single determinant decides the rank of J")
    poses = list(look.poses())
    pairs = [list(look.pairs(q)) for q in poses]
    tried = [pair for near in pairs for pair in near][:PAIRS]
    crossing = next((found for pair in tried if (found := look.crossing(*pair)) is not None), None)
    shared = sum(1 for near in pairs if near)
    signs = tuple(look.signs_of_branches())
    counts, groups = tuple(map(len, poses)), tuple(look.groups())
    return Aspects(inverse, look.conditions, groups, "", counts, shared, crossing, signs, values, singular.task)


class _Look:
    """Looks at one arm in numbers.

    `is_same` says whether det J in numbers is the product of the factors, by whose signs, `conditions`, aspects are
    told apart; there are none where det J itself is taken.
    """

    def __init__(
        self,
        inverse: InverseKinematics,
        chain: NumericChain,
        determinant: ScaledDeterminant,
        singular: Singularities,
        values: Mapping[str, float],
    ) -> None:
        self._inverse, self._chain, self._determinant = inverse, chain, determinant
        self._values = values
        self._known: Numbers = {sympy.Symbol(name): np.float64(value) for name, value in values.items()}
        self._q = [sympy.Symbol(joint.variable) for joint in inverse.robot.joints]
        sample = random_configurations(chain, 64, 6)
        product = math.prod(self._number(each.expression, sample) ** each.exponent for each in singular.factors)
        # The same function but for a factor: its ratio is constant at random configurations.
        ratio = determinant(sample) / product
        self.is_same = bool(singular.conditions) and bool(np.ptp(ratio) <= 1e-6 * np.abs(ratio).max())
        self.conditions = singular.conditions if self.is_same else ()
        self._joints = [tuple(j - 1 for j in condition.joints) for condition in self.conditions]
        if not self._joints:  # those that change det J itself
            steps = np.random.default_rng(7).uniform(0.5, 1.0, (chain.n, len(sample)))
            moved = sample + steps[..., None] * np.eye(chain.n)[:, None]
            changes = np.abs(determinant(moved) - determinant(sample)).max(axis=-1)
            self._joints = [tuple(np.flatnonzero(changes > 1e-9).tolist())]
        self._roads: dict[tuple[int, ...], Roadmap] = {}

    def _number(self, expression: Expr, q: Array) -> Array:
        known: Numbers = self._known | {symbol: q[..., k] for k, symbol in enumerate(self._q)}
        return np.broadcast_to(np.asarray(array_value(expression, known)), q.shape[:-1])

    def signs(self, q: Array) -> Array:
        """The signs of all factors, (..., factors); of det J where it has none."""
        factors = [self._number(condition.expression, q) for condition in self.conditions] or [self._determinant(q)]
        return np.stack([np.where(factor > 0.0, 1, -1) for factor in factors], axis=-1)

    def groups(self) -> Iterator[FactorGroup]:
        """Joints that stand together in factors, and into how many parts these cut them."""
        sets: list[tuple[set[int], set[int]]] = []
        for factor, joints in enumerate(self._joints):
            # Factors that share a joint are cut out of the same torus.
            together = [pair for pair in sets if pair[0] & set(joints)]
            sets = [pair for pair in sets if pair not in together]
            sets.append((set(joints).union(*(p[0] for p in together)), {factor}.union(*(p[1] for p in together))))
        pairs = sorted((tuple(sorted(members)), tuple(sorted(factors))) for members, factors in sets)
        yield from (FactorGroup(*pair, self._parts(*pair)) for pair in pairs)

    def _parts(self, joints: Sequence[int], factors: Sequence[int]) -> int | None:
        """Connected sets of a grid on which no sign changes."""
        cells = GRIDS.get(len(joints))
        if cells is None:
            return None
        turns = [bool(self._chain.revolute[j]) for j in joints]
        share = 2.0 * (np.arange(cells) + math.sqrt(2.0) - 1.0) / cells
        q = np.zeros((*(cells,) * len(joints), self._chain.n))
        for axis, (joint, turn) in enumerate(zip(joints, turns, strict=True)):
            values = share * math.pi if turn else (share - 1.0) * self._chain.reach
            q[..., joint] = values.reshape([-1 if k == axis else 1 for k in range(len(joints))])
        # A number for each combination of signs; its connected sets are the aspects.
        code = ((self.signs(q)[..., list(factors)] > 0) * 2 ** np.arange(len(factors))).sum(axis=-1)
        _, sizes = np.unique(connected(code, turns), return_counts=True)
        return int(np.sum(sizes > SPECK * code.size))

    def poses(self) -> Iterator[Array]:
        """The real solutions of random poses, (solutions, n) each."""
        goal, _ = self._chain.pose_and_jacobian(random_configurations(self._chain, POSES, 8))
        solved = InverseSolver.of(self._inverse.robot, self._inverse.graph, self._values).solve(goal).q
        yield from (found[np.isfinite(found).all(axis=-1)] for found in solved)

    def pairs(self, q: Array) -> Iterator[tuple[Array, Array]]:
        """Solutions of one pose with the same signs."""
        signs, clear = self.signs(q), np.abs(self._determinant(q)) > CLEAR
        for i, j in combinations(range(len(q)), 2):
            if clear[i] and clear[j] and (signs[i] == signs[j]).all():
                yield q[i], q[j]

    def crossing(self, start: Array, end: Array) -> Crossing | None:
        """A path without a singularity from one configuration to another."""
        signs = self.signs(start)
        key = tuple(int(x) for x in signs)
        if key not in self._roads:
            free = random_configurations(self._chain, 40 * MILESTONES, 9)
            active = sorted(set().union(*self._joints))
            places = free[(self.signs(free) == signs).all(axis=-1)][:MILESTONES]
            self._roads[key] = Roadmap(self._chain, self._determinant, places, active)
        return self._roads[key].path(start, end)

    def signs_of_branches(self) -> Iterator[tuple[int, ...] | None]:
        """For each solution in closed form the signs of the factors, where they are the same at all poses."""
        goal, _ = self._chain.pose_and_jacobian(random_configurations(self._chain, _LOOKED_AT, 10))
        places: Numbers = {self._inverse.pose[i, j]: goal[:, i, j] for i in range(3) for j in range(4)}
        for solution in self._inverse.solutions if self.conditions else ():
            known = with_lines(self._known | places, solution.lines)
            found = np.stack([np.broadcast_to(known[symbol], len(goal)) for symbol in self._q], axis=-1)
            seen = set(map(tuple, self.signs(found[np.isfinite(found).all(axis=-1)]).tolist()))
            yield seen.pop() if len(seen) == 1 else None


def connected(code: Array, closed: Sequence[bool]) -> Array:
    """A label for every cell of a grid, the same for cells of one value that hang together."""
    label = np.arange(code.size).reshape(code.shape)
    while True:
        before = label
        for axis, is_closed in enumerate(closed):
            for step in (1, -1):
                same = np.roll(code, step, axis) == code
                if not is_closed:
                    edge = 0 if step > 0 else -1
                    same[tuple(edge if k == axis else slice(None) for k in range(code.ndim))] = False
                # Every cell takes the smallest label of its neighbours of equal signs, until nothing changes.
                label = np.where(same, np.minimum(label, np.roll(label, step, axis)), label)
        label = label.ravel()[label]
        if (label == before).all():
            return label


# -- paths on which an arm is never singular: looked for by way of random configurations, then verified


@dataclass(frozen=True, eq=False)
class Crossing:
    """A path between two solutions of one pose on which the arm is never singular."""

    path: Array  # corners of the path, (k, n); straight pieces lie between them
    clearance: float  # the smallest amount of det J on the way, as a part of its largest value anywhere


class ScaledDeterminant:
    """det J in parts of its largest value, of orthonormal rows `basis`, None where these are not as many as joints."""

    def __init__(self, chain: NumericChain) -> None:
        self._chain, self._scale = chain, 1.0
        self.basis: Array | None = None
        q = random_configurations(chain, 4000, 5)
        for columns_of in (self._twist, self._linear):
            columns = columns_of(q[:200])
            # Principal directions of all columns of J: the task space, where as many as joints are left.
            rows = columns.transpose(0, 2, 1).reshape(-1, columns.shape[1])
            values, vectors = np.linalg.eigh(rows.T @ rows / len(rows))
            kept = vectors[:, values > 1e-12 * max(values[-1], 1e-300)]
            if kept.shape[1] == chain.n:
                self.basis, self._columns = kept, columns_of
                self._scale = float(np.abs(self(q)).max()) or 1.0
                return

    def __call__(self, q: Array) -> Array:
        """Its value."""
        basis = np.eye(6) if self.basis is None else self.basis
        return np.asarray(np.linalg.det(basis.T @ self._columns(q)) / self._scale)

    def _linear(self, q: Array) -> Array:
        """Velocities of the end effector's origin by each joint, (..., 3, n)."""
        _, slope = self._chain.pose_and_jacobian(q)
        return np.swapaxes(slope[..., :, 3], -1, -2) / self._chain.reach

    def _twist(self, q: Array) -> Array:
        """Twists about the world's origin by each joint, (..., 6, n)."""
        pose, slope = self._chain.pose_and_jacobian(q)
        # dR/dq R^T = [w]x, and v - w x p is the velocity of the world's origin.
        spin = slope[..., :3] @ np.swapaxes(pose[..., None, :3, :3], -1, -2)
        angular = np.stack([spin[..., 2, 1], spin[..., 0, 2], spin[..., 1, 0]], axis=-1)
        linear = slope[..., 3] - np.cross(angular, pose[..., None, :3, 3])
        return np.swapaxes(np.concatenate([linear / self._chain.reach, angular], axis=-1), -1, -2)


def random_configurations(chain: NumericChain, count: int, seed: int) -> Array:
    """Configurations of an arm without joint limits, (count, n): slides by as much as the arm reaches."""
    most = np.where(chain.revolute, math.pi, chain.reach)
    return np.random.default_rng(seed).uniform(-most, most, (count, chain.n))


class Roadmap:
    """Straight pieces between random configurations with the same signs, (k, n), on which det J is not zero."""

    def __init__(
        self, chain: NumericChain, determinant: ScaledDeterminant, places: Array, active: Sequence[int]
    ) -> None:
        self._chain, self._determinant, self._active = chain, determinant, list(active)
        self._places = places
        pairs = {(min(i, j), max(i, j)) for i, near in enumerate(self._near(places)) for j in near if i != j}
        self._pairs = sorted(pairs)
        self._clear = self._clearances(places[[i for i, _ in self._pairs]], places[[j for _, j in self._pairs]])

    def _way(self, start: Array, end: Array) -> Array:
        """The shortest way, around by the other side where angles are nearer there."""
        way = end - start
        return np.asarray(np.where(self._chain.revolute, way - 2.0 * math.pi * np.round(way / (2.0 * math.pi)), way))

    def _near(self, q: Array) -> list[list[int]]:
        ways = (self._way(own, self._places)[:, self._active] for own in q)
        return [np.argsort(np.sum(way**2, axis=-1), kind="stable")[: _NEIGHBOURS + 1].tolist() for way in ways]

    def _clearances(self, starts: Array, ends: Array) -> Array:
        """The smallest amount of det J on straight pieces; 0 where it changes its sign."""
        values = self._determinant(starts + np.linspace(0.0, 1.0, _STEPS)[:, None, None] * self._way(starts, ends))
        same = (np.sign(values) == np.sign(values[0])).all(axis=0)
        return np.where(same, np.abs(values).min(axis=0, initial=np.inf), 0.0)

    def path(self, start: Array, end: Array) -> Crossing | None:
        """The path that stays clearest of singularities."""
        places = np.concatenate([self._places, start[None], end[None]])
        ends = len(places) - 2, len(places) - 1
        more = [(j, own) for own, near in zip(ends, self._near(places[-2:]), strict=True) for j in near] + [ends]
        clear = self._clearances(places[[i for i, _ in more]], places[[j for _, j in more]])
        way = _widest(*ends, [*self._pairs, *more], [*self._clear, *clear])
        if way is None:
            return None
        # Corners are left out where straight pieces without them are nearly as clear of singularities.
        corners, path, at = places[way], [start], 0
        enough = self._clearances(corners[:-1], corners[1:]).min() / 2.0
        while at < len(corners) - 1:
            ahead = self._clearances(np.broadcast_to(corners[at], corners[at + 1 :].shape), corners[at + 1 :])
            at += 1 + int(np.flatnonzero(ahead >= enough).max(initial=0))
            path.append(path[-1] + self._way(path[-1], corners[at]))
        return self._verified(np.array(path))

    def _verified(self, path: Array) -> Crossing | None:
        """The path, where det J keeps its sign between places so near that it changes by less than half of itself."""
        share = np.linspace(0.0, 1.0, _STEPS)[:, None]
        q = np.concatenate([a + share * (b - a) for a, b in pairwise(path)])
        for _ in range(_HALVINGS):
            values = self._determinant(q)
            if np.abs(values).min() <= CLEAR or np.ptp(np.sign(values)) > 0.0:
                return None
            small = np.minimum(np.abs(values[:-1]), np.abs(values[1:]))
            # Where det J changes by more than half of itself it could be zero in between: such pieces are halved.
            rough = np.flatnonzero(np.abs(np.diff(values)) > small / 2.0)
            if not len(rough):
                return Crossing(path, float(np.abs(values).min()))
            q = np.insert(q, rough + 1, (q[rough] + q[rough + 1]) / 2.0, axis=0)
        return None


def _widest(start: int, end: int, pairs: Sequence[tuple[int, int]], clear: Sequence[float]) -> list[int] | None:
    """The places on the way between two of them, by pairs whose clearances are as large as they can be."""
    roads = dict[int, list[tuple[float, int]]]()
    for (i, j), clearance in zip(pairs, clear, strict=True):
        for one, other in ((i, j), (j, i)) if clearance > CLEAR else ():
            roads.setdefault(one, []).append((-clearance, other))
    # Prim's maximum spanning tree: its path between two places has the widest clearance of all.
    before, front = dict[int, int](), [(0.0, start, start)]
    while front and end not in before:
        _, place, last = heappop(front)
        if place not in before:
            before[place] = last
            for clearance, beside in roads.get(place, ()):
                heappush(front, (clearance, beside, place))
    found = [end]
    while found[-1] != start and end in before:
        found.append(before[found[-1]])
    return found[::-1] if end in before else None


# -- which singularities are seen in the inverse kinematics, found by looking: at zeros of a factor of det J solutions
# meet, or are infinitely many; there the conditions of every step of the derivation are computed

LOOKED_AT = 3  # zeros of a factor that are looked at
# Below it a condition of a step is zero: a square root halves the digits of a zero of the factor.
_VANISHES = mpmath.mpf(10) ** -12
_TRIES = 40
_GRID = 24  # intervals of a joint's way in which a factor is looked for a change of its sign


def coincidences(
    found: InverseKinematics, factors: Sequence[SingularFactor]
) -> tuple[tuple[tuple[SingularFactor, ...], tuple[SingularFactor, ...]], ...]:
    """For each step the factors of det J at whose zeros its two values are one, and those at whose zeros it is free."""
    moving = [factor for factor in factors if factor.condition is not None]
    places = [(factor, list(islice(_zeros(found, factor), LOOKED_AT))) for factor in moving]

    def _where_zero(conditions: Sequence[Expr]) -> tuple[SingularFactor, ...]:
        vanishing = []
        for factor, zeros in places if conditions else ():
            pairs = product(conditions, zeros)
            with mpmath.workdps(DIGITS), suppress(ArithmeticError, ValueError):  # what has no value is not zero
                if zeros and all(abs(value_of(e, known)) < _VANISHES for e, known in pairs):
                    vanishing.append(factor)
        return tuple(vanishing)

    # Values of a step become one where its condition, an inequality, holds with equality.
    merged = (() if step.exists is sympy.true else (step.exists.lhs - step.exists.rhs,) for step in found.steps)
    return tuple((_where_zero(own), _where_zero(step.free)) for own, step in zip(merged, found.steps, strict=True))


def _zeros(found: InverseKinematics, factor: SingularFactor) -> Iterator[Numbers]:
    """Numbers of everything that is named, at configurations at which a factor is zero."""
    rng = random.Random(5)
    variables = [sympy.Symbol(joint.variable) for joint in found.robot.joints]
    with mpmath.workdps(DIGITS):
        for _ in range(_TRIES):
            values = parameter_numbers(found.robot, rng)
            q = {symbol: mpmath.mpf(rng.randint(-300, 300)) / 101 for symbol in variables}
            joint = variables[factor.condition.joints[-1] - 1] if factor.condition else variables[-1]
            zero = _zero(factor.expression, {**values, **q}, joint)
            if zero is not None:
                yield _known(found, values, {**q, joint: zero})


def _zero(expression: Expr, known: Numbers, joint: Expr) -> Any:
    """A zero of an expression in one joint variable, by halving an interval; None where its sign does not change."""
    # A little more than a full turn, so that no change of sign lies at its ends.
    grid = [mpmath.mpf(7 * k) / _GRID - mpmath.mpf("3.4") for k in range(_GRID + 1)]
    values = [value_of(expression, {**known, joint: x}) for x in grid]
    size = max(map(abs, values))
    for k in range(_GRID):
        if values[k] * values[k + 1] < 0:
            ends, tolerance = (grid[k], grid[k + 1]), mpmath.mpf(10) ** -(2 * 28)
            return mpmath.findroot(
                lambda x: value_of(expression, {**known, joint: x}) / size, ends, solver="anderson", tol=tolerance
            )
    return None


def _known(found: InverseKinematics, values: Numbers, q: Numbers) -> Numbers:
    """Numbers of pose, joint variables, their sums and all named quantities; a choice of sign is plus."""
    known = found.values_at(values, q) | q
    known |= {name: value_of(total, known) for total, name in found.sums.items()}
    for line in found.lines:
        signs: Numbers = {symbol: mpmath.mpf(1) for symbol in line.value.free_symbols if isinstance(symbol, Sign)}
        if line.symbol.is_Symbol and line.symbol not in known:
            try:
                known[line.symbol] = value_of(line.value, {**known, **signs})
            except (ArithmeticError, ValueError):  # a root that vanishes here is negative by rounding
                known[line.symbol] = mpmath.mpf(0)
    return known
