"""The pose: what of it is zero, one or equal wherever the arm reaches, names for the rest, and conditions on it.

The poses that an arm of n < 6 joints reaches are a set of n dimensions among six. Outside it equations of the pool do
not hold; as many of them are taken as there are dimensions missing: entries of T that are constant or equal first, then
the shortest equations. That they say different things is seen from their derivatives at a pose that is reached, in the
six directions in which it can be left; where an equation needs joints, these follow from the pose by the graph.
"""

import re
from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from derive.algebra.ring import Polynomial
from derive.arrays import Array
from derive.inverse.closed.evidence import Evidence
from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import GraphWalk, SolutionGraph, pose_of
from derive.inverse.closed.nodes import NodeEquation, Provenance
from derive.inverse.closed.pool import Atoms, Links, dimension, frame_of, scaled
from derive.inverse.closed.unknowns import InverseDomain, turned
from derive.mechanics.vectors import Matrix, Vector, add_matrices, dot, hat, matmul, multiply, outer, transpose
from derive.robot.evaluate import to_float
from derive.robot.expression import Expression, names
from derive.robot.names import free_symbols
from derive.robot.options.inverse import ROWS

_STEP = 1e-5  # by how much the pose is left, against the reach of the arm
_INDEPENDENT = 1e-6  # a derivative that adds less than this to the others says nothing new
_PLACE = re.compile(r"T\[(\d),(\d)\]")

# Entries of T in the order in which they are looked at: books begin with the third column.
_CONSTANT_ORDER = ((1, 3), (2, 3), (3, 3), (3, 1), (3, 2), (1, 1), (2, 1), (1, 2), (2, 2), (1, 4), (2, 4), (3, 4))


