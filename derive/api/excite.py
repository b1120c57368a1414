"""Motions that excite the base parameters of a robot, from Python."""

import json
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from derive.api.robots import RobotLike, load
from derive.arrays import Array
from derive.errors import DeriveError, listed
from derive.identification.excitation import Criterion, Design, Excitation, FourierSeries, Room, excited
from derive.identification.standard import Unknowns
from derive.publish.atomic_folder import refuse_taken, write_files
from derive.robot.cells import joint_value
from derive.robot.evaluate import evaluate
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from derive.robot.writer import robot_text
from derive.targets.target import joint_limits

OfJoints = float | str | Sequence[float | str]
"""One value for all joints, or one a joint; a text is one cell or several with commas between."""
MOST_HARMONICS, MOST_SAMPLES = 20, 100_000


def excite(
    robot: RobotLike,
    path: str | Path | None = None,
    *,
    period: float = 10.0,
    harmonics: int = 5,
    criterion: str = "determinant",
    position: OfJoints | None = None,
    speed: OfJoints | None = None,
    acceleration: OfJoints | None = None,
    torque: OfJoints | None = None,
    floor: float | None = 0.0,
    noise: OfJoints = "1%",
    sample: float = 0.01,
    add: Sequence[str] = ("viscous", "coulomb"),
    starts: int = 2,
    seed: int = 1,
    force: bool = False,
) -> Excitation:
    """Find a motion from which the base parameters of a robot follow best, as ``derive excite`` does.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue; its symbols all have numbers.
        path: The plan that is written; None for none.
        period: How long the motion lasts [s].
        harmonics: Of the Fourier series of each joint, from 2 to 20.
        criterion: What is made small: ``determinant`` of the parameters' covariance, or ``condition`` number.
        position: Largest magnitudes in the units of the robot file, whose limits hold, too.
        speed: Likewise, per second.
        acceleration: Likewise, per second squared; None for what speeds and harmonics allow.
        torque: Likewise [N m or N].
        floor: Height above which the origins of all frames stay [m]; None for any.
        noise: Standard deviation of the torques' noise [N m or N], or a part of each joint's largest torque, ``1%``.
        sample: Time between two samples [s].
        add: What shall be identified though the robot file does not give it: ``viscous``, ``coulomb``, ``armature``.
        starts: From how many random motions the search goes.
        seed: Of the random numbers; the same gives the same motion.
        force: Whether a file that exists is overwritten.

    Returns:
        The plan as text, the condition number, and the standard deviation of each base parameter.

    Raises:
        DeriveError: A value is not what is allowed, or a joint has no limits.
        QuantityError: The robot cannot be identified, or its torques or the floor allow it nowhere.
        OutputError: There is such a file already, or it cannot be written.
    """
    paths = [] if path is None else [Path(path)]
    refuse_taken(paths, force=force)
    chosen = load(robot, remarks_on_bodies=False)
    _check(2 <= harmonics <= MOST_HARMONICS, f"{harmonics} harmonics", f"2 to {MOST_HARMONICS}")
    _check(0 < period < np.inf, f"a period of {period:.6g} s", "a time above zero [s]")
    shortest, longest = period / MOST_SAMPLES, period / (4 * harmonics)
    _check(shortest <= sample <= longest, f"samples every {sample:.6g} s", f"{shortest:.3g} to {longest:.3g} s")
    _check(starts >= 1, f"{starts} starts", "one or more")
    _check(criterion in [*Criterion], f"criterion {criterion}", listed(Criterion))
    unknowns, series = Unknowns.of(chosen, tuple(add)), FourierSeries(float(period), harmonics)
    asked = {"position": position, "speed": speed, "acceleration": acceleration, "torque": torque}
    typed = {what: _of_joints(chosen, values, what) for what, values in asked.items() if values is not None}
    room = _room(chosen, typed, -np.inf if floor is None else floor)
    design = Design(unknowns, series, room, Criterion(criterion), _noise(chosen, noise))
    limits = [f"{what}: [{', '.join(texts)}]" for what, texts in typed.items() if what != "position"]
    found = excited(design, starts, seed, sample, [_robot_lines(robot, paths), *limits])
    write_files({path: found.text.encode() for path in paths}, force=force)
    return found


def _check(right: bool, found: str, allowed: str) -> None:
    if not right:
        raise DeriveError(found, allowed=f"allowed: {allowed}")


def _of_joints(robot: Robot, values: OfJoints, what: str) -> list[str]:
    typed = values.split(",") if isinstance(values, str) else [values] if isinstance(values, float | int) else values
    texts = [str(value).strip() for value in typed]
    texts *= robot.dof if len(texts) == 1 else 1
    names = listed(joint.variable for joint in robot.variables)
    _check(len(texts) == robot.dof, f"{len(texts)} values of {what}", f"one, or one for each of {names}")
    return texts


def _room(robot: Robot, given: Mapping[str, Sequence[str]], floor: float) -> Room:
    """What robot file and options allow together."""
    joints = robot.variables

    def _most(what: str) -> Array:
        of_file = (getattr(joint, what, None) for joint in joints)
        found = np.array([np.inf if cell is None else evaluate(cell, {}) for cell in of_file])
        for i, text in enumerate(given.get(what, ())):
            of_joint = f"{what} of {joints[i].variable}"
            typed = evaluate(joint_value(robot, None if what == "torque" else joints[i], text, of_joint), {})
            _check(typed > 0, f"{what} {text} of {joints[i].variable}", "above zero")
            found[i] = min(found[i], typed)
        return found

    most, speed = _most("position"), _most("speed")
    low, high = np.transpose([pair or (-np.inf, np.inf) for pair in joint_limits(robot)])
    low, high = np.maximum(low, -most), np.minimum(high, most)
    for what, unlimited in (("position", np.isinf(high - low)), ("speed", np.isinf(speed))):
        if lacking := [joint.variable for joint, lacks in zip(joints, unlimited, strict=True) if lacks]:
            remedy = f"write {'limits' if what == 'position' else what}: into the robot file, or give --{what}"
            raise DeriveError(f"{listed(lacking)} of {robot.name} without limits of {what}", remedy=remedy)
    for joint, narrow in zip(joints, high <= low, strict=True):
        _check(not narrow, f"no room for {joint.variable}", "a position within the limits of the robot file")
    return Room((low + high) / 2, (high - low) / 2, speed, _most("acceleration"), _most("torque"), floor)


def _noise(robot: Robot, noise: OfJoints) -> Callable[[Array], Array]:
    """Deviations of the torques by the largest torques."""
    found = []
    for text in _of_joints(robot, noise, "noise"):
        value = 0.0
        with suppress(ValueError):
            value = float(text.removesuffix("%"))
        _check(0 < value < np.inf, f"noise {text}", "N m or N, or per cent such as 1%")
        found.append((value / 100, 0.0) if text.endswith("%") else (0.0, value))
    parts, fixed = np.array(found).T
    return lambda largest: parts * largest + fixed


def _robot_lines(robot: RobotLike, paths: Sequence[Path]) -> str:
    """What a plan there says of its robot."""
    if isinstance(robot, Robot):
        return "robot:\n" + "\n".join(f"  {line}".rstrip() for line in robot_text(robot).splitlines())
    there = str(robot)
    if paths and there not in catalogue_names():
        there = Path(os.path.relpath(there, paths[0].parent)).as_posix()
    return f"robot: {json.dumps(there, ensure_ascii=False)}"
