"""``derive handout`` as teachers use it: files, exercises, fragments, options over the file, and what it refuses."""

import json
import re
from pathlib import Path

import pytest

from tests.cli.command import PENDULUM, Outcome, accepted, refused
from tests.handouts.latex_runner import require_latex, run_clean


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.yaml").write_text(PENDULUM)
    return tmp_path


def handout(folder: Path, *arguments: str) -> Outcome:
    return accepted("handout", "arm.yaml", *arguments, folder=folder)


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()} - {"arm.yaml"}


def test_the_latex_file_is_written_by_default(folder: Path) -> None:
    outcome = handout(folder)
    assert names(folder) == {"pendulum.tex"}
    assert outcome.stdout.startswith("pendulum.tex\n")
    run_clean((folder / "pendulum.tex").read_text(), folder)


def test_a_pdf_comes_with_its_source_and_the_number_of_pages(folder: Path) -> None:
    require_latex()
    outcome = handout(folder, "--pdf", "--out", "sheets/new", "--json")
    assert names(folder / "sheets" / "new") == {"pendulum.tex", "pendulum.pdf"}
    report = json.loads(outcome.stdout)
    assert [Path(file["path"]).name for file in report["files"]] == ["pendulum.tex", "pendulum.pdf"]
    assert report["files"][1]["pages"] >= 1
    assert "inertia" in report["parts"]
    assert (folder / "sheets" / "new" / "pendulum.pdf").read_bytes().startswith(b"%PDF")


def test_a_web_page_is_one_file(folder: Path) -> None:
    handout(folder, "--html")
    assert names(folder) == {"pendulum.html"}
    assert "http-equiv" in (folder / "pendulum.html").read_text()


def test_a_refusal_of_latex_leaves_what_was_there(folder: Path) -> None:
    handout(folder)
    before = (folder / "pendulum.tex").read_bytes()
    options = ("--pdf", "--notation", "inertia=M", "--force")
    outcome = refused("handout", "arm.yaml", *options, folder=folder, PATH=str(folder))
    assert "texlive-latex-recommended latexmk" in outcome.stderr
    assert (folder / "pendulum.tex").read_bytes() == before
    assert names(folder) == {"pendulum.tex"}


def test_an_exercise_asks_for_what_its_solutions_tell(folder: Path) -> None:
    require_latex()
    handout(folder, "--exercise", "--pdf", "--derivation", "steps")
    sheets = {f"pendulum-{kind}.{form}" for kind in ("exercise", "solutions") for form in ("tex", "pdf")}
    assert names(folder) == sheets
    question, answer = ((folder / f"pendulum-{kind}.tex").read_text() for kind in ("exercise", "solutions"))
    solved = re.compile(r"b_\{11\}\s*=|\\mathbf\{B\}\(\\mathbf\{q\}\) = \\begin")
    assert "\\mathbf{B}" in question
    assert solved.search(answer)
    assert not solved.search(question)
    assert "Exercise" in question
    assert "Solutions" in answer


def test_a_sheet_keeps_to_the_pages_that_are_asked_for(folder: Path) -> None:
    outcome = handout(folder, "--pages", "1")
    assert "--pages 0 prints everything" in outcome.stdout
    assert "within the page limit (1)" in (folder / "pendulum.tex").read_text()
    handout(folder, "--pages", "0", "--force")
    assert "page limit" not in (folder / "pendulum.tex").read_text()


def test_a_fragment_goes_to_a_file_with_lines_as_wide_as_is_asked_for(folder: Path) -> None:
    outcome = handout(folder, "--fragment", "B", "--width", "84mm", "-o", "notes/b.tex")
    assert outcome.stdout == ""
    assert all(words in (folder / "notes" / "b.tex").read_text() for words in ("\\linewidth=84mm", "b_{11} = "))


def test_options_win_over_the_robot_file(folder: Path) -> None:
    with (folder / "arm.yaml").open("a") as file:
        file.write("handout: {parts: [inertia, gravity], language: it, notation: {inertia: D}}\n")
    handout(folder)
    text = (folder / "pendulum.tex").read_text()
    assert "\\mathbf{D}" in text
    assert text.count("\\section") == 2
    options = ("--parts", "gravity,inertia,table", "--lang", "en", "--notation", "inertia=M,angle=vartheta")
    handout(folder, *options, "--force")
    text = (folder / "pendulum.tex").read_text()
    assert "\\mathbf{M}" in text
    assert "\\vartheta" in text
    assert "Inertia matrix" in text
    assert text.count("\\section") == 3


def test_a_configuration_is_computed(folder: Path) -> None:
    with (folder / "arm.yaml").open("a") as file:
        file.write("parameters: {a1: 0.5, l1: 0.2, m1: 2, I1: 0.1, g: 9.81}\n")
    handout(folder, "-q", "pi/2", "--parts", "example")
    default = (folder / "pendulum.tex").read_text()
    handout(folder, "-q=-1/4", "--parts", "example", "--force")
    assert (folder / "pendulum.tex").read_text() != default
