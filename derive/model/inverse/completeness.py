"""How many solutions there are, so that it can be said that none is missing.

The configurations of an arm form one irreducible variety, and so do pairs of configuration and pose: the number of
complex solutions over a generic reachable pose is one number. Every solution passes through all nodes, for their
equations hold at all of them; so there are at most as many as leaves. Run over integers modulo a prime at poses that
the arm reaches, the leaves that lead back to the pose are counted: all of them are there as soon as every square root
of the graph has a value, which is so at one of many poses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from derive.algebra.residues import Residue, ResidueDomain
from derive.mechanics.chain import build_chain
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.model.inverse.fields import PrimeField
from derive.model.inverse.graph import Leaf, Run, SolutionGraph, pose_of
from derive.model.inverse.nodes import Kind
from derive.model.inverse.unknowns import InverseDomain
from derive.robot.expression import Expression

_COUNTED = 3
"""Poses at which leaves are counted."""

_SAMPLES = 512
"""Poses modulo a prime: with seven independent square roots four of them have them all."""


def counted(graph: SolutionGraph, sampled: InverseDomain, numbers: Mapping[str, Expression]) -> SolutionGraph:
    """A graph with the number of its solutions.

    Args:
        graph: The graph.
        sampled: The ring of its arm with numbers in place of the parameters that have numbers.
        numbers: These numbers.

    Returns:
        The graph; `SolutionGraph.complete` is set where the count is certain.
    """
    count = 0
    if all(node.kind not in (Kind.CONIC, Kind.GENERAL) for node in graph.nodes):
        count = _modulo_prime(graph, sampled, numbers)
    return replace(graph, count=count, complete=count > 0)


def _modulo_prime(graph: SolutionGraph, sampled: InverseDomain, numbers: Mapping[str, Expression]) -> int:
    """The number of leaves that lead to the pose; 0 where some square root is missing at every sample."""
    residues = ResidueDomain(sampled, _SAMPLES, seed=2)
    field = PrimeField(residues, numbers)
    chain = build_chain(sampled.robot, residues)
    frame = forward_kinematics(chain)
    pose = [[*frame.rotation[i], frame.position[i]] for i in range(3)]
    given = [_half_angle(sampled, residues, joint, field) for joint in graph.given]
    run = Run(graph, field, pose, given)
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
        closing.append(closes)
    counts = [_distinct(leaves, closing, int(k)) for k in good[:_COUNTED]]
    return max(counts)


def _distinct(leaves: Sequence[Leaf[Residue, Any]], closing: Sequence[Any], sample: int) -> int:
    """How many different leaves lead to the pose of one sample."""
    found = set()
    for leaf, closes in zip(leaves, closing, strict=True):
        if closes[sample, 0]:
            numbers = [np.broadcast_to(x.values, (len(closes), 1))[sample, 0] for own in leaf.joints for x in own]
            found.add(tuple(map(int, numbers)))
    return len(found)


def _half_angle(sampled: InverseDomain, residues: ResidueDomain, joint: int, field: PrimeField) -> Residue:
    """The number that stands for the variable of a joint."""
    row = sampled.robot.joints[joint]
    if not row.is_revolute:
        return residues.value(sampled.ring.generator(row.variable))
    cosine, sine = map(residues.value, sampled.cosine_sine_of(joint))
    return field.angle(cosine, sine)
