"""The end effector on a spline through points: its place and its orientation are cubic splines of time.

The orientation is R(t) = exp(w(t)^) R_0 with a spline w through the rotation vectors of the points. Its angular
velocity is omega = V w' with V = 1 + a w^ + b w^ w^, a = (1 - cos x)/x^2, b = (x - sin x)/x^3, x = |w|, the left
Jacobian of the exponential (Murray, Li and Sastry, A Mathematical Introduction to Robotic Manipulation, 1994, 2.4).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial

import numpy as np
from sympy import Expr, Float

from derive.arrays import Array
from derive.motion.curves.trajectory import Trajectory
from derive.motion.paths.poses import Way, cross_matrix, rotation_of, rotation_vector
from derive.plans.profile import spline
from derive.plans.segments import Segment

TERMS = 24  # of the power series of a and b, which are exact to rounding up to a whole turn


def spline_way(times: Sequence[Expr], poses: Sequence[Array]) -> Way:
    """The way through poses, by time; they are passed at rational times from 0 on [s]."""
    start = poses[0][:3, :3]
    turns = [np.zeros(3)]
    for pose in poses[1:]:
        turn = rotation_vector(pose[:3, :3] @ start.T)
        angle = float(np.linalg.norm(turn))
        # Of the same rotation the vector that is nearest to the one before.
        axis = turn / angle if angle >= 1e-12 else np.zeros(3)
        turns.append(turn + 2 * np.pi * np.round((turns[-1] - turn) @ axis / (2 * np.pi)) * axis)
    rows = np.array([[*pose[:3, 3], *turn] for pose, turn in zip(poses, turns, strict=True)])
    tracks = tuple(spline(times, [Float(value) for value in column]) for column in rows.T)
    trajectory = Trajectory((Segment("", times[0], times[-1] - times[0], tracks),))

    def _place(t: float) -> tuple[Array, Array, Array]:
        p, v, a = (value[:3] for value in trajectory(t))
        return p, v, a

    def _turned(t: float) -> tuple[Array, Array, Array]:
        w, rate, bend = (value[3:] for value in trajectory(t))
        return rotation_of(w) @ start, *angular_motion(w, rate, bend)

    return Way(_place, _turned)


def angular_motion(w: Array, rate: Array, bend: Array) -> tuple[Array, Array]:
    """Angular velocity omega = V w' and acceleration V w'' + V' w', (3,) each, by the rotation vector w [rad]."""
    # With x = |w|^2: V = 1 + a w^ + b w^ w^ and V' by the product rule, a' = (da/dx) x', x' = 2 w.w'.
    x, slope = float(w @ w), 2 * float(w @ rate)  # the square of the angle, and its rate
    cross, turning = cross_matrix(w), cross_matrix(rate)
    square, squared = cross @ cross, turning @ cross + cross @ turning
    # a = sum (-x)^k / (2k + 2)!, b = sum (-x)^k / (2k + 3)!: no division by an angle that is zero.
    series = [[(-1) ** k / factorial(2 * k + least) for k in range(TERMS)] for least in (2, 3)]
    a, b = (float(np.polyval(terms[::-1], x)) for terms in series)
    da, db = (float(np.polyval([k * term for k, term in enumerate(terms)][:0:-1], x)) for terms in series)
    jacobian = np.eye(3) + a * cross + b * square
    drift = da * slope * cross + a * turning + db * slope * square + b * squared
    return jacobian @ rate, jacobian @ bend + drift @ rate
