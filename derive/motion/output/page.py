"""The web page of a motion: the arm that plays it; and the handout's part about the plan, as a sheet on paper."""

import numpy as np

from derive.arrays import Array
from derive.handouts.assemble import context_of, section_of
from derive.handouts.page.viewer import FUNCTIONS, Viewer, viewer
from derive.handouts.page.writer import page
from derive.handouts.parts.plan import HAND_SPLINE, plan_section, plan_sheet
from derive.handouts.pdf import compile_latex
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Document, Section
from derive.handouts.sheet.latex_writer import latex
from derive.motion.motion import Motion
from derive.motion.output.plane import motion_normal
from derive.motion.output.playback import playback
from derive.motion.simulation.simulation import Run
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort

DRAWN = 361  # times at which curves are drawn on paper
PARTS = ("table", "parameters")  # what of the robot's own handout stands on the page


def motion_page(motion: Motion, run: Run | None = None) -> str:
    """The page of a motion."""
    context = context_of(motion.plan.robot)
    mark = f"<!DOCTYPE html>\n<!-- written by derive {context.version} -->"
    html = page(_sheet(motion, context), context.text, motion_figure(motion, context, run))
    return html.replace("<!DOCTYPE html>", mark, 1)


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
