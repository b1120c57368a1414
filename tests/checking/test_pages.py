"""What is said of pages that people write is true: a wrong verdict needs certainty of what a formula is about.

Of a document about several robots each formula is compared for the robot that is meant, or none is named.
"""

from pathlib import Path
from typing import Any

import pytest
import yaml

from derive.checking.documents import document_of
from derive.checking.files import document_printouts, formula_printout
from derive.checking.formulas.findings import FileReport, Outcome, judge
from derive.checking.latex.conditions import AMONG
from derive.cli.main import main
from derive.errors import CheckError
from derive.robot.robot import Robot

FOLDER = Path(__file__).parent
FILE = yaml.safe_load((FOLDER / "pages.yaml").read_text(encoding="utf-8"))
FILES = [
    yaml.safe_load(path.read_text(encoding="utf-8")) for path in sorted(FOLDER.glob("published/*.yaml"), reverse=True)
]
PUBLISHED = [(file, page) for file in FILES for page in file["pages"]]
ANT = Robot.from_text(FILE["robots"]["min-ant"])


def checked(robot: Robot, text: str, kind: str = ".md") -> FileReport:
    formula = text if kind == "latex" else document_of(text, "page", kind)
    return formula_printout(robot, "", formula, latex=True).report


def assert_true(file: dict[str, Any], page: dict[str, Any]) -> None:
    text = file["robots"].get(page["robot"])
    robot = Robot.from_text(text) if text else Robot.load(page["robot"])
    report = checked(robot, page["text"], page.get("kind", ".md"))
    assert [finding.entry for finding in report.wrong] == page["wrong"]
    assert (report.equal, len(report.unread)) == (page["equal"], page["unread"]), report.unread


@pytest.mark.parametrize("page", FILE["pages"], ids=lambda page: page["id"])
@pytest.mark.first(36)
def test_a_page_gets_the_verdicts_that_are_true(page: dict[str, Any]) -> None:
    assert_true(FILE, page)


@pytest.mark.first(8)
@pytest.mark.parametrize(("file", "page"), PUBLISHED, ids=[page["id"] for _, page in PUBLISHED])
def test_a_page_that_other_people_published_gets_them_too(file: dict[str, Any], page: dict[str, Any]) -> None:
    assert_true(file, page)


def test_a_solution_with_one_sign_is_right_for_some_branches() -> None:
    (finding,) = checked(ANT, r"$$\theta_3 = \text{atan2}(\sqrt{1 - c_3^2}, c_3)$$").findings
    assert judge(finding).outcome is Outcome.SOME
    (finding,) = checked(ANT, r"$$\theta_3 = \text{atan2}(s_3 + 1, c_3)$$").findings
    assert judge(finding).outcome is Outcome.WRONG


X = "$$x = a_1 c_1 + a_2 c_{12}$$\n"


@pytest.mark.parametrize(
    ("text", "wrong", "told"),
    [
        ("$$x = a_1 s_1 + a_2 c_{12}$$", ["p[1]"], 0),  # one change away
        ("$$x = a_1 c_1 + a_2 c_1 c_2$$", ["p[1]"], 0),  # most of it is that of ours
        ("$$x = 7 s_2 a_1^2$$", [], 1),  # nothing says that this x is ours
        (X * AMONG + "$$x = 7 s_2 a_1^2$$", ["p[1]"], 0),  # formulas of its kind are right
        (r"$$s_1 + 1 = c_2 + a_1 / a_2$$ $$c_1 + 2 = a_1 s_2$$", [], 2),
        (r"$$s_1 + 1 = c_2 + a_1 / a_2$$", [r"s_1 + 1"], 0),  # both sides of the only identity are those of the text
    ],
)
def test_what_is_far_from_ours_is_wrong_only_among_right_formulas(text: str, wrong: list[str], told: int) -> None:
    report = checked(Robot.load("planar-2r-perugia"), text)
    assert ([finding.entry for finding in report.wrong], len(report.unread)) == (wrong, told)


COLUMNS = (
    r"\begin{bmatrix} n_x & o_x & a_x & p_x \\ n_y & o_y & a_y & p_y \\ n_z & o_z & a_z & p_z \\ 0&0&0&1 \end{bmatrix}"
)


def test_names_of_columns_are_no_claim() -> None:
    assert not checked(ANT, f"$$T_3^0 = {COLUMNS}$$").findings
    with pytest.raises(CheckError, match="gives names to the entries of a pose"):
        checked(ANT, f"T_3^0 = {COLUMNS}", "latex")


END = r"0 & 0 & 0 & 1 \end{bmatrix}"
LINK = r"\begin{bmatrix} c_2 & -s_2 & 0 & a_2 c_2 \\ s_2 & c_2 & 0 & a_2 s_2 \\ 0 & 0 & 1 & 0 \\" + END
FORWARD = {
    "01": r"\begin{bmatrix} c_1 & 0 & s_1 & 0 \\ s_1 & 0 & -c_1 & 0 \\ 0 & 1 & 0 & d_1 \\" + END,
    "12": LINK,
    "23": LINK.replace("_2", "_3"),
}


