"""LaTeX from templates, and from one of them the formulas that hold for every robot."""

from __future__ import annotations

from functools import cache

from jinja2.environment import Template, TemplateModule

from derive.handouts.document import Rows
from derive.targets.templating import environment


@cache
def latex_template(name: str) -> Template:
    """A template of LaTeX, which is full of braces, so that its marks are ``<< >>`` and ``<% %>``.

    Args:
        name: Path below ``templates/handout``.

    Returns:
        The template.
    """
    marks = environment().overlay(
        block_start_string="<%",
        block_end_string="%>",
        variable_start_string="<<",
        variable_end_string=">>",
        comment_start_string="<#",
        comment_end_string="#>",
    )
    return marks.get_template(f"handout/{name}")


@cache
def macros(name: str) -> TemplateModule:
    """The macros of a template of LaTeX.

    Args:
        name: Path below ``templates/handout``.

    Returns:
        A module with a function for each macro.
    """
    return latex_template(name).module


def textbook(name: str, **values: object) -> Rows:
    """A formula as textbooks print it, such as c_ijk by the derivatives of B.

    Args:
        name: Its macro in ``templates/handout/textbook.tex.jinja``.
        values: What the macro asks for: letters as LaTeX, and what the robot has.

    Returns:
        Its lines; an indented line of the template continues the one before.
    """
    lines: list[str] = []
    for line in getattr(macros("textbook.tex.jinja"), name)(**values).splitlines():
        if line.startswith(" "):
            lines[-1] += f" {line.strip()}"
        elif line:
            lines.append(line)
    return Rows(tuple(lines))
