"""``derive check``: what it prints and how it ends."""

import json
import sys
from pathlib import Path

import pytest

from derive.cli.main import main
from tests.checking.test_files import ARM
from tests.cli.command import derive, is_one_message, refused

RIGHT = ARM + 'expected:\n  - {quantity: p, entries: {"1": "a1*c1 + a2*c12"}}\n'
WRONG = ARM + 'expected:\n  - {quantity: p, entries: {"1": "a1*c1 + a2*c2"}}\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "right.yaml").write_text(RIGHT)
    (tmp_path / "wrong.yaml").write_text(WRONG)
    (tmp_path / "broken.yaml").write_text(WRONG.replace("c2", "(c2"))
    return tmp_path


def test_a_wrong_formula_ends_with_1_and_is_shown_with_the_right_one_and_numbers(folder: Path) -> None:
    done = derive("check", "right.yaml", "wrong.yaml", folder=folder)
    assert done.status == 1
    first, place, right, change, difference, numbers, count = done.stdout.splitlines()
    assert first == "right.yaml: 1 equal (1 in the same form), 0 wrong"
    assert place == "wrong.yaml:8:35: p[1] is wrong: a1*c1 + a2*c2"
    assert right == "  right: a1*c1 + a2*c12"
    assert change == "  change: index: c12 instead of c2 in a2*c2"
    assert difference == "  printed - right: a2*c2 - a2*c12"
    assert numbers.startswith("  at a1 = ")
    assert count == "wrong.yaml: 0 equal, 1 wrong"


def test_a_formula_that_cannot_be_read_ends_with_2_and_its_place(folder: Path) -> None:
    done = refused("check", "right.yaml", "broken.yaml", folder=folder)
    assert done.stdout == ""
    assert "broken.yaml:8:" in done.stderr


def test_the_report_as_json_and_as_a_page_for_a_colleague(folder: Path) -> None:
    done = derive("check", "wrong.yaml", "right.yaml", "--json", "--report", "errata.md", folder=folder)
    report, _ = json.loads(done.stdout)
    assert (done.status, report["equal"], report["wrong"], report["robot"]) == (1, 0, 1, "arm")
    (entry,) = report["entries"]
    assert (entry["quantity"], entry["equal"], entry["exact"], entry["line"]) == ("p[1]", False, True, 8)
    assert entry["right"] == "a1*c1 + a2*c12"
    assert entry["verdict"] == "wrong"
    assert entry["change"]["kinds"] == ["index"]
    assert entry["change"]["formula"] == "a1*c1 + a2*c12"
    assert entry["difference"] == ["a2*c2", "-a2*c12"]
    assert entry["counter_example"]["printed"] != entry["counter_example"]["right"]
    assert set(entry["counter_example"]["values"]) == {"a1", "a2", "q1", "q2"}
    page = (folder / "errata.md").read_text(encoding="utf-8")
    assert page.startswith("# Errata\n\n2 formulas compared: 1 wrong, at 1 place;")
    assert page[page.index("- printed:") :].splitlines()[:3] == [
        "- printed: `a1*c1 + a2*c2`",
        "- right: `a1*c1 + a2*c12`",
        "- change: `index: c12 instead of c2 in a2*c2`",
    ]


@pytest.mark.parametrize(
    ("formula", "status", "said"),
    [
        ("a1*c1 + a2*c12", 0, "T[1,4]: same form\n"),
        ("a1*c1 + a2*c1*c2 - a2*s1*s2", 0, "T[1,4]: equal\n  ours: a1*c1 + a2*c12\n"),
        ("a1*c1", 1, "T[1,4] is wrong: a1*c1\n"),
        ("a1*(", 2, "error: --expression:1:5: "),
        (r"a_1 c_1 + a_2 c_{12}", 0, "T[1,4]: same form\n"),
        (r"a_1 \cos\theta_1 + a_2 \cos(\theta_1 + \theta_2)", 0, "T[1,4]: same form\n"),
        (r"a_1 c_1 - a_2 c_{12}", 1, "T[1,4] is wrong: "),
        (r"a_1 c_1 + \foo", 2, "--latex:1:11: unknown macro '\\foo'"),
        (r"a_1 c_1 + b_2", 2, "--latex:1:11: unknown name 'b2'"),
    ],
)
def test_one_formula_without_a_file_as_text_or_latex(folder: Path, formula: str, status: int, said: str) -> None:
    option = "--latex" if "_" in formula else "--expression"
    done = derive("check", "scara-perugia", "--quantity", "T[1,4]", option, formula, folder=folder)
    assert (done.status, bool(done.stderr)) == (status, status == 2)
    assert said in (done.stdout + done.stderr if status else [done.stdout])


