"""Of a document about several robots each formula is compared for the robot that is meant, or none is named."""

from pathlib import Path

import pytest

from derive.api.check import document_printouts
from derive.checking.documents import document_of
from derive.checking.latex.several import divided
from derive.cli.main import main
from derive.errors import CheckError
from derive.robot.robot import Robot

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
    slip = "$$J_{11} = a_1 c_1$$\n"
    (_, wrong, unread), three = told("$$x = a_1 c_1 + a_2 c_{12}$$\n" + slip + "$$J_{13} = -a_3 s_{123}$$")
    assert not wrong
    assert "wrong for planar-2r-perugia and for planar-3r; which is meant is not certain" in unread[0]
    assert three == (["J[1,3]"], [], ())


def test_without_reports_nothing_is_divided() -> None:
    assert divided([], [], []) == []


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["planar-3r", "--latex", "x = a_1 c_1"], "several robots for one formula"),
        (["planar-2r-perugia", "--latex", "{notes}"], "two robots are called 'planar-2r-perugia'"),
        (["planar-3r", "--latex", "{empty}"], "no mathematics between"),
    ],
)
def test_what_cannot_be_divided_gets_one_message(
    arguments: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "notes.md").write_text(NOTES)
    (tmp_path / "empty.md").write_text("# No formula\nhere\n")
    files = {"{notes}": str(tmp_path / "notes.md"), "{empty}": str(tmp_path / "empty.md")}
    assert main(["check", "planar-2r-perugia", *(files.get(a, a) for a in arguments)]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


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
    with pytest.raises(CheckError, match="two robots"):
        document_printouts([TWO, TWO], document_of(NOTES, "notes.md", ".md"))
