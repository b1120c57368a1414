"""Inverse kinematics against the oracle's forward kinematics: every solution leads to its pose, and none is missing.

Random configurations give poses by the independent recursion. The configuration must be among the solutions of its
pose, modulo full turns, unless joints are free or branches coincide there; every solution must lead to the pose again;
solutions must differ; and a pose out of reach must have none. One pose and a batch of them must agree, and a task
without orientation must have the same solutions whatever that is.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from derive.errors import VerificationError
from derive.robot import tree
from derive.robot.description import Joint
from derive.robot.options.inverse import ROWS
from derive.robot.robot import Robot
from derive.verification.generated import GeneratedModel, NumpyModel
from derive.verification.oracle.frames import Array, NumericArm, forward_kinematics, jacobian
from derive.verification.samples import SampleSet

FUNCTION = "inverse_kinematics"

# Largest error of the pose of a solution: of R, and of p relative to twice the farthest pose where that is above 1.
CLOSED = 1e-10
SAME = 1e-5  # configurations that are nearer to each other may be one: at the boundary errors of 1e-16 become 1e-8
APART = 1e-9  # solutions that are nearer are one solution twice
FAR = 1e3  # times the reach of an arm without slides where nothing is
# Poses that are tried where solutions are looked for from many starts, which takes long and may miss some.
SEARCHED = 6
SINGULAR = 1e-6  # smallest singular value of the Jacobian against the largest, below which solutions coincide
TINY = 1e-300  # keeps lengths that are all zero from dividing
NONE, EXACT = 0, 1


def _joints_of(robot: Robot, model: GeneratedModel, end: str, remedy: str) -> list[int]:
    """The joints that lead to an end, from 0, which the target must have told."""
    joints = [*tree.path(robot, tree.way_to(robot, tree.end_named(robot, end).after).joint)]
    if list(model.constants["JOINTS_OF"][end]) != joints:
        raise VerificationError(f"JOINTS_OF of {model.file} has not the joints of {end}", remedy=remedy)
    return joints


def inverse_errors(
    robot: Robot, model: GeneratedModel, sets: Sequence[SampleSet], remedy: str
) -> Iterator[tuple[int, float]]:
    """What the inverse kinematics of one target, or of an end of a tree in it, does wrong."""
    listed, end = model.constants.get("GIVEN", ()), end_of(model)
    joints = _joints_of(robot, model, end, remedy) if end else list(range(robot.n))
    own = [robot.joints[k] for k in joints]
    given = [k for k, joint in enumerate(own) if {k, joint.label, joint.variable}.intersection(listed)]
    free = [joint for k, joint in enumerate(joints) if k not in given]
    places = [(i - 1, j - 1) for row in robot.inverse.task for i, j in ROWS[row]]
    complete = bool(model.constants.get("COMPLETE", True))
    for samples in sets:
        q = samples.arguments["q"] if complete else samples.arguments["q"][:SEARCHED]
        arm = samples.oracle.arm.at(end) if end else samples.oracle.arm
        poses = forward_kinematics(arm, q)
        whole, q = q, q[:, joints]
        found, status = model.inverse(poses, q[:, given], samples.parameters)
        where = f"{name_of(model)} of {model.file}"
        if status.shape != found.shape[:2] or found.shape[2] != len(own):
            raise VerificationError(f"{where} returns shapes {found.shape} and {status.shape}", remedy=remedy)
        scale = np.where(np.array([j for _, j in places]) == 3, max(1.0, 2.0 * _reach(poses)), 1.0)
        worst = 0.0
        for k, pose in enumerate(poses):
            rows = found[k][status[k] != NONE]
            is_singular = _is_singular(arm, whole[k], places, free)
            fault = _fault(own, rows, status[k], found[k], q[k], complete=complete, is_singular=is_singular)
            if not fault and len(rows):
                there = np.repeat(whole[k : k + 1], len(rows), axis=0)
                there[:, joints] = rows
                again = forward_kinematics(arm, there)
                errors = np.array([abs(again[:, i, j] - pose[i, j]) for i, j in places]).T / scale
                worst = max(worst, float(errors.max()))
                fault = "" if errors.max() <= CLOSED else f"leads to a pose that is {errors.max():.1e} off"
            if fault:
                place = f"q = [{', '.join(f'{value:.17g}' for value in q[k])}]"
                numbers = "".join(f", {name} = {value:.17g}" for name, value in samples.parameters.items())
                raise VerificationError(f"{where} {fault} at {place}{numbers}", remedy=remedy)
        one, code = model.inverse(poses[1:2], q[1:2, given], samples.parameters)
        if not np.array_equal(code[0], status[1]) or not np.allclose(one[0], found[1], atol=SAME, equal_nan=True):
            raise VerificationError(f"{where} gives one pose other solutions than a batch", remedy=remedy)
        if all(j == 3 for _, j in places):
            other = np.roll(poses, 1, axis=0)
            for i, j in places:
                other[:, i, j] = poses[:, i, j]
            one, code = model.inverse(other, q[:, given], samples.parameters)
            if not np.array_equal(code, status) or not np.allclose(one, found, atol=SAME, equal_nan=True):
                raise VerificationError(f"{where} depends on more of the pose than its task", remedy=remedy)
        if all(joint.is_revolute for joint in own) and (0, 3) in places:
            away = poses[:2].copy()
            away[:, :3, 3] += FAR * max(1.0, _reach(poses))
            if model.inverse(away, q[:2, given], samples.parameters)[1].any():
                raise VerificationError(f"{where} finds solutions of poses out of reach", remedy=remedy)
        yield len(poses), worst


def end_of(model: GeneratedModel) -> str:
    """The end of a tree whose inverse kinematics a model is asked for; empty for a robot of one end."""
    return model.end if isinstance(model, NumpyModel) else ""


def name_of(model: GeneratedModel) -> str:
    """Of its function."""
    return f"{FUNCTION}_{end}" if (end := end_of(model)) else FUNCTION


def solvers(model: GeneratedModel) -> Iterator[GeneratedModel]:
    """A model as it solves for each pose that it knows: that of the end effector, or of each end of a tree."""
    ends = model.constants.get("JOINTS_OF", ())
    if isinstance(model, NumpyModel) and ends:
        yield from (replace(model, end=end) for end in ends)
    elif FUNCTION in model.constants:
        yield model


def _fault(
    joints: Sequence[Joint], rows: Array, status: Array, found: Array, q: Array, *, complete: bool, is_singular: bool
) -> str:
    """What is wrong with the solutions of a pose, but for the poses that they lead to."""
    if not len(rows):
        return "finds no solution of a reachable pose" if complete else ""
    if not np.array_equal(np.isnan(found).any(axis=1), status == NONE):
        return "marks branches that do not exist by other things than nan"
    if is_singular or (status > EXACT).any():
        return ""
    turns = np.array([joint.is_revolute for joint in joints])
    if complete and _distance(rows, q, turns).min() > SAME:
        return "misses the configuration"
    is_twice = any(_distance(rows[:i], rows[i], turns).min() < APART for i in range(1, len(rows)))
    return "finds a solution twice" if is_twice else ""


def _is_singular(arm: NumericArm, q: Array, places: Sequence[tuple[int, int]], free: Sequence[int]) -> bool:
    """Whether a configuration is a multiple solution of its pose, which is known to some of its digits alone."""
    slopes = jacobian(arm, q)
    slopes[:3] /= max(np.abs(np.concatenate([arm.a, arm.d, slopes[:3].ravel()])).max(), TINY)
    rows = [i for i, j in places if j == 3] + [3, 4, 5] * any(j < 3 for _, j in places)
    values = np.linalg.svd(slopes[rows][:, free], compute_uv=False)
    return bool(values[-1] < SINGULAR * values[0])


def _distance(rows: Array, q: Array, turns: Array) -> Array:
    """How far configurations are from one, modulo full turns."""
    difference = rows - q
    angles = np.abs((difference + np.pi) % (2.0 * np.pi) - np.pi)
    return np.asarray(np.where(turns, angles, np.abs(difference)).max(axis=1))


def _reach(poses: Array) -> float:
    return float(np.abs(poses[:, :3, 3]).max(initial=0.0))
