"""A motion as numbers and trees that the web page plays."""

from __future__ import annotations

import numpy as np
from sympy import Abs, Add, Expr, Mul, Pow, atan, atan2, cos, sign, sin, tan

from derive.handouts.page.player import REGRESSOR, TORQUE, Formula, Playback, PlayedPiece, PlayedSegment
from derive.motion.hermite import TIME, Piece, basis
from derive.motion.motion import Motion
from derive.motion.profile import AnyPiece, Curve

OPERATIONS: dict[type[Expr], str] = {
    Add: "add",
    Mul: "multiply",
    Pow: "power",
    sin: "sin",
    cos: "cos",
    tan: "tan",
    sign: "sign",
    Abs: "abs",
    atan2: "atan2",
    atan: "atan",
}
"""What the page calls the operations of formulas."""

SAMPLES = 1001
"""Times at which the ranges of the joints are looked for."""


def playback(motion: Motion) -> Playback:
    """The motion as the page plays it.

    Args:
        motion: The motion.

    Returns:
        Its pieces in floats: those from which the motion is computed here, too.
    """
    trajectory, steps = motion.trajectory, motion.plan.steps
    functions: tuple[str, ...] = ()
    payloads: list[tuple[tuple[int, float], ...]] = []
    if motion.has_torques and motion.base is None:
        functions = (TORQUE, REGRESSOR) if any(step.payload for step in steps) else (TORQUE,)
        payloads = [motion.payload_columns(step) for step in steps]
    payloads += [()] * (len(trajectory.segments) - len(payloads))  # curves have a segment and no step
    tracks = tuple(
        tuple(_played(piece) for segment in trajectory.segments for piece in segment.joints[j])
        for j in range(motion.plan.robot.n)
    )
    reached = motion(np.linspace(0, motion.duration, SAMPLES))[0]
    lengths = {len(piece.values) // 2 for track in tracks for piece in track if piece.kind == "hermite"}
    return Playback(
        tracks=tracks,
        segments=tuple(
            PlayedSegment(segment.name, float(segment.start), payload)
            for segment, payload in zip(trajectory.segments, payloads, strict=True)
        ),
        basis={k: basis(k) for k in sorted(lengths)},
        duration=motion.duration,
        sample=motion.sample,
        ranges=tuple((float(low), float(high)) for low, high in zip(reached.min(0), reached.max(0), strict=True)),
        functions=functions,
        base=tuple(tuple(map(tree, row)) for row in motion.base.transform.tolist()) if motion.base else (),
    )


def _played(piece: AnyPiece) -> PlayedPiece:
    start, duration = float(piece.start), float(piece.duration)
    if isinstance(piece, Curve):
        return PlayedPiece("curve", start, duration, formulas=tuple(map(tree, piece.formulas)))
    values = tuple(float(value) for end in piece.values for value in end)
    return PlayedPiece("hermite" if isinstance(piece, Piece) else "cosine", start, duration, values)


def tree(formula: Expr) -> Formula:
    """A formula of time as lists of operations and their operands.

    Args:
        formula: In the symbol `TIME`, in what the grammar of cells and its derivatives know.

    Returns:
        A number, ``t``, or the name of an operation and its operands.
    """
    if formula == TIME:
        return "t"
    if not formula.has(TIME):
        return float(formula)
    return [OPERATIONS[formula.func], *map(tree, formula.args)]
