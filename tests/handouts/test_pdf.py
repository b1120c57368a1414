"""A document becomes the same PDF wherever and whenever; a refusal says where, and nothing is read, run or left."""

import os
import tempfile
from pathlib import Path

import pytest

from derive.errors import LatexError
from derive.handouts.pdf import LatexRun, compile_latex
from tests.handouts.latex_runner import overfull, overfull_boxes, require_latex

DOCUMENT = r"""\documentclass{{article}}
\usepackage{{amsmath}}
\begin{{document}}
\section*{{Inertia matrix}}
{}
\end{{document}}
"""


@pytest.fixture(autouse=True)
def scratch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    require_latex()
    folder = tmp_path / "scratch"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def document(body: str) -> str:
    return DOCUMENT.format(body)


def refusal(body: str) -> str:
    with pytest.raises(LatexError) as caught:
        compile_latex(document(body), "arm")
    return str(caught.value)


def test_the_same_text_gives_the_same_bytes_and_nothing_is_left_behind(scratch: Path) -> None:
    before = os.getcwd()
    first, second = (compile_latex(document("$x$"), "arm") for _ in range(2))
    assert first.pdf == second.pdf
    assert first.pdf.startswith(b"%PDF")
    assert list(scratch.iterdir()) == []
    assert os.getcwd() == before


def test_references_are_resolved() -> None:
    compiled = compile_latex(document(r"\begin{equation}\label{e} x \end{equation} \ref{e} \pageref{e}"))
    assert "undefined references" not in compiled.text
    assert compiled.pages == 1


def test_a_refusal_tells_message_line_source_heading_and_where_the_document_is_kept(scratch: Path) -> None:
    text = refusal("fine\n\\unknowncommand{2}")
    (folder,) = scratch.iterdir()
    assert text.startswith("arm.tex:6:1: ")
    assert "Undefined control sequence" in text
    assert r"line 6 is '\unknowncommand{2}'" in text
    assert "Inertia matrix" in text
    assert str(folder / "arm.tex") in text
    assert (folder / "arm.tex").read_text() == document("fine\n\\unknowncommand{2}")


def test_missing_packages_and_programs_are_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with pytest.raises(LatexError, match="apt install texlive-latex-recommended"):
        compile_latex(document("x").replace("amsmath", "nosuchpackage"))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(LatexError, match=r"latexmk and pdflatex not found.*texlive-latex-recommended latexmk"):
        compile_latex(document("x"))


def test_a_document_without_end_is_stopped() -> None:
    with pytest.raises(LatexError, match="stopped after 1 s"):
        compile_latex(document(r"\def\x{\x}\x"), time_limit=1)


@pytest.mark.parametrize("name", ["/etc/passwd", "../secret", "../../secret.tex"])
def test_files_outside_are_not_read(name: str, scratch: Path) -> None:
    (scratch / "secret.tex").write_text("secret")
    assert "not found" in refusal(rf"\input{{{name}}}")


def test_no_program_is_run_and_settings_of_the_user_do_not_count(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ".latexmkrc").write_text("die 'read';\n")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert compile_latex(document(rf"\immediate\write18{{touch {tmp_path}/ran}} x")).pages == 1
    assert not (tmp_path / "ran").exists()


def test_overfull_boxes_are_measured() -> None:
    log = compile_latex(document(r"\hbox to 3pt{aaaaaa}"))
    assert [line for _, line in overfull_boxes(log)] == [5]
    assert 10 < overfull(log) < 40


def test_errors_of_both_forms_and_pages_are_read_from_the_log() -> None:
    plain = LatexRun("! Undefined control sequence.\n<recently read> \\x\nl.12 \\x\n")
    placed = LatexRun("./arm.tex:12: Undefined control sequence.\nl.12 \\x\n")
    assert plain.faults == [("Undefined control sequence.", 12)]
    assert plain.faults == placed.faults
    assert LatexRun("!  ==> Fatal error occurred, no output PDF file produced!\n").faults == []
    assert LatexRun("Output written on a_very_long_name.pdf (1\n2 pages, 100 bytes).").pages == 12
    assert LatexRun("No pages of output.").pages == 0
