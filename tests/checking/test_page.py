"""The verdicts on a document as one web page: slips beside what is right, nothing from a network, no text that runs."""

import re
from pathlib import Path

import pytest

from derive.api.check import formula_printout
from derive.checking.documents import document_of
from derive.checking.page import verdict_page
from derive.cli.main import main
from tests.checking.test_pages import ANT

NOTES = r"""
$$p_z = d_1 + a_2 s_2 - a_3 s_{23}$$
$$p_x = c_1 (a_2 c_2 + a_3 c_{23})$$
$$p_y = 0.3$$
$${}^0R_3 = \begin{bmatrix} c_1 c_{23} & s_1 c_{23} & s_{23} \\
-c_1 s_{23} & -s_1 s_{23} & c_{23} \\ s_1 & -c_1 & 0 \end{bmatrix}$$
"""


def page_of(text: str, name: str = "notes.md") -> str:
    return verdict_page([formula_printout(ANT, "", document_of(text, name, ".md"), latex=True)], [ANT])


def test_a_page_tells_slips_what_is_right_and_what_was_not_compared() -> None:
    page = page_of(NOTES)
    for words in (
        "Slips",
        "Not compared",
        "Right",
        "the matrix is transposed",
        "is a numeric example",
        "sign of the 3rd",
    ):
        assert words in page
    assert "a_{3}s_{23}" in re.sub(r"\s", "", page)


def test_a_page_needs_no_network_and_runs_nothing_of_the_document() -> None:
    page = page_of(r"$$p_z = d_1 + a_2 s_2 \text{</script><img src=x onerror=alert(1)>}$$" + NOTES, "<b>.md")
    assert not re.findall(r"(?:src|href)\s*=\s*[\"']?(?:https?:)?//", page)
    assert "<img src=x" not in page
    assert "<b>.md" not in page


def test_only_latex_becomes_a_web_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "page.html"
    assert main(["check", "planar-2r-perugia", "--quantity", "p[1]", "--expression", "a1*c1", "-o", str(target)]) == 2
    assert "a web page of formulas that are no LaTeX" in capsys.readouterr().err
    assert not target.exists()
    assert main(["check", "planar-2r-perugia", "--latex", "x = a_1 c_1", "-o", str(target), "--quiet"]) == 1
    assert target.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
