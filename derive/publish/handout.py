"""Assembles the handout of a robot: LaTeX, PDF and web page from one document."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from enum import StrEnum

from derive.handout.assemble import context_of, document, exercise, solutions
from derive.handout.context import Context
from derive.handout.document import Document
from derive.handout.latex_writer import latex
from derive.programs.effort import Effort
from derive.programs.functions.functions import build_program
from derive.publish.pdf import compile_latex
from derive.robot.handout import HandoutOptions
from derive.robot.robot import Robot


class Format(StrEnum):
    """A form of the handout; the value is the ending of its file."""

    TEX = "tex"
    PDF = "pdf"
    HTML = "html"


@dataclass(frozen=True, slots=True)
class Handout:
    """A finished handout.

    Attributes:
        files: Contents by file name.
        pages: Pages of each PDF by file name.
        parts: The parts that it has.
    """

    files: dict[str, bytes] = field(default_factory=dict)
    pages: dict[str, int] = field(default_factory=dict)
    parts: tuple[str, ...] = ()


def handout_files(
    robot: Robot, options: HandoutOptions, formats: Collection[Format], *, exercise_sheets: bool = False
) -> Handout:
    """Makes the files of a handout, in memory.

    Args:
        robot: The robot.
        options: What the handout shows.
        formats: Which forms.
        exercise_sheets: Whether an exercise and its solutions are made instead of one sheet.

    Raises:
        TargetError: There is no such language, or a package for the web page is missing.
        LatexError: LaTeX is missing or refused the document.
    """
    context = context_of(robot, options)
    whole = document(context)
    handout = Handout(parts=tuple(section.part for section in whole.sections))
    for name, sheet in _sheets(whole, context, exercise_sheets):
        for form in (form for form in Format if form in formats):
            _add(handout, f"{name}.{form.value}", form, sheet, context)
    return handout


def _sheets(whole: Document, context: Context, exercise_sheets: bool) -> Iterator[tuple[str, Document]]:
    """File names without their endings, and what stands on each sheet."""
    name = context.robot.name
    if not exercise_sheets:
        yield name, whole
        return
    yield f"{name}-exercise", exercise(whole, context.text)
    yield f"{name}-solutions", solutions(whole, context.text)


def _add(handout: Handout, name: str, form: Format, sheet: Document, context: Context) -> None:
    match form:
        case Format.TEX:
            handout.files[name] = latex(sheet, context.text).encode()
        case Format.PDF:
            compiled = compile_latex(latex(sheet, context.text), name.removesuffix(".pdf"))
            handout.files[name], handout.pages[name] = compiled.pdf, compiled.log.pages
        case Format.HTML:
            handout.files[name] = _page(sheet, context).encode()


def _page(sheet: Document, context: Context) -> str:
    from derive.handout.page.viewer import viewer
    from derive.handout.page.writer import page

    figure = None
    if context.poses is not None:
        assumed = {name: value for name, value, _ in context.poses.assumed}
        figure = viewer(
            context.robot, build_program(context.robot, Effort.QUICK), assumed, context.text, notation=context.notation
        )
    mark = f"<!DOCTYPE html>\n<!-- written by derive {context.version} -->"
    return page(sheet, context.text, figure).replace("<!DOCTYPE html>", mark, 1)
