"""Fragments: every quantity that the model has can be put into notes, alone, and names the packages that it needs."""

from dataclasses import replace

import pytest

from derive.errors import QuantityError, TargetError
from derive.handouts.fragment import fragment_text
from derive.model.quantities import REGISTRY
from derive.programs.functions import ROWS
from derive.robot.options.handout import InertiaLetter, NotationOptions
from derive.robot.robot import Robot

ARM = """
name: bar
convention: standard
joints: [{type: revolute, a: a1}, {type: revolute, a: a2}]
gravity: [0, -g, 0]
links: [{mass: m1, com: [-l1, 0, 0], inertia: {zz: I1}}, {mass: m2, com: [-l2, 0, 0], inertia: {zz: I2}}]
"""
NAMES = (
    *("T", "T[0,1]", "A[1]", "p", "R", "J", "Jv_com[2]", "B", "B[1,2]", "Bdot", "C", "N", "g", "tau", "tau[1]"),
    *("kinetic", "potential", "christoffel[1,1,2]"),
)


@pytest.fixture(scope="module")
def bar() -> Robot:
    return Robot.from_text(ARM)


@pytest.mark.parametrize("name", NAMES)
def test_a_quantity_stands_alone(bar: Robot, name: str) -> None:
    heading, body = fragment_text(bar, bar.handout, name).split("\n", 1)
    assert heading.startswith(f"% {name} of bar: written by derive")
    assert r"needs \usepackage{amsmath}" in heading
    assert "=" in body
    assert r"\documentclass" not in body
    assert body.count("{") - body.count(r"\{") == body.count("}") - body.count(r"\}")
    assert body.count(r"\begin") == body.count(r"\end")


@pytest.mark.parametrize(
    ("book", "ours"),
    [
        ("M", "B"),
        ("mass matrix", "B"),
        ("T02", "T[0,2]"),
        ("^0T_2[1,4]", "T[0,2][1,4]"),
        ("b_12", "B[1,2]"),
        ("det(J)", "detJ"),
    ],
)
def test_names_of_books_are_understood_as_by_show(bar: Robot, book: str, ours: str) -> None:
    assert (
        fragment_text(bar, bar.handout, book).split("\n", 1)[1]
        == fragment_text(bar, bar.handout, ours).split("\n", 1)[1]
    )


def test_a_word_with_several_meanings_is_refused_with_them(bar: Robot) -> None:
    with pytest.raises(QuantityError, match="several meanings"):
        fragment_text(bar, bar.handout, "euler angles")


def test_a_name_with_line_breaks_stays_in_its_comment(bar: Robot) -> None:
    assert fragment_text(bar, bar.handout, "mass\n matrix").startswith("% mass matrix of bar")


def test_matrices_wider_than_amsmath_expects_say_so() -> None:
    joints = ", ".join(["{type: prismatic}"] * 11)
    robot = Robot.from_text(f"name: snake\nconvention: standard\njoints: [{joints}]\n")
    text = fragment_text(robot, robot.handout, "J")
    assert "c@MaxMatrixCols\\endcsname=11" in text


def test_a_generated_function_is_named_where_one_computes_the_quantity() -> None:
    functions = {row.interface.name for row in ROWS}
    named = {row.name: row.function for row in REGISTRY.values() if row.function}
    assert set(named.values()) <= functions
    assert named["B"] == "inertia_matrix"


def test_symbols_are_those_of_the_registry_with_the_index_and_the_letter_asked_for(bar: Robot) -> None:
    letter = replace(bar.handout, notation=NotationOptions(inertia=InertiaLetter.M))
    assert "\\mathbf{J}_v^{l_{2}}" in fragment_text(bar, letter, "Jv_com[2]")
    assert "\\mathbf{M}^{l_{1}}" in fragment_text(bar, letter, "B_link[1]")
    assert "\\dot{\\mathbf{M}}" in fragment_text(bar, letter, "Bdot")


@pytest.mark.parametrize("width", ["84", "wide", "-3cm", "1em\\input{x}", "10 mm"])
def test_a_width_that_is_none_is_refused(bar: Robot, width: str) -> None:
    with pytest.raises(QuantityError, match="such as 84mm"):
        fragment_text(bar, bar.handout, "B", width)


def test_what_there_is_not_is_refused_with_what_may_be_meant(bar: Robot) -> None:
    with pytest.raises(TargetError, match="did you mean 'inertia'"):
        fragment_text(bar, bar.handout, "inerta")
    plain = Robot.from_text("name: bar\nconvention: standard\njoints: [{type: revolute, a: a1}]\n")
    with pytest.raises(QuantityError, match="no links"):
        fragment_text(plain, plain.handout, "B")
