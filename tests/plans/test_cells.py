"""Cells of plans, and one message with its place for each that is wrong."""

from __future__ import annotations

import pytest

from derive.errors import DeriveError
from derive.motion.motion import Motion
from derive.plans.cells import PlanCells
from derive.robot.expression import to_text
from derive.robot.reading.document import Document, YamlMapping, read_tree
from derive.robot.robot import Robot
from tests.motion.wrong_plans import RIGHT, WRONG


def cells(text: str) -> PlanCells:
    root = read_tree(text.encode(), "plan.yaml")
    assert isinstance(root, YamlMapping)
    return PlanCells(Document(root, "plan.yaml", "", "the plan"), Robot.load("scara-matlab"))


def test_the_right_plan_is_right() -> None:
    assert not Motion.from_text(RIGHT, "plan.yaml").violations


@pytest.mark.parametrize(("old", "new", "message"), WRONG, ids=[new.strip()[:60] for _, new, _ in WRONG])
def test_a_wrong_plan_is_one_message_when_it_is_loaded(old: str, new: str, message: str) -> None:
    assert old in RIGHT
    text = RIGHT.replace(old, new, 1) if old else RIGHT + new
    with pytest.raises(DeriveError) as caught:
        Motion.from_text(text, "plan.yaml")
    assert str(caught.value).startswith(f"plan.yaml:{message}")
    assert caught.value.exit_status == 2
    assert "\n" not in str(caught.value)


def test_joint_values_are_read_in_the_units_of_the_robot_and_have_numbers() -> None:
    found = cells("values: {w: 1/3}\nq: [pi/2, 2*w, w, 0]\n")
    assert [to_text(value) for value in found.of_joints(("q",))] == ["pi/2", "2*w", "w", "0"]
    assert found.size(found.plain(("q", 1))) == pytest.approx(2 / 3)
    found.check_used()


def test_a_number_that_nothing_has_is_refused() -> None:
    with pytest.raises(DeriveError, match=r"plan.yaml:1:13: values, w: no symbol 'w' in scara-matlab or in a formula"):
        cells("values: {w: 1}").check_used()


def test_formulas_may_have_the_time_and_other_cells_not() -> None:
    found = cells("x: 2*t")
    assert to_text(found.formula(("x",), found.cells.plain)) == "2*t"
    with pytest.raises(DeriveError, match="the symbol 't' has no number"):
        found.plain(("x",))
