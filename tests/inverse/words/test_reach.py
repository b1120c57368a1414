"""What an arm reaches, read off the square roots of its inverse kinematics, against poses that it does reach."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy

from derive.inverse.numeric.chain import NumericChain
from derive.inverse.words.reach import Reach
from derive.model.model import Model
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

CONVENTION = "name: arm\nconvention: standard\njoints: "
OFFSET = "[{alpha: pi/2, a: a1}, {a: a2}, {a: a3}]"
ORTHOGONAL = "[{a: 1, alpha: -pi/2}, {d: 1, a: 2, alpha: pi/2}, {a: 1.5}]"


@cache
def reach_of(robot: Robot) -> Reach:
    """The workspace of a robot."""
    return Model(robot).workspace


@cache
def catalogue(name: str) -> Robot:
    """A robot of the catalogue."""
    return Robot.load(name)


def three(rows: str) -> Robot:
    """An arm of three joints that turn."""
    return Robot.from_text(CONVENTION + rows.replace("{", "{type: revolute, "))


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
    assert hollow.least is not None
    assert hollow.most is not None
    assert sympy.expand(hollow.least - (a2 - forearm) ** 2 - d3**2) == 0
    assert sympy.expand(hollow.most - (a2 + forearm) ** 2 - d3**2) == 0


def test_an_offset_of_the_shoulder_makes_tori() -> None:
    found = reach_of(three(OFFSET))
    (bound,) = found.bounds
    pz, rho, a1, a2, a3 = sympy.symbols("pz rho a1 a2 a3")
    assert sympy.expand(bound.quantity - (rho - a1) ** 2 - pz**2) == 0
    assert bound.radii == (sympy.Abs(a2 - a3), a2 + a3)
    assert [str(line.symbol) for line in found.names] == ["rho"]


def test_a_quartic_leaves_no_bound_of_the_position() -> None:
    found = reach_of(three(ORTHOGONAL))
    assert found.bounds == ()
    assert not found.is_whole


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
    robot = Robot.load("anthropomorphic-arm")
    found = reach_of(robot)
    values = {"a2": 0.7, "a3": 0.4}
    poses = np.tile(np.eye(4), (4, 1, 1))
    poses[:, 0, 3] = 0.299, 0.301, 1.099, 1.101
    (margins,) = found.margins(poses, values)
    assert np.min(margins, axis=0).tolist() == pytest.approx(
        [0.299**2 - 0.09, 0.301**2 - 0.09, 1.21 - 1.099**2, 1.21 - 1.101**2]
    )


def test_numbers_of_bounds_are_those_of_the_file() -> None:
    found = reach_of(catalogue("puma560-corke"))
    numbers = found.numbers(found.bounds[1])
    assert numbers is not None
    assert [float(number) for number in numbers if number is not None] == pytest.approx([0.150051, 0.877008], abs=1e-6)
    planar = reach_of(catalogue("planar-2r-perugia"))
    assert planar.numbers(planar.bounds[0]) is None


def test_a_slide_that_is_found_before_bounds_no_place() -> None:
    """Where q1 is real depends on q3 there, which the pose tells; a comparison with its sign ended in a fault."""
    rows = "[{type: revolute, d: d1}, {type: revolute, alpha: pi/2}, {type: prismatic, a: a2, alpha: pi/4}]"
    found = reach_of(Robot.from_text("name: arm\nconvention: modified\njoints: " + rows))
    assert [str(bound.least) for bound in found.bounds] == ["a2**2"]
    assert sympy.Symbol("q1") in found.others
