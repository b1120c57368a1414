"""The recursions that derive is compared with are right, for any arm."""

import numpy as np
import pytest

from bench.operations import _row
from bench.peers import casadi_by_hand, sympy_by_hand
from bench.peers.peer import Peer
from bench.plain_arm import plain_arm
from bench.quantities import QUANTITIES, arguments, relative_error
from bench.robots import COUNTED, Case, load
from bench.urdf import roll_pitch_yaw
from tests.exchange.urdfs import turned
from tests.rows import robot_of_rows

ROWS = (
    "R d: 0.1 | P a: 0.2, alpha: pi/3, theta: 0.4 | R a: a3, alpha: -pi/2, d: 0.3"
    "| R a: 0.1, alpha: 0.7, theta: q4 + 0.2"
)
BODIES = """
gravity: [1.5, -2, -9]
links:
  - {mass: 1.1, com: [0.1, 0.2, 0.3], inertia: {xx: 0.4, yy: 0.5, zz: 0.6, xy: 0.01, xz: 0.02, yz: 0.03}}
  - {mass: m2, com: [0.3, 0.1, -0.1], inertia: {xx: 0.3, yy: 0.35, zz: 0.2, xy: 0.02}}
  - {mass: 0.7, com: [-0.2, 0.1, c3], inertia: {xx: 0.1, yy: 0.15, zz: 0.12, yz: 0.03}}
  - {mass: 0.4, com: [0.1, 0.1, 0.1], inertia: {xx: 0.05, yy: I4, zz: 0.06}}
"""


def mixed() -> Case:
    robot = robot_of_rows(ROWS, BODIES, name="mixed", convention="modified")
    return Case("mixed", robot, {"a3": 0.3, "m2": 1.2, "c3": 0.4, "I4": 0.07})


@pytest.mark.parametrize("peer", [casadi_by_hand.PLAIN, casadi_by_hand.BASE], ids=lambda peer: peer.name)
def test_every_quantity_of_any_arm_is_right(peer: Peer) -> None:
    row = _row(peer, mixed())
    assert list(sorted(row)) == sorted(quantity.symbol for quantity in QUANTITIES)
    assert not [cell for cell in row.values() if "failed" in cell]


def test_sympy_by_hand_is_right_and_base_parameters_save_operations() -> None:
    row = _row(sympy_by_hand.PEER, load("planar-2r-symbolic"))
    assert row["tau"]["error"] < 1e-12
    assert row["g"]["error"] < 1e-12
    case = load("stanford-numeric")
    plain, base = (_row(peer, case) for peer in (casadi_by_hand.PLAIN, casadi_by_hand.BASE))
    assert base["tau"]["arithmetic"] < 0.7 * plain["tau"]["arithmetic"]


def test_a_wrong_result_is_not_reported() -> None:
    case = load("planar-2r-numeric")
    motions = case.motions(2)
    for quantity in QUANTITIES:
        right = case.oracle.evaluate(quantity.function, *arguments(quantity, motions))
        assert relative_error(case, quantity, motions, right) < 1e-14
        assert relative_error(case, quantity, motions, right + 1e-3) > 1e-6
        assert relative_error(case, quantity, motions, right[..., :1]) == float("inf")


@pytest.mark.parametrize("name", COUNTED)
def test_every_robot_of_the_harness_loads(name: str) -> None:
    case = load(name)
    assert case.robot.name == name
    assert case.oracle.arm.n == case.robot.n


def test_angles_of_urdf_give_the_placement_back() -> None:
    for joint in plain_arm(mixed()).joints:
        roll, pitch, yaw = roll_pitch_yaw(joint.placement)
        found = turned(2, yaw) @ turned(1, pitch) @ turned(0, roll)
        np.testing.assert_allclose(found, joint.placement[:3, :3], atol=1e-15)
