"""The formulas of a motion as they are printed: a polynomial of time for every joint and segment."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sympy import Expr, Float, Symbol, latex, sstr

from derive.motion.motion import Motion
from derive.plans.hermite import MOST_PRINTED
from derive.plans.segments import DIGITS, formula
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
                value, start = formula(piece, segment), piece.start - segment.start
                span = (start, start + piece.duration) if len(pieces) > 1 else None
                lines.append(_line(joint.variable, value, span, as_latex=as_latex))
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


def _line(name: str, value: Expr, span: tuple[Expr, Expr] | None, *, as_latex: bool) -> str:
    if as_latex:
        said = "" if span is None else rf" && {latex(span[0])} \le t \le {latex(span[1])}"
        return f"  {latex(Symbol(name))}(t) &= {latex(value, order='rev-lex')}{said}"
    said = "" if span is None else f"  for {_time(span[0])} <= t <= {_time(span[1])}"
    return f"  {name} = {sstr(value, order='rev-lex')}{said}"
