"""A colleague who grades: one file per student, LaTeX as it was handed in, verdicts and a page to send back."""

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

RIGHT = r"""
expected:
  - quantity: p
    latex: '\begin{pmatrix} a_1 c_1 + a_2 c_{12} \\ a_1 s_1 + a_2 s_{12} \\ 0 \end{pmatrix}'
  - quantity: g
    latex: 'g(q) = \begin{bmatrix} (m_1+m_2) g a_1 \cos q_1 + m_2 g a_2 c_{12} \\ m_2 g a_2 c_{12} \end{bmatrix}'
"""

WRONG = r"""
expected:
  - quantity: p
    latex: '\begin{pmatrix} a_1 c_1 + a_2 c_{12} \\ a_1 s_1 + a_2 c_{12} \\ 0 \end{pmatrix}'
  - quantity: B
    entries: {"2,2": "m2*a2"}
"""


def test_answers_are_judged_entry_by_entry(tmp_path: Path) -> None:
    grader = Person(tmp_path)
    grader.writes("rossi.yaml", ROBOT + RIGHT)
    grader.writes("silva.yaml", ROBOT + WRONG)
    assert grader.types("derive check rossi.yaml").stdout == "rossi.yaml: 5 equal (5 in the same form), 0 wrong\n"
    told = grader.types("derive check rossi.yaml silva.yaml --report back.md", status=1).stdout
    page = (tmp_path / "back.md").read_text(encoding="utf-8")
    for change in ("s12 instead of c12 in a2*c12", "a2**2 instead of a2 in m2*a2"):
        assert change in told
        assert change in page
    marks = json.loads(grader.types("derive check rossi.yaml silva.yaml --json", status=1).stdout)
    assert [(answer["equal"], answer["wrong"]) for answer in marks] == [(5, 0), (2, 2)]
    wrong = [entry["quantity"] for entry in marks[1]["entries"] if entry["verdict"] == "wrong"]
    assert wrong == ["p[2]", "B[2,2]"]


def test_one_answer_that_cannot_be_read_is_named_with_its_place(tmp_path: Path) -> None:
    grader = Person(tmp_path)
    grader.writes("rossi.yaml", ROBOT + RIGHT.replace("a_2 s_{12}", r"a_2 \includegraphics{x}"))
    message = grader.types("derive check rossi.yaml", status=2).stderr
    assert message.startswith("derive: error: rossi.yaml:14:67: ")
    assert "includegraphics" in message
