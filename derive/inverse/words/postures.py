"""The branches of a graph by name, in the one order that print and generated code have.

At random reachable poses every leaf of the graph is looked at: what the arm looks like in it gives its name
(`derive.inverse.words.branch_names`), and to which leaf a printed solution leads gives its place.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np

from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import SolutionGraph
from derive.inverse.closed.walk import GraphWalk
from derive.inverse.words.branch_names import Shape, Vector, branch_names, placed
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.floats import ArrayDomain
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.robot.evaluate import Values, parameter_values, to_float
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

LOOKED_AT = 60  # random poses at which the arm is looked at
_KEPT = 32  # graphs whose branches are kept for those who ask again


@dataclass(frozen=True, eq=False)
class Postures:
    """The branches of a graph at some poses."""

    # What each is called; ``#3`` where words do not tell the third one from others, empty where it is the only one or
    # exists at none of the poses.
    names: tuple[str, ...]
    parameters: Values  # numbers of the parameters: those of the file, random ones for the others
    q: Vector  # (n, poses) the configurations that the poses are made of
    branches: tuple[Vector, ...]  # (n, poses) for each branch, not a number where it does not exist

    def places(self, printed: Sequence[Vector]) -> list[int]:
        """To which branch each of as many solutions leads, most often; each to another one.

        Args:
            printed: (n, poses) for each solution, not a number where it does not exist.
        """
        hits: Counter[tuple[int, int]] = Counter()
        with np.errstate(invalid="ignore"):
            for k, own in enumerate(printed):
                among = self.branches[: len(printed)]
                apart = [np.abs(np.exp(1j * own) - np.exp(1j * branch)).sum(axis=0) for branch in among]
                real = np.isfinite(own).all(axis=0) & np.isfinite(apart).any(axis=0)
                nearest = np.argmin(np.where(np.isfinite(apart), apart, np.inf), axis=0)[real]
                hits.update((k, int(place)) for place in nearest)
        found: dict[int, int] = {}
        pairs = [pair for pair, _ in hits.most_common()]
        pairs += [(k, place) for k in range(len(printed)) for place in range(len(printed))]
        for k, place in pairs:
            if k not in found and place not in found.values():
                found[k] = place
        return [found[k] for k in range(len(printed))]


@lru_cache(_KEPT)
def postures(robot: Robot, graph: SolutionGraph) -> Postures:
    """The branches of an arm."""
    rng = np.random.default_rng(12)
    numbers, known = random.Random(12), parameter_values(robot)
    for name in robot_symbols(robot):
        known.setdefault(name, Fraction(numbers.randint(20, 90), 97))
    q = np.stack(
        [rng.uniform(-3, 3, LOOKED_AT) if j.is_revolute else rng.uniform(-1, 1, LOOKED_AT) for j in robot.joints]
    )
    end = forward_kinematics(_chain(robot, known, q))
    rows = [
        [np.broadcast_to(x, LOOKED_AT) + 0.0 for x in (*row, place)]
        for row, place in zip(end.rotation, end.position, strict=True)
    ]
    run: GraphWalk[Any, Any] = GraphWalk(graph, FloatField(known), rows, [q[k] for k in graph.given])
    branches = []
    with np.errstate(all="ignore"):  # where a branch does not exist its numbers are any
        for leaf in run.leaves():
            own = np.stack([np.broadcast_to(x, LOOKED_AT) + 0.0 for x in run.angles(leaf)])
            real = np.broadcast_to(leaf.exists, LOOKED_AT) & np.isfinite(own).all(axis=0)
            branches.append(np.where(real, own, np.nan))
    return Postures(_names(robot, known, q, branches), known, q, tuple(branches))


def _names(robot: Robot, known: Values, q: Vector, branches: Sequence[Vector]) -> tuple[str, ...]:
    """Words for the branches where they hold wherever the arm is looked at, else their numbers."""
    names = [""] * len(branches)
    real = [np.isfinite(own).all(axis=0) for own in branches]
    met = [k for k, own in enumerate(real) if own.any()]
    if len(branches) > 1 and met:
        own = [branches[k][:, real[k]] for k in met]
        seen = [placed(_chain(robot, known, one), list(one), one.shape[1]) for one in own]
        shape = Shape(robot, placed(_chain(robot, known, q), list(q), LOOKED_AT)[0], _up(robot))
        for k, name in zip(met, branch_names(shape, seen, [f"#{k + 1}" for k in met]), strict=True):
            names[k] = name
    return tuple(names)


def _chain(robot: Robot, known: Values, q: Vector) -> Chain[Any]:
    """The arm at many configurations."""
    bare = replace(robot, links=(), gravity=None)
    return build_chain(bare, ArrayDomain(bare, list(q), known))


def _up(robot: Robot) -> Vector | None:
    """The direction against gravity, where the robot file has one; a symbol in it counts as positive."""
    if robot.gravity is None:
        return None
    down = [to_float(cell, dict.fromkeys(robot_symbols(robot), 1)) for cell in robot.gravity]
    length = float(np.linalg.norm(down))
    return -np.array(down) / length if length else None
