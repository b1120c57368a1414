"""Singularities read the same as text, LaTeX, Python and JSON."""

import json

import pytest
import sympy

from derive.handouts.notation.singularities import singularities_lines, singularities_parts
from derive.handouts.notation.text import PlainPrinter
from derive.model.model import Model
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot

WRITE = PlainPrinter().doprint


@pytest.mark.parametrize("name", [name for name in catalogue_names() if Robot.load(name).n > 1])
def test_every_form_has_the_task_all_families_and_whether_they_are_all(name: str) -> None:
    found = Model(Robot.load(name)).singularities
    parts = json.loads(json.dumps(singularities_parts(found, WRITE)))
    assert parts["task"] == list(found.task)
    assert parts["complete"] is found.complete
    assert [[c["zero"] for c in family] for family in parts["families"]] == [
        [WRITE(c.expression) for c in family] for family in found.families
    ]
    for form in ("text", "latex", "python"):
        printed = "\n".join(singularities_lines(found, "singularities", form, WRITE))
        assert all(WRITE(c.expression) in printed or c.is_solution for family in found.families for c in family)
        assert f"for the task {', '.join(found.task)}" in printed or not found.task
        assert ("others may exist" in printed or "no closed form" in printed) is not found.complete


def test_python_can_run_what_is_written_for_it() -> None:
    code = singularities_lines(Model(Robot.load("kuka-lwr4")).singularities, "singularities", "python", WRITE)
    names = {f"q{k}": sympy.Symbol(f"q{k}") for k in range(1, 8)} | {"sin": sympy.sin, "cos": sympy.cos}
    exec("\n".join(code), names)
    assert [sympy.sin(sympy.Symbol("q4"))] in names["singularities"]
