"""Every printed result of the corpus is right, or wrong where it says so."""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from derive.checking.formulas.findings import Role
from derive.model.model import Model
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from tests.lectures.general_results import FORMULAS, METHODS, SETS, arms, method_results, recursion_of, variants
from tests.lectures.results import (
    FRAMES,
    ROBOT_FILES,
    Result,
    corpus_file,
    document,
    frame_results,
    report,
    robot_results,
)


@pytest.mark.parametrize("name", [item["id"] for item in FRAMES])
def test_the_product_is_as_printed(name: str) -> None:
    assert not [result.entry for result in frame_results(name) if not result.confirmed]


@pytest.mark.parametrize("file", ROBOT_FILES)
def test_what_is_printed_about_a_robot_is_confirmed_and_equality_is_decided_by_algebra(file: str) -> None:
    assert not [result.entry for result in robot_results(file) if not result.confirmed]
    algebraic = [f for f in report(file).findings if f.question is None or f.question.compared is None]
    assert not [finding.entry for finding in algebraic if not finding.verdict.exact]
    others = [f for f in report(file).findings if f.role in (Role.ABBREVIATED, Role.REST, Role.CORRECTION)]
    assert not [finding.entry for finding in others if not finding.verdict.equal]
    for finding in report(file).wrong:
        example = finding.verdict.counter_example
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


ROBOTS_WITH_ROTORS = ("planar-2r-perugia", "scara-perugia", "scara-perugia-zup")


@pytest.mark.parametrize("name", SETS)
def test_the_equations_are_confirmed_and_each_of_two_slips_is_wrong_alone(name: str) -> None:
    assert not [result.entry for result in method_results(name) if not result.confirmed]
    assert not [text for text, holds in variants(name) if holds]


@pytest.mark.parametrize("robot", arms(), ids=lambda robot: robot.name)
def test_both_sets_give_the_same_torques(robot: Robot) -> None:
    base, link = (recursion_of(name, robot).torques for name in SETS)
    np.testing.assert_allclose(base, link, rtol=1e-12)


def test_gravity_is_an_acceleration_of_the_base_and_every_formula_of_lagrange_tested() -> None:
    assert METHODS["initial_conditions"]["status"] == "ok"
    for name in SETS:
        first, *_, last = recursion_of(name, arms()[2]).links
        assert (first.previous.w, first.previous.wd, first.previous.v) == ((0.0, 0.0, 0.0),) * 3
        assert first.previous.vd == (0.0, 0.0, 9.8062)
        assert last.following.f == last.following.n == (0.0, 0.0, 0.0)
    assert {item["name"] for item in METHODS["lagrange"]} == FORMULAS.keys()


@pytest.mark.parametrize("robot", ROBOTS_WITH_ROTORS)
@pytest.mark.parametrize("formula", FORMULAS)
def test_a_general_formula_of_lagrange_holds(formula: str, robot: str) -> None:
    assert FORMULAS[formula](Model(Robot.load(robot)))


RIGHT = 1416
WRONG = 35
ERRATA = 26
AGAIN_OR_IMPLIED = 83 + 11


def results() -> list[tuple[str, Result]]:
    found = [(file, result) for file in ROBOT_FILES for result in robot_results(file)]
    found += [("frames.yaml", result) for item in FRAMES for result in frame_results(item["id"])]
    found += [("methods.yaml", result) for name in SETS for result in method_results(name)]
    return found + [("methods.yaml", result) for result in other_methods()]


def other_methods() -> list[Result]:
    """Initial conditions, stop condition and general formulas; `test_methods` tests them one by one."""
    model = Model(Robot.load("planar-2r-perugia"))
    found = [Result(name, name, True, formula(model)) for name, formula in FORMULAS.items()]
    found.append(Result("initial conditions", "initial conditions", True, True))
    stops = [Result(item["id"], item["id"], False, False, corrected=True) for item in METHODS["algorithm"]["errata"]]
    return found + stops


def test_the_totals_of_the_corpus() -> None:
    found = results()
    assert all(result.confirmed for _, result in found)
    counted = [(file, result) for file, result in found if result.counted]
    wrong = [(file, result.item) for file, result in counted if not result.ok]
    assert len(counted) - len(wrong) == RIGHT
    assert len(wrong) == WRONG
    assert len(set(wrong)) == ERRATA
    assert len(found) - len(counted) == AGAIN_OR_IMPLIED
