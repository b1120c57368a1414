"""Other closed-form solvers: EAIK, ssik, IK-Geo, and what roboticstoolbox derives and writes in C.

All are given the Denavit-Hartenberg table; offsets of angles are put back into what they return.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from functools import cache, partial
from typing import Any

import numpy as np

from bench.built import imported
from bench.compilers import BUILD
from bench.inverse.ours import pose_loop
from bench.inverse.problem import BATCH, CHECKED, ONE, C, Problem, Solver, Solving, one_by_one
from bench.peers.pinocchio_cpp import pointer
from bench.peers.toolbox import robot_of
from bench.robots import Array

_SOME = 2_000
"""Poses of a pass of a batch that returns objects."""


def _table(problem: Problem) -> tuple[Array, Array, Array]:
    """Twists, lengths and offsets of an arm of standard rows, all of whose joints turn; d of slides is zero.

    Raises:
        ValueError: The arm is of another kind.
    """
    arm = problem.case.oracle.arm
    if not arm.standard or not np.all(arm.revolute):
        raise ValueError("takes joints that turn alone")
    return np.array(arm.alpha), np.array(arm.a), np.array(arm.d)


def _joints(problem: Problem, rows: Iterable[Any]) -> Array:
    """Angles of the rows of the table as joint variables."""
    found = np.array([np.asarray(row, dtype=float) for row in rows]).reshape(-1, problem.case.robot.n)
    return found - np.array(problem.case.oracle.arm.theta)


def _eaik(problem: Problem) -> Any:
    from eaik.IK_DH import DhRobot

    robot = DhRobot(*_table(problem))
    if not robot.hasKnownDecomposition():
        raise ValueError("has no decomposition of this arm")
    return robot


def _eaik_one(problem: Problem) -> Solving:
    return one_by_one(_eaik(problem).IK, lambda found: _joints(problem, found.Q), problem.poses)


def _eaik_batch(problem: Problem) -> Solving:
    robot, poses = _eaik(problem), list(problem.poses[:_SOME])

    def _solve(some: list[Array]) -> Any:
        return robot.IK_batched(some, num_worker_threads=1)

    return Solving(
        lambda: _solve(poses), len(poses), lambda: (_joints(problem, found.Q) for found in _solve(poses[:CHECKED]))
    )


def _ssik(problem: Problem) -> Solving:
    """The module that ssik writes for an arm."""
    from ssik import Manipulator
    from ssik.core.codegen import emit_artifact

    arm, name = Manipulator.from_dh(*_table(problem)), f"{problem.case.name.replace('-', '_')}_ssik"
    BUILD.mkdir(exist_ok=True)
    path = BUILD / f"{name}.py"
    emit_artifact(kb=arm.kinbody, plan=arm.dispatch_plan, module_name=name, output_path=str(path))
    solve = partial(imported(path).solve, respect_limits=False)
    return one_by_one(solve, lambda found: _joints(problem, (one.q for one in found)), problem.poses)


def _ik_geo(problem: Problem) -> Solving:
    from py_ikgeo_kinematics import KinematicModel, Robot
    from scipy.spatial.transform import RigidTransform, Rotation

    alpha, a, d = _table(problem)
    axes, steps, rotation = [], [np.zeros(3)], np.eye(3)
    for k in range(len(alpha)):
        axes.append(rotation[:, 2])
        c, s = np.cos(alpha[k]), np.sin(alpha[k])
        steps.append(rotation @ np.array([a[k], 0.0, d[k]]))
        rotation = rotation @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    robot = Robot(KinematicModel(np.array(axes).T, np.array(steps).T), degrees=False)
    straight = RigidTransform.from_rotation(Rotation.from_matrix(rotation.T))
    return one_by_one(
        robot.inverse,
        lambda found: _joints(problem, found),
        problem.poses,
        lambda pose: RigidTransform.from_matrix(pose) * straight,
    )


@cache
def _toolbox(problem: Problem) -> Any:
    """The toolbox's solver; deriving it takes seconds."""
    return robot_of(problem.case).analytic_ik()


def _toolbox_one(problem: Problem) -> Solving:
    solve = partial(_toolbox(problem).solve, joint_limits=False)
    return one_by_one(solve, lambda found: np.asarray(found.q), problem.poses)


def _toolbox_c(problem: Problem) -> Solving:
    BUILD.mkdir(exist_ok=True)
    path = BUILD / f"inverse_{problem.case.name}.c"
    path.write_text(_toolbox(problem).generate("c", "solve"), encoding="utf-8")
    call = "solve(T + 16 * k, 1e-6, (double(*)[IKINE_DOF])(out + 64 * IKINE_DOF * k), found + k)"
    poses, n = problem.poses[:_SOME], problem.case.robot.n
    rows, counts = np.full((len(poses), 64, n), np.nan), np.zeros(len(poses), dtype=np.intc)
    loop = partial(pose_loop(path, call), ctypes.c_long(len(poses)), pointer(poses), pointer(rows), pointer(counts))
    return Solving(loop, len(poses), lambda: (rows[k, : counts[k]] for k in range(CHECKED)))


SOLVERS = (
    Solver("EAIK", ONE, _eaik_one, ("eaik",)),
    Solver("EAIK, one thread", BATCH, _eaik_batch, ("eaik",)),
    Solver("ssik", ONE, _ssik, ("ssik",)),
    Solver("IK-Geo (py-ikgeo-kinematics)", ONE, _ik_geo, ("py_ikgeo_kinematics",)),
    Solver("roboticstoolbox", ONE, _toolbox_one, ("roboticstoolbox", "flint")),
    Solver("roboticstoolbox: generated C", C, _toolbox_c, ("roboticstoolbox", "flint")),
)