class Pose:
    """The pose in exact polynomials: entries that are always zero, one or equal are not told apart.

    `atoms` are W and its invariants; `definitions` by generator polynomials of T and of those defined before;
    `constant` what vanishes, by entries of the position within the arm that are a number or another entry.
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
        self._known: list[tuple[int, bool, tuple[int, ...], Polynomial]] = []
        self.definitions: dict[str, Polynomial] = {}
        places = [(i, j) for j in range(4) for i in range(3)]
        first = sorted(places, key=lambda place: (place[0] + 1, place[1] + 1) not in allowed)
        end = frame_of({(i, j): self._entry(f"T[{i + 1},{j + 1}]", None) for i, j in first})
        inner = links.base.inverse @ end @ links.tool.inverse
        self._known.clear()
        flat = {(i, j): inner.position[i] if j == 3 else inner.rotation[i][j] for i, j in places}
        told = sorted(places, key=lambda place: not evidence.is_told(f"W[{place[0] + 1},{place[1] + 1}]"))
        pose = frame_of({(i, j): self._entry(f"W[{i + 1},{j + 1}]", flat[i, j]) for i, j in told})
        r, p = pose.rotation, pose.position
        plain = [(f"p[{i + 1}]", flat[i, 3] - p[i]) for i in range(3) if f"W[{i + 1},4]" not in self.definitions]
        self.constant = {entry: difference for entry, difference in plain if difference}
        back = self._vector("u[", multiply(transpose(r), p))
        square = self._entry("p.p", dot(p, p))
        moment = reflection = None
        if deep:
            moment = self._matrix("m", matmul(hat(p, links.zero), r))
            reflection = self._matrix("k", add_matrices(scaled(square, r), scaled(-2, outer(p, back))))
        self.atoms = Atoms(r, p, back, square, moment, reflection)

    def _matrix(self, name: str, matrix: Matrix[Polynomial]) -> Matrix[Polynomial]:
        a, b, c = (self._vector(f"{name}[{i},", row) for i, row in enumerate(matrix, 1))
        return (a, b, c)

    def _vector(self, stem: str, vector: Vector[Polynomial]) -> Vector[Polynomial]:
        x, y, z = (self._entry(f"{stem}{k}]", value) for k, value in enumerate(vector, 1))
        return (x, y, z)

    def _entry(self, name: str, value: Polynomial | None) -> Polynomial:
        """An entry: zero, plus or minus one, plus or minus an earlier one, what it is if that is short, or its name."""
        # An earlier one has the same dimension, and what is told by the task is not written by what is not.
        ring, p = self._domain.ring, self._evidence.prime
        residues = self._evidence.number(name, self._constants)
        for number in (0, 1, -1):
            if np.all(residues == number % p):
                return ring.number(number)
        power = int(name.endswith(",4]")) if name[0] in "TW" else dimension(name)  # of length
        told = name[0] == "T" or self._evidence.is_told(name)
        for own_power, own_told, known, polynomial in self._known:
            if own_power == power and (own_told or not told):
                if np.all(residues == known):
                    return polynomial
                if np.all(residues == (p - np.array(known)) % p):
                    return -polynomial
        if value is None or not is_plain(value):
            if value is not None:
                self.definitions[name] = value
            value = ring.generator(name)
        self._known.append((power, told, tuple(int(x) for x in residues), value))
        return value


def is_plain(p: Polynomial) -> bool:
    """Whether a polynomial is a number, or plus or minus one generator."""
    return p.is_constant or (len(p) == 1 and sum(p.degrees()) == 1 and abs(next(iter(p.terms()))[1]) == 1)


def entry_conditions(
    graph: SolutionGraph, evidence: Evidence, constants: Mapping[str, Expression]
) -> list[NodeEquation]:
    """Entries of T that are always 0, 1, -1 or plus or minus another one."""
    ring, prime, whole = graph.domain.ring, evidence.prime, Provenance(1, graph.robot.n, "T")
    given = {place for row in graph.task for place in ROWS[row]}
    found, known = [], list[tuple[tuple[int, ...], Polynomial]]()
    for i, j in (place for place in _CONSTANT_ORDER if place in given):
        residues = evidence.number(f"T[{i},{j}]", constants)
        entry = ring.generator(f"T[{i},{j}]")
        # Constant or equal at all sampled poses of the arm, modulo the prime: identically so.
        same = [ring.number(k) for k in (0, 1, -1) if np.all(residues == k % prime)]
        same += [e * p for key, p in known for e in (1, -1) if np.all(residues == e * np.array(key) % prime)]
        found += [NodeEquation({(): entry - p}, 0 if j < 4 else 1, whole) for p in same[:1]]
        known.append((tuple(map(int, residues)), entry))
    return sorted(found, key=lambda equation: _number_of(equation) is None)


def conditions(
    graph: SolutionGraph,
    missing: int,
    equations: Iterable[tuple[Polynomial, Provenance]],
    evidence: Evidence,
    constants: Mapping[str, Expression],
    numbers: Mapping[str, Expression],
) -> tuple[NodeEquation, ...]:
    """Conditions on the pose, as many as dimensions are missing."""
    # An arm of n joints reaches n of 6 dimensions: 6 - n conditions with independent gradients there are wanted.
    leaving = _Leaving(graph, numbers)
    entries = entry_conditions(graph, evidence, constants)
    says = [_number_of(equation) for equation in entries]
    added = [leaving.adds(equation.coefficient()) for equation in entries]
    # A 1 or -1 follows from zeros beside it but for its sign, which no gradient shows: it is kept for that.
    zeros = {said[0] for said, is_new in zip(says, added, strict=True) if said and is_new and said[1] == 0}
    chosen = [e for e, said, is_new in zip(entries, says, added, strict=True) if is_new or _tells_sign(said, zeros)]
    for p, source in equations:
        if len(leaving.basis) >= missing:
            break
        if p and leaving.adds(p):
            chosen.append(NodeEquation({(): p}, dimension(source.entry), source))
    return tuple(chosen)


def _number_of(equation: NodeEquation) -> tuple[tuple[int, int], int] | None:
    """The place of an entry of T that is said to be 0, 1 or -1, and that number."""
    p = equation.coefficient()
    places = _PLACE.findall(" ".join(name for name, degree in zip(p.ring.names, p.degrees(), strict=True) if degree))
    numbers = [-int(coefficient) for exponents, coefficient in p.terms() if not any(exponents)]
    return ((int(places[0][0]), int(places[0][1])), sum(numbers)) if len(places) == 1 else None


def _tells_sign(said: tuple[tuple[int, int], int] | None, zeros: set[tuple[int, int]]) -> bool:
    """Whether an entry of R is 1 or -1 and the others of its row or column are among the zeros."""
    if said is None or said[1] == 0 or said[0][1] == 4:
        return False
    i, j = said[0]
    return {(i, k) for k in (1, 2, 3) if k != j} <= zeros or {(k, j) for k in (1, 2, 3) if k != i} <= zeros


class _Leaving:
    """Derivatives of equations where the reachable poses are left, an orthonormal `basis` of them so far."""

    def __init__(self, graph: SolutionGraph, numbers: Mapping[str, Expression]) -> None:
        rng = np.random.default_rng(6)
        values: dict[str, Fraction | float] = {name: to_float(value, {}) for name, value in numbers.items()}
        free = [*free_symbols(graph.robot), *(name for shift in graph.shifts for name in names(shift))]
        values |= {name: float(rng.uniform(0.3, 1)) for name in dict.fromkeys(free) if name not in values}
        field: Any = FloatField(values)
        q = rng.uniform(0.3, 1.2, graph.robot.n)
        joints = [(np.cos(x), np.sin(x)) if j.is_revolute else (x,) for j, x in zip(graph.robot.joints, q, strict=True)]
        frame: Any = pose_of(GraphWalk(graph, field, []), joints)
        rotation = np.array([[float(x) for x in row] for row in frame.rotation])
        poses = self._around(rotation, np.array([float(x) for x in frame.position]))
        given = [q[k] - field.constant(graph.shifts[k]) + np.zeros(13) for k in graph.given]
        self._run: GraphWalk[Any, Any] = GraphWalk(
            graph, field, [[poses[:, i, j] for j in range(4)] for i in range(3)], given
        )
        flat = np.array([x for own in joints for x in own])

        def _distance(leaf: Any) -> float:
            own = np.array([np.broadcast_to(x, (13,))[0] for numbers in leaf.joints for x in numbers])
            return float(np.abs(own - flat).max()) if np.broadcast_to(leaf.exists, (13,))[0] else 9.0

        # Of the arm's branches the one that the poses were made of.
        nearest = min(self._run.leaves(), key=_distance)
        self._values = dict(self._run.known)
        for unknown in graph.domain.unknowns():
            total: Any = nearest.joints[unknown.joints[0]]
            for joint, sign in zip(unknown.joints[1:], unknown.signs[1:], strict=True):
                total = turned(total, nearest.joints[joint], sign)
            self._values.update(zip(unknown.generators, total, strict=True))
        self.basis: list[Array] = []

    @staticmethod
    def _around(rotation: Array, position: Array) -> Array:
        """The pose, and the pose turned and moved a little in each direction, both ways."""
        poses = np.zeros((13, 3, 4))
        for k in range(13):
            # Central differences: six twists of the world, each forwards and backwards.
            axis, amount = (k - 1) % 6, 0.0 if k == 0 else _STEP if k < 7 else -_STEP
            turn = np.eye(3)
            moved = position.copy()
            if axis < 3:
                moved[axis] += amount
            else:
                a, b = (axis - 2) % 3, (axis - 1) % 3
                turn[a, a] = turn[b, b] = np.cos(amount)
                turn[b, a], turn[a, b] = np.sin(amount), -np.sin(amount)
            poses[k, :, :3], poses[k, :, 3] = turn @ rotation, moved
        return poses

    def adds(self, p: Polynomial) -> bool:
        """Whether the derivative of a polynomial is independent of those before; if so it joins them."""
        try:
            values = np.broadcast_to(self._run.evaluate(p, self._values), (13,))
        except KeyError:
            return False
        # The gradient in the six directions, less its parts along those before (Gram and Schmidt).
        slope = (values[1:7] - values[7:]) / (2 * _STEP)
        size = float(np.abs(slope).max())
        if not np.isfinite(size) or size < _INDEPENDENT:
            return False
        rest = slope / size
        for vector in self.basis:
            rest = rest - (rest @ vector) * vector
        if (length := float(np.linalg.norm(rest))) < 1e-4:
            return False
        self.basis.append(rest / length)
        return True