def test_an_unknown_name_is_a_verdict_for_programs(folder: Path) -> None:
    formula = ("--quantity", "T[1,4]", "--expression", "a1*c1 + a3*c12")
    done = refused("check", "scara-perugia", *formula, "--json", folder=folder)
    verdict = json.loads(done.stdout)
    assert verdict["verdict"] == "undecidable name"
    assert "did you mean" in verdict["reason"]


MIXED = ARM + ('expected:\n  - {quantity: p, entries: {"1": "a1*c1 + a2*cc", "2": "a1*s1 - a2*s12", "3": "0"}}\n')


@pytest.fixture
def mixed(folder: Path) -> Path:
    (folder / "mixed.yaml").write_text(MIXED)
    return folder


def test_an_unknown_name_in_a_file_concerns_its_entry_only(mixed: Path) -> None:
    done = derive("check", "mixed.yaml", "right.yaml", folder=mixed)
    lines = done.stdout.splitlines()
    assert (done.status, done.stderr) == (2, "")
    assert lines[0] == "mixed.yaml:8:57: p[2] is wrong: a1*s1 - a2*s12"
    assert lines[-3].startswith("mixed.yaml:8:46: p[1]: undecidable name: unknown name 'cc'; ")
    assert "did you mean c" in lines[-3]
    assert lines[-2] == "mixed.yaml: 1 equal (1 in the same form), 1 wrong, 1 undecidable"
    assert lines[-1] == "right.yaml: 1 equal (1 in the same form), 0 wrong"


def test_an_unknown_name_is_told_to_programs_and_stands_on_the_page_for_a_colleague(mixed: Path) -> None:
    done = derive("check", "mixed.yaml", "--json", "--report", "errata.md", folder=mixed)
    (report,) = json.loads(done.stdout)
    assert (done.status, report["equal"], report["wrong"], report["undecidable"]) == (2, 1, 1, 1)
    first, *others = report["entries"]
    assert [entry["verdict"] for entry in others] == ["wrong", "same form"]
    assert (first["verdict"], first["line"], first["column"], first["equal"]) == ("undecidable name", 8, 46, None)
    assert first["reason"].startswith("mixed.yaml:8:46: unknown name 'cc'; ")
    page = (mixed / "errata.md").read_text(encoding="utf-8")
    assert page.startswith("# Errata\n\n2 formulas compared: 1 wrong, at 1 place;")
    heading, line = page.split("## ")[-1].strip().split("\n\n")
    assert heading == "Undecidable: unknown names"
    assert line.startswith("- `mixed.yaml:8:46`: p\\[1\\], printed `a1*c1 + a2*cc`: unknown name 'cc'; ")


def test_a_terminal_shows_a_table_with_changes_and_unknown_names(
    mixed: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "300")
    assert main(["check", str(mixed / "mixed.yaml")]) == 2
    shown = capsys.readouterr().out
    assert "change" in shown
    assert "s12" in shown
    assert "undecidable name" in shown
    assert "unknown name 'cc'" in shown
    assert shown.rstrip().endswith("1 wrong, 1 undecidable")


MATRIX = r"J = \begin{bmatrix} -a_1 s_1 - a_2 s_{12} & a_2 s_{12} \\ a_1 c_1 + a_2 c_{12} & a_2 c_{12} \end{bmatrix}"


def test_a_matrix_in_latex_has_a_verdict_for_each_entry_and_is_no_other_quantity(folder: Path) -> None:
    done = derive("check", "planar-2r-perugia", "--latex", MATRIX, folder=folder)
    lines = done.stdout.splitlines()
    assert (done.status, done.stderr) == (1, "")
    assert lines[0] == "J[1,1]: same form"
    assert lines[1] == "--latex:1:45: J[1,2] is wrong: a_2 s_{12}"
    assert lines[3] == "  change: sign: -a2*s12 instead of a2*s12"
    assert lines[-1] == "--latex: 3 equal (3 in the same form), 1 wrong"
    done = refused("check", "planar-2r-perugia", "--quantity", "B", "--latex", MATRIX, folder=folder)
    assert "left side 'J' means J, but the quantity asked about is B" in done.stderr


