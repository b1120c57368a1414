"""The formulas of a motion as they are printed: a polynomial of time for every joint and segment."""

from __future__ import annotations

from collections.abc import Iterator

from sympy import Expr, Symbol, cos, expand, latex, pi, sstr

from derive.motion.hermite import Piece
from derive.motion.motion import Motion
from derive.motion.profile import AnyPiece, Cosine, Curve
from derive.motion.trajectory import Segment

TIME = Symbol("t")
"""Time since the segment began."""


def formula(piece: AnyPiece, segment: Segment) -> Expr:
    """The position of a joint as a formula of the time since its segment began.

    Args:
        piece: Of the joint.
        segment: In which it stands.

    Returns:
        Exact where the piece is.
    """
    if isinstance(piece, Curve):
        return piece.formulas[0].subs(next(iter(piece.formulas[0].free_symbols), TIME), TIME)
    u = (TIME - piece.start + segment.start) / piece.duration
    if isinstance(piece, Cosine):
        (q0,), (q1,) = piece.values
        return q0 + (q1 - q0) * (1 - cos(pi * u)) / 2
    polynomial = piece.in_unit_time()
    return expand(polynomial.as_expr().subs(polynomial.gen, u))


def printed(motion: Motion, *, as_latex: bool = False) -> Iterator[str]:
    """All formulas, segment by segment.

    Args:
        motion: The motion.
        as_latex: Whether they are LaTeX.

    Yields:
        Lines: a heading for each segment, then its joints; a joint that stands has one number.
    """
    joints = motion.plan.robot.joints
    for segment in motion.trajectory.segments:
        yield ("% " if as_latex else "") + f"{segment.name}, 0 <= t <= {sstr(segment.duration)} s"
        for joint, pieces in zip(joints, segment.joints, strict=True):
            if len(pieces) > 8 and isinstance(pieces[0], Piece):
                yield f"  {joint.variable}: {len(pieces)} polynomials between places on the way"
                continue
            for piece in pieces:
                value = formula(piece, segment)
                span = ""
                if len(pieces) > 1:
                    start = piece.start - segment.start
                    span = f"  for {sstr(start)} <= t <= {sstr(start + piece.duration)}"
                yield _line(joint.variable, value, span, as_latex=as_latex)


def _line(name: str, value: Expr, span: str, *, as_latex: bool) -> str:
    if as_latex:
        return f"{latex(Symbol(name))}(t) = {latex(value, order='rev-lex')}{span.replace('<=', chr(92) + 'le')}"
    return f"  {name} = {sstr(value, order='rev-lex')}{span}"
