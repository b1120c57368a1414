"""Conditions for a diagonal inertia matrix: with them put in it is diagonal, and without them it is not."""

import pytest
import sympy

from derive.errors import QuantityError
from derive.model.decoupling import find_decoupling
from derive.model.model import Model
from derive.robot.robot import Robot

ARM = """
name: r
convention: modified
joints: [{type: revolute}, {type: revolute, a: LENGTH, theta: ANGLE}, {type: fixed, name: weight, a: -l2}]
links: [{mass: m1, inertia: {zz: I1}}, {mass: m2, com: [c2, 0, 0], inertia: {zz: I2}}, {mass: m3}]
"""


def lines(text: str) -> list[str]:
    return find_decoupling(Model(Robot.from_text(text))).lines(str)[1:]


def arm(angle: str, length: str = "l1") -> str:
    return ARM.replace("LENGTH", length).replace("ANGLE", angle)


def test_the_five_bar_linkage_is_decoupled_where_the_book_says() -> None:
    model = Model(Robot.load("five-bar"))
    found, symbols = model.decoupling, {s.name: s for s in model.B.free_symbols}
    (((left, right),),) = found.conditions
    assert {left, right} == {sympy.sympify("m3*l2*lc3", symbols), sympy.sympify("m4*l1*lc4", symbols)}
    at = sympy.solve(left - right, symbols["m3"])[0]
    assert sympy.simplify(model.B[0, 1].subs(symbols["m3"], at)) == 0
    assert found.lines(str)[-1].startswith("B is diagonal exactly where ")


@pytest.mark.parametrize(
    ("text", "entry", "whole"),
    [
        (arm("q2 - q1"), "c2*m2 = l2*m3", "B is diagonal exactly where c2*m2 = l2*m3"),
        (arm("q2 - q1", "l1 - l0"), "l1 = l0 or c2*m2 = l2*m3", "B is diagonal exactly where l1 = l0 or c2*m2 = l2*m3"),
        (arm("q2"), "never without a zero parameter: ", "conditions for a diagonal B: none, for B[1,2] cannot vanish"),
        (arm("q2", "0"), "never without a zero parameter: ", "conditions for a diagonal B: none, for B[1,2] cannot"),
    ],
)
def test_sums_whose_signs_are_free_can_vanish_and_products_cannot(text: str, entry: str, whole: str) -> None:
    first, last = lines(text)
    assert first.startswith(f"  B[1,2]  {entry}")
    assert last.startswith(whole)


def test_entries_that_are_zero_and_robots_without_any() -> None:
    slides = "{type: prismatic, alpha: pi/2}"
    links = "links: [{mass: m1}, {mass: m2}]"
    text = f"name: r\nconvention: standard\njoints: [{slides}, {slides}]\n"
    assert lines(text + links) == ["  B[1,2]  always", "B is diagonal"]
    with pytest.raises(QuantityError, match="has no `links`"):
        lines(text)
    with pytest.raises(QuantityError, match="decoupling of r, which has one variable; allowed: two or more"):
        lines(f"name: r\nconvention: standard\njoints: [{slides}]\nlinks: [{{mass: m1}}]")


def test_functions_that_depend_on_each_other_give_no_certain_conditions() -> None:
    rows = "[{type: revolute, alpha: pi/2}, {type: revolute, a: l1, alpha: pi/2}, {type: revolute, theta: 2*q2, a: l2}]"
    text = f"name: r\nconvention: standard\njoints: {rows}\nlinks: [{{mass: m1}}, {{mass: m2}}, {{mass: m3}}]\n"
    model = Model(Robot.from_text(text))
    assert not model.decoupling.is_exact
    assert not any("never" in line or "exactly" in line for line in model.decoupling.lines(str))
