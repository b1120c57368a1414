"""``derive style``: what it prints and how it ends."""

import json
import shlex
from pathlib import Path

import pytest
import yaml

from derive.cli import style
from derive.robot.options.style import Style
from derive.robot.robot import Robot
from tests.cli.command import accepted, derive

GRAVITY = "g[1] = ml1*g*l1*c1 + mm2*g*a1*c1 + ml2*g*(a1*c1 + l2*c12)"
ARM = """\
robot:
  name: arm
  convention: standard
  joints: [{type: revolute, a: a1}, {type: revolute, a: a2}]
  gravity: [0, -g, 0]
  links: [{mass: m1, com: [l1 - a1, 0, 0], inertia: {zz: I1}}, {mass: m2, com: [l2 - a2, 0, 0], inertia: {zz: I2}}]
expected:
"""
NOTES = ARM + '  - {quantity: g, entries: {"1": "m1*g*l1*c1 + m2*g*(a1*c1 + l2*c12)", "2": "m2*g*l2*c12"}}\n'
MIXED = NOTES + '  - {quantity: potential, matrix: [["g*(m1*l1*s1 + m2*(a1*s1 + l2*s12))"]]}\n'
OTHER = NOTES + '  - {quantity: g, entries: {"1": "(m1*l1 + m2*a1)*g*c1 + m2*g*l2*c12"}}\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in {"notes": NOTES, "mixed": MIXED, "other": OTHER}.items():
        (tmp_path / f"{name}.yaml").write_text(text)
    return tmp_path


def test_the_block_can_be_pasted_into_a_robot_file_and_examples_are_text_or_latex(folder: Path) -> None:
    done = derive("style", "notes.yaml", folder=folder)
    assert (done.status, done.stderr) == (0, "")
    assert yaml.safe_load(done.stdout) == {"style": {"gravity": "body"}}
    robot = yaml.safe_load(NOTES)["robot"]
    assert Robot.from_text(done.stdout + yaml.safe_dump(robot)).style == Style.of("gravity: body")
    latex = r"g_1 = m_{l1} g l_1 c_1 + m_{m2} g a_1 c_1 + m_{l2} g \left(a_1 c_1 + l_2 c_{12}\right)"
    expected = derive("style", "planar-2r-perugia", "--example", GRAVITY, folder=folder)
    assert expected.stdout.startswith("style:\n  gravity: body\n")
    assert derive("style", "planar-2r-perugia", "--example", latex, folder=folder) == expected


def test_the_equations_of_a_latex_document_are_examples(folder: Path) -> None:
    equations = r"""The torques of gravity are
\begin{align}
g_1 &= m_{l1} g l_1 c_1 + m_{m2} g a_1 c_1 + m_{l2} g \left(a_1 c_1 + l_2 c_{12}\right) \\
g_2 &= m_{l2} g l_2 c_{12}
\end{align}
and \[ b_{12} = I_{l2} + m_{l2} l_2^2 + m_{l2} a_1 l_2 c_2 + k_{r2} I_{m2}. \]
"""
    (folder / "notes.tex").write_text(equations)
    done = derive("style", "planar-2r-perugia", "--example", "notes.tex", folder=folder)
    assert yaml.safe_load(done.stdout) == {"style": {"inertia": "geometry", "gravity": "body"}}
    assert "# as printed: 2 of 2 formulas" in done.stdout
    chosen = ["--style-from", "notes.tex", "--fragment", "g"]
    assert "g(a_{1}c_{1} " in derive("handout", "planar-2r-perugia", *chosen, folder=folder).stdout


def test_another_style_is_named_with_the_reason_and_a_wrong_formula_ends_with_1(folder: Path) -> None:
    done = accepted("style", "other.yaml", folder=folder)
    lines = done.stdout.splitlines()
    (place,) = [line for line in lines if "other.yaml" in line]
    assert "g[1]: as printed with gravity:" in place
    assert lines[lines.index(place) + 1].startswith("#   printed: ")
    assert lines[lines.index(place) + 2].startswith("#   written: ")
    wrong = GRAVITY.replace("g[1]", "g[2]")
    done = derive("style", "planar-2r-perugia", "--example", wrong, folder=folder)
    assert done.status == 1
    assert "style: compact\n# as printed: 0 of 1" in done.stdout
    assert "it is not equal to the derived formula" in done.stdout


def test_the_examples_of_the_help_are_right_and_the_report_may_be_json(folder: Path) -> None:
    typed = [shlex.split(line) for line in style.DESCRIPTION.splitlines() if "--example" in line]
    assert len(typed) == 2
    for _, *arguments in typed:
        assert derive(*arguments, folder=folder).stdout.startswith("style:\n  inertia: geometry\n# as printed: 1 of 1")
    done = derive("style", "notes.yaml", "--json", folder=folder)
    report = json.loads(done.stdout)
    assert (report["style"], report["reproduced"]) == ({"gravity": "body"}, 1)
    assert [(e["quantity"], e["outcome"]) for e in report["examples"]] == [("g[1]", "same form")]


def test_a_handout_is_set_as_the_notes_are(folder: Path) -> None:
    printed = [
        derive("handout", "planar-2r-perugia", "--fragment", "g", *chosen, folder=folder).stdout
        for chosen in ([], ["--style-from", "notes.yaml"], ["--style", "gravity: body"])
    ]
    assert printed[0] != printed[1] == printed[2]
    done = derive("handout", "planar-2r-perugia", "--parts", "gravity", "--style-from", "notes.yaml", folder=folder)
    assert "style of notes.yaml: gravity: body; as printed: 1 of 1 formula, " in done.stdout
