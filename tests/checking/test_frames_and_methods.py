"""Printed products of frames and Newton-Euler equations: what is read, what is refused, what is found."""

from __future__ import annotations

from pathlib import Path

import pytest

from derive.checking.files import check_path
from derive.checking.formulas.findings import FileReport, judge
from derive.errors import CheckError, DeriveError

FRAMES = """\
items:
  - id: turn
    factors: ["Trans(l1, 0, 0)", "Rot(z, alpha)"]
    matrix:
      - [cos(alpha), -sin(alpha), 0, l1]
      - [sin(alpha), cos(alpha), 0, 0]
      - [0, 0, 1, 0]
      - [0, 0, 0, 1]
  - id: end
    factors: ["Ref(turn)", "Vec(l2, 0, 0)"]
    matrix: [["l1 + l2*cos(alpha)"], ["l2*sin(alpha)"], [0], [1]]
"""
EQUATION = "newton_euler_base:\n  - {id: x, joint: %s, result: %s, printed: '%s', status: ok}\n"


def check(folder: Path, text: str) -> FileReport:
    path = folder / "file.yaml"
    path.write_text(text)
    return check_path(str(path))[0]


def test_products_of_frames_are_compared_entry_by_entry(tmp_path: Path) -> None:
    report = check(tmp_path, FRAMES)
    assert report.passed
    assert len(report.findings) == 20


def test_a_slip_in_a_product_is_found_and_repaired(tmp_path: Path) -> None:
    (wrong,) = check(tmp_path, FRAMES.replace('["l2*sin(alpha)"]', '["-l2*sin(alpha)"]')).wrong
    repair = judge(wrong).repair
    assert wrong.entry == "end[2,1]"
    assert repair is not None
    assert repair.text == "sign: l2*sin(alpha) instead of -l2*sin(alpha)"


@pytest.mark.parametrize(
    ("found", "instead", "message"),
    [
        ("Trans(l1, 0, 0)", "Move(l1)", "factor 'Move"),
        ("Trans(l1, 0, 0)", "Trans(l1, 0)", "take 3"),
        ("Rot(z, alpha)", "Rot(w, alpha)", "axis 'w'"),
        ("Rot(z, alpha)", "Rot(z)", "Rot with 1"),
        ("Ref(turn)", "Ref(later)", "earlier item"),
        ("Rot(z, alpha)", "Rot(z, __import__)", "unexpected character"),
        ('["l2*sin(alpha)"], ', "", "another shape"),
    ],
)
def test_frames_that_cannot_be_read_are_refused(tmp_path: Path, found: str, instead: str, message: str) -> None:
    assert found in FRAMES
    with pytest.raises(DeriveError, match=r"file\.yaml") as caught:
        check(tmp_path, FRAMES.replace(found, instead))
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("joint", "result", "printed", "right"),
    [
        ("revolute", "w", "w_prev + z_prev*qd", True),
        ("prismatic", "w", "w_prev + z_prev*qd", False),
        ("any", "F", "m*a", True),
        ("any", "N", "I @ wd + cross(w, I @ w)", True),
        ("any", "N", "I @ wd - cross(w, I @ w)", False),
        ("revolute", "tau", "n @ z_prev + b*qd", True),
        ("any", "F", "m @ a", False),
        ("any", "F", "m", False),
    ],
)
def test_equations_hold_for_every_link_or_are_wrong(
    tmp_path: Path, joint: str, result: str, printed: str, right: bool
) -> None:
    assert check(tmp_path, EQUATION % (joint, result, printed)).passed is right


@pytest.mark.parametrize(
    ("printed", "text"),
    [
        ("I @ wd - cross(w, I @ w)", "sign of -cross(w, I @ w)"),
        ("I @ wd + cross(wd, I @ w)", "index: w instead of wd"),
        ("I @ w + cross(wd, I @ w)", "2 changes: index: wd instead of w; index: w instead of wd"),
    ],
)
def test_the_change_that_repairs_an_equation_is_named(tmp_path: Path, printed: str, text: str) -> None:
    (wrong,) = check(tmp_path, EQUATION % ("any", "N", printed)).wrong
    assert wrong.repair is not None
    assert wrong.repair.text == text


@pytest.mark.parametrize(
    ("printed", "message"),
    [
        ("m*acc", "unknown name 'acc'"),
        ("m*", "vector equation"),
        ("__import__(w)", "vector equation"),
        ("cross(w)", "vector equation"),
        ("(" * 300 + "w", "vector equation"),
        ("+".join(["w"] * 300), "too long"),
    ],
)
def test_equations_that_cannot_be_read_are_refused(tmp_path: Path, printed: str, message: str) -> None:
    with pytest.raises(CheckError) as caught:
        check(tmp_path, EQUATION % ("any", "F", printed))
    assert message in str(caught.value)
    assert caught.value.location is not None
    assert caught.value.location.line == 2


def test_a_file_of_another_kind_is_refused_as_before(tmp_path: Path) -> None:
    with pytest.raises(DeriveError, match=r"file\.yaml"):
        check(tmp_path, "something: else\n")
