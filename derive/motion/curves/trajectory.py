"""A motion of all joints: from a plan to position, velocity and acceleration at any time."""

from __future__ import annotations

import csv
import math
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from sympy import Abs, Expr, Float, Integer, Pow, cos, preorder_traversal, tan

from derive.arrays import Array, Indices
from derive.errors import Location, QuantityError, RobotFileError, listed, optional, quoted
from derive.motion.curves.limits import refined
from derive.plans.profile import TIME, ZERO, AnyPiece, Cosine, Curve, Piece, joined, power_coefficients, sampled
from derive.plans.segments import Joints, Segment
from derive.robot.load import file_bytes
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.robot import Robot

Corner = tuple[Expr, ...]  # joint variables at a point
ONE = Integer(1)

JUMP = 1e-6  # of the largest acceleration of a joint: what is a jump, and no rounding


@dataclass(frozen=True)
class Trajectory:
    """Joint variables as functions of time."""

    segments: tuple[Segment, ...]  # one after the other

    @classmethod
    def of(cls, joints: Joints, duration: Expr = ONE) -> Trajectory:
        """One segment from time 0 on [s]."""
        return cls((Segment("", Integer(0), duration, joints),))

    @property
    def duration(self) -> Expr:
        """How long it lasts [s]."""
        return self.segments[-1].start + self.segments[-1].duration

    def segment_at(self, times: Array) -> Indices:
        """Which segment the arm is in."""
        starts = [float(segment.start) for segment in self.segments]
        return np.asarray(np.clip(np.searchsorted(starts, times, side="right") - 1, 0, len(self.segments) - 1))

    def __call__(self, t: float | Array) -> tuple[Array, Array, Array]:
        """q, qd, qdd, (..., n) each, at times t [s], (...); before the start and after the end the arm stands."""
        if (times := np.asarray(t, dtype=float)).ndim == 0:
            q, qd, qdd = np.array([track.at(float(times)) for track in self._tracks]).T
            return q, qd, qdd
        found = np.stack([track(times.reshape(-1)) for track in self._tracks], axis=-1)
        q, qd, qdd = found.reshape(3, *times.shape, len(self._tracks))
        return q, qd, qdd

    @cached_property
    def jumps(self) -> tuple[float, ...]:
        """Times between start and end at which an acceleration jumps [s], by more than `JUMP` of the largest."""
        starts = np.unique(np.concatenate([track.starts for track in self._tracks]))
        inner = starts[(starts > starts[0]) & (starts < float(self.duration))]
        after = self(inner)[2]
        gaps = np.abs(after - self(np.nextafter(inner, -np.inf))[2])
        largest = np.abs(after).max(axis=0, initial=0) + gaps.max(axis=0, initial=0)
        return tuple(inner[(gaps > JUMP * largest).any(axis=1)].tolist())

    @cached_property
    def _tracks(self) -> tuple[_Track, ...]:
        joints = len(self.segments[0].joints)
        return tuple(_Track([piece for s in self.segments for piece in s.joints[j]]) for j in range(joints))


_COSINE, _CURVE = 0, -1


class _Track:
    def __init__(self, pieces: Sequence[AnyPiece]) -> None:
        self.starts = np.array([float(piece.start) for piece in pieces])
        self._start_list = [float(start) for start in self.starts]
        self.end = float(pieces[-1].end)
        self.durations = np.array([float(piece.duration) for piece in pieces])
        self.pieces = pieces
        # How a piece is computed: a polynomial by its number of values at each end; a formula is alone in its motion.
        kinds = {Cosine: _COSINE, Curve: _CURVE}
        self.kinds = np.array([piece.k if isinstance(piece, Piece) else kinds[type(piece)] for piece in pieces])
        values = [getattr(piece, "values", ()) for piece in pieces]  # none of a formula
        self.numbers = [np.array([float(value) for end in ends for value in end]) for ends in values]
        self.rows: dict[int, Array] = {}  # the numbers of all pieces of each kind, and zeros of others
        for kind in set(self.kinds.tolist()):
            places = np.flatnonzero(self.kinds == kind)
            self.rows[kind] = np.zeros((len(pieces), max(self.numbers[i].size for i in places)))
            self.rows[kind][places] = [self.numbers[i] for i in places]

    @cached_property
    def _powers(self) -> list[list[float]]:
        """Coefficients of each polynomial by powers of unit time, the highest first."""
        return [
            list(power_coefficients(numbers, int(kind), length)) if kind > 0 else []
            for numbers, kind, length in zip(self.numbers, self.kinds, self.durations, strict=True)
        ]

    def at(self, t: float) -> tuple[float, float, float]:
        """Position, velocity, acceleration at one time, without the cost of arrays."""
        index = max(bisect_right(self._start_list, t) - 1, 0)
        if self.kinds[index] <= 0 or not self._start_list[0] <= t <= self.end:
            q, qd, qdd = self(np.array([t]))[:, 0]
            return float(q), float(qd), float(qdd)
        length = float(self.durations[index])
        u = (t - self._start_list[index]) / length
        q = qd = qdd = 0.0
        # Horner's rule with both derivatives: q'' = q'' u + 2 q', q' = q' u + q, q = q u + c.
        for coefficient in self._powers[index]:
            qdd = qdd * u + 2 * qd
            qd = qd * u + q
            q = q * u + coefficient
        return q, qd / length, qdd / length**2

    def __call__(self, t: Array) -> Array:
        """Position, velocity, acceleration, (3, points)."""
        inside = np.clip(t, self.starts[0], self.end)
        index = np.clip(np.searchsorted(self.starts, inside, side="right") - 1, 0, len(self.starts) - 1)
        following = np.append(self.starts[1:], self.end)
        length = self.durations[index]
        u = np.where(inside >= following[index], 1.0, (inside - self.starts[index]) / length)
        found = np.zeros((3, t.size))
        for kind in sorted(set(self.kinds[index].tolist())):  # np.unique would import numpy.ma
            here = self.kinds[index] == kind
            numbers = self.rows[kind][index[here]]
            for order in range(3):
                if kind > 0:
                    found[order, here] = sampled(numbers, kind, u[here], length[here], order)
                elif kind == _COSINE:
                    found[order, here] = _cosine(numbers, u[here], length[here], order)
                else:
                    found[order, here] = self.pieces[index[here][0]].sampled(inside[here], order)
        found[1:, (t < self.starts[0]) | (t > self.end)] = 0
        return found


