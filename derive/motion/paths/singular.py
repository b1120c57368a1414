"""Where an arm loses a direction of its end effector, and which of its singularities that is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from sympy import Symbol, sstr

from derive.arrays import Array
from derive.errors import DeriveError
from derive.motion.torques.functions import Functions
from derive.robot.robot import Robot

if TYPE_CHECKING:
    from derive.model.singularities.conditions import Condition

NEAR = 0.25  # of what a factor is elsewhere: below it a singularity is near
PROBES = 8  # configurations at which the rank of J is looked at


def usual_rank(functions: Functions, rows: Sequence[int]) -> int:
    """In how many directions the end effector moves where the arm is not singular."""
    return max(int(np.linalg.matrix_rank(jacobian[list(rows)], tol=1e-9)) for jacobian in _jacobians(functions))


def all_directions(functions: Functions) -> int:
    """How many directions the twists of the end effector have over all configurations."""
    return int(np.linalg.matrix_rank(np.hstack(_jacobians(functions)), tol=1e-9))


def _jacobians(functions: Functions) -> list[Array]:
    """J at random configurations."""
    return [functions("jacobian", q) for q in np.random.default_rng(0).uniform(-1, 1, (PROBES, functions.n))]


def vanishing_factor(robot: Robot, values: Mapping[str, float], q: Array) -> str:
    """What vanishes at the singularity that is nearest: a factor of det J, or factors that are zero together."""
    from derive.model.kinematic_model import KinematicModel  # closed forms are needed for this message alone

    try:
        families = KinematicModel(robot).singularities.families
    except DeriveError:
        return ""
    numbers = {Symbol(name): value for name, value in values.items()}
    variables = [Symbol(joint.variable) for joint in robot.joints]
    # The size of a factor counts relative to its largest one at random configurations.
    places = [q, *np.random.default_rng(0).uniform(-3, 3, (PROBES, len(q)))]

    def _size(family: tuple[Condition, ...]) -> float:
        """How near it is, as a part of how far it is elsewhere."""
        at = [numbers | dict(zip(variables, map(float, place), strict=True)) for place in places]
        here, *elsewhere = ([abs(float(c.expression.subs(known))) for c in family] for known in at)
        return max(float(size / max(sizes)) for size, sizes in zip(here, zip(*elsewhere, strict=True), strict=True))

    nearest = min(families, key=_size, default=())
    return " = 0 and ".join(sstr(c.expression) for c in nearest) if nearest and _size(nearest) < NEAR else ""
