"""Incremental inverse kinematics: many small displacements of the hand, J^+ for each (document 001, slide 32).

Near a singular configuration J^+ is damped: a small singular value s counts as s/(s^2 + d^2), with d growing from zero
as it falls, and other directions are left alone (Nakamura and Hanafusa, 1986; Chiaverini, 1997; Siciliano et al.,
Robotics, 2009, 3.5.2). Where corrections stop all the same, as on a line through the axis of a joint, which J^+ cannot
leave, they begin anew aside of it, down the square of the distance (Levenberg and Marquardt).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from derive.arrays import Array
from derive.errors import QuantityError
from derive.motion.motion import Motion
from derive.motion.paths.poses import all_directions, rotation_vector, usual_rank, vanishing_factor
from derive.motion.torques.functions import Functions, arm_of
from derive.robot.options.inverse import FREEDOMS
from derive.robot.robot import Robot

NEAR = 0.05  # singular value of J, relative to the largest, below which its direction is damped
DAMPING = 0.05  # damping at a singular configuration, relative to the largest singular value
CLOSED = 1e-12  # distance at which the hand has arrived, relative to how far it goes
CORRECTIONS = 50  # most corrections at the end
ANEW = 12  # how often corrections begin anew, farther and farther aside, where they stop short of the target
DESCENTS = 200  # most steps of each of these


@dataclass(frozen=True, slots=True)
class Increments:
    """A displacement of the hand in small steps."""

    q: Array  # joint variables after each step, the start first, (steps + 1, n), of a tree those that lead to the end
    error: float  # distance from the target after the last step, before any correction [m]
    corrections: int  # steps towards the target after that
    closed: float  # distance from the target then [m]
    damped: int  # how many steps were damped
    factor: str  # what vanishes at the nearest singularity that the arm came near, also in corrections; empty for none
    turn: float | None = None  # angle to the target before any correction [rad]; None where the arm cannot turn freely
    turned: float = 0.0  # that angle after the corrections
    anew: int = 0  # how often corrections began anew, aside of where those with J^+ stop

    @property
    def is_closed(self) -> bool:
        """Whether the hand is at the target, to 1e-9 m and rad."""
        return max(self.closed, self.turned) <= 1e-9


class Walker:
    """Moves the hand of a robot, or an end of a tree, in small steps of the joints that lead there, `places`."""

    def __init__(self, robot: Robot, values: Mapping[str, float], end: str = "") -> None:
        self._robot, self.places = arm_of(robot, end)
        self._values = values
        self._functions = Functions(self._robot, frozenset({"forward_kinematics", "jacobian"}), values)

    def pose(self, q: Array) -> Array:
        """The pose of the hand, (4, 4)."""
        return self._functions("forward_kinematics", q)

    def walk(self, q: Array, target: Array, steps: int) -> Increments:
        """Along the line to a target, (3,) [m] or a pose (4, 4), each step from where the line should be."""
        way = self._off(target, q)
        rows, near = [q], []
        for _ in range(steps):
            inverse, ratio = self._pseudoinverse(q, way.size)
            near.append((ratio, q))
            q = q + inverse @ (way / steps)
            rows.append(q)
        damped, first = sum(ratio < NEAR for ratio, _ in near), self._off(target, q)
        # The corrections: Newton's steps towards the target itself, J^+ e.
        bound, off, corrections = CLOSED * (1 + float(np.linalg.norm(way))), first, 0
        while (left := float(np.linalg.norm(off))) > bound and corrections < CORRECTIONS:
            inverse, ratio = self._pseudoinverse(q, way.size, left)
            near.append((ratio, q))
            q = q + inverse @ off
            off, corrections = self._off(target, q), corrections + 1
        q, more, anew = self._anew(q, target, bound) if left > 1e-9 else (q, 0, 0)
        worst = min(near, key=lambda pair: pair[0], default=(np.inf, q))
        factor = vanishing_factor(self._robot, self._values, worst[1]) if worst[0] < NEAR else ""
        errors = (first[:3], first[3:], self._off(target, q)[:3], self._off(target, q)[3:])
        error, turn, closed, turned = (float(np.linalg.norm(each)) for each in errors)
        sizes = error, corrections + more, closed, damped, factor, turn if way.size > 3 else None, turned, anew
        return Increments(np.array([*rows[:-1], q]), *sizes)

    def _anew(self, q: Array, target: Array, bound: float) -> tuple[Array, int, int]:
        """Where it ends from aside, down the square of the distance (Levenberg and Marquardt); steps and attempts."""
        random = np.random.default_rng(0)
        # From farther and farther aside, 2^-9 to 2^2 rad or m.
        for attempt in range(1, ANEW + 1):
            found = q + random.normal(scale=2.0 ** (attempt - 10), size=q.size)
            off, damping, steps = self._off(target, found), 1e-2, 0
            while (left := float(np.linalg.norm(off))) > bound and steps < DESCENTS:
                jacobian = self._functions("jacobian", found)[: off.size]
                # (J^T J + l |e| 1) dq = J^T e; l falls after a step that comes nearer and grows after any other.
                square = jacobian.T @ jacobian + damping * left * np.eye(q.size)
                there = found + np.linalg.solve(square, jacobian.T @ off)
                later, steps = self._off(target, there), steps + 1
                nearer = np.linalg.norm(later) < left
                damping *= 0.2 if nearer else 8.0
                found, off = (there, later) if nearer else (found, off)
            if left <= 1e-9:
                return found, steps, attempt
        return q, 0, 0

    def _off(self, target: Array, q: Array) -> Array:
        """From the hand to the target: the way [m], and where the arm is free to turn and a pose is wanted the turn."""
        pose = self.pose(q)
        if target.ndim == 1 or not self._turns:
            return np.asarray((target[:3, 3] if target.ndim > 1 else target) - pose[:3, 3])
        return np.concatenate([target[:3, 3] - pose[:3, 3], rotation_vector(target[:3, :3] @ pose[:3, :3].T)])

    def _pseudoinverse(self, q: Array, rows: int, most: float = np.inf) -> tuple[Array, float]:
        """J^+ of the first rows, damped near singular configurations, and how near one is."""
        # Corrections damp by no more than the distance that is left: they converge ever faster where J is regular.
        # J = U S V^T; J^+ with s/(s^2 + d^2) for 1/s, where d^2 = d0^2 (1 - (s/s0)^2) below s0 and zero above.
        left, values, right = np.linalg.svd(self._functions("jacobian", q)[:rows], full_matrices=False)
        kept = slice(0, self._ranks[rows])
        ratios = values[kept] / (values[0] or 1.0)
        squared = np.minimum(DAMPING**2 * np.maximum(1 - (ratios / NEAR) ** 2, 0) * values[0] ** 2, most**2)
        gains = values[kept] / (values[kept] ** 2 + squared)
        return np.asarray(right[kept].T @ (gains[:, None] * left[:, kept].T)), float(ratios[-1]) if kept.stop else 1.0

    @cached_property
    def _ranks(self) -> Mapping[int, int]:
        """Of the first rows of J."""
        return {rows: usual_rank(self._functions, range(rows)) for rows in (3, 6)}

    @cached_property
    def _turns(self) -> bool:
        """Whether the hand goes on a line and turns as it likes: its directions are everywhere the same."""
        asked = not FREEDOMS.keys().isdisjoint(self._robot.inverse.task)
        return asked and self._ranks[6] > self._ranks[3] and self._ranks[6] == all_directions(self._functions)


def increments_of(motion: Motion, steps: int) -> list[Increments]:
    """The displacements between the points of a path, each along a straight line from where the plan is."""
    if motion.base is not None:
        raise QuantityError("increments of an arm whose base moves", allowed="allowed: a base that stands")
    if not motion.plan.steps:
        raise QuantityError("increments go from point to point of a path", remedy="write points: and path:")
    plan, walkers, found = motion.plan, dict[str, Walker](), []
    for step, segment in zip(plan.steps, motion.trajectory.segments, strict=True):
        name = plan.points[step.to].end or step.end
        if len(plan.robot.ends) > 1 and not name:
            found_text = f"increments to {step.to}, which is a point of no end"
            raise QuantityError(found_text, remedy="write it as a pose of an end", location=step.location)
        walker = walkers.setdefault(name, Walker(plan.robot, motion.values, name))
        times = (segment.start, segment.start + segment.duration)
        start, end = (motion(float(t))[0][..., list(walker.places)] for t in times)
        found.append(walker.walk(start, walker.pose(end), steps))
    return found


def printed_increments(motion: Motion, steps: int, found: Sequence[Increments] = ()) -> Iterator[str]:
    """How well incremental inverse kinematics does."""
    pairs = zip(found or increments_of(motion, steps), increments_of(motion, 2 * steps), strict=True)
    for segment, (ours, finer) in zip(motion.trajectory.segments, pairs, strict=True):
        first, second = (_size(each.error, each.turn) for each in (ours, finer))
        free, left = ours.turn is not None, _size(ours.closed, None if ours.turn is None else ours.turned)
        closed = f"closed to 1e-9 m{' and rad' * free}" if ours.is_closed else f"not closed: {left} left"
        aside = f", in attempt {ours.anew + 1}, aside of where J^+ stops" if ours.anew else ""
        near = f"; damped in {ours.damped} steps, near {ours.factor} = 0" if ours.damped else ""
        near = near or (f"; ends near {ours.factor} = 0" if ours.factor else "")
        errors = f"{first} after {steps} steps, {second} after {2 * steps}"
        yield f"{segment.name}: {errors}; {closed} by {ours.corrections} corrections{aside}{near}"


def _size(distance: float, angle: float | None) -> str:
    return f"{distance:.3g} m" + ("" if angle is None else f" and {angle:.3g} rad")


def not_closed(motion: Motion, found: Sequence[Increments]) -> str:
    """Which targets increments stop short of; nothing where they reach all."""
    names = [s.name for s, each in zip(motion.trajectory.segments, found, strict=True) if not each.is_closed]
    return f"increments do not close on the target of {', '.join(names)}; go through a point aside" if names else ""
