"""How many solutions there are, so that it can be said that none is missing.

The configurations of an arm form one irreducible variety, and so do pairs of configuration and pose: the number of
complex solutions over a generic reachable pose is one number. Every solution passes through all nodes, for their
equations hold at all of them; so there are at most as many as leaves. Run over integers modulo a prime at poses that
the arm reaches, the leaves that lead back to the pose are counted: all of them are there as soon as every square root
of the graph has a value, which is so at one of many poses. Graphs with quartics are run over the complex numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from derive.algebra.residues import Residue, ResidueDomain
from derive.inverse.closed.fields import ComplexField, PrimeField
from derive.inverse.closed.graph import SolutionGraph
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.closed.unknowns import InverseDomain
from derive.inverse.closed.walk import GraphWalk, Leaf, pose_of
from derive.mechanics.chain import build_chain
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.robot.evaluate import to_float
from derive.robot.expression import ZERO, Expression
from derive.robot.names import free_symbols

_COUNTED = 3  # poses at which leaves are counted
_COMPLEX = 9  # complex poses at which leaves are counted; a few of them may be too ill-conditioned to tell
_CLOSES = 1e-6  # complex leaves that miss the pose by more than this part of its size do not lead there
_SAMPLES = 512  # poses modulo a prime: with seven independent square roots four of them have them all


def counted(graph: SolutionGraph, sampled: InverseDomain, numbers: Mapping[str, Expression]) -> SolutionGraph:
    """A graph with the number of its solutions."""
    # joint variables are counted from where their cells have no constants: an angle has no value modulo a prime
    graph, original = replace(graph, shifts=(ZERO,) * graph.robot.n), graph
    count = 0
    if all(node.kind is not NodeKind.CONIC for node in graph.nodes):
        count = _modulo_prime(graph, sampled, numbers)
    count = count or _over_complex(graph, numbers)
    return replace(original, count=count, complete=count > 0)


def _modulo_prime(graph: SolutionGraph, sampled: InverseDomain, numbers: Mapping[str, Expression]) -> int:
    """The number of leaves that lead to the pose; 0 where some square root is missing at every sample."""
    residues = ResidueDomain(sampled, _SAMPLES, seed=2)
    field = PrimeField(residues, numbers)
    chain = build_chain(sampled.robot, residues)
    frame = forward_kinematics(chain)
    pose = [[*frame.rotation[i], frame.position[i]] for i in range(3)]
    given = [_half_angle(sampled, residues, joint, field) for joint in graph.given]
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
        again = pose_of(run, leaf.joints)
        closes = everything.copy()
        for row, column in graph.places:
            ours = again.position[row] if column == 3 else again.rotation[row][column]
            closes &= (ours - pose[row][column]).values == 0
        for excess in _off_circle(leaf):
            closes &= excess.values == 0
        flat = [np.broadcast_to(x.values, (_SAMPLES, 1))[:, 0] for own in leaf.joints for x in own]
        closing.append((closes[:, 0], np.stack(flat, axis=1)))
    # Of leaves that lead to the pose each different one counts.
    return max(len({tuple(leaf[k].tolist()) for closes, leaf in closing if closes[k]}) for k in good[:_COUNTED])


def _over_complex(graph: SolutionGraph, numbers: Mapping[str, Expression]) -> int:
    """The number of leaves that lead to random complex poses; 0 where it is not the same at most of them.

    Quartics have no roots modulo a prime as often as not, but over the complex numbers they have all four.
    """
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
        again = pose_of(run, leaf.joints)
        miss = np.zeros(_COMPLEX)
        for i, j in graph.places:
            miss = np.maximum(miss, np.abs((again.position[i] if j == 3 else again.rotation[i][j]) - pose[i][j]))
        for excess in _off_circle(leaf):
            miss = np.maximum(miss, np.abs(excess))
        flat = np.stack([np.broadcast_to(x, (_COMPLEX,)) for own in leaf.joints for x in own])
        for k in np.flatnonzero(miss < _CLOSES * size):
            if all(np.abs(flat[:, k] - other).max() > _CLOSES for other in solutions[k]):
                solutions[k].append(flat[:, k])
    counts = sorted(len(found) for found in solutions)
    middle = counts[len(counts) // 2]
    return middle if counts.count(middle) > len(counts) // 2 else 0


def _off_circle(leaf: Leaf[Any, Any]) -> list[Any]:
    """By how much c^2 + s^2 of the joints differ from 1: a pose may be right with pairs that are of no angle."""
    return [pair[0] * pair[0] + pair[1] * pair[1] - 1 for pair in leaf.joints if len(pair) == 2]


def _half_angle(sampled: InverseDomain, residues: ResidueDomain, joint: int, field: PrimeField) -> Residue:
    row = sampled.robot.joints[joint]
    if not row.is_revolute:
        return residues.value(sampled.ring.generator(row.variable))
    cosine, sine = map(residues.value, sampled.cosine_sine_of(joint))
    return field.angle(cosine, sine)
