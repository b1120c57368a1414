"""The web page of a motion: what it plays, as numbers and trees; and the handout's part about the plan on paper."""

from collections.abc import Sequence
from itertools import pairwise
from math import ceil

import numpy as np
from sympy import Abs, Add, Expr, Mul, Pow, atan, atan2, cos, sign, sin, tan

from derive.arrays import Array
from derive.handouts.assemble import context_of, section_of
from derive.handouts.page.player import REGRESSOR, TORQUE, Formula, Playback, PlayedPiece, PlayedRun
from derive.handouts.page.viewer import FUNCTIONS, Viewer, viewer
from derive.handouts.page.writer import page
from derive.handouts.parts.plan import HAND_SPLINE, plan_section, plan_sheet
from derive.handouts.pdf import compile_latex
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Document, Section
from derive.handouts.sheet.latex_writer import latex
from derive.motion.motion import Motion
from derive.motion.output.code import Kernel
from derive.motion.output.film import motion_normal
from derive.motion.simulation.simulation import Run
from derive.plans.profile import TIME, AnyPiece, Cosine, Curve, Piece, basis
from derive.plans.segments import Payload
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.targets.kernel import JAVASCRIPT

DRAWN = 361  # times at which curves are drawn on paper
PARTS = ("table", "parameters")  # what of the robot's own handout stands on the page
OPERATIONS: dict[type[Expr], str] = {Add: "add", Mul: "multiply", Pow: "power", Abs: "abs"}  # as the page calls them
OPERATIONS |= {function: function.__name__ for function in (sin, cos, tan, sign, atan2, atan)}
KINDS: dict[type[AnyPiece], str] = {Piece: "hermite", Cosine: "cosine", Curve: "curve"}  # likewise
SAMPLES = 1001  # times at which the ranges of the joints are looked for
# Of a motion on the page, about 1.5 megabytes, half of them where a simulation has the other half. Of a longer
# simulation every second row, every third, ...; of a longer motion as many places.
MOST_NUMBERS = 80_000
DIGITS = 12  # significant ones of the numbers of a simulation


_Rows = tuple[tuple[Formula, ...], ...]  # of a transform


def motion_page(motion: Motion, run: Run | None = None) -> str:
    """The page of a motion."""
    context = context_of(motion.plan.robot)
    return page(_sheet(motion, context), context.text, motion_figure(motion, context, run), is_marked=True)


def motion_figure(motion: Motion, context: Context, run: Run | None = None) -> Viewer:
    """The arm that plays the motion, with its plots, for a page."""
    robot = motion.plan.robot
    values = {name: value for name, value, _ in context.poses.assumed} if context.poses else {}
    values |= {name: motion.values[name] for name in motion.plan.values}
    played = playback(motion, run)
    program = build_program(robot, Effort.QUICK, names={*FUNCTIONS, *played.functions})
    normal = motion_normal(motion) if context.poses else None
    return viewer(robot, program, values, context.text, notation=context.notation, playback=played, normal=normal)


def motion_sheet(motion: Motion, suffix: str) -> bytes:
    """The handout's part about a plan on paper, as LaTeX or as PDF."""
    context = context_of(motion.plan.robot)
    tex = latex(_sheet(motion, context, drawn=True), context.text)
    return tex.encode() if suffix == ".tex" else compile_latex(tex, motion.plan.robot.name).pdf


def _sheet(motion: Motion, context: Context, *, drawn: bool = False) -> Document:
    robot = motion.plan.robot
    sections = (plan_part(motion, context, drawn=drawn), *(section_of(context, name) for name in PARTS))
    title = motion.plan.title or robot.title or robot.name
    return plan_sheet(context, title, motion.plan.digest, tuple(section for section in sections if section))


def plan_part(motion: Motion, context: Context, *, drawn: bool = False) -> Section:
    """The handout's part about a plan."""
    profiles = dict.fromkeys(HAND_SPLINE if step.by_hand else str(step.profile) for step in motion.plan.steps)
    curves: tuple[Array, ...] = ()
    if drawn:
        times = np.linspace(0.0, motion.duration, DRAWN)
        curves = (times, *motion(times), *([motion.torques(times)] if motion.has_torques else []))
    return plan_section(context, motion.peaks, tuple(profiles), curves)


# -- what the page plays


