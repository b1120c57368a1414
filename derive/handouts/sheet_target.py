"""The LaTeX target: ``sheet.tex``, the handout on paper."""

from __future__ import annotations

from derive.handouts.assemble import context_of, document
from derive.handouts.latex_writer import latex
from derive.targets.target import Source, Target


def render(source: Source) -> dict[str, str]:
    """The files of the target.

    Args:
        source: The robot and its program.

    Returns:
        Name -> text.
    """
    context = context_of(source.robot)
    return {"sheet.tex": latex(document(context), context.text)}


TARGET = Target(
    name="latex",
    summary="the equations as a sheet to print, for pdflatex",
    files=("sheet.tex",),
    render=render,
)
