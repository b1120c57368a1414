"""Every formula that the notes print about a robot: right ones equal, wrong ones wrong and right as corrected."""

from __future__ import annotations

from dataclasses import replace

import pytest
import sympy

from derive.checking.formulas.findings import Role
from derive.model.model import Model
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from tests.lectures.results import ROBOT_FILES, document
from tests.lectures.robot_results import corpus_file, report, robot_results


@pytest.mark.parametrize("file", ROBOT_FILES)
def test_the_corpus_is_confirmed(file: str) -> None:
    assert not [result.entry for result in robot_results(file) if not result.confirmed]


@pytest.mark.parametrize("file", ROBOT_FILES)
def test_equality_is_decided_by_algebra(file: str) -> None:
    algebraic = [f for f in report(file).findings if f.question is None or f.question.is_plain]
    assert not [finding.entry for finding in algebraic if not finding.verdict.exact]


@pytest.mark.parametrize("file", ROBOT_FILES)
def test_what_is_printed_with_abbreviations_and_as_zero_is_equal(file: str) -> None:
    others = [f for f in report(file).findings if f.role in (Role.ABBREVIATED, Role.REST, Role.CORRECTION)]
    assert not [finding.entry for finding in others if not finding.verdict.equal]


@pytest.mark.parametrize("file", ROBOT_FILES)
def test_a_wrong_formula_comes_with_numbers_that_show_it(file: str) -> None:
    for finding in report(file).wrong:
        example = finding.verdict.counter_example
        assert example is not None
        assert abs(example.printed - example.right) > 1e-3 * (1 + abs(example.right))


@pytest.mark.parametrize("file", ROBOT_FILES)
def test_the_robot_is_in_the_catalogue(file: str) -> None:
    printed = corpus_file(file).robot
    assert printed.name in catalogue_names()
    built_in = Robot.load(printed.name)
    assert replace(built_in, digest="", source="") == replace(printed, digest="", source="")


def test_the_pick_and_place_positions_follow_from_the_table() -> None:
    block = document("004-scara-matlab.yaml")
    trajectory, robot = block["trajectory"], corpus_file("004-scara-matlab.yaml").robot
    model = Model(robot)
    numbers = {name: sympy.Rational(str(value)) for name, value in block["robot"]["parameters"].items()}
    assert trajectory["samples"] == round(trajectory["duration"] / trajectory["sample_time"]) + 1
    for point in trajectory["waypoints"]:
        turn = {"pi/2": sympy.pi / 2}
        q = [turn.get(value, value) for value in point["q"]]
        place = model.p.subs(dict(zip(model.q, q, strict=True))).subs(numbers)
        assert place == sympy.Matrix(trajectory["computed_positions"][point["name"]])
