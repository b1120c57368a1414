"""``derive show``: numbers in few digits, and it says so; exactly where that is asked for."""

import json
import shlex
from pathlib import Path

import pytest

from derive.cli.main import main
from tests.cli.command import accepted, derive

NOTE = "numbers are rounded to {} significant digits; --exact prints all of them"
ROD = """\
name: rod
convention: standard
joints: [{type: revolute, a: 0.4318}]
links: [{mass: 1.2345, com: [-0.2159, 0, 0], inertia: {zz: 0.019}}]
gravity: [0, -9.81, 0]
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rod.yaml").write_text(ROD)
    return tmp_path


def printed(folder: Path, *arguments: str) -> list[str]:
    outcome = accepted("show", "rod.yaml", *arguments, folder=folder)
    return outcome.stdout.splitlines()


EXACT = "15308702789/200000000000"
PRINTED = {
    "B[1,1] p[1]": [f"# {NOTE.format(6)}", "B[1,1] = 0.0765435", "", "p[1] = 0.4318*c1"],
    "p[1]": ["p[1] = 0.4318*c1"],
    "B[1,1] --format latex": [f"% {NOTE.format(6)}", "0.0765435"],
    "B[1,1] --digits 2": [f"# {NOTE.format(2)}", "B[1,1] = 0.077"],
    "B[1,1] --exact": [f"B[1,1] = {EXACT}"],
    "B[1,1] --exact --format latex": ["0.076543513945"],
    "B[1,1] --format python": [f"B_1_1 = {EXACT}"],
    "M_11 --exact": [f"M_11 = {EXACT}"],
    "'mass matrix' --digits 3": [f"# {NOTE.format(3)}", "mass matrix =", "  0.0765"],
}


@pytest.mark.parametrize(("typed", "lines"), PRINTED.items())
def test_numbers_have_the_digits_asked_for_and_a_line_says_so(typed: str, lines: list[str], folder: Path) -> None:
    assert printed(folder, *shlex.split(typed)) == lines
    assert EXACT in "".join(printed(folder, "B[1,1]", "--format", "json"))


DEGREES = """\
name: two
convention: standard
units: {angle: deg, length: mm}
joints: [{type: revolute, a: a1}, {type: prismatic, alpha: 90}]
"""


def test_a_point_is_given_in_the_units_of_the_file_and_numbers_are_printed(folder: Path) -> None:
    (folder / "two.yaml").write_text(DEGREES)
    outcome = derive("show", "two.yaml", "p[2]", "T[][1,1]", "--at", "-30, 260", "--at", "a1=0.6", folder=folder)
    assert outcome.stdout.splitlines() == [
        "# at q1 = -pi/6, q2 = 0.26, a1 = 0.6 (SI units, rad)",
        "# numbers are rounded to 6 significant digits; --exact prints all of them",
        "p[2] = -0.3",
        "",
        "T[][1,1] = 0.866025",
    ]


def test_a_symbol_without_a_number_stays(folder: Path) -> None:
    (folder / "two.yaml").write_text(DEGREES)
    exact = derive("show", "two.yaml", "p[1]", "--at", "q1=30", "--exact", folder=folder)
    assert exact.stdout.splitlines()[-1] == "p[1] = sqrt(3)*a1/2"
    rounded = derive("show", "two.yaml", "p[1]", "--at", "q1=30", folder=folder)
    assert rounded.stdout.splitlines()[-1] == "p[1] = 0.866025*a1"
    written = derive("show", "two.yaml", "T[1]", "--at", "q1=30", "--format", "json", folder=folder).stdout
    (first, *_, last), *_ = json.loads(written)["quantities"]["T[1]"]
    assert first == pytest.approx(3**0.5 / 2, rel=1e-15)
    assert last == "0.86602540378443865*a1"


def test_rates_go_by_order_or_by_name_and_without_a_quantity_a_point_shows_the_usual_ones(folder: Path) -> None:
    by_order = printed(folder, "tau", "--at", "pi/3", "--rates", "-2", "--accelerations", "3", "--format", "json")
    by_name = printed(folder, "tau", "--at", "q1=pi/3, qd1=-2, qdd1=3", "--format", "json")
    assert by_order == by_name
    ((torque,),) = json.loads("".join(by_order))["quantities"]["tau"]
    assert torque == pytest.approx(0.076543513945 * 3 + 1.2345 * 9.81 * 0.2159 / 2, rel=1e-14)
    found = [line for line in printed(folder, "--at", "0", "--rates", "1", "--format", "python") if " = [" in line]
    assert [line.partition(" ")[0] for line in found] == ["T", "J", "B", "g", "Cqd"]


def test_the_list_says_shape_and_unit_and_singularities_where_they_are(folder: Path, tmp_path: Path) -> None:
    lines = printed(folder)
    assert lines[0].split() == ["quantity", "shape", "unit", "what", "it", "is"]
    assert next(line for line in lines if line.startswith("g ")).split()[1:5] == ["1x1", "N", "m", "or"]
    assert not [line for line in lines if line.startswith("J_12")]
    outcome = derive("show", "planar-2r-perugia", "singularities", folder=tmp_path)
    task = "  the determinant of J for the task x, y (rows 1, 2)"
    assert outcome.stdout.splitlines() == ["singularities = a1*a2*s2", task, "  s2 = 0: q2 = 0 or pi"]


@pytest.mark.parametrize(
    ("alpha", "determinant", "words"),
    [
        ("pi/2", "-1", "no singularity: it is the same in every configuration"),
        ("x", "-sin(x)", "no singularity unless this is 0: it is the same in every configuration"),
    ],
)
def test_a_constant_determinant_says_what_it_means(tmp_path: Path, alpha: str, determinant: str, words: str) -> None:
    cells = (f"q1, alpha: {alpha}, theta: pi/2", "q2")
    rows = "".join(f"  - {{type: prismatic, d: {cell}}}\n" for cell in cells)
    (tmp_path / "slides.yaml").write_text(f"name: slides\nconvention: standard\njoints:\n{rows}")
    outcome = derive("show", "slides.yaml", "singularities", folder=tmp_path)
    first, task, last = outcome.stdout.splitlines()
    assert (first, last) == (f"singularities = {determinant}", f"  {words}")
    assert task.startswith("  the determinant of J for the task x, ")


def test_options_stand_anywhere(folder: Path) -> None:
    expected = printed(folder, "B", "p", "--at", "-1", "--digits", "3")
    assert printed(folder, "--at", "-1", "B", "--digits=3", "p") == expected
    assert printed(folder, "B", "--at=-1", "--digits", "3", "p") == expected
    outcome = derive("show", "--at", "-1", "--digits", "3", "rod.yaml", "B", "p", folder=folder)
    assert outcome.stdout.splitlines() == expected


ARM = "planar-2r-perugia"


def shown(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["show", ARM, "inverse", *arguments]) == 0
    return capsys.readouterr().out


def test_the_task_is_solved_as_text_as_json_and_at_a_configuration(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert shown(capsys).startswith("1 solution (complete)\n")
    text = shown(capsys, "--task", "x,y")
    assert text.startswith("2 solutions (complete)\n")
    assert "q1 = atan2(py, px) - atan2(a2*s2, a1 + a2*c2)" in text
    found = json.loads(shown(capsys, "--task", "x,y", "--format", "json"))["quantities"]["inverse"]
    assert found["count"] == 2
    assert found["complete"] is True
    assert [step["unknown"] for step in found["steps"]] == ["q2", "q1"]
    assert [branch["name"] for branch in found["solutions"]] == ["elbow down", "elbow up"]
    assert found["steps"][1]["free_where_zero"] == ["px", "py"]
    text = shown(capsys, "--task", "x,y", "--at", "0.5, 1, a1=1, a2=1", "--format", "json")
    rows = json.loads(text)["quantities"]["inverse"]
    columns = sorted(zip(*([float(x) for x in row] for row in rows), strict=True))
    assert columns == [pytest.approx((0.5, 1.0)), pytest.approx((1.5, -1.0))]


def test_descriptions_stand_beside_quantities(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", ARM, "workspace", "p", "--format", "json"]) == 0
    found = json.loads(capsys.readouterr().out)["quantities"]
    assert found["workspace"]["bounds"][0]["shape"] == "between two circles"
    assert len(found["p"]) == 3
    assert main(["show", ARM]) == 0
    assert "aspects " in capsys.readouterr().out
