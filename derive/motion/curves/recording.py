"""Joint variables from a CSV file: recorded angles, or the samples that ``derive move --csv`` writes."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
from sympy import Float

from derive.errors import Location, RobotFileError, TargetError, install_extra, listed, quoted
from derive.motion.curves.trajectory import Trajectory
from derive.plans.hermite import joined
from derive.plans.segments import Segment
from derive.robot.load import file_bytes
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.robot import Robot

ROWS = 200_000  # most rows of a file
BYTES = 100_000_000  # most bytes of a file
# Units that a column may name after its variable, ``q1 [deg]``; without one it is rad or m.
UNITS = {"rad": 1.0, "deg": math.pi / 180, "m": 1.0, "mm": 1e-3}


def read_recording(path: Path, robot: Robot) -> Trajectory:
    """A motion from a CSV file with a heading: ``t``, and a column for each joint variable; others are not looked at.

    Between the rows it is the cubic spline; with velocities of all joints in the file it is cubic polynomials that have
    them, with accelerations, too, quintic ones.
    """
    source = str(path)

    def _refused(found: str, allowed: str, *place: int) -> RobotFileError:
        return RobotFileError(found, allowed=f"allowed: {allowed}", location=Location(source, *place))

    data = file_bytes(path, BYTES)
    if len(data) > BYTES:
        raise _refused(f"more than {BYTES} bytes", f"at most {BYTES} bytes and {ROWS} rows")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise _refused("this is no text in UTF-8", "comma-separated values") from None
    lines = list(csv.reader(text.splitlines()))
    columns = _columns(lines[0] if lines else [], robot, source)
    if not 2 <= len(lines) - 1 <= ROWS:
        raise _refused(f"{max(len(lines) - 1, 0)} rows", f"2 to {ROWS}", max(len(lines), 1))
    rows = [_row(line, columns, Location(source, k)) for k, line in enumerate(lines[1:], start=2) if line]
    numbers = np.array(rows)
    times = numbers[:, 0] - numbers[0, 0]
    if (np.diff(times) <= 0).any():
        at = int(np.argmax(np.diff(times) <= 0)) + 3
        raise _refused(f"the time {numbers[at - 2, 0]:.6g} after {numbers[at - 3, 0]:.6g}", "times that ascend", at, 1)
    orders = (numbers.shape[1] - 1) // robot.n
    states = numbers[:, 1:].reshape(len(times), orders, robot.n)
    if orders == 1:
        try:
            from scipy.interpolate import CubicSpline
        except ImportError:
            found = "rates of a recorded motion need scipy, which is not installed"
            raise TargetError(found, remedy=install_extra("motion")) from None
        # Velocities of the cubic spline without a knot at the second point and the last but one.
        states = np.stack([states[:, 0], CubicSpline(times, states[:, 0])(times, 1)], axis=1)
    when = [Float(t) for t in times]
    joints = tuple(joined([tuple(map(Float, node)) for node in states[:, :, j]], when) for j in range(robot.n))
    return Trajectory((Segment("recording", when[0], when[-1], joints),))


def _columns(heading: list[str], robot: Robot, source: str) -> list[tuple[int, float]]:
    """Place and unit of the time, of all variables, and of their rates where all are there."""
    named: dict[str, tuple[int, float]] = {}
    for k, cell in enumerate(heading):
        name, _, unit = cell.strip().partition("[")
        unit = unit.strip().removesuffix("]").strip()
        if unit in UNITS or not unit:
            named.setdefault(name.strip(), (k, UNITS.get(unit, 1.0)))
    variables = [joint.variable for joint in robot.joints]
    for name in ("t", *variables):
        if name not in named:
            found = f"no column {quoted(name)} among {listed(tuple(map(quoted, heading)))}" if heading else "no heading"
            allowed = f"allowed: t and {listed(tuple(variables))}, with a unit as in 'q1 [deg]' or in rad and m"
            remedy = "separate columns by commas" if heading and ";" in heading[0] else ""
            raise RobotFileError(found, allowed=allowed, remedy=remedy, location=Location(source, 1, 1))
    found_columns = [named[name] for name in ("t", *variables)]
    for rate in (velocity_name, acceleration_name):
        names = [rate(variable) for variable in variables]
        if not all(name in named for name in names):
            break
        found_columns += [named[name] for name in names]
    return found_columns


def _row(line: list[str], columns: list[tuple[int, float]], place: Location) -> list[float]:
    numbers = []
    for at, unit in columns:
        cell = line[at].strip() if at < len(line) else ""
        try:
            value = float(cell)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            column = sum(len(before) + 1 for before in line[:at]) + 1
            there = Location(place.source, place.line, column)
            raise RobotFileError(f"found {quoted(cell)}", allowed="allowed: a number", location=there)
        numbers.append(value * unit)
    return numbers