def test_of_a_latex_file_the_displays_are_compared_and_the_rest_is_listed(folder: Path) -> None:
    text = "The tool is at\n\\[ x = a_1 c_1 + a_2 c_{12} \\]\nwith\n\\[ K_i = \\sum_j k_j \\]\n"
    (folder / "homework.tex").write_text(text)
    done = derive("check", "planar-2r-perugia", "--latex", "homework.tex", folder=folder)
    assert (done.status, done.stderr) == (3, "")
    assert derive("check", "planar-2r-perugia", "--latex", "homework.tex", "--allow-unread", folder=folder).status == 0
    assert derive("check", "planar-2r-perugia", "--latex", "homework.tex", "--lines", "1-2", folder=folder).status == 0
    first, skipped, count = done.stdout.splitlines()
    assert first == "p[1]: same form"
    assert skipped.startswith("homework.tex:4:")
    assert "not compared" in skipped
    assert count == "homework.tex: 1 equal (1 in the same form), 0 wrong; 1 not compared"


LATEX = (
    ARM
    + r"""expected:
  - quantity: p
    status: erratum
    latex: |
      \begin{bmatrix} a_1 c_1 + a_2 c_{12} \\
        a_1 s_1 - a_2 s_{12} \\ 0
      \end{bmatrix}
    correct: {"2": "a1*s1 + a2*s12"}
  - latex: 'x = a_1 c_1 + a_9'
  - {latex: "y = \\sin q_1 a_1 + a_2 s_{12}"}
"""
)


def test_latex_in_a_file_is_checked_like_the_rest(folder: Path) -> None:
    (folder / "latex.yaml").write_text(LATEX)
    done = derive("check", "latex.yaml", folder=folder)
    lines = done.stdout.splitlines()
    assert done.status == 2
    assert lines[0].startswith("latex.yaml:12:9: p[2] (marked as an erratum) is wrong: a_1 s_1 - a_2 s_{12}")
    assert "  its correction is right: a1*s1 + a2*s12" in lines
    assert lines[-2].startswith("latex.yaml:15:27: ")
    assert "unknown name 'a9'" in lines[-2]
    assert lines[-1] == "latex.yaml: 4 equal (4 in the same form), 1 wrong (1 marked as errata), 1 undecidable"


PLANAR = "D = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2); theta2 = atan2({}sqrt(1 - D**2), D)"


def test_an_inverse_solution_is_checked_as_a_whole(folder: Path) -> None:
    asked = ("check", "planar-2r-perugia", "--quantity", "inverse", "--expression")
    done = derive(*asked, PLANAR.format("+-"), folder=folder)
    first, branches, _ = done.stdout.splitlines()
    assert (done.status, first, branches) == (0, "q2: same form", "inverse: all 2 solutions of q2; no formula for q1")
    done = derive(*asked, PLANAR.format(""), "--report", "report.md", folder=folder)
    assert done.status == 1
    assert "  missing: elbow up" in done.stdout.splitlines()
    assert "- missing: elbow up" in (folder / "report.md").read_text()
    done = derive(*asked, "theta2 = atan2(", folder=folder)
    assert done.status == 2
    assert is_one_message(done.stderr)


def test_the_task_of_an_inverse_solution_may_be_given(folder: Path) -> None:
    asked = ("check", "planar-2r-perugia", "--quantity", "inverse", "--expression", PLANAR.format("+-"), "--task")
    assert "the one solution of q2" in derive(*asked, "pose", folder=folder).stdout
    refused(*asked, "x,w", folder=folder)


def test_a_solution_in_latex_needs_no_quantity(folder: Path) -> None:
    latex = r"\theta_1 = \arctan\frac{y - a_2 s_{12}}{x - a_2 c_{12}}"
    done = derive("check", "planar-2r-perugia", "--latex", latex, "--json", folder=folder)
    (found,) = json.loads(done.stdout)["entries"] if done.stdout.startswith("[") else [json.loads(done.stdout)]
    assert (done.status, found["verdict"]) == (1, "wrong")
    assert found["change"]["formula"] == "atan2(y - a2*s12, x - a2*c12)"
