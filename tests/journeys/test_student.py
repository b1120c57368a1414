"""A student with a homework: the table of a slide, an answer to check, and a slip or two on the way."""

from pathlib import Path

from tests.journeys.person import Person

TABLE = """\
name: homework-3
convention: standard
joints:
  - {type: revolute, alpha: 90}
  - {type: prismatic}
"""

LINKS = """\
gravity: [0, -g, 0]
links:
  - {mass: m1, inertia: {yy: I1}}
  - {mass: m2, inertia: {xx: I2, yy: I2}}
"""


def test_from_the_table_of_a_slide_to_a_checked_answer(tmp_path: Path) -> None:
    student = Person(tmp_path)
    student.writes("homework.yaml", TABLE)
    assert (
        "90 rad is more than a turn; if degrees are meant write pi/2"
        in student.types("derive show homework.yaml T").stderr
    )
    student.writes("homework.yaml", TABLE.replace("90", "pi/2") + LINKS)
    shown = student.types("derive show homework.yaml")
    assert shown.stderr == ""
    assert all(name in shown.stdout for name in ("inertia matrix", "christoffel", "gravity", "singularities"))

    assert student.types("derive show homework.yaml p").stdout == "p =\n   q2*s1\n  -q2*c1\n       0\n"
    assert student.types("derive show homework.yaml p --at 'pi/2, 0.2'").stdout.splitlines()[-3:] == [
        "  0.2",
        "    0",
        "    0",
    ]
    assert "J or" in student.types("derive show homework.yaml jacobain", status=2).stderr

    right = student.types("derive check homework.yaml --quantity 'B[1,1]' --expression 'I1 + I2 + m2*q2**2'")
    assert right.stdout == "B[1,1]: same form\n"
    wrong = student.types(r"derive check homework.yaml --quantity 'g[1]' --latex '-m_2 g q_2 \sin(q_1)'", status=1)
    assert "change: sign: m2*g*q2*s1 instead of -m2*g*q2*s1" in wrong.stdout

    student.types("derive handout homework.yaml --tex --html --lang it")
    assert {path.name for path in tmp_path.iterdir()} == {"homework.yaml", "homework-3.tex", "homework-3.html"}


SLIPS = [
    ("convention: DH", "convention: standard", "write convention: standard"),
    ("type: rot,", "type: revolute,", "write type: revolute"),
    ("alpha: 90°", "alpha: 90", "write 90 and units: {angle: deg}"),
    ('a: "0,4"', "a: 0.4", "write 0.4, with a decimal point"),
    ("limits: 170", "limits: [-170, 170]", "write limits: [-170, 170]"),
    ("com: {x: -0.2}", "com: [-0.2, 0, 0]", "write com: [-0.2, 0, 0]"),
    (
        "inertia: [[1, 0, 0], [0, 2, 0], [0, 0, 3]]",
        "inertia: {xx: 1, yy: 2, zz: 3}",
        "write inertia: {xx: 1, yy: 2, zz: 3}",
    ),
    ("theta: 1.5708 + q2", "theta: 90 + q2", "if radians are meant write 90"),
]
"""What a beginner writes, what it should be, and what the message says."""


def test_a_file_with_one_slip_after_another_is_mended_by_its_messages_alone(tmp_path: Path) -> None:
    student = Person(tmp_path)
    text = """\
name: slips
convention: DH
units: {angle: deg}
joints:
  - {type: rot, d: 0.3, alpha: 90°}
  - {type: revolute, theta: 1.5708 + q2, a: "0,4", limits: 170}
links:
  - {mass: 2}
  - {mass: 3, com: {x: -0.2}, inertia: [[1, 0, 0], [0, 2, 0], [0, 0, 3]]}
"""
    for _ in SLIPS:
        student.writes("slips.yaml", text)
        message = student.types("derive show slips.yaml B --strict", status=2).stderr
        found = [(wrong, right) for wrong, right, words in SLIPS if wrong in text and words in message]
        assert len(found) == 1, message
        text = text.replace(*found[0])
    student.writes("slips.yaml", text)
    assert student.types("derive show slips.yaml B --strict").stderr == ""
