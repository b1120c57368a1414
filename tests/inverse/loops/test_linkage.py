"""Closed loops: every assembly is found and none is spurious, and what cannot move as it is written is refused."""

import re
from math import pi

import numpy as np
import numpy.typing as npt
import pytest

from derive.errors import DeriveError
from derive.inverse.closed.solve import solve
from derive.inverse.loops.circuit import circuit
from derive.inverse.loops.closing import twists
from derive.inverse.loops.linkage import linkage, positions
from derive.mechanics.floats import ArrayDomain
from derive.robot.robot import Robot
from tests.random_robots import seeds

Array = npt.NDArray[np.float64]
FOUR = """
name: four
convention: standard
joints:
  - {type: revolute, name: crank, a: l1}
  - {type: revolute, name: coupler, a: l2, passive: true}
  - {type: fixed, name: ground, after: base, a: l0}
  - {type: revolute, name: rocker, after: ground, a: l3, passive: true}
ends: {pin: coupler}
loops:
  - {join: [coupler, rocker], by: revolute}
"""
FIVE = FOUR.replace("l3, passive: true}", "l3}\n  - {type: revolute, name: rod, a: l4, passive: true}").replace(
    "rocker]", "rod]"
)


def robot(text: str) -> Robot:
    return Robot.from_bytes(text.encode(), "loop.yaml")


def branches(text: str, q: list[Array], values: dict[str, float]) -> tuple[list[Array], list[Array]]:
    """Of each assembly the absolute angle of the rod that is second, and where it exists."""
    angles, exist = [], []
    for sign in "+-":
        one = robot(text.replace("by: revolute", f"by: revolute, branch: '{sign}'"))
        full, exists = positions(one, linkage(one), q, values)
        angles.append(full[0] + full[1])
        exist.append(exists)
    return angles, exist


def roots(value: Array) -> npt.NDArray[np.intp]:
    """Where samples of a periodic function change their sign."""
    return np.flatnonzero(np.sign(value) != np.sign(np.roll(value, -1)))


