"""Incremental inverse kinematics: many small displacements of the hand, J^+ for each (document 001, slide 32).

Near a singular configuration J^+ is damped: a small singular value s counts as s/(s^2 + d^2), with d growing from zero
as it falls, and other directions are left alone (Nakamura and Hanafusa, 1986; Chiaverini, 1997; Siciliano et al.,
Robotics, 2009, 3.5.2).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from derive.errors import QuantityError
from derive.motion.functions import Functions
from derive.motion.hand_curve import kinematics_alone
from derive.motion.hermite import Array
from derive.motion.motion import Motion
from derive.motion.singular import usual_rank, vanishing_factor
from derive.robot.robot import Robot

NEAR = 0.05
"""Singular value of J, relative to the largest, below which its direction is damped."""

DAMPING = 0.05
"""Damping at a singular configuration, relative to the largest singular value."""

CLOSED = 1e-12
"""Distance at which the hand has arrived, relative to how far it goes."""

CORRECTIONS = 50
"""Most corrections at the end."""


@dataclass(frozen=True, slots=True)
class Increments:
    """A displacement of the hand in small steps.

    Attributes:
        q: Joint variables after each step, the start first, (steps + 1, n).
        error: Distance from the target after the last step, before any correction [m].
        corrections: Steps of J^+ towards the target after that.
        closed: Distance from the target then [m].
        damped: How many steps were damped.
        factor: The factor of det J that was smallest where the arm came nearest to a singular configuration, also while
            it was corrected; empty where it came near none.
    """

    q: Array
    error: float
    corrections: int
    closed: float
    damped: int
    factor: str


class Walker:
    """Moves the hand of a robot in small steps.

    Args:
        robot: The robot.
        values: Numbers of all symbols.
    """

    def __init__(self, robot: Robot, values: Mapping[str, float]) -> None:
        self._robot = kinematics_alone(robot)
        self._values = values
        self._functions = Functions(self._robot, frozenset({"forward_kinematics", "jacobian"}), values)

    def place(self, q: Array) -> Array:
        """Where the hand is, (3,) [m].

        Args:
            q: Joint variables, (n,).
        """
        return self._functions("forward_kinematics", q)[:3, 3]

    def walk(self, q: Array, target: Array, steps: int) -> Increments:
        """Along the straight line to a target, each step from where the line should be.

        Args:
            q: Joint variables at the start, (n,).
            target: Where the hand goes, (3,) [m].
            steps: How many displacements.

        Returns:
            The way, and how well it ends: the error before correction falls with the length of a step.
        """
        way = target - self.place(q)
        rows, damped, worst = [q], 0, (np.inf, q)
        for _ in range(steps):
            inverse, ratio = self._pseudoinverse(q)
            damped += ratio < NEAR
            worst = min(worst, (ratio, q), key=lambda pair: pair[0])
            q = q + inverse @ (way / steps)
            rows.append(q)
        error, corrections = float(np.linalg.norm(target - self.place(q))), 0
        left = error
        while left > CLOSED * (1 + float(np.linalg.norm(way))) and corrections < CORRECTIONS:
            inverse, ratio = self._pseudoinverse(q, left)
            worst = min(worst, (ratio, q), key=lambda pair: pair[0])
            q = q + inverse @ (target - self.place(q))
            left, corrections = float(np.linalg.norm(target - self.place(q))), corrections + 1
        factor = vanishing_factor(self._robot, self._values, worst[1]) if worst[0] < NEAR else ""
        return Increments(np.array([*rows[:-1], q]), error, corrections, left, int(damped), factor)

    def _pseudoinverse(self, q: Array, most: float = np.inf) -> tuple[Array, float]:
        """J^+ of the hand's position, damped near singular configurations, and how near one is.

        Corrections damp by no more than the distance that is left: they converge faster and faster where J is regular.
        """
        left, values, right = np.linalg.svd(self._functions("jacobian", q)[:3], full_matrices=False)
        kept = slice(0, self._rank)
        ratios = values[kept] / (values[0] or 1.0)
        squared = np.minimum(DAMPING**2 * np.maximum(1 - (ratios / NEAR) ** 2, 0) * values[0] ** 2, most**2)
        gains = values[kept] / (values[kept] ** 2 + squared)
        return np.asarray(right[kept].T @ (gains[:, None] * left[:, kept].T)), float(ratios[-1]) if self._rank else 1.0

    @cached_property
    def _rank(self) -> int:
        return usual_rank(self._functions, range(3))


def increments_of(motion: Motion, steps: int) -> list[Increments]:
    """The displacements between the points of a path, each along a straight line from where the plan is.

    Args:
        motion: Of a path, with a base that stands.
        steps: Displacements of each segment.

    Returns:
        One for each segment.

    Raises:
        QuantityError: The base moves, or there is no path.
    """
    if motion.base is not None or not motion.plan.steps:
        raise QuantityError("increments go from point to point of a path", remedy="write points: and path:")
    walker, found = Walker(motion.plan.robot, motion.values), []
    for segment in motion.trajectory.segments:
        start, end = (motion(float(t))[0] for t in (segment.start, segment.start + segment.duration))
        found.append(walker.walk(start, walker.place(end), steps))
    return found


def printed_increments(motion: Motion, steps: int) -> Iterator[str]:
    """How well incremental inverse kinematics does.

    Args:
        motion: Of a path.
        steps: Displacements of each segment.

    Yields:
        A line for each segment: the errors before correction with these steps and with twice as many, and after.
    """
    pairs = zip(motion.trajectory.segments, increments_of(motion, steps), increments_of(motion, 2 * steps), strict=True)
    for segment, ours, finer in pairs:
        errors = f"{ours.error:.3g} m after {steps} steps, {finer.error:.3g} m after {2 * steps}"
        closed = "closed to 1e-9 m" if ours.closed <= 1e-9 else f"not closed: {ours.closed:.3g} m left"
        near = f"; damped in {ours.damped} steps, near {ours.factor} = 0" if ours.damped else ""
        near = near or (f"; ends near {ours.factor} = 0" if ours.factor else "")
        yield f"{segment.name}: {errors}; {closed} by {ours.corrections} corrections{near}"
