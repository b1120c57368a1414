"""A motion as it is printed: a polynomial of time for every joint and segment, plain data for JSON, the hand's curve.

In the data exact numbers stand as texts beside their decimals. The curve of the hand is where the end effector is and
how fast it goes, in numbers and, of formulas, as a formula.
"""

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from sympy import Expr, Float, Matrix, Symbol, latex, powdenest, sqrt, sstr

from derive.arrays import Array
from derive.errors import QuantityError
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.mechanics.vectors import dot
from derive.model.kinematic_model import KinematicModel
from derive.motion.curves.limits import Violation
from derive.motion.motion import Motion
from derive.motion.simulation.simulation import Run
from derive.motion.torques.functions import Functions, arm_of, check_numbers
from derive.plans.hermite import MOST_PRINTED, TIME
from derive.plans.segments import DIGITS, Peak, SegmentPeaks, formula
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.robot.tree import ends
from derive.targets.escape import latex_text

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
        self.robot, self._places = arm_of(motion.plan.robot, end)

    def __call__(self, t: Array) -> tuple[Array, Array]:
        """Position [m] and velocity [m/s] in the world frame, (times, 3) each."""
        times = np.asarray(t, dtype=float)
        q, qd = (value[..., list(self._places)] for value in self._motion(times)[:2])
        p = self._functions("forward_kinematics", q)[..., :3, 3]
        v = np.einsum("tij,tj->ti", self._functions("jacobian", q)[..., :3, :], qd)  # v = J_v qd
        if (base := self._motion.base) is None:
            return p, v
        # On a base with the pose (R, o): p_world = R p + o, v_world = R' p + R v + o'.
        now, rate = base(times, 0), base(times, 1)
        turned = np.einsum("tij,tj->ti", rate[:, :3, :3], p) + np.einsum("tij,tj->ti", now[:, :3, :3], v)
        return np.einsum("tij,tj->ti", now[:, :3, :3], p) + now[:, :3, 3], turned + rate[:, :3, 3]

    @cached_property
    def _functions(self) -> Functions:
        robot, place = self.robot, self._motion.plan.places["robot"]
        check_numbers(free_symbols(robot), self._motion.values, robot.name, place)
        return Functions(robot, frozenset({"forward_kinematics", "jacobian"}), self._motion.values)

    @cached_property
    def position(self) -> tuple[Expr, Expr, Expr]:
        """x, y, z of the end effector in the joint variables and the symbols of the robot, the base moving."""
        p = Matrix([*KinematicModel(self.robot).p, 1])
        if self._motion.base is not None:
            p = self._motion.base.transform * p
        x, y, z = p[:3]
        return x, y, z

    @cached_property
    def formula(self) -> tuple[Expr, Expr, Expr]:
        """x, y, z of the end effector as formulas of time, of a motion by curves."""
        curves = self._motion.plan.curves
        if not curves:
            raise QuantityError("no formula of the hand", remedy="only curves: have one")
        plain = Symbol(TIME.name)
        joints = {Symbol(name): expression_to_sympy(value).subs(plain, TIME) for name, value in curves.items()}
        x, y, z = (entry.subs(joints, simultaneous=True) for entry in self.position)
        return x, y, z

    @cached_property
    def weights(self) -> tuple[Expr, ...]:
        """How far the hand goes when a joint alone moves by one: the length of each column of J (slide 27)."""
        model = KinematicModel(self.robot)
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
                value = entry.subs(TIME, plain)
                if value != 0:
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
