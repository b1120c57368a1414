"""`derive.find_style` and `derive.Style.from_examples`: what a book's formulas tell about its style."""

from pathlib import Path

import pytest

import derive
from derive.api.handout import fragment
from derive.api.style import find_style
from derive.errors import CheckError
from derive.robot.options.style import Style
from tests.cli.test_style import GRAVITY, MIXED, NOTES

INERTIA = "B[1,2] = Il2 + ml2*l2**2 + ml2*a1*l2*c2 + kr2*Im2"


def test_formulas_as_texts_by_quantity_and_in_a_file_tell_the_same(tmp_path: Path) -> None:
    (tmp_path / "notes.yaml").write_text(NOTES)
    found = [
        find_style("planar-2r-perugia", examples=[GRAVITY]),
        find_style("planar-2r-perugia", examples=dict([GRAVITY.split(" = ")])),
        find_style(derive.load("planar-2r-perugia"), examples=[tmp_path / "notes.yaml"]),
        find_style(tmp_path / "notes.yaml"),
        find_style(str(tmp_path / "notes.yaml")),
    ]
    assert [each.style for each in found] == [Style.of("gravity: body")] * 5
    assert all(each.reproduced == 1 and each.passed for each in found)


def test_several_files_are_one_book(tmp_path: Path) -> None:
    (tmp_path / "one.yaml").write_text(NOTES)
    (tmp_path / "two.yaml").write_text(MIXED)
    found = find_style(tmp_path / "one.yaml", tmp_path / "two.yaml")
    assert [verdict.quantity for verdict in found.verdicts] == ["g[1]", "g[1]", "potential"]


def test_a_model_is_written_in_the_style_of_examples() -> None:
    robot = derive.load("planar-2r-perugia")
    style = derive.Style.from_examples(robot, [GRAVITY, INERTIA])
    assert style == Style.of("gravity: body, inertia: geometry")
    assert hash(style) == hash(derive.Style(**{"gravity": style.gravity, "inertia": style.inertia}))
    model, plain = derive.Model(robot, style=style), derive.Model(robot)
    for example in (GRAVITY, INERTIA):
        name, formula = example.split(" = ")
        assert model.equal(name, formula)
        assert model.quantity(name) != plain.quantity(name)
    assert fragment(robot, "g", style=style) != fragment(robot, "g")


def test_a_verdict_says_what_is_written_instead_and_why() -> None:
    found = find_style("planar-2r-perugia", examples=[GRAVITY, "g[1] = (ml1*l1 + ml2*a1 + mm2*a1)*g*c1 + ml2*g*l2*c12"])
    assert (found.reproduced, found.default, len(found.verdicts)) == (1, 1, 2)
    (other,) = [verdict for verdict in found.verdicts if not verdict.reproduced]
    assert other.outcome == "equal"
    assert other.reason.startswith("as printed with gravity: ")
    assert str(found).startswith(found.block)


def test_no_formula_that_tells_anything_is_refused() -> None:
    with pytest.raises(CheckError, match="no printed formula with a sum"):
        find_style("planar-2r-perugia")
    with pytest.raises(CheckError, match="one robot"):
        find_style("planar-2r-perugia", "scara-perugia", examples=[GRAVITY])
