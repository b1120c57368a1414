"""Formulas of textbooks: every macro of the template gives lines of balanced LaTeX."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from jinja2 import nodes

from derive.handouts.formula import textbook
from derive.handouts.latex_writer import latex_template, macros
from derive.targets.templating import template_folder

FOLDER = Path(str(template_folder())) / "handout"
TEMPLATE = "textbook.tex.jinja"
NAMES = [name for name in dir(macros(TEMPLATE)) if not name.startswith("_")]
FLAGS = ("rotors", "armatures", "friction", "revolute", "prismatic")


def arguments(name: str, flag: bool) -> dict[str, object]:
    names = getattr(macros(TEMPLATE), name).arguments
    return {argument: ("word" if flag else "") if argument in FLAGS else "X" for argument in names}


@pytest.mark.parametrize("flag", [True, False])
@pytest.mark.parametrize("name", NAMES)
def test_every_formula_is_balanced(name: str, flag: bool) -> None:
    lines = textbook(name, **arguments(name, flag)).lines
    assert lines or (name == "link_jacobians" and not flag)
    for line in lines:
        plain = re.sub(r"\\[{}]", "", line)
        assert plain.count("{") == plain.count("}")
        assert line.count("\\left") == line.count("\\right")
        assert line == line.strip()
        assert not re.search(r"<<|>>|<%|%>|<#|#>|\n", line)


@pytest.mark.parametrize("name", sorted(path.name for path in FOLDER.iterdir()))
def test_templates_compute_nothing(name: str) -> None:
    """No arithmetic, comparison, filter, test or assignment: values come finished."""
    tree = latex_template(name).environment.parse((FOLDER / name).read_text(encoding="utf-8"))
    assert list(tree.find_all(nodes.Output))
    for kind in (nodes.BinExpr, nodes.UnaryExpr, nodes.Filter, nodes.Test, nodes.Compare, nodes.Assign):
        assert not [node for node in tree.find_all(kind) if not isinstance(node, nodes.And | nodes.Or | nodes.Not)]


def test_an_indented_line_continues_the_one_before() -> None:
    assert textbook("rotor_jacobians").lines == (
        "\\mathbf{J}_{v,i}^{m_i} = \\mathbf{0}, \\qquad \\mathbf{J}_{\\omega,i}^{m_i} = k_{r_i}\\,\\mathbf{z}_{m_i}",
    )