def _cosine(numbers: Array, u: Array, length: Array, order: int) -> Array:
    """A harmonic piece; symmetric about its middle, so that nothing is rounded at its ends."""
    q0, way, near = numbers[:, 0], numbers[:, 1] - numbers[:, 0], np.minimum(u, 1 - u)
    if order == 1:
        return np.asarray(way / 2 * np.pi / length * np.sin(np.pi * near))
    wave = np.where(u <= 0.5, np.cos(np.pi * near), -np.cos(np.pi * near))
    if order == 2:
        return np.asarray(way / 2 * (np.pi / length) ** 2 * wave)
    return np.asarray(np.where(u <= 0.5, q0 + way * (1 - wave) / 2, numbers[:, 1] - way * (1 + wave) / 2))


# -- motions that are no paths: formulas of time that a joint can follow, finite with two derivatives, and recordings
#
# A recording is a CSV file: recorded angles, or the samples that ``derive move --csv`` writes.

PLACES = 4001  # times at which formulas are looked at; zeros between two are found by the change of sign
NOTHING = 1e-12  # relative to the largest value: what is smaller is zero
ROWS = 200_000  # most rows of a file
BYTES = 100_000_000  # most bytes of a file
UNITS = {"rad": 1.0, "deg": math.pi / 180, "m": 1.0, "mm": 1e-3}  # of a column, as in ``q1 [deg]``; else rad or m


def curves_of(formulas: Sequence[Expr], duration: Expr) -> Trajectory:
    """Joint variables by formulas of time that last so long [s]."""
    pairs = [(formula, formula.diff(TIME)) for formula in formulas]
    pieces = tuple((Curve(ZERO, duration, (formula, rate, rate.diff(TIME))),) for formula, rate in pairs)
    return Trajectory((Segment("curves", ZERO, duration, pieces),))


def followed(formula: Expr, duration: float) -> Expr:
    """A formula that a joint can follow from 0 to its duration [s]."""
    # Magnitudes, as of sqrt(t**2), are written without where what stands in them keeps its sign: the derivatives are
    # one-sided at both ends.
    times = np.linspace(0.0, duration, PLACES)
    for magnitude in sorted(formula.atoms(Abs), key=lambda node: node.count_ops()):
        (inner,) = magnitude.args
        if (values := _numbers(inner, times)).min() < 0 < values.max():
            raise _refusal("the velocity jumps", _zero(times, values))
        formula = formula.xreplace({magnitude: inner if values.max() > 0 else -inner})
    derivative = formula
    for what in ("the formula", "its velocity", "its acceleration"):
        for message, time in _undefined(derivative, times):
            raise _refusal(message if what == "the formula" else f"{what} is not finite: {message}", time)
        if not np.isfinite(_numbers(derivative, times)).all():
            raise _refusal(f"{what} is not finite", times[np.argmin(np.isfinite(_numbers(derivative, times)))])
        derivative = derivative.diff(TIME)
    return formula


def _refusal(found: str, time: float) -> QuantityError:
    allowed = "allowed: formulas with a finite velocity and acceleration from 0 to the end"
    return QuantityError(f"{found} near t = {time:.4g} s", allowed=allowed, remedy="write another formula or time")


