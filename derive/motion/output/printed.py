"""A motion as it is printed: polynomials of time, plain data for JSON, the curve of the hand, tables and samples.

In the data exact numbers stand as texts beside their decimals. The curve of the hand is where the end effector is and
how fast it goes, as formulas.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from sympy import Expr, Float, Matrix, Symbol, latex, powdenest, sqrt, sstr

from derive.arrays import Array
from derive.errors import QuantityError
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.mechanics.vectors import dot
from derive.motion.curves.limits import ROUNDING, Violation
from derive.motion.motion import Motion
from derive.motion.simulation.simulation import Run
from derive.motion.torques.functions import arm_of, joint_positions
from derive.plans.profile import MOST_PRINTED, TIME
from derive.plans.segments import DIGITS, Peak, SegmentPeaks, formula
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.robot import Robot
from derive.robot.tree import ends
from derive.targets.escape import latex_text

if TYPE_CHECKING:
    from derive.model.kinematic_model import KinematicModel

AXES = ("x", "y", "z")


def printed(motion: Motion, *, as_latex: bool = False) -> Iterator[str]:
    """All formulas, segment by segment."""
    for segment in motion.trajectory.segments:
        heading, lines = f"{segment.name}, 0 <= t <= {_time(segment.duration)} s", []
        for joint, pieces in zip(motion.plan.robot.variables, segment.joints, strict=True):
            if len(pieces) > MOST_PRINTED:
                said = f"{joint.variable}: {len(pieces)} polynomials between places on the way"
                lines.append(rf"  &\text{{{latex_text(said)}}}" if as_latex else f"  {said}")
                continue
            for piece in pieces:
                value, low = formula(piece, segment), piece.start - segment.start
                high = low + piece.duration
                if as_latex:
                    span = rf" && {latex(low)} \le t \le {latex(high)}" if len(pieces) > 1 else ""
                    lines.append(f"  {latex(Symbol(joint.variable))}(t) &= {latex(value, order='rev-lex')}{span}")
                else:
                    span = f"  for {_time(low)} <= t <= {_time(high)}" if len(pieces) > 1 else ""
                    lines.append(f"  {joint.variable} = {sstr(value, order='rev-lex')}{span}")
        yield from aligned(heading, lines) if as_latex else (heading, *lines)


def aligned(heading: str, lines: Sequence[str]) -> Iterator[str]:
    """Formulas as one display of LaTeX."""
    yield f"% {' '.join(heading.split())}"
    yield r"\begin{align*}"
    yield from (f"{line} \\\\" for line in lines[:-1])
    yield from lines[-1:]
    yield r"\end{align*}"


def _time(value: Expr) -> str:
    return f"{float(value):.{DIGITS}g}" if value.has(Float) else sstr(value)


def summary(motion: Motion, run: Run | None = None) -> dict[str, Any]:
    """What a motion asks of its robot."""
    robot = motion.plan.robot
    found: dict[str, Any] = {
        "plan": motion.plan.source,
        "robot": robot.name,
        "joints": [joint.variable for joint in robot.variables],
        "duration": motion.duration,
        "samples": len(motion.times),
        "segments": [_segment(robot, peaks) for peaks in motion.peaks],
        "violations": _violations(robot, motion.violations),
    }
    if run is not None:
        errors = abs(run.q - motion(run.t)[0]).max(axis=0)
        found["simulation"] = {
            "law": motion.plan.control.law,
            "friction": motion.plan.friction,
            "reached": run.reached,
            "time": float(run.t[-1]),
            "largest_errors": dict(zip(found["joints"], errors.tolist(), strict=True)),
            "end": {"q": run.q[-1].tolist(), "qd": run.qd[-1].tolist()},
            **{name: float(getattr(run, name)[-1]) for name in ("work", "brought", "pushed")},
            "base_work": float(run.base[-1]),
            "lost": float(run.lost[-1]),
            "energy_error": run.energy_error,
            "violations": _violations(robot, motion.violations_of(run)),
        }
    return found


def _segment(robot: Robot, peaks: SegmentPeaks) -> dict[str, Any]:
    joints: dict[str, dict[str, Any]] = {}
    for j, joint in enumerate(robot.variables):
        joints[joint.variable] = {"speed": _peak(peaks.speeds[j]), "acceleration": _peak(peaks.accelerations[j])}
        if peaks.loads:
            load = peaks.loads[j]
            joints[joint.variable]["torque"] = {"value": load.peak, "time": load.time, "rms": load.rms}
            joints[joint.variable] |= {"power": load.power, "work": load.work}
    segment = peaks.segment
    found: dict[str, Any] = {"name": segment.name, "start": float(segment.start), "duration": float(segment.duration)}
    works = {"work": peaks.work} if peaks.loads else {}
    works |= {"base_work": peaks.base.work} if peaks.base else {}
    return {**found, **works, "joints": joints}


def _violations(robot: Robot, violations: Sequence[Violation]) -> list[dict[str, Any]]:
    keys = ("what", "time", "value", "limit", "excess")
    names = [joint.variable for joint in robot.variables]
    return [{"joint": names[item.joint], **{key: getattr(item, key) for key in keys}} for item in violations]


def _peak(peak: Peak) -> dict[str, Any]:
    exact = {"exact": sstr(peak.value)} if peak.is_exact else {}
    return {"value": float(peak.value), "time": float(peak.time), **exact}


# -- the curve of the hand


class HandCurve:
    """The end effector of a motion, or an end of a tree."""

    def __init__(self, motion: Motion, end: str = "") -> None:
        self._motion = motion
        self.robot, _ = arm_of(motion.plan.robot, end)

    @cached_property
    def _model(self) -> KinematicModel:
        from derive.model.kinematic_model import KinematicModel  # the table of a motion needs no formulas

        return KinematicModel(self.robot)

    @cached_property
    def position(self) -> tuple[Expr, Expr, Expr]:
        """x, y, z of the end effector in the joint variables and the symbols of the robot, the base moving."""
        p = Matrix([*self._model.p, 1])
        if self._motion.base is not None:
            p = self._motion.base.transform * p
        x, y, z = p[:3]
        return x, y, z

    @cached_property
    def formula(self) -> tuple[Expr, Expr, Expr]:
        """x, y, z of the end effector as formulas of time, of a motion by curves."""
        if not (curves := self._motion.plan.curves):
            raise QuantityError("no formula of the hand", remedy="only curves: have one")
        plain = Symbol(TIME.name)
        joints = {Symbol(name): expression_to_sympy(value).subs(plain, TIME) for name, value in curves.items()}
        x, y, z = (entry.subs(joints, simultaneous=True) for entry in self.position)
        return x, y, z

    @cached_property
    def weights(self) -> tuple[Expr, ...]:
        """How far the hand goes when a joint alone moves by one: the length of each column of J (slide 27)."""
        model = self._model
        columns, _ = model.jacobian_columns
        squares = (model.form.kinematic(dot(column, column)) for column in columns)
        return tuple(powdenest(sqrt(square), force=True) for square in squares)  # symbols of lengths are positive


def printed_hand(motion: Motion, *, as_latex: bool = False) -> Iterator[str]:
    """The curve of the hand as people write it."""
    for end in ends(motion.plan.robot):
        yield ("% " if as_latex else "") + (f"hand, end {end.name}" if end.name else "hand")
        hand, plain = HandCurve(motion, end.name), Symbol(TIME.name)
        of_time = [hand.formula, [entry.diff(TIME) for entry in hand.formula]] if motion.plan.curves else []
        for letter, entries in zip("pv", of_time or [hand.position], strict=False):
            for axis, entry in zip(AXES, entries, strict=True):
                if (value := entry.subs(TIME, plain)) != 0:
                    yield f"{letter}_{axis}(t) = {latex(value)}" if as_latex else f"  {letter}{axis} = {sstr(value)}"


def printed_weights(motion: Motion, *, as_latex: bool = False) -> Iterator[str]:
    """Which joint moves the hand most."""
    for end in ends(motion.plan.robot):
        hand = HandCurve(motion, end.name)
        for joint, weight in zip(hand.robot.variables, hand.weights, strict=True):
            if as_latex:
                of_end = f"^{{\\text{{{latex_text(end.name)}}}}}" if end.name else ""
                yield f"\\lVert J{of_end}_{{{latex(Symbol(joint.variable))}}} \\rVert = {latex(weight)}"
            else:
                yield f"{joint.variable} moves {end.name or 'the hand'} by {sstr(weight)}"


# -- the table that derive move prints, and samples as rows

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
    last = joint_positions(robot, q, motion.values, motion.reached)[0][:, places]
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
