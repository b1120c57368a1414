"""The web page of a motion: the arm that plays it; and the handout's part about the plan, as a sheet on paper."""

from __future__ import annotations

import numpy as np

from derive.handouts.assemble import context_of, section_of
from derive.handouts.page.viewer import FUNCTIONS, Viewer, viewer
from derive.handouts.page.writer import page
from derive.handouts.parts.plan import (
    HAND_SPLINE,
    PlannedCurves,
    PlannedJoint,
    PlannedMotion,
    PlannedPiece,
    PlannedSegment,
    plan_section,
    plan_sheet,
)
from derive.handouts.pdf import compile_latex
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Section
from derive.handouts.sheet.latex_writer import latex
from derive.motion.curves.trajectory import Segment
from derive.motion.motion import Motion
from derive.motion.output.plane import motion_normal
from derive.motion.output.playback import playback
from derive.motion.output.polynomials import formula
from derive.motion.simulation.simulation import Run
from derive.motion.torques.loads import SegmentPeaks
from derive.plans.hermite import MOST_PRINTED, basis
from derive.plans.profile import VALUES
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort

DRAWN = 361  # times at which curves are drawn on paper
PARTS = ("table", "parameters")  # what of the robot's own handout stands on the page


def motion_page(motion: Motion, run: Run | None = None) -> str:
    """The page of a motion."""
    robot = motion.plan.robot
    context = context_of(robot)
    text = context.text
    sections = (plan_part(motion, context), *(section_of(context, name) for name in PARTS))
    title = motion.plan.title or robot.title or robot.name
    sheet = plan_sheet(context, title, motion.plan.digest, tuple(section for section in sections if section))
    mark = f"<!DOCTYPE html>\n<!-- written by derive {context.version} -->"
    return page(sheet, text, motion_figure(motion, context, run)).replace("<!DOCTYPE html>", mark, 1)


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
    """The handout's part about a plan as a sheet."""
    robot = motion.plan.robot
    context = context_of(robot)
    sections = (plan_part(motion, context, drawn=True), *(section_of(context, name) for name in PARTS))
    title = motion.plan.title or robot.title or robot.name
    sheet = plan_sheet(context, title, motion.plan.digest, tuple(section for section in sections if section))
    tex = latex(sheet, context.text)
    return tex.encode() if suffix == ".tex" else compile_latex(tex, robot.name).pdf


def plan_part(motion: Motion, context: Context, *, drawn: bool = False) -> Section:
    """The handout's part about a plan."""
    segments = tuple(
        PlannedSegment(
            peaks.segment.name,
            peaks.segment.duration,
            tuple(
                PlannedJoint(
                    _pieces(peaks.segment, j),
                    len(peaks.segment.joints[j]),
                    peaks.speeds[j].value,
                    peaks.accelerations[j].value,
                    *_load(peaks, j),
                )
                for j in range(motion.plan.robot.n)
            ),
            peaks.work if peaks.loads else None,
        )
        for peaks in motion.peaks
    )
    steps = motion.plan.steps
    profiles = {HAND_SPLINE if step.by_hand else str(step.profile): step.profile for step in steps}
    coefficients = {
        name: basis(VALUES[profile])[VALUES[profile]] if profile in VALUES else () for name, profile in profiles.items()
    }
    return plan_section(context, PlannedMotion(segments, coefficients, _curves(motion) if drawn else None))


def _curves(motion: Motion) -> PlannedCurves:
    """What the joints do, at so many times that curves look smooth."""
    times = np.linspace(0.0, motion.duration, DRAWN)
    torques = (motion.torques(times),) if motion.has_torques else ()
    return PlannedCurves(times, (*motion(times), *torques))


def _load(peaks: SegmentPeaks, joint: int) -> tuple[float | None, ...]:
    """Torque, RMS, power and work of a joint."""
    if not peaks.loads:
        return (None,) * 4
    load = peaks.loads[joint]
    return load.peak, load.rms, load.power, load.work


def _pieces(segment: Segment, joint: int) -> tuple[PlannedPiece, ...]:
    pieces = segment.joints[joint]
    if len(pieces) > MOST_PRINTED:
        return ()
    return tuple(
        PlannedPiece(piece.start - segment.start, piece.end - segment.start, formula(piece, segment))
        for piece in pieces
    )
