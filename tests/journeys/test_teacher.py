"""A teacher with a Franka Panda: the maker's table, a sheet, an exercise, formulas in notes of one's own."""

import re
from pathlib import Path

import pytest

from tests.handouts.latex_runner import require_latex, run_latex
from tests.journeys.person import Person

PANDA = """\
name: panda
title: "Franka Emika Panda"
convention: modified
joints:
  - {type: revolute, d: 0.333, limits: [-2.8973, 2.8973]}
  - {type: revolute, alpha: -pi/2, limits: [-1.7628, 1.7628]}
  - {type: revolute, alpha: pi/2, d: 0.316, limits: [-2.8973, 2.8973]}
  - {type: revolute, alpha: pi/2, a: 0.0825, limits: [-3.0718, -0.0698]}
  - {type: revolute, alpha: -pi/2, a: -0.0825, d: 0.384, limits: [-2.8973, 2.8973]}
  - {type: revolute, alpha: pi/2, limits: [-0.0175, 3.7525]}
  - {type: revolute, alpha: pi/2, a: 0.088, limits: [-2.8973, 2.8973]}
tool: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.107], [0, 0, 0, 1]]
"""

NOTES = r"""
\documentclass[11pt]{article}
%s
\begin{document}
The position of the flange:
\input{position}
\end{document}
"""


def test_the_table_of_a_maker_is_read_without_a_remark(tmp_path: Path) -> None:
    teacher = Person(tmp_path)
    teacher.writes("panda.yaml", PANDA)
    shown = teacher.types("derive show panda.yaml p --at '0, 0, 0, -pi/2, 0, pi/2, 0'")
    assert shown.stderr == ""
    x, y, z = (float(line) for line in shown.stdout.splitlines()[-3:])
    assert (x, y, z) == pytest.approx((0.0825 + 0.384 + 0.088, 0, 0.333 + 0.316 + 0.0825 - 0.107), abs=1e-5)


def test_a_formula_goes_into_notes_of_ones_own(tmp_path: Path) -> None:
    teacher = Person(tmp_path)
    teacher.writes("panda.yaml", PANDA)
    teacher.types("derive handout panda.yaml --fragment p -o position.tex")
    packages = re.findall(
        r"\\usepackage(?:\[[^]]*\])?\{[^}]*\}", (tmp_path / "position.tex").read_text().splitlines()[0]
    )
    log = run_latex(NOTES % "\n".join(packages), tmp_path)
    assert log.pages
    assert "Overfull" not in log.text


@pytest.mark.sweep
def test_a_sheet_keeps_to_its_pages_and_the_exercise_to_the_sheet(tmp_path: Path) -> None:
    require_latex()
    teacher = Person(tmp_path)
    teacher.writes("panda.yaml", PANDA)
    report = teacher.types("derive handout panda.yaml --pdf --lang it --derivation steps --pages 12").stdout
    (pages,) = (int(count) for count in re.findall(r"panda\.pdf: (\d+) pages", report))
    assert pages <= 12
    exercise = teacher.types(
        "derive handout panda.yaml --pdf --exercise --parts table,transforms,kinematics --out sheets"
    ).stdout
    counts = dict(re.findall(r"(\S+)\.pdf: (\d+) page", exercise))
    assert len(counts) == 2
    sheet = teacher.types("derive handout panda.yaml --pdf --parts table,transforms,kinematics --out sheet").stdout
    (whole,) = re.findall(r"panda\.pdf: (\d+) page", sheet)
    assert max(map(int, counts.values())) <= 2 * int(whole)
