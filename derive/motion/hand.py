"""The end effector of a plan's robot: configurations of points that are poses, and its way on lines and arcs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np
from sympy import Expr, Float

from derive.errors import RobotFileError
from derive.motion.functions import Functions
from derive.motion.hermite import Array
from derive.motion.plan import Plan, Point, Step, Vector
from derive.motion.poses import NODES, ROWS, Follower, Way, rotation_of
from derive.motion.trajectory import Corner, Joints, Trajectory
from derive.robot.evaluate import evaluate

ARRIVED = 1e-6
"""Largest difference between a configuration and where a line ends [rad or m]."""


class Hand:
    """Knows where the points of a plan are.

    Args:
        plan: The plan.
        values: Numbers of all symbols.
        exact: Cells with the numbers of their symbols.
    """

    def __init__(self, plan: Plan, values: Mapping[str, float], exact: Callable[[Vector], Corner]) -> None:
        self._plan = plan
        self._values = values
        self._exact = exact

    @cached_property
    def _functions(self) -> Functions:
        names = frozenset({"forward_kinematics", "jacobian", "jacobian_dot"})
        poses = any(point.pose for point in self._plan.points.values())
        kinematics = replace(self._plan.robot, links=(), gravity=None)
        return Functions(kinematics, names, self._values, inverse=poses)

    def configuration(self, name: str, before: Corner | None) -> Corner:
        """Joint variables at a point; of a pose the solution nearest to where the arm comes from.

        Args:
            name: Of the point.
            before: Where the arm comes from; None at the start.

        Returns:
            Exact where the plan gives joint variables.

        Raises:
            RobotFileError: The arm does not reach the pose.
        """
        point = self._plan.points[name]
        if point.q is not None:
            return self._exact(point.q)
        start = np.zeros(self._plan.robot.n) if before is None else np.array(before, dtype=float)
        found = self._functions.nearest(self._pose(point), start)
        if not np.isfinite(found).all():
            remedy = f"derive show {self._plan.robot.source} inverse says what a pose must satisfy"
            raise RobotFileError(f"the arm does not reach {point.name}", remedy=remedy, location=point.location)
        return tuple(map(Float, found))

    def _pose(self, point: Point) -> Array:
        """Where the end effector is at a point, (4, 4)."""
        if point.pose is None:
            return self._functions("forward_kinematics", np.array(self._exact(point.q or ()), dtype=float))
        pose = np.eye(4)
        pose[:3, 3] = [evaluate(cell, self._values) for cell in point.pose.position]
        if point.pose.angles is not None:
            a, b, c = (evaluate(cell, self._values) for cell in point.pose.angles)
            turns = ((2, a), (1, b), (2, c)) if point.pose.is_zyz else ((2, c), (1, b), (0, a))
            for axis, angle in turns:
                pose[:3, :3] = pose[:3, :3] @ rotation_of(angle * np.eye(3)[axis])
        return pose

    def follow(self, step: Step, before: Corner, start: Expr, unit: Trajectory) -> Joints:
        """The pieces of each joint while the end effector moves on a line or an arc.

        Args:
            step: The segment.
            before: Joint variables at its start.
            start: When it begins [s].
            unit: The fraction of the way, from 0 to 1, as a function of the time since then.

        Returns:
            Polynomials of degree five between places at which the arm is put exactly.

        Raises:
            RobotFileError: The way leaves what the arm reaches, leads through a singular configuration, or ends in
                another posture than the point has.
        """
        end, q = self._plan.points[step.to], np.array(before, dtype=float)
        here = self._functions("forward_kinematics", q)
        try:
            if step.through:
                way = Way.arc(here, self._pose(self._plan.points[step.through]), self._pose(end))
            else:
                way = Way.line(here, self._pose(end))
        except ValueError as error:
            raise RobotFileError(str(error), remedy="write line: yes", location=step.location) from None
        rows = sorted({row for word in self._plan.robot.inverse.task for row in ROWS.get(word, ROWS["orientation"])})
        local = np.linspace(0, float(unit.duration), NODES + 1)
        s, sd, sdd = (value[:, 0] for value in unit(local))
        follower = Follower(self._functions, tuple(rows), step.location)
        joints = follower.pieces(way, q, float(start) + local, (s, sd, sdd))
        arrived = np.array([float(pieces[-1].values[1][0]) for pieces in joints])
        if end.q is not None and np.abs(arrived - np.array(self._exact(end.q), dtype=float)).max() > ARRIVED:
            found = f"the way to {step.to} ends in another posture of the arm than {step.to} has"
            remedy = f"give {step.to} as a pose, or go there by joints"
            raise RobotFileError(found, remedy=remedy, location=step.location)
        return joints