@pytest.mark.parametrize("text", [FOUR, FIVE])
@pytest.mark.parametrize("seed", seeds(500, 5, 500))
def test_all_assemblies_of_random_linkages_are_found_and_none_is_spurious(text: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    values = {f"l{k}": float(rng.uniform(0.2, 1.0)) for k in range(5)}
    q = [rng.uniform(-pi, pi, 4) for _ in robot(text).variables]
    angles, exist = branches(text, q, values)
    grid = np.linspace(-pi, pi, 20_001)[:-1]
    for k in range(4):
        # The pin on a circle about the crank's tip, and how far it is from the circle about the other one.
        tip = values["l1"] * np.exp(1j * q[0][k])
        other = values["l0"] + (values["l3"] * np.exp(1j * q[1][k]) if text is FIVE else 0)
        gap = np.abs(tip + values["l2"] * np.exp(1j * grid) - other) - values["l4" if text is FIVE else "l3"]
        found = grid[roots(gap)]
        own = np.array([angle[k] for angle, exists in zip(angles, exist, strict=True) if exists[k]])
        assert len(own) == len(found) or np.abs(gap).min() < 1e-6  # a grid sees no double root
        for angle in own:
            assert np.abs(np.exp(1j * found) - np.exp(1j * angle)).min(initial=9.0) < 1e-3 or np.abs(gap).min() < 1e-6


@pytest.mark.parametrize("text", [FOUR, FIVE])
def test_the_number_of_assemblies_is_proven(text: str) -> None:
    one = robot(text)
    graph = solve(circuit(one, one.loops[0], ()).arm)
    assert (graph.count, graph.complete) == (2, True)


def changed(old: str, new: str, text: str = FOUR) -> str:
    assert old in text
    return text.replace(old, new)


NUMBERS = "\nparameters: {l0: 2, l1: 0.2, l2: 0.3, l3: 0.5}\n"
ROD = changed("  - {type: revolute, name: coupler, a: l2, passive: true}\n", "").replace(
    "{pin: coupler}", "{pin: rocker}"
)
ROD = ROD.replace("[coupler, rocker], by: revolute", "[crank, rocker], by: distance, length: l2")
REFUSED = {
    "at best 1 m are missing; correct lengths": ROD + NUMBERS,
    "by: distance without a length": ROD.replace(", length: l2", ""),
    "by: revolute with a length": changed("by: revolute", "by: revolute, length: l2"),
    "length: a rod of -1 m; allowed: more than zero": ROD.replace("length: l2", "length: -1"),
    "q2, q3 move it, and a rod determines one joint": changed("by: revolute", "by: distance, length: l4"),
    "it does not determine q2": ROD.replace("a: l3", "a: 0"),
    "no joint of the loop is passive; allowed: loops that move joints": ROD.replace("rocker],", "ground],"),
    "cannot be assembled: at best 1 m are missing": FOUR + NUMBERS,
    "at best 0.1 m are missing": changed("a: l2", "a: l2, d: 0.1"),
    "over-constrained: 1 of q1, q2 depends on the others": changed("a: l2, passive: true", "a: l2"),
    "it does not determine q4, q3, q2": changed(
        "  - {type: fixed", "  - {type: revolute, name: more, a: l4, passive: true}\n  - {type: fixed"
    ).replace("[coupler,", "[more,"),
    "over-constrained: loops above determine all its passive joints": changed(
        "by: revolute}\n", "by: revolute}\n  - {join: [coupler, rocker], by: fixed}\n"
    ),
    "all joints of its loops are passive": changed("a: l1}", "a: l1, passive: true}"),
    "no joint of the loop is passive": FOUR.replace(", passive: true", ""),
    "no loop moves the joint": FOUR.replace("loops:\n  - {join: [coupler, rocker], by: revolute}\n", ""),
    "branch '++'; allowed: one sign for 1 choice": changed("by: revolute", "by: revolute, branch: '++'"),
    "a fixed row has no motion": changed("after: base, a: l0", "after: base, a: l0, passive: true"),
    "the velocity of 'q2' is called 'qd2', and that is a symbol already": changed("a: l2", "a: qd2"),
    "branch 'open'; allowed: signs + and -": changed("by: revolute", "by: revolute, branch: open"),
    "no row 'rockr'": changed("[coupler, rocker]", "[coupler, rockr]"),
    "'coupler' joined with itself": changed("[coupler, rocker]", "[coupler, coupler]"),
    "a passive joint that variables move": changed("a: l2, passive", "a: l2, theta: q1, passive"),
}


@pytest.mark.parametrize("message", REFUSED)
def test_loops_that_cannot_move_as_they_are_written_are_refused_at_their_place(message: str) -> None:
    with pytest.raises(DeriveError, match=re.escape(message)) as refusal:
        linkage(robot(REFUSED[message]))
    assert str(refusal.value).startswith("loop.yaml:")


def test_a_loop_is_the_same_whichever_frame_is_named_first_and_where_axes_are_opposed() -> None:
    swapped = changed("[coupler, rocker]", "[rocker, coupler]")
    texts = FOUR, swapped, swapped.replace("by: revolute", "by: revolute, branch: '-'"), changed("l3", "l3, alpha: pi")
    q, values = [np.linspace(-3, 3, 7)], {"l0": 1.0, "l1": 0.3, "l2": 0.8, "l3": 0.7}
    found = [np.exp(1j * np.array(positions(each, linkage(each), q, values)[0])) for each in map(robot, texts)]
    usual, other, opposite, opposed = found
    assert min(np.abs(usual - each).max() for each in (other, opposite)) < 1e-12
    assert np.abs(usual - opposed).max() < 1e-12


def test_closures_take_no_name_that_the_file_has() -> None:
    for name in ("psi", "psi1", "psid1"):
        arm = linkage(robot(changed("a: l2", f"a: {name}")))[0].circuit.arm
        assert "psi_1" in [joint.variable for joint in arm.joints]


BENNETT = """
name: bennett
convention: standard
joints:
  - {type: revolute, name: one, a: 1, alpha: pi/6}
  - {type: revolute, name: two, a: 2, alpha: pi/2, passive: true}
  - {type: revolute, name: three, a: 1, alpha: pi/6, passive: true}
  - {type: fixed, name: ground, after: base, a: -2, alpha: -pi/2}
ends: {tip: two}
loops: [{join: [three, ground], by: revolute}]"""


def test_rates_of_an_over_constrained_linkage_exist_wherever_it_moves() -> None:
    (loop,) = loops = linkage(one := robot(BENNETT))
    full, _ = positions(one, loops, [np.linspace(-3, 3, 61)])
    found, _ = twists(one, loop, ArrayDomain(one, full, {}))
    matrix = np.array([[np.broadcast_to(found[k][row], 61) for k in loop.passive] for row in loop.rows])
    assert np.abs(np.linalg.det(matrix.T)).min() > 0.1  # at the flat linkage, q = 0, some rows are dependent
