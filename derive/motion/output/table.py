"""The table that ``derive move`` prints, and the samples of a motion as rows."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from derive.arrays import Array
from derive.motion.curves.limits import ROUNDING
from derive.motion.motion import Motion
from derive.motion.torques.functions import joint_positions
from derive.plans.segments import Peak
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.robot import Robot

if TYPE_CHECKING:
    from derive.motion.simulation.simulation import Run

HEADER = ("segment", "time", "peak speed", "peak acceleration", "peak torque", "work", "work of base")

JOINT_HEADER = ("segment", "joint", "peak speed", "peak acceleration", "peak torque", "RMS", "peak power", "work")

SIMULATED_HEADER = ("simulated", "largest error", "peak torque", "work", "lost to friction")

# What a simulated arm gets besides the work of its motors, as `Run` has it, where it gets any.
GIVEN = {"base": "work of base", "pushed": "work of disturbances", "brought": "brought by loads"}


def table(motion: Motion) -> list[tuple[str, ...]]:
    """A row for each segment: of every quantity the joint with the largest value in its unit, angles before slides."""
    robot, rows = motion.plan.robot, []
    for peaks in motion.peaks:
        cells = [peaks.segment.name, f"{_number(peaks.segment.duration)} s"]
        cells += [_largest(robot, peaks.speeds, "s"), _largest(robot, peaks.accelerations, "s^2")]
        if peaks.loads:
            at, load = max(enumerate(peaks.loads), key=lambda pair: abs(pair[1].peak))
            given = (*peaks.loads, peaks.base) if peaks.base else peaks.loads
            moved = sum(abs(other.power) for other in given) * float(peaks.segment.duration)
            cells.append(_torque(robot, at, load.peak, load.time))
            cells += [_joules(work, moved) for work in (peaks.work, *(other.work for other in given[robot.dof :]))]
        rows.append(tuple(cells))
    return rows


def _joules(work: float, most: float) -> str:
    """Work; zero where it is rounding of all that was moved to and fro."""
    return f"{work if abs(work) > ROUNDING * most else 0.0:.4g} J"


def joint_table(motion: Motion) -> list[tuple[str, ...]]:
    """A row for each segment and joint: what the joint does."""
    rows, robot = [], motion.plan.robot
    for peaks in motion.peaks:
        name = peaks.segment.name
        for j, joint in enumerate(robot.variables):
            unit, force = ("rad", "N m") if joint.is_revolute else ("m", "N")
            cells = [name, joint.variable, f"{_number(peaks.speeds[j].value)} {unit}/s"]
            cells.append(f"{_number(peaks.accelerations[j].value)} {unit}/s^2")
            if peaks.loads:
                load = peaks.loads[j]
                cells += [f"{load.peak:.4g} {force} at {load.time:.4g} s", f"{load.rms:.4g} {force}"]
                cells += [f"{load.power:.4g} W", f"{load.work:.4g} J"]
            rows.append(tuple(cells))
            name = ""
        if peaks.base:
            rows.append(("", "base", *[""] * 4, f"{peaks.base.power:.4g} W", f"{peaks.base.work:.4g} J"))
    return rows


def _torque(robot: Robot, joint: int, value: float, time: float) -> str:
    unit = "N m" if robot.variables[joint].is_revolute else "N"
    return f"tau{joint + 1} {value:.4g} {unit} at {time:.4g} s"


def simulated_table(motion: Motion, run: Run) -> list[tuple[str, ...]]:
    """A row for each segment of a simulation, as far as it came."""
    robot = motion.plan.robot
    rows: list[tuple[str, ...]] = []
    errors, ledger = run.q - motion(run.t)[0], [run.work, run.lost, *(getattr(run, name) for name in given_in(run))]
    most = sum(float(np.ptp(entry)) for entry in (run.energy, *ledger))
    for segment in motion.trajectory.segments:
        start, end = float(segment.start), float(segment.start + segment.duration)
        (inside,) = np.nonzero((run.t >= start) & (run.t <= end))
        if inside.size == 0:
            break
        at, joint = np.unravel_index(np.abs(run.tau[inside]).argmax(), run.tau[inside].shape)
        first, last = inside[0], inside[-1]
        worst = []
        for revolute, unit in ((True, "rad"), (False, "m")):
            if joints := [j for j in range(robot.dof) if robot.variables[j].is_revolute is revolute]:
                off = errors[inside][:, joints]
                row, k = np.unravel_index(np.abs(off).argmax(), off.shape)
                variable = robot.variables[joints[k]].variable
                worst.append(f"{variable} {off[row, k]:.1e} {unit} at {run.t[inside][row]:.4g} s")
        torque = _torque(robot, int(joint), float(run.tau[inside][at, joint]), float(run.t[inside][at]))
        works = (_joules(float(entry[last] - entry[first]), most) for entry in ledger)
        rows.append((segment.name, ", ".join(worst), torque, *works))
    return rows


def given_in(run: Run) -> list[str]:
    """What of `GIVEN` a simulated arm got."""
    return [name for name in GIVEN if getattr(run, name).any()]


def diverged(motion: Motion, run: Run) -> str:
    """Where a simulation was given up."""
    found = run.divergence
    assert found is not None
    state = []
    for joint, q, qd in zip(motion.plan.robot.variables, found.q, found.qd, strict=True):
        unit = "rad" if joint.is_revolute else "m"
        state.append(f"{joint.variable} = {q:.4g} {unit}, {velocity_name(joint.variable)} = {qd:.4g} {unit}/s")
    when = f"after {found.time:.6g} s of {motion.duration:.6g} s, where {', '.join(state)}"
    if found.is_dead:
        return f"the simulation ends at a dead point of a loop {when}"
    return f"the simulation diverges {when}; smaller gains or a shorter period may help"


def _largest(robot: Robot, peaks: Sequence[Peak], per: str) -> str:
    """The largest of the angles and the largest of the slides, those that move."""
    said, kinds = [], [joint.is_revolute for joint in robot.variables]
    for revolute, unit in ((True, "rad"), (False, "m")):
        if joints := [j for j, kind in enumerate(kinds) if kind is revolute and peaks[j].value != 0]:
            at = max(joints, key=lambda j: abs(float(peaks[j].value)))
            said.append(f"{robot.variables[at].variable} {_number(peaks[at].value)} {unit}/{per}")
    return ", ".join(said) or "none"


def _number(value: object) -> str:
    """An exact value with its decimals where these say more, a rounded one, or a long fraction, by them alone."""
    text, decimals = str(value), f"{float(value):.4g}"  # type: ignore[arg-type]
    exact = "." not in text and len(text) <= 24 and not re.fullmatch(r"-?\d+/\d{5,}", text)
    return text if text == decimals else f"{text} = {decimals}" if exact else decimals


def violations(motion: Motion, run: Run | None = None) -> list[str]:
    """What a motion asks beyond the limits of its robot and its plan, a line each."""
    lines = []
    for found in motion.violations if run is None else motion.violations_of(run):
        joint = motion.plan.robot.variables[found.joint]
        length, force = ("rad", "N m") if joint.is_revolute else ("m", "N")
        units = {"position": length, "speed": f"{length}/s", "acceleration": f"{length}/s^2", "torque": force}
        unit, who = units[found.what], joint.variable if run is None else f"simulated {joint.variable}"
        said = f"{who}: {found.what} {found.value:.6g} {unit} at {found.time:.6g} s"
        lines.append(f"{said} exceeds the limit {found.limit:.6g} by {found.excess:.3g} {unit}")
    return lines


def samples(motion: Motion, run: Run | None = None) -> tuple[tuple[str, ...], Array]:
    """The motion row by row, as it is wanted or as it was simulated."""
    robot, wanted = motion.plan.robot, motion(motion.times)
    variables = [joint.variable for joint in robot.variables]
    names = ["t", *variables, *map(velocity_name, variables)]
    torques, places = [f"tau{j + 1}" for j in range(robot.dof)], [k for k, j in enumerate(robot.joints) if j.follows]
    passive, q = [robot.joints[k].variable for k in places], wanted[0] if run is None else run.q
    last = joint_positions(robot, q, motion.values)[0][:, places]
    if run is not None:
        ledger = ("energy", "work", "lost", *given_in(run))
        columns = [run.t[:, None], run.q, run.qd, run.tau, *(getattr(run, name)[:, None] for name in ledger)]
        return (*names, *torques, *ledger, *passive), np.hstack([*columns, last])
    names += map(acceleration_name, variables)
    columns = [motion.times[:, None], *wanted]
    if motion.has_torques:
        names += torques
        columns.append(motion.torques(motion.times))
    return (*names, *passive), np.hstack([*columns, last])


def csv_bytes(motion: Motion, run: Run | None = None) -> bytes:
    """The rows of `samples` as comma-separated values with all digits."""
    names, values = samples(motion, run)
    lines = [",".join(names), *(",".join(map(repr, row)) for row in values.tolist())]
    return ("\n".join(lines) + "\n").encode()
