"""The table that ``derive move`` prints, and the samples of a motion as rows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from derive.motion.extremes import Peak
from derive.motion.motion import Motion, SegmentPeaks
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.robot import Robot

HEADER = ("segment", "time", "peak speed", "peak acceleration", "peak torque", "work")


def table(motion: Motion) -> list[tuple[str, ...]]:
    """A row for each segment: of every quantity the joint with the largest value in its unit, angles before slides.

    Args:
        motion: The motion.

    Returns:
        Cells as `HEADER` names them; the last two only where the robot has dynamics.
    """
    return [_row(motion.plan.robot, peaks) for peaks in motion.peaks]


def _row(robot: Robot, peaks: SegmentPeaks) -> tuple[str, ...]:
    cells = (
        peaks.segment.name,
        f"{_number(peaks.segment.duration)} s",
        _largest(robot, peaks.speeds, "s"),
        _largest(robot, peaks.accelerations, "s^2"),
    )
    if not peaks.loads:
        return cells
    at = max(range(robot.n), key=lambda j: abs(peaks.loads[j].peak))
    load = peaks.loads[at]
    unit = "N m" if robot.joints[at].is_revolute else "N"
    return (*cells, f"tau{at + 1} {load.peak:.4g} {unit} at {load.time:.4g} s", f"{peaks.work:.4g} J")


def _largest(robot: Robot, peaks: Sequence[Peak], per: str) -> str:
    """The largest of the angles and the largest of the slides, those that move."""
    said = []
    for revolute, unit in ((True, "rad"), (False, "m")):
        joints = [j for j in range(robot.n) if robot.joints[j].is_revolute is revolute and peaks[j].value != 0]
        if joints:
            at = max(joints, key=lambda j: abs(float(peaks[j].value)))
            said.append(f"{robot.joints[at].variable} {_number(peaks[at].value)} {unit}/{per}")
    return ", ".join(said) or "none"


def _number(value: object) -> str:
    """An exact value with its decimals where these say more, a rounded one by them alone."""
    text, decimals = str(value), f"{float(value):.4g}"  # type: ignore[arg-type]
    exact = not any(character == "." for character in text) and len(text) <= 24
    return text if text == decimals else f"{text} = {decimals}" if exact else decimals


def violations(motion: Motion) -> list[str]:
    """What a motion asks beyond the limits of its robot, a line each.

    Args:
        motion: The motion.

    Returns:
        Joint, time, value, limit and excess.
    """
    lines = []
    for found in motion.violations:
        joint = motion.plan.robot.joints[found.joint]
        length, force = ("rad", "N m") if joint.is_revolute else ("m", "N")
        unit = {"position": length, "speed": f"{length}/s", "torque": force}[found.what]
        said = f"{found.what} {found.value:.6g} {unit} at {found.time:.6g} s"
        lines.append(f"{joint.variable}: {said} exceeds the limit {found.limit:.6g} by {found.excess:.3g} {unit}")
    return lines


def samples(motion: Motion) -> tuple[tuple[str, ...], np.ndarray]:
    """The motion row by row.

    Args:
        motion: The motion.

    Returns:
        Names of the columns, and a row for each sample: time, positions, velocities, accelerations, torques.
    """
    robot = motion.plan.robot
    variables = [joint.variable for joint in robot.joints]
    names = ["t", *variables, *map(velocity_name, variables), *map(acceleration_name, variables)]
    columns = [motion.times[:, None], *motion(motion.times)]
    if motion.has_torques:
        names += [f"tau{j + 1}" for j in range(robot.n)]
        columns.append(motion.torques(motion.times))
    return tuple(names), np.hstack(columns)
