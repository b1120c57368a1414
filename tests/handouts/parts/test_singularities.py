"""The part of the handout with the singularities."""

import random

import pytest

from derive.handouts.assemble import section_of
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Paragraph, Section, SheetFormula, Steps, blocks_of
from derive.handouts.sheet.language import Text
from derive.model.dynamic_entries import ModelEntries
from derive.model.model import Model
from derive.robot.load import catalogue_names
from derive.robot.options.handout import Derivation, HandoutOptions
from derive.robot.robot import Robot
from tests.random_robots import random_robot


def part(robot: Robot, *, steps: bool = False, text: Text | None = None) -> Section:
    options = HandoutOptions(derivation=Derivation.STEPS if steps else Derivation.RESULT)
    found = section_of(Context(ModelEntries(Model(robot)), options, text or Text(), "0"), "singularities")
    assert found is not None
    return found


def lines(found: Section) -> list[str]:
    formulas = [block for block in found.blocks if isinstance(block, SheetFormula)]
    return [line for formula in formulas for rows in formula.rows for line in rows.lines]


def test_the_scara_of_the_report_is_singular_when_stretched_out() -> None:
    found = lines(part(Robot.load("scara-perugia")))
    assert found[0] == "\\det\\mathbf{J}' = a_{1}a_{2}s_{2}"
    assert found[1].startswith("s_{2} = 0 \\iff q_{2} = 0")


def test_a_spherical_wrist_splits_the_determinant() -> None:
    found = part(Robot.load("puma560-corke"))
    assert any(isinstance(b, Paragraph) and "\\det\\mathbf{J}_{22}" in b.text for b in found.blocks)
    printed = lines(found)
    assert "a_{2}s_{5}(d_{4}c_{3} + a_{3}s_{3})(a_{2}c_{2} + a_{3}c_{23} - d_{4}s_{23})" in printed[0]
    assert [word in "".join(printed) for word in ("shoulder", "elbow", "wrist")] == [True] * 3


def test_the_steps_show_the_blocks() -> None:
    robot = Robot.load("stanford-deluca")
    assert not any(isinstance(block, Steps) for block in part(robot).blocks)
    steps = next(block for block in part(robot, steps=True).blocks if isinstance(block, Steps))
    assert sum(isinstance(block, SheetFormula) for block in steps.blocks) == 2


def test_the_results_can_be_left_blank() -> None:
    formulas = [block for block in part(Robot.load("planar-2r-perugia")).blocks if isinstance(block, SheetFormula)]
    assert formulas
    assert all(formula.blanks for formula in formulas)


def test_a_redundant_arm_names_its_measure() -> None:
    found = part(Robot.load("kuka-lwr4"))
    first, *_, last = (block.text for block in found.blocks if isinstance(block, Paragraph))
    assert "\\det(\\mathbf{J}\\,\\mathbf{J}^T) = 0" in first
    assert last == "Nowhere else is rank lost."
    assert any(line.startswith("s_{2} = 0 ") and ",\\quad c_{3} = 0 " in line for line in lines(found))


def test_the_texts_are_translated() -> None:
    words = {"Singularities": "Singolarità", "or": "oppure", "wrist": "polso"}
    found = part(Robot.load("stanford-deluca"), text=Text("it", words))
    assert found.title == "Singolarità"
    assert "\\text{oppure}" in "".join(lines(found))
    assert "\\text{(polso)}" in "".join(lines(found))


@pytest.mark.parametrize("name", catalogue_names())
def test_every_robot_of_the_catalogue_has_the_part(name: str) -> None:
    assert list(blocks_of(part(Robot.load(name), steps=True)))


@pytest.mark.parametrize("seed", range(20))
def test_every_random_robot_has_the_part(seed: int) -> None:
    robot = Robot.from_text(random_robot(random.Random(seed), dynamics=False).text)
    for block in blocks_of(part(robot, steps=True)):
        if isinstance(block, SheetFormula):
            assert block.rows or block.omitted
            printed = (line.replace("\\{", "").replace("\\}", "") for rows in block.rows for line in rows.lines)
            assert all(line.count("{") == line.count("}") for line in printed)
