"""Singularities, aspects and the workspace in formulas read the same as text, LaTeX, Python and JSON."""

import json

import pytest
import sympy

from derive.handouts.notation.notation import Notation
from derive.handouts.notation.singularities import aspects_parts, aspects_text, singularities_lines, singularities_parts
from derive.handouts.notation.text import PlainPrinter, TextPrinter
from derive.handouts.notation.workspace import workspace_lines, workspace_parts
from derive.inverse.words.reach import Reach
from derive.model.model import Model
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from tests.workspace.arms import arm

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


def aspects(robot: Robot) -> list[str]:
    return aspects_text(Model(robot).aspects, TextPrinter(robot, None).doprint)


def test_each_solution_is_listed_with_its_signs() -> None:
    found = aspects(Robot.load("planar-2r-perugia"))
    assert found[0].startswith("2 aspects")
    assert found[1:5] == ["   1. s2", "its sign in each solution:", "   +  elbow down", "   -  elbow up"]
    assert found[-1].startswith("looked at with a1 = ")


def test_a_cuspidal_arm_is_called_so_with_the_path() -> None:
    robot = arm("cuspidal")
    aspects = Model(robot).aspects
    found = aspects_text(aspects, TextPrinter(robot, None).doprint)
    (first,) = [number for number, line in enumerate(found) if line.startswith("cuspidal")]
    assert [line.split()[0] for line in found[first + 2 :]] == ["q1", "q2", "q3"]
    rounded = aspects_text(aspects, TextPrinter(robot, None).doprint, 3)[first + 2 :]
    for exact, short in zip(found[first + 2 :], rounded, strict=True):
        assert [f"{float(value):.3g}" for value in exact.split()[1:]] == short.split()[1:]
    parts = json.loads(json.dumps(aspects_parts(aspects)))
    assert parts["cuspidal"] is True
    assert all(len(corner) == 3 for corner in parts["path"])


def test_an_arm_without_aspects_says_why() -> None:
    assert aspects(Robot.load("thumb")) == ["aspects cannot be computed: no single determinant decides the rank of J"]


def lines(name: str, form: str) -> list[str]:
    robot = Robot.load(name)
    return workspace_lines(Model(robot).workspace, form, Notation.of(robot))


def test_a_ring_is_written_with_its_radii() -> None:
    assert lines("planar-2r-perugia", "text") == [
        "reachable region, if no joint has limits:",
        "   abs(a1 - a2) <= sqrt(px**2 + py**2) <= a1 + a2: between two circles, q2 is real",
        "2 solutions inside",
    ]
    (_, row, _) = lines("planar-2r-perugia", "latex")
    assert row == r"  \lvert a_{1} - a_{2} \rvert \le \sqrt{p_{x}^{2} + p_{y}^{2}} \le a_{1} + a_{2} \\"


def test_python_can_run_a_workspace() -> None:
    code = "\n".join(lines("planar-3r", "python"))
    for px, wanted in ((1.05, True), (0.25, False), (1.3, False)):  # the tool points along x: the wrist is at px - 0.2
        values = {"a1": 0.5, "a2": 0.4, "a3": 0.2, "px": px, "py": 0.0, "r11": 1.0, "r21": 0.0}
        exec("from math import sqrt\n" + code, values)
        assert values["reached"] is wanted


def test_numbers_alone_are_decimals() -> None:
    (bound,) = [line for line in lines("kuka-kr5", "text") if "<=" in line]
    assert bound.strip() == ("0.0384234 <= sqrt(wz**2 + (rho - 0.075)**2) <= 0.578423: between two tori, q3 is real")


def test_json_has_every_bound() -> None:
    found: Reach = Model(Robot.load("puma560-corke")).workspace
    parts = workspace_parts(found)
    assert [bound["shape"] for bound in parts["bounds"]] == ["outside of a cylinder", "between two spheres"]
    assert (parts["whole"], parts["count"]) == (True, 8)


def test_an_arm_without_bounds_says_what_to_do() -> None:
    assert lines("thumb", "text")[-1] == "the boundary: derive plot --workspace"
    assert lines("spherical-wrist", "text")[0].startswith("no bound")
