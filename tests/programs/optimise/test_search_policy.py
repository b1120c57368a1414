"""The policy of the search: every threshold counts, and can be tried with other values."""

import inspect
import re
from dataclasses import fields, replace

import pytest

from derive.errors import DeriveError
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import POLICY, Effort, Policy, effort_named
from derive.robot.robot import Robot
from tests.programs.thresholds import measured, values_tried


@pytest.mark.parametrize("name", [field.name for field in fields(Policy)])
def test_every_threshold_has_a_reason_and_is_tried_below_and_above(name: str) -> None:
    below, above = values_tried(name)
    assert below < getattr(POLICY, name) < above
    assert re.search(rf"# .*\n    {name}: |    {name}: .*  # ", inspect.getsource(Policy))


def test_one_of_both_ways_to_accelerations_is_left_for_every_number_of_joints() -> None:
    assert POLICY.fewest_articulated <= POLICY.most_factorised + 1


def test_a_search_without_work_finds_less() -> None:
    idle = replace(POLICY, search_work=0, draft_work=0, hoisted_work=0, frame_choice_work=0)
    costs, _ = measured(idle, ["puma560-corke"], ["inertia_matrix"])
    usual = build_program(Robot.load("puma560-corke"), names=["inertia_matrix"])["inertia_matrix"]
    assert usual.tape.operations.cost < costs["puma560-corke", "inertia_matrix"]


def test_an_effort_has_a_name() -> None:
    assert effort_named("quick") is Effort.QUICK
    with pytest.raises(DeriveError, match="unknown effort 'most'"):
        effort_named("most")
