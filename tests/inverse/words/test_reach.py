"""Branches, postures and reach in words."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
import sympy

from derive.inverse.closed.solve import solve
from derive.inverse.numeric.chain import NumericChain
from derive.inverse.words.elementary import PrintedLine, array_value
from derive.inverse.words.postures import LOOKED_AT, Placed, Shape, Word, placed, postures
from derive.inverse.words.reach import Reach
from derive.inverse.words.solutions import ArrayDomain, InverseKinematics, inverse_kinematics
from derive.mechanics.chain import build_chain
from derive.mechanics.floats import FloatDomain
from derive.model.model import Model
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot
from tests.inverse.arms import PUBLISHED, arm_of, random_arm
from tests.inverse.closed.test_pool import PLANAR, planar_graph
from tests.random_robots import chains


@cache
def reach_of(robot: Robot) -> Reach:
    return Model(robot).workspace


@cache
def catalogue(name: str) -> Robot:
    return Robot.load(name)


def test_a_planar_arm_reaches_what_lies_between_difference_and_sum_of_its_links() -> None:
    found = reach_of(catalogue("planar-2r-perugia"))
    (bound,) = found.bounds
    a1, a2 = sympy.symbols("a1 a2")
    assert bound.radii == (sympy.Abs(a1 - a2), a1 + a2)
    assert (found.is_flat, found.is_whole, bound.coordinates) == (True, True, 2)


def test_a_puma_has_a_bore_and_a_hollow() -> None:
    bore, hollow = reach_of(catalogue("puma560-corke")).bounds
    a2, a3, d3, d4 = sympy.symbols("a2 a3 d3 d4")
    forearm = sympy.sqrt(a3**2 + d4**2)
    assert (bore.least, bore.most) == (d3**2, None)
    assert sympy.expand(hollow.least - (a2 - forearm) ** 2 - d3**2) == 0
    assert sympy.expand(hollow.most - (a2 + forearm) ** 2 - d3**2) == 0


def test_an_offset_of_the_shoulder_makes_tori_and_a_quartic_leaves_no_bound() -> None:
    found = reach_of(arm_of("standard", "R 0 0 a1 90; R 0 0 a2 0; R 0 0 a3 0"))
    (bound,) = found.bounds
    pz, rho, a1, a2, a3 = sympy.symbols("pz rho a1 a2 a3")
    assert sympy.expand(bound.quantity - (rho - a1) ** 2 - pz**2) == 0
    assert bound.radii == (sympy.Abs(a2 - a3), a2 + a3)
    assert [str(line.symbol) for line in found.names] == ["rho"]
    found = reach_of(arm_of("standard", "R 0 0 1 -90; R 0 1 2 90; R 0 0 1.5 0"))
    assert (found.bounds, found.is_whole) == ((), False)


@pytest.mark.parametrize("name", ["planar-3r", "scara-perugia", "puma560-corke", "kuka-kr5", "stanford-deluca"])
def test_reachable_poses_are_within_the_bounds_and_come_near_to_them(name: str) -> None:
    robot = catalogue(name)
    found = reach_of(robot)
    values = {symbol: 0.2 + 0.17 * k for k, symbol in enumerate(robot_symbols(robot))}
    chain = NumericChain.of(robot, values)
    q = np.random.default_rng(7).uniform(-np.pi, np.pi, (40_000, robot.n))
    ways = found.margins(chain.pose_and_jacobian(q)[0], values)
    inside = np.any([np.all([margin > -1e-12 for margin in way], axis=0) for way in ways], axis=0)
    assert inside.all()
    for sides in zip(*ways, strict=True):  # the boundary is touched: a bound that is too wide is seen
        near = np.nanmin([np.where(np.isnan(side) | (side < 0), np.inf, side).min() for side in sides])
        assert near < 2e-3


def test_places_just_outside_of_the_bounds_have_no_solution() -> None:
    found, values = reach_of(catalogue("anthropomorphic-arm")), {"a2": 0.7, "a3": 0.4}
    poses = np.tile(np.eye(4), (4, 1, 1))
    poses[:, 0, 3] = 0.299, 0.301, 1.099, 1.101
    (margins,) = found.margins(poses, values)
    assert np.min(margins, axis=0).tolist() == pytest.approx(
        [0.299**2 - 0.09, 0.301**2 - 0.09, 1.21 - 1.099**2, 1.21 - 1.101**2]
    )


def test_numbers_of_bounds_are_those_of_the_file() -> None:
    found = reach_of(catalogue("puma560-corke"))
    numbers = found.numbers(found.bounds[1])
    assert [float(number) for number in numbers if number is not None] == pytest.approx([0.150051, 0.877008], abs=1e-6)
    planar = reach_of(catalogue("planar-2r-perugia"))
    assert planar.numbers(planar.bounds[0]) is None


def test_a_slide_that_is_found_before_bounds_no_place() -> None:
    """Where q1 is real depends on q3 there, which the pose tells; a comparison with its sign ended in a fault."""
    found = reach_of(arm_of("modified", "R 0 0 d1 0; R 90 0 0 0; P 45 a2 0 0"))
    assert [str(bound.least) for bound in found.bounds] == ["a2**2"]
    assert sympy.Symbol("q1") in found.others


USUAL = ("planar-3r", "scara-perugia", "spherical-wrist", "stanford-deluca")
"""And ``scara-wrist``, where a factor of an equation moves."""


@pytest.mark.parametrize(
    "name",
    [*USUAL, "scara-wrist", *(pytest.param(n, marks=pytest.mark.sweep) for n in chains() if n not in USUAL)],
)
def test_printed_solutions_stand_in_the_order_of_the_graph_under_its_names(name: str) -> None:
    found = None if name in chains() else next(case.robot() for case in PUBLISHED if case.name == name)
    robot = found or Robot.load(name)
    inverse = inverse_kinematics(robot, robot.style)
    if len(inverse.solutions) < 2:
        return
    looked = postures(robot, inverse.graph)
    assert tuple(solution.name for solution in inverse.solutions) == looked.names[: len(inverse.solutions)]
    met = 0
    for solution, branch in zip(inverse.solutions, looked.branches, strict=False):
        own = in_numbers(inverse, solution.lines)
        real = np.isfinite(own).all(axis=0)
        met += int(real.sum())
        assert np.abs(np.exp(1j * own) - np.exp(1j * branch))[:, real].max(initial=0.0) < 1e-5
    assert met >= LOOKED_AT


def in_numbers(inverse: InverseKinematics, lines: Sequence[PrintedLine]) -> np.ndarray:
    """The joint variables of a solution at the poses looked at, not a number where it is none."""
    looked, robot = postures(inverse.robot, inverse.graph), inverse.robot
    variables = [sympy.Symbol(joint.variable) for joint in robot.joints]
    q = dict(zip(variables, looked.q, strict=True))
    known = inverse.values_at({sympy.Symbol(k): float(x) for k, x in looked.parameters.items()}, q, ArrayDomain)
    with np.errstate(all="ignore"):
        for line in lines:
            known[line.symbol] = array_value(line.value, known)
    return np.stack([np.broadcast_to(known.get(symbol, own), own.shape) for symbol, own in q.items()])


def test_solutions_are_told_apart_wherever_rounding_puts_them() -> None:
    looked = postures(PLANAR, planar_graph())
    assert looked.names == ("elbow down", "elbow up")
    turned = [np.where(np.arange(LOOKED_AT) < 20, a, b) for a, b in (looked.branches, looked.branches[::-1])]
    assert looked.places(turned) == [1, 0]
    assert looked.places(looked.branches) == [0, 1]


def test_an_arm_with_one_solution_has_no_names_and_branches_that_do_not_exist_no_warning() -> None:
    inverse = inverse_kinematics(catalogue("spherical-arm"), catalogue("spherical-arm").style)
    assert postures(inverse.robot, inverse.graph).names == ("",)
    assert [solution.name for solution in inverse.solutions] == [""]
    robot = random_arm("5dof", 2).robot()
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        assert len(postures(robot, solve(robot)).branches) > 1


NUMBERS = {"a1": 0.5, "a2": 0.4, "a3": 0.3, "d3": 0.15, "d4": 0.4, "d2": 0.15, "d6": 0.1}


def looked_at(robot: Robot, q: list[float]) -> Placed:
    chain = build_chain(replace(robot, links=(), gravity=None), FloatDomain(robot, q, NUMBERS))
    return placed(chain, q, 1)[0]


def words(robot: Robot, q: list[float]) -> set[str | None]:
    return set(Shape(robot, looked_at(robot, [0.3] * robot.n), np.array([0.0, 0.0, 1.0])).words(looked_at(robot, q)))


RIGHT_ANGLE = (math.pi / 4, math.pi)  # upper arm 45 degrees upwards, forearm 45 degrees downwards
PLACED = [
    ("planar", [math.pi / 4, -math.pi / 2], Word.ELBOW_UP),
    ("planar", [-math.pi / 4, math.pi / 2], Word.ELBOW_DOWN),
    ("scara-perugia", [-0.5, 1.0, 0.1, 0.0], Word.ELBOW_RIGHT),
    ("scara-perugia", [0.5, -1.0, 0.1, 0.0], Word.ELBOW_LEFT),
    ("puma560-corke", [0.0, *RIGHT_ANGLE, 0.3, 0.4, 0.5], Word.ELBOW_UP),
    ("puma560-corke", [0.0, -math.pi / 4, 0.0, 0.3, 0.4, 0.5], Word.ELBOW_DOWN),
    ("puma560-corke", [0.0, *RIGHT_ANGLE, 0.3, 0.4, 0.5], Word.WRIST),
    ("puma560-corke", [0.0, *RIGHT_ANGLE, 0.3, -0.4, 0.5], Word.WRIST_FLIPPED),
]
"""The elbow of an arm that reaches to the right is up above the line to the hand, of an articulated one above wrist
and shoulder; a SCARA has it to the left or right of that line; a wrist is flipped where its middle joint turns back."""


@pytest.mark.parametrize(("name", "q", "word"), PLACED)
def test_elbows_and_wrists_have_the_words_of_where_they_are(name: str, q: list[float], word: Word) -> None:
    assert word in words(PLANAR if name == "planar" else catalogue(name), q)


NAMES = {
    "planar-3r": {"elbow up", "elbow down"},
    "spherical-wrist": {"wrist flipped", "wrist not flipped"},
    "puma560-corke": {
        f"shoulder {shoulder}, elbow {elbow}, wrist {wrist}"
        for shoulder, elbow, wrist in product(("left", "right"), ("up", "down"), ("flipped", "not flipped"))
    },
}


@pytest.mark.parametrize("robot", NAMES)
def test_every_branch_has_a_name_of_its_own(robot: str) -> None:
    found = [solution.name for solution in Model(Robot.load(robot)).inverse.solutions]
    assert len(found) == len(set(found))
    assert set(found) == NAMES[robot]
