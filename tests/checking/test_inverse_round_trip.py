"""What ``derive show ROBOT inverse`` prints, as text, LaTeX and Python, is right and complete to ``derive check``."""

from __future__ import annotations

import pytest

from derive.api.robots import load
from derive.checking.formulas.findings import Role
from derive.checking.formulas.printed import Asked
from derive.checking.inverse.check import check_inverse, inverse_text
from derive.errors import Location
from derive.handouts.notation.derivation import derivation_lines
from derive.handouts.notation.notation import Notation
from derive.model.model import Model

USUAL = ("planar-3r", "scara-perugia", "spherical-wrist", "skeleton-root")
OTHERS = (
    *(
        "anthropomorphic-arm",
        "anthropomorphic-wrist",
        "kuka-kr5",
        "planar-2r-perugia",
        "puma560-corke",
        "puma560-laschi",
    ),
    *(
        "puma560-usp",
        "scara-bajd",
        "scara-matlab",
        "scara-perugia-zup",
        "scara-sankyo",
        "skeleton",
        "skeleton-modified",
    ),
    *("spherical-arm", "stanford-deluca", "stanford-laschi", "thumb"),
)


MARKS = [pytest.mark.sweep if k % 3 == 0 else pytest.mark.release for k in range(len(OTHERS))]


@pytest.mark.parametrize("form", ["text", "latex", "python"])
@pytest.mark.parametrize(
    "robot", [*USUAL, *(pytest.param(name, marks=mark) for name, mark in zip(OTHERS, MARKS, strict=True))]
)
def test_what_is_shown_is_right_and_complete(robot: str, form: str) -> None:
    model = Model(load(robot))
    lines = derivation_lines(model.inverse, form, Notation.of(model.robot))
    if form == "text":  # formulas alone, without the words around them
        lines = [line for line in lines if line.startswith("   ") and " = " in line and "where " not in line]
    asked = Asked(Location(form), model.robot.inverse.task)
    findings, _ = check_inverse(model, inverse_text("\n".join(lines), asked, latex=form == "latex"))
    assert [finding.text for finding in findings if not finding.verdict.equal] == []
    assert findings[-1].role is Role.BRANCHES
    count = model.inverse.count
    assert findings[-1].text.startswith(f"all {count} solutions" if count > 1 else "the one solution")
    assert any(finding.same for finding in findings)