def playback(motion: Motion, run: Run | None = None) -> Playback:
    """The motion as the page plays it."""
    trajectory, steps = motion.trajectory, motion.plan.steps
    carried = [step.payload for step in steps] or [None]  # curves have a segment and no step
    loads = list(dict.fromkeys(carried))
    functions = () if not motion.has_torques else (TORQUE, REGRESSOR) if any(carried) else (TORQUE,)
    payloads = [motion.payload_columns(step) for step in steps if functions] or [()] * len(trajectory.segments)
    tracks, places = _tracks(motion, MOST_NUMBERS if run is None else MOST_NUMBERS // 2)
    reached = motion(np.linspace(0, motion.duration, SAMPLES))[0]
    reached = reached if run is None else np.concatenate([reached, run.q])
    violations = motion.violations if run is None else motion.violations_of(run)
    told = [item for item in violations if functions or item.what != "torque"]
    lengths = {len(piece.values) // 2 for track in tracks for piece in track if piece.kind == "hermite"}
    base, base_rates, base_torques = _base_of(motion, loads if functions else ())
    end = motion.duration if run is None else max(float(run.t[-1]), motion.sample)
    segments = tuple(
        (segment.name, float(segment.start), payload, loads.index(body))
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
            for what, ends in motion.near_bounds(run).items()
            if np.isfinite(ends).any()
        },
        exceeded=tuple((item.what, item.joint, item.time, item.value) for item in told),
        run=None if run is None else _played_run(motion, run),
        places=places,
    )


def _tracks(motion: Motion, room: int) -> tuple[tuple[tuple[PlayedPiece, ...], ...], int]:
    """The pieces of each joint; Hermite pieces between as many places if they have more numbers than there is room."""
    joints, segments = range(motion.plan.robot.dof), motion.trajectory.segments
    tracks: list[list[PlayedPiece]] = [[] for _ in joints]
    for piece, track in ((piece, tracks[j]) for segment in segments for j in joints for piece in segment.joints[j]):
        if isinstance(piece, Curve):
            values: tuple[Formula, ...] = tuple(map(tree, piece.formulas))
        else:
            values = tuple(float(x) for end in piece.values for x in end)
        track.append(PlayedPiece(KINDS[type(piece)], float(piece.start), float(piece.duration), values))
    if sum(len(piece.values) // 2 for track in tracks for piece in track) <= room:
        return tuple(map(tuple, tracks)), 0
    places = room // (2 * len(joints))
    times = np.linspace(0.0, motion.duration, places)
    ends = list(pairwise(zip(times.tolist(), np.stack(motion(times)[:2], axis=2).tolist(), strict=True)))
    pairs = ([(a, b - a, (*here[j], *there[j])) for (a, here), (b, there) in ends] for j in joints)
    return tuple(tuple(PlayedPiece("hermite", *pair) for pair in track) for track in pairs), places


def _base_of(
    motion: Motion, loads: Sequence[Payload | None]
) -> tuple[_Rows, tuple[_Rows, ...], tuple[tuple[tuple[str, ...], tuple[str, ...]], ...]]:
    """The transform of a base that moves, its derivatives, and what they add to the torques."""
    base, added = motion.base, motion.base_torques
    if base is None or added is None:
        return (), (), ()
    matrices = (base.transform.diff(TIME, order).tolist() for order in range(3))
    transform, rate, bend = (tuple(tuple(map(tree, row)) for row in matrix) for matrix in matrices)
    written = tuple(Kernel("base_torques", added.tape(load)).written(JAVASCRIPT) for load in loads)
    return transform, (rate[:3], bend[:3]) if written else (), written


def _played_run(motion: Motion, run: Run) -> PlayedRun:
    """Its rows, or as many as a page should hold, the last one among them."""
    step = ceil(run.t.size * (1 + 3 * motion.plan.robot.dof) / (MOST_NUMBERS // 2))
    kept = np.unique(np.append(np.arange(0, run.t.size, step), run.t.size - 1))
    times = run.t[kept]
    if kept.size == 1:  # given up before the second row
        kept, times = np.zeros(2, dtype=int), np.append(times, times + motion.sample)
    rows = (values[kept] for values in (run.q, run.qd, run.tau))
    q, qd, tau = (tuple(tuple(float(f"{x:.{DIGITS}g}") for x in row) for row in values) for values in rows)
    return PlayedRun(tuple(times.tolist()), q, qd, tau, motion.plan.control.law, motion.plan.friction, run.reached)


def tree(formula: Expr) -> Formula:
    """A formula of time as lists of operations and their operands."""
    if formula == TIME:
        return "t"
    return [OPERATIONS[formula.func], *map(tree, formula.args)] if formula.has(TIME) else float(formula)