def _numbers(formula: Expr, times: Array) -> Array:
    with np.errstate(all="ignore"):
        return np.asarray(Curve(Integer(0), Integer(1), (formula, formula, formula)).sampled(times, 0), dtype=float)


def _undefined(formula: Expr, times: Array) -> Iterator[tuple[str, float]]:
    """Parts of a formula that have no finite real value at some time, and when."""
    for node in preorder_traversal(formula):
        if isinstance(node, Pow) and node.has(TIME):
            base = _numbers(node.base, times)
            if not node.exp.is_Integer and base.min() < -NOTHING * np.abs(base).max():
                yield "root of a negative number", times[base.argmin()]
            elif node.exp.is_negative and (time := _zero_of(node.base, times, base)) is not None:
                yield "division by zero", time
        elif isinstance(node, tan) and node.has(TIME):
            below = cos(node.args[0])
            if (time := _zero_of(below, times, _numbers(below, times))) is not None:
                yield "tangent at its pole", time


def _zero_of(formula: Expr, times: Array, values: Array) -> float | None:
    """When a formula is zero, whether it changes its sign there or not."""
    if values.min() < 0 < values.max():
        return _zero(times, values)
    at, last = int(np.abs(values).argmin()), times.size - 1
    ends = times[[max(at - 1, 0)]], times[[min(at + 1, last)]]
    (when,), (least,) = refined(lambda places: -np.abs(_numbers(formula, places)), *ends)
    return float(when) if -least <= NOTHING * np.abs(values).max() else None


def _zero(times: Array, values: Array) -> float:
    """The first time at which a function changes its sign."""
    signs = np.sign(values)
    at = int(np.argmax(signs[1:] * signs[:-1] <= 0))
    a, b = values[at], values[at + 1]
    return float(times[at] if a == b else times[at] - a * (times[at + 1] - times[at]) / (b - a))


def read_recording(path: Path, robot: Robot) -> Trajectory:
    """A motion from a CSV file with a heading: ``t``, and a column for each joint variable; others are passed over."""
    # Between the rows it is the cubic spline; with velocities of all joints in the file it is cubic polynomials that
    # have them, with accelerations, too, quintic ones.
    source = str(path)

    def _refused(found: str, allowed: str, *place: int) -> RobotFileError:
        return RobotFileError(found, allowed=f"allowed: {allowed}", location=Location(source, *place))

    if len(data := file_bytes(path, BYTES)) > BYTES:
        raise _refused(f"more than {BYTES} bytes", f"at most {BYTES} bytes and {ROWS} rows")
    try:
        lines = list(csv.reader(data.decode("utf-8-sig").splitlines()))
    except UnicodeDecodeError:
        raise _refused("this is no text in UTF-8", "comma-separated values") from None
    columns = _columns(lines[0] if lines else [], robot, source)
    if not 2 <= len(lines) - 1 <= ROWS:
        raise _refused(f"{max(len(lines) - 1, 0)} rows", f"2 to {ROWS}", max(len(lines), 1))
    numbers = np.array([_row(line, columns, Location(source, k)) for k, line in enumerate(lines[1:], start=2) if line])
    times = numbers[:, 0] - numbers[0, 0]
    if (np.diff(times) <= 0).any():
        at = int(np.argmax(np.diff(times) <= 0)) + 3
        raise _refused(f"the time {numbers[at - 2, 0]:.6g} after {numbers[at - 3, 0]:.6g}", "times that ascend", at, 1)
    orders = (numbers.shape[1] - 1) // robot.dof
    states = numbers[:, 1:].reshape(len(times), orders, robot.dof)
    if orders == 1:
        scipy = optional("scipy.interpolate", "rates of a recorded motion need scipy", "motion")
        # Velocities of the cubic spline without a knot at the second point and the last but one.
        states = np.stack([states[:, 0], scipy.CubicSpline(times, states[:, 0])(times, 1)], axis=1)
    when = [Float(t) for t in times]
    joints = tuple(joined([tuple(map(Float, node)) for node in states[:, :, j]], when) for j in range(robot.dof))
    return Trajectory((Segment("recording", when[0], when[-1], joints),))


def _columns(heading: list[str], robot: Robot, source: str) -> list[tuple[int, float]]:
    """Place and unit of the time, of all variables, and of their rates where all are there."""
    named: dict[str, tuple[int, float]] = {}
    for k, cell in enumerate(heading):
        name, _, unit = cell.strip().partition("[")
        unit = unit.strip().removesuffix("]").strip()
        if unit in UNITS or not unit:
            named.setdefault(name.strip(), (k, UNITS.get(unit, 1.0)))
    variables = [joint.variable for joint in robot.variables]
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
            there = Location(place.source, place.line, sum(len(before) + 1 for before in line[:at]) + 1)
            raise RobotFileError(f"found {quoted(cell)}", allowed="allowed: a number", location=there)
        numbers.append(value * unit)
    return numbers