@pytest.mark.parametrize("written", ["T_{%s%s}", "{}^%s_%sT", "T^%s_%s", "{}^%sT_%s", "T_{%s,%s}"])
def test_the_order_of_frames_is_settled_once_for_a_whole_document(written: str) -> None:
    def page(swapped: bool, slip: str = "") -> str:
        lefts = [written % tuple(reversed(pair) if swapped else pair) for pair in FORWARD]
        matrices = [m.replace(slip, f"-{slip}") if slip else m for m in FORWARD.values()]
        return "\n".join(f"$${left} = {matrix}$$" for left, matrix in zip(lefts, matrices, strict=True))

    report = checked(ANT, page(swapped=False))
    assert (report.equal, report.wrong, report.readings) == (48, (), ())
    (slipped,) = checked(ANT, page(swapped=False, slip="a_2 s_2")).wrong
    assert (slipped.row, slipped.column) == (2, 4)
    if written != "{}^%sT_%s":  # whose places say which frame is which
        turned = checked(ANT, page(swapped=True))
        assert (turned.equal, turned.wrong) == (48, ())
        assert "3 of 3 matrices" in turned.readings[0]


def test_one_matrix_that_is_written_the_other_way_is_a_slip_among_others() -> None:
    lefts = {"01": "T^0_1", "12": "T^1_2", "23": "T^3_2"}
    report = checked(ANT, "\n".join(f"$${lefts[pair]} = {matrix}$$" for pair, matrix in FORWARD.items()))
    (slip,) = report.wrong
    repair = judge(slip).repair
    assert report.equal == 32
    assert repair.text == "the frames exchanged: the matrix is T[2,3]"


def test_mathematics_inside_a_line_is_read_and_its_prose_passed_over() -> None:
    text = r"With $\theta_1 = 30^\circ$ and $n = 3$ it is at $p_z = d_1 - a_2 s_2 + a_3 s_{23}$, see $\foo{x}$."
    report = checked(ANT, text)
    assert ([f.entry for f in report.wrong], report.unread) == (["p[3]"], ())


TWO, THREE = Robot.load("planar-2r-perugia"), Robot.load("planar-3r")
NOTES = r"""
## Planar arm
$$x = a_1 c_1 + a_2 c_{12}$$
$$J_{22} = a_2 s_{12}$$
$$y = a_1 s_1 + a_2 s_{12}$$
## Three links
$$x = a_1 c_1 + a_2 c_{12} + a_3 c_{123}$$
$$y = a_1 s_1 + a_2 s_{12}$$
$$y = a_1 s_1 + a_2 s_{12} + a_3 s_{123}$$
$$J_{13} = a_3 s_{123}$$
"""


def told(text: str) -> list[tuple[list[str], list[str], tuple[str, ...]]]:
    reports = [printout.report for printout in document_printouts([TWO, THREE], document_of(text, "notes.md", ".md"))]
    return [([f.entry for f in r.findings], [f.entry for f in r.wrong], r.unread) for r in reports]


def test_formulas_belong_to_the_robot_of_their_section() -> None:
    two, three = told(NOTES)
    assert two == (["p[1]", "J[2,2]", "p[2]"], ["J[2,2]"], ())
    assert three[:2] == (["p[1]", "p[2]", "J[1,3]"], ["J[1,3]"])
    (reason,) = three[2]  # a third term that was forgotten is no formula of the other arm
    assert reason.startswith("notes.md:8:")
    assert "right for planar-2r-perugia and wrong for planar-3r" in reason


def test_what_is_wrong_for_all_and_stands_between_them_is_not_compared() -> None:
    slip = "$$J_{61} = -1$$\n"
    (_, wrong, unread), three = told("$$x = a_1 c_1 + a_2 c_{12}$$\n" + slip + "$$J_{13} = -a_3 s_{123}$$")
    assert not wrong
    assert "wrong for planar-2r-perugia and for planar-3r; which is meant is not certain" in unread[0]
    assert three == (["J[1,3]"], [], ())


def test_the_command_tells_and_writes_the_verdicts_for_each_robot(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    notes, page = tmp_path / "notes.md", tmp_path / "page.html"
    notes.write_text(NOTES)
    command = ["check", "planar-2r-perugia", "planar-3r", "--latex", str(notes)]
    assert main(command) == 1
    printed = capsys.readouterr().out
    assert "notes.md (planar-2r-perugia): 2 equal (2 in the same form), 1 wrong\n" in printed
    assert "notes.md (planar-3r): 2 equal (2 in the same form), 1 wrong; 1 not compared\n" in printed
    assert main([*command, "-o", str(page), "--quiet"]) == 1
    text = page.read_text(encoding="utf-8")
    assert "planar-2r-perugia: Slips" in text
    assert "planar-3r: Slips" in text


def test_a_document_about_a_longer_arm_is_refused_unless_it_is_about_several() -> None:
    text = (
        " ".join(rf"$$\theta_{k} = \theta_5 + \theta_6$$" for k in (4, 5, 6)) + r" $$p_z = d_1 + a_2 s_2 + a_3 s_{23}$$"
    )
    with pytest.raises(CheckError, match="names joint 6 in 3 formulas, for ant with 3"):
        checked(ANT, text)
    longer = Robot.load("puma560-corke")
    (short, _) = document_printouts([ANT, longer], document_of(text, "page", ".md"))
    assert [finding.entry for finding in short.report.findings] == ["p[3]"]
