"""What a pose must satisfy so that an arm with few joints reaches it.

The poses that an arm of n joints reaches are a set of n dimensions among six. Outside it equations of the pool do not
hold; as many of them are taken as there are dimensions missing: entries of T that are constant or equal first, then the
shortest equations. That they say different things is seen from their derivatives at a pose that is reached, in the
six directions in which it can be left; where an equation needs joints, these follow from the pose by the graph.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Mapping
from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.algebra.ring import Polynomial
from derive.inverse.closed.evidence import Evidence
from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import SolutionGraph
from derive.inverse.closed.nodes import NodeEquation, Provenance
from derive.inverse.closed.pool import dimension
from derive.inverse.closed.unknowns import turned
from derive.inverse.closed.walk import GraphWalk, pose_of
from derive.robot.evaluate import to_float
from derive.robot.expression import Expression, names
from derive.robot.names import free_symbols
from derive.robot.options.inverse import ROWS

Floats = npt.NDArray[np.float64]

_STEP = 1e-5  # by how much the pose is left, against the reach of the arm
_INDEPENDENT = 1e-6  # a derivative that adds less than this to the others says nothing new
_PLACE = re.compile(r"T\[(\d),(\d)\]")

# Entries of T in the order in which they are looked at: books begin with the third column.
_CONSTANT_ORDER = ((1, 3), (2, 3), (3, 3), (3, 1), (3, 2), (1, 1), (2, 1), (1, 2), (2, 2), (1, 4), (2, 4), (3, 4))


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
        number = next((k for k in (0, 1, -1) if np.all(residues == k % prime)), None)
        equal = [(p, sign) for key, p in known for sign in (1, -1) if np.all(residues == sign * np.array(key) % prime)]
        if number is not None:
            found.append(NodeEquation({(): entry - number}, 0 if j < 4 else 1, whole))
        elif equal:
            found.append(NodeEquation({(): entry - equal[0][1] * equal[0][0]}, 0 if j < 4 else 1, whole))
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
        if leaving.rank >= missing:
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


def _tells_sign(said: tuple[tuple[int, int], int] | None, zeros: Container[tuple[int, int]]) -> bool:
    """Whether an entry of R is 1 or -1 and the others of its row or column are among the zeros."""
    if said is None or said[1] == 0 or said[0][1] == 4:
        return False
    i, j = said[0]
    row, column = ([(i, k) for k in (1, 2, 3) if k != j], [(k, j) for k in (1, 2, 3) if k != i])
    return all(place in zeros for place in row) or all(place in zeros for place in column)


class _Leaving:
    """Derivatives of equations where the reachable poses are left.

    Attributes:
        rank: How many independent derivatives there are so far.
    """

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
        position = np.array([float(x) for x in frame.position])
        poses = self._around(rotation, position)
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
        self._values = {**self._run.known, **self._sums(graph, nearest.joints)}
        self.rank = 0
        self._basis = np.zeros((0, 6))

    @staticmethod
    def _around(rotation: Floats, position: Floats) -> Floats:
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

    @staticmethod
    def _sums(graph: SolutionGraph, joints: Any) -> dict[str, Any]:
        """Cosines and sines of all angles and sums of angles, and the slides."""
        found: dict[str, Any] = {}
        domain = graph.domain
        for group in domain.groups:
            for u, v in combinations(range(len(group) + 1), 2):
                unknown = domain.unknown(*group[u:v])
                total: Any = (1.0, 0.0)
                for joint, sign in zip(unknown.joints, unknown.signs, strict=True):
                    total = turned(total, joints[joint], sign)
                found.update(zip(unknown.generators, total, strict=True))
        for k, row in enumerate(graph.robot.joints):
            if not row.is_revolute:
                found[domain.unknown(k).generators[0]] = joints[k][0]
        return found

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
        for vector in self._basis:
            rest = rest - (rest @ vector) * vector
        length = float(np.linalg.norm(rest))
        if length < 1e-4:
            return False
        self._basis = np.vstack([self._basis, rest / length])
        self.rank += 1
        return True
