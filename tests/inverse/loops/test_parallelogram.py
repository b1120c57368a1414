"""Parallelograms become coupled joints, other loops stay, and the positions are those of the loop."""

import numpy as np
import pytest

from derive.inverse.loops.linkage import linkage, positions
from derive.inverse.loops.parallelogram import reduced
from derive.model.model import Model
from derive.robot.robot import Robot

FOUR = """
name: r
convention: standard
joints:
  - {type: revolute, name: crank, a: l1}
  - {type: revolute, name: coupler, a: l0, passive: true}
  - {type: fixed, name: ground, after: base, a: l0}
  - {type: revolute, name: rocker, after: ground, a: l1, passive: true, q: v, theta: v}
ends: {pin: coupler}
loops: [{join: [coupler, rocker], by: revolute, branch: '+'}]
"""
SECOND = """
  - {type: revolute, name: arm, after: coupler, a: l3, theta: w - pi/2, q: w}
  - {type: revolute, name: hand, a: l4, passive: true, q: x}
  - {type: fixed, name: stand, after: coupler, a: l4}
  - {type: revolute, name: rod, after: stand, a: l3, passive: true, q: y}
ends: {pin: hand}"""
TWO = FOUR.replace("\nends: {pin: coupler}", SECOND).replace("}]", "}, {join: [hand, rod], by: revolute}]")
PIN = "\n  - {type: revolute, name: pin, passive: true}\nends"
WELDED = FOUR.replace("revolute, branch", "fixed, branch").replace("r, rocker", "r, pin").replace("\nends", PIN)


@pytest.mark.parametrize("branch", "+-")
@pytest.mark.parametrize("theta", ["v", "-v", "v + pi/2", "pi - v"])
def test_opposite_sides_turn_alike_on_either_branch(theta: str, branch: str) -> None:
    robot = Robot.from_text(FOUR.replace("theta: v", f"theta: {theta}").replace("'+'", f"'{branch}'"))
    assert not reduced(robot).loops
    assert [joint.row["theta"] for joint in reduced(robot).joints] == ["q1", "-q1", "q1"]
    assert [str(x) for x in Model(robot).quantity("p[pin]")] == ["l0 + l1*cos(q1)", "l1*sin(q1)", "0"]


@pytest.mark.parametrize("text", [TWO, WELDED], ids=["two", "welded"])
def test_loops_behind_each_other_and_welded_ones_become_couplings(text: str) -> None:
    model = Model(Robot.from_text(text))
    assert not model.robot.loops
    assert model.quantity("R[pin]").is_Identity


def test_other_loops_stay() -> None:
    (left,) = reduced(Robot.from_text(TWO.replace("after: stand, a: l3", "after: stand, a: l5"))).loops
    assert left.join == ("hand", "rod")
    assert reduced(Robot.from_text(FOUR.replace("ground, a: l1", "ground, a: l2"))).loops
    # Limits that keep the sides off one line leave to the branch whether they cross.
    below = FOUR.replace("name: crank,", "name: crank, limits: [-3, -1/10],")
    assert {len(reduced(Robot.from_text(below.replace("'+'", f"'{sign}'"))).loops) for sign in "+-"} == {0, 1}


def test_the_five_bar_linkage_is_where_its_loop_is_and_has_the_matrix_of_the_book() -> None:
    robot, q = Robot.load("five-bar"), np.random.default_rng(1).uniform(-3, 3, (2, 40))
    full, _ = positions(robot, linkage(robot), [*q], {"l1": 0.4, "l2": 0.3, "l4": 0.7})
    apart = [np.abs(np.exp(1j * (x + way * (q[1] - q[0]))) - 1) for x, way in zip(full[2:], (1, -1), strict=True)]
    assert (np.max(apart, axis=0) < 1e-9).tolist() == (np.sin(q[0] - q[1]) > 0).tolist()
    model = Model(robot)
    assert str(model.B[0, 1]) == "(-l1*lc4*m4 + l2*lc3*m3)*cos(q1 - q2)"
    assert model.equal("B[1,1]", "m1*lc1**2 + m3*lc3**2 + m4*l1**2 + I1 + I3")
    assert model.equal("B[2,2]", "m2*lc2**2 + m3*l2**2 + m4*lc4**2 + I2 + I4")
