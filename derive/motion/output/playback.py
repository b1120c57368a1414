"""A motion as numbers and trees that the web page plays."""

from collections.abc import Sequence
from itertools import pairwise
from math import ceil

import numpy as np
from sympy import Abs, Add, Expr, Mul, Pow, atan, atan2, cos, sign, sin, tan

from derive.handouts.page.player import (
    REGRESSOR,
    TORQUE,
    BaseTorquesText,
    Exceeded,
    Formula,
    Playback,
    PlayedPiece,
    PlayedRun,
    PlayedSegment,
)
from derive.motion.motion import Motion
from derive.motion.output.kernels import Kernel
from derive.motion.simulation.simulation import Run
from derive.plans.hermite import TIME, Piece, basis
from derive.plans.points import Payload
from derive.plans.profile import AnyPiece, Curve
from derive.targets.kernel import JAVASCRIPT

# What the page calls the operations of formulas.
OPERATIONS: dict[type[Expr], str] = {Add: "add", Mul: "multiply", Pow: "power", Abs: "abs"}
OPERATIONS |= {function: function.__name__ for function in (sin, cos, tan, sign, atan2, atan)}
SAMPLES = 1001  # times at which the ranges of the joints are looked for
# Of a motion on the page, about 1.5 megabytes, half of them where a simulation has the other half. Of a longer
# simulation every second row, every third, ...; of a longer motion as many places.
MOST_NUMBERS = 80_000
DIGITS = 12  # significant ones of the numbers of a simulation


_Rows = tuple[tuple[Formula, ...], ...]  # of a transform


def playback(motion: Motion, run: Run | None = None) -> Playback:
    """The motion as the page plays it."""
    trajectory, steps = motion.trajectory, motion.plan.steps
    carried = [step.payload for step in steps] or [None]  # curves have a segment and no step
    loads = list(dict.fromkeys(carried))
    functions: tuple[str, ...] = ()
    if motion.has_torques:
        functions = (TORQUE, REGRESSOR) if any(carried) else (TORQUE,)
    payloads = [motion.payload_columns(step) for step in steps if functions] or [()] * len(trajectory.segments)
    tracks, places = _tracks(motion, MOST_NUMBERS if run is None else MOST_NUMBERS // 2)
    reached = motion(np.linspace(0, motion.duration, SAMPLES))[0]
    if run is not None:
        reached = np.concatenate([reached, run.q])
    violations = motion.violations if run is None else motion.violations_of(run)
    near = motion.near_bounds(run)
    lengths = {len(piece.values) // 2 for track in tracks for piece in track if piece.kind == "hermite"}
    base, base_rates, base_torques = _base_of(motion, loads if functions else ())
    end = motion.duration if run is None else max(float(run.t[-1]), motion.sample)
    segments = tuple(
        PlayedSegment(segment.name, float(segment.start), payload, loads.index(body))
        for segment, payload, body in zip(trajectory.segments, payloads, carried, strict=True)
        if float(segment.start) < end
    )
    return Playback(
        tracks=tracks,
        segments=segments,
        basis={k: basis(k) for k in sorted(lengths | ({2} if run else set()))},
        duration=end,
        sample=motion.sample,
        ranges=tuple((float(low), float(high)) for low, high in zip(reached.min(0), reached.max(0), strict=True)),
        functions=functions,
        base=base,
        base_rates=base_rates,
        base_torques=base_torques,
        bounds={
            what: tuple(zip(*([x if np.isfinite(x) else None for x in end.tolist()] for end in ends), strict=True))
            for what, ends in near.items()
            if np.isfinite(ends).any()
        },
        exceeded=tuple(
            Exceeded(item.what, item.joint, item.time, item.value)
            for item in violations
            if functions or item.what != "torque"
        ),
        run=None if run is None else _played_run(motion, run),
        places=places,
    )


def _tracks(motion: Motion, room: int) -> tuple[tuple[tuple[PlayedPiece, ...], ...], int]:
    """The pieces of each joint; Hermite pieces between as many places if they have more numbers than there is room."""
    joints, segments = range(motion.plan.robot.n), motion.trajectory.segments
    tracks = tuple(tuple(_played(piece) for segment in segments for piece in segment.joints[j]) for j in joints)
    if sum(len(piece.values) // 2 for track in tracks for piece in track) <= room:
        return tracks, 0
    places = room // (2 * len(joints))
    times = np.linspace(0.0, motion.duration, places)
    ends = list(pairwise(zip(times.tolist(), np.stack(motion(times)[:2], axis=2).tolist(), strict=True)))
    return tuple(
        tuple(PlayedPiece("hermite", a, b - a, (*here[j], *there[j])) for (a, here), (b, there) in ends) for j in joints
    ), places


def _base_of(
    motion: Motion, loads: Sequence[Payload | None]
) -> tuple[_Rows, tuple[_Rows, ...], tuple[BaseTorquesText, ...]]:
    """The transform of a base that moves, its derivatives, and what they add to the torques."""
    base, added = motion.base, motion.base_torques
    if base is None or added is None:
        return (), (), ()
    transform, rate, bend = (
        tuple(tuple(map(tree, row)) for row in base.transform.diff(TIME, order).tolist()) for order in range(3)
    )
    texts = (Kernel("base_torques", added.tape(load)).written(JAVASCRIPT) for load in loads)
    written = tuple(BaseTorquesText(body, results) for body, results in texts)
    return transform, (rate[:3], bend[:3]) if written else (), written


def _played_run(motion: Motion, run: Run) -> PlayedRun:
    """Its rows, or as many as a page should hold, the last one among them."""
    step = ceil(run.t.size * (1 + 3 * motion.plan.robot.n) / (MOST_NUMBERS // 2))
    kept = np.unique(np.append(np.arange(0, run.t.size, step), run.t.size - 1))
    times = run.t[kept]
    if kept.size == 1:  # given up before the second row
        kept, times = np.zeros(2, dtype=int), np.append(times, times + motion.sample)

    q, qd, tau = (
        tuple(tuple(float(f"{value:.{DIGITS}g}") for value in row) for row in values[kept])
        for values in (run.q, run.qd, run.tau)
    )
    return PlayedRun(tuple(times.tolist()), q, qd, tau, motion.plan.control.law, motion.plan.friction, run.reached)


def _played(piece: AnyPiece) -> PlayedPiece:
    start, duration = float(piece.start), float(piece.duration)
    if isinstance(piece, Curve):
        return PlayedPiece("curve", start, duration, formulas=tuple(map(tree, piece.formulas)))
    values = tuple(float(value) for end in piece.values for value in end)
    return PlayedPiece("hermite" if isinstance(piece, Piece) else "cosine", start, duration, values)


def tree(formula: Expr) -> Formula:
    """A formula of time as lists of operations and their operands."""
    if formula == TIME:
        return "t"
    if not formula.has(TIME):
        return float(formula)
    return [OPERATIONS[formula.func], *map(tree, formula.args)]
