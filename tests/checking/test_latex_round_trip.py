"""What `derive show --format latex` and the handout print is read back as the same formulas."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from derive.checking.latex.check import check_latex
from derive.checking.latex.formula import read_latex
from derive.cli.main import main
from derive.errors import DeriveError
from derive.handouts.fragment import fragment_text
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import LatexPrinter
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import compare
from derive.model.model import Model
from derive.model.quantities import REGISTRY
from derive.robot.options.handout import HandoutOptions
from derive.robot.robot import Robot
from tests.random_robots import catalogue, swept_catalogue

LONGEST = 3_000
QUICK = ("planar-2r-perugia", "spherical-wrist")
LONG_CHAIN = 8
"""Joints from which only the transforms of the rows are short enough to be read."""


def quantities(model: Model) -> Iterator[str]:
    """Every quantity that the robot has, with indices where it takes some."""
    n = model.robot.n
    for row in REGISTRY.values():
        if row.name == "inverse":  # solutions are lines, no entries
            continue
        for indices in ("", "[1]", f"[0,{n}]", "[1,2]", "[1,1,2]"):
            name = row.name + indices
            if indices.count(",") + bool(indices) not in row.indices:
                continue
            try:
                value = model.quantity(name)
            except DeriveError:
                continue
            if 0 not in getattr(value, "shape", ()):
                yield name


@pytest.mark.parametrize("name", swept_catalogue(LONG_CHAIN - 1, usual=QUICK))
def test_what_show_prints_is_read_back(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    model = Model(Robot.load(name))
    for quantity in quantities(model):
        assert main(["show", name, quantity, "--format", "latex"]) == 0
        printed, asked = capsys.readouterr().out, quantity
        if quantity == "singularities":  # a configuration in which it is zero is no formula for it
            printed, asked = "\n".join(line for line in printed.splitlines() if "\\det \\mathbf" in line), ""
        findings = check_latex(model, printed, asked).findings if printed else ()
        assert findings or not (printed or model.singularities.blocks)
        assert all(finding.unknown is None and finding.verdict.equal for finding in findings), quantity


FRAGMENTS = ("T", "J", "A[1]", "T[0,1]", "B", "C", "g", "tau", "potential", "kinetic")


@pytest.mark.parametrize("name", swept_catalogue(LONG_CHAIN - 1, usual=QUICK))
def test_fragments_of_the_handout_are_read_back(name: str) -> None:
    robot = Robot.load(name)
    model = Model(robot)
    for quantity in FRAGMENTS:
        if robot.has_dynamics or not REGISTRY[quantity.split("[")[0]].dynamic:
            report = check_latex(model, fragment_text(robot, HandoutOptions(), quantity), document=True)
            long = [skipped for skipped in report.skipped if "\\colon" in skipped.text]  # printed as a number of terms
            assert len(long) == len(report.skipped), quantity
            assert all(finding.verdict.equal for finding in report.findings), quantity


@pytest.mark.parametrize("name", [name for name, robot in catalogue().items() if robot.n <= 7])
def test_printed_latex_is_read_back(name: str) -> None:
    robot = Robot.load(name)
    model, latex = Model(robot), LatexPrinter(Notation.of(robot)).latex
    names = ["T", "J", *(["B", "C", "g", "tau"] if robot.has_dynamics and robot.n < 5 else [])]
    for entry in (entry for quantity in names for entry in model.quantity(quantity)):
        text = latex(entry)
        if len(text) <= LONGEST:
            assert compare(robot, expression_from_sympy(entry), read_latex(text, robot)).equal, text
