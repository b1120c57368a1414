"""Where an arm loses a direction of its end effector, and which factor of det J vanishes there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from sympy import Expr, Symbol, sstr

from derive.errors import DeriveError
from derive.model.kinematic_model import KinematicModel
from derive.motion.functions import Functions
from derive.motion.hermite import Array
from derive.robot.robot import Robot

PROBES = 8
"""Configurations at which the rank of J is looked at."""


def usual_rank(functions: Functions, rows: Sequence[int]) -> int:
    """In how many directions the end effector moves where the arm is not singular.

    Args:
        functions: With ``jacobian``.
        rows: Of the twist.
    """
    places = np.random.default_rng(0).uniform(-1, 1, (PROBES, functions.n))
    return max(int(np.linalg.matrix_rank(functions("jacobian", q)[list(rows)], tol=1e-9)) for q in places)


def vanishing_factor(robot: Robot, values: Mapping[str, float], q: Array) -> str:
    """The factor of det J that is nearest to zero.

    Args:
        robot: The arm.
        values: Numbers of its symbols.
        q: Joint variables, (n,).

    Returns:
        The formula; nothing where the arm has no such factor.
    """
    numbers = {Symbol(name): value for name, value in values.items()}
    numbers |= {Symbol(joint.variable): float(v) for joint, v in zip(robot.joints, q, strict=True)}
    try:
        factors = KinematicModel(robot).singularities.factors
    except DeriveError:
        return ""

    def _size(factor: Expr) -> float:
        return abs(float(factor.subs(numbers)))

    moving = [factor.expression for factor in factors if factor.condition is not None]
    return sstr(min(moving, key=_size)) if moving else ""
