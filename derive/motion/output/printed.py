"""A motion as it is printed: a polynomial of time for every joint and segment, or plain data for JSON.

In the data exact numbers stand as texts beside their decimals.
"""

from collections.abc import Iterator, Sequence
from typing import Any

from sympy import Expr, Float, Symbol, latex, sstr

from derive.motion.curves.violations import Violation
from derive.motion.motion import Motion
from derive.motion.simulation.simulation import Run
from derive.plans.hermite import MOST_PRINTED
from derive.plans.segments import DIGITS, Peak, SegmentPeaks, formula
from derive.robot.robot import Robot
from derive.targets.escape import latex_text


def printed(motion: Motion, *, as_latex: bool = False) -> Iterator[str]:
    """All formulas, segment by segment."""
    joints = motion.plan.robot.joints
    for segment in motion.trajectory.segments:
        heading, lines = f"{segment.name}, 0 <= t <= {_time(segment.duration)} s", []
        for joint, pieces in zip(joints, segment.joints, strict=True):
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
        "joints": [joint.variable for joint in robot.joints],
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
            "work": float(run.work[-1]),
            "brought": float(run.brought[-1]),
            "pushed": float(run.pushed[-1]),
            "base_work": float(run.base[-1]),
            "lost": float(run.lost[-1]),
            "energy_error": run.energy_error,
            "violations": _violations(robot, motion.violations_of(run)),
        }
    return found


def _segment(robot: Robot, peaks: SegmentPeaks) -> dict[str, Any]:
    joints: dict[str, dict[str, Any]] = {}
    for j, joint in enumerate(robot.joints):
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
    return [
        {"joint": robot.joints[item.joint].variable, **{key: getattr(item, key) for key in keys}} for item in violations
    ]


def _peak(peak: Peak) -> dict[str, Any]:
    exact = {"exact": sstr(peak.value)} if peak.is_exact else {}
    return {"value": float(peak.value), "time": float(peak.time), **exact}
