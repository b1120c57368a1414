"""Random arms and trees in floats: the recursions themselves, without a tape between them and the numbers."""

from __future__ import annotations

import random
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, partial
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.floats import FloatDomain
from derive.model.identification.base_parameters import base_set
from derive.robot import tree
from derive.robot.expression import Number
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.random_robots import configurations, random_robot, seeds
from tests.random_trees import random_tree

Array = npt.NDArray[np.float64]
SEEDS = range(21)


@dataclass(frozen=True)
class Arm:
    """A random robot whose symbols all have numbers, at a state."""

    robot: Robot
    q: Array  # joint variables; likewise velocities and accelerations
    qd: Array
    qdd: Array

    @property
    def chain(self) -> Chain[float]:
        return self.chain_of(self.robot)

    def chain_of(self, robot: Robot) -> Chain[float]:
        return build_chain(robot, FloatDomain(robot, self.q.tolist()))

    def limb(self) -> Arm:
        """The arm to the last end, with the bodies of its joints."""
        arm, places = tree.arm(self.robot, tree.ends(self.robot)[-1].name)
        arm = replace(arm, links=tuple(self.robot.links[place] for place in places))
        return Arm(arm, *(state[list(places)] for state in (self.q, self.qd, self.qdd)))

    def expected(self, function: str, *arguments: Array) -> Array:
        base = base_set(self.robot).parameters if "regressor" in function else None
        return Oracle.of(self.robot, base=base).evaluate(function, *(arguments or (self.q,)))


@cache
def arm_of(seed: int) -> Arm:
    drawn = random_robot(random.Random(seed), 1 + seed % 7)
    robot = Robot.from_text(drawn.text)
    known = dict(robot.parameters) | {name: Number(Fraction(value)) for name, value in drawn.values.items()}
    robot = replace(robot, parameters=tuple(known.items()), runtime=())
    return moving(robot, seed)


@cache
def tree_of(seed: int) -> Arm:
    return moving(random_tree(random.Random(seed)).robot, seed)


def trees_of(count: int, usual: int, swept: int) -> list[Any]:
    """What makes a tree, for each seed as `seeds` has them."""
    drawn = seeds(count, usual, swept)
    return [pytest.param(partial(tree_of, *s.values), marks=s.marks, id=f"tree{s.values[0]}") for s in drawn]


def moving(robot: Robot, seed: int) -> Arm:
    q, qd, qdd = configurations(random.Random(seed + 1), robot.n, 3)
    return Arm(robot, q, qd, qdd)


def assert_close(found: Any, wanted: Any, tolerance: float = 1e-12) -> None:
    found, wanted = np.array(found, dtype=float), np.array(wanted, dtype=float)
    assert found.shape == wanted.shape
    assert np.abs(found - wanted).max(initial=0.0) <= tolerance * max(1.0, np.abs(wanted).max(initial=0.0))
