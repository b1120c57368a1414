"""The handout of a robot as files in memory: LaTeX, PDF and web page from one document; and the sheet of a folder."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING

from derive.handouts.assemble import context_of, document
from derive.handouts.exercise import exercise, solutions
from derive.handouts.pdf import compile_latex
from derive.handouts.sheet.budget import within
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Document, Section
from derive.handouts.sheet.latex_writer import latex
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.options.handout import HandoutOptions
from derive.robot.robot import Robot

if TYPE_CHECKING:
    from derive.handouts.page.viewer import Viewer


class Format(StrEnum):
    """A form of the handout; the value is the ending of its file."""

    TEX = "tex"
    PDF = "pdf"
    HTML = "html"


@dataclass(frozen=True, slots=True)
class Handout:
    """A finished handout."""

    files: dict[str, bytes] = field(default_factory=dict)  # contents by file name
    pages: dict[str, int] = field(default_factory=dict)  # pages of each PDF by file name
    parts: tuple[str, ...] = ()  # the parts that it has
    shortened: bool = False  # whether anything was left out on paper to keep to its number of pages


@dataclass(frozen=True)
class Addition:
    """What stands in a handout beside the parts of its robot."""

    section: Callable[[Context], Section]  # a part after all others
    # The arm of the web page, which moves in another way than by the sliders alone.
    figure: Callable[[Context], Viewer]


def sheet_names(robot: Robot, *, exercise_sheets: bool) -> tuple[str, ...]:
    """Names of a handout's files, without their endings."""
    return (f"{robot.name}-exercise", f"{robot.name}-solutions") if exercise_sheets else (robot.name,)


def handout_files(
    robot: Robot,
    options: HandoutOptions,
    formats: Collection[Format],
    *,
    exercise_sheets: bool = False,
    progress: Callable[[str, str], None] | None = None,
    addition: Addition | None = None,
) -> Handout:
    """The files of a handout, in memory."""
    tell = progress or (lambda robot, stage: None)
    tell(robot.name, "formulas")
    context = context_of(robot, options)
    whole = document(context)
    if addition is not None:
        whole = replace(whole, sections=(*whole.sections, addition.section(context)))
    paper = within(whole, options.pages, context.text)
    makers: list[Callable[[Document], Document]] = [lambda sheet: sheet]
    if exercise_sheets:
        makers = [lambda sheet: exercise(sheet, context.text), lambda sheet: solutions(sheet, context.text)]
    files: dict[str, bytes] = {}
    pages: dict[str, int] = {}
    shortened = paper is not whole
    for name, made_from in zip(sheet_names(robot, exercise_sheets=exercise_sheets), makers, strict=True):
        tex = latex(made_from(paper), context.text) if {Format.TEX, Format.PDF}.intersection(formats) else ""
        printed: dict[str, bytes] = {}
        if Format.PDF in formats:
            tell(robot.name, "pdflatex")
            compiled, spare = compile_latex(tex, name), 0
            while name == robot.name and compiled.pages > options.pages > spare + 1:  # the estimate was too low
                spare += 1
                tex = latex(within(whole, options.pages, context.text, spare), context.text)
                compiled = compile_latex(tex, name)
            shortened |= spare > 0
            printed[f"{name}.pdf"], pages[f"{name}.pdf"] = compiled.pdf, compiled.pages
        if Format.TEX in formats:
            files[f"{name}.tex"] = tex.encode()
        files.update(printed)
        if Format.HTML in formats:
            tell(robot.name, "web page")
            from derive.handouts.page.writer import page

            figure = addition.figure(context) if addition else _arm(context)
            mark = f"<!DOCTYPE html>\n<!-- written by derive {context.version} -->"
            html = page(made_from(whole), context.text, figure).replace("<!DOCTYPE html>", mark, 1)
            files[f"{name}.html"] = html.encode()
    return Handout(files, pages, tuple(section.part for section in whole.sections), shortened)


def _arm(context: Context) -> Viewer | None:
    """The arm to move where it can be drawn."""
    from derive.handouts.figure.projection import plane_normal
    from derive.handouts.figure.scene import arm_scene
    from derive.handouts.page.viewer import FUNCTIONS, FUNCTIONS_OF_TREES, dragging, symbol_values, viewer

    if context.poses is None:
        return None
    assumed = {name: value for name, value, _ in context.poses.assumed}
    robot = context.robot
    dragged = dragging(robot, symbol_values(robot, (), assumed))
    asked = robot if dragged is None else replace(robot, inverse=dragged.task)
    names = FUNCTIONS_OF_TREES if robot.is_tree else FUNCTIONS
    program = build_program(asked, Effort.QUICK, names=names, inverse=dragged is not None)
    normal = plane_normal([arm_scene(robot, context.poses.frames(context.poses.zero))])
    return viewer(robot, program, assumed, context.text, notation=context.notation, dragged=dragged, normal=normal)


def generated_sheet(robot: Robot) -> dict[str, str]:
    """The sheet of a generated folder, as the robot file asks for it."""
    context = context_of(robot)
    return {"sheet.tex": latex(within(document(context), robot.handout.pages, context.text), context.text)}
