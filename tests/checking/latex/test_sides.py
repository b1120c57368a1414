"""What the sides of an equation say, and quantities that pages print beside those of the registry."""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from derive.checking.latex.matrix_names import MatrixNames
from derive.checking.latex.pieces import LatexPiece
from derive.checking.latex.quantities import OWN, own_quantity, slope, written
from derive.checking.latex.scope import Scope
from derive.errors import Location
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.model.model import Model
from derive.robot.description import Convention
from derive.robot.expression import ZERO
from derive.robot.robot import Robot
from tests.rows import robot_of_rows

ARM = Model(Robot.load("anthropomorphic-arm"))
Q = {"q1": 0.3, "q2": -0.7, "q3": 1.1}
RATES = {"qd1": 0.4, "qd2": 0.9, "qd3": -0.6}


def numbers(value: sympy.Matrix, q: dict[str, float]) -> np.ndarray:
    free = {name: 0.2 + 0.1 * k for k, name in enumerate(sorted(map(str, value.free_symbols)))}
    return np.array(value.subs(free | RATES | q), dtype=float)


BODIES = """
gravity: [0, g, -g]
links:
  - {mass: m1, com: [x1, 0, z1], inertia: {xx: A1, yy: B1, zz: C1, xy: D1}}
  - {mass: m2, com: [x2, y2, 0], inertia: {xx: A2, yy: B2, zz: C2, yz: D2}}
  - {mass: m3, com: [0, y3, z3], inertia: {xx: A3, yy: B3, zz: C3, xz: D3}}
"""
RPR = robot_of_rows("R d: d1 | P alpha: pi/3, a: a1 | R alpha: -pi/2, a: a2", BODIES, convention="modified")


@pytest.mark.first(1)
@pytest.mark.parametrize("robot", [Robot.load("scara-perugia"), RPR], ids=["scara", "rpr"])
def test_the_moment_on_a_link_along_its_joint_is_the_torque_of_the_joint(robot: Robot) -> None:
    bodies = tuple(replace(link, motor=None, armature=ZERO, viscous=ZERO, coulomb=ZERO) for link in robot.links)
    model = Model(replace(robot, links=bodies))
    for i, joint in enumerate(model.robot.joints, 1):
        frame = i if model.robot.convention is Convention.MODIFIED else i - 1
        kind = "joint_moment" if joint.is_revolute else "joint_force"
        axis = model.frame(frame)[:3, 2]
        torque = sympy.Matrix([(axis.T * own_quantity(model, f"{kind}[{i},0]"))[0, 0], model.quantity("tau")[i - 1]])
        assert np.isclose(*numbers(torque, {}).ravel())


def test_turns_about_axes_are_those_of_their_skew_matrices() -> None:
    scope = Scope(ARM, "$$ T = 1 $$", Location("page"), document=True)
    found = MatrixNames(scope.meanings, scope.reader(0))
    for axis, k in (("x", 0), ("y", 1), ("z", 2)):
        tables = list(found.values(LatexPiece(rf"R_{axis}(\theta_1)", 0)))
        turn = next(table for table in tables if table.shape == (3, 3))
        printed = sympy.Matrix(3, 3, [expression_to_sympy(entry.formula) for entry in turn.entries])
        skew = np.array([[-int(sympy.LeviCivita(k, i, j)) for j in range(3)] for i in range(3)])
        rodrigues = np.eye(3) + np.sin(Q["q1"]) * skew + (1 - np.cos(Q["q1"])) * skew @ skew
        assert np.allclose(numbers(printed, Q), rodrigues)


def test_velocities_are_what_differences_of_positions_give() -> None:
    step = 1e-6
    later = {name: value + step * RATES[name.replace("q", "qd")] for name, value in Q.items()}
    values = [numbers(ARM.quantity("p"), q) for q in (Q, later)]
    assert np.allclose((values[1] - values[0]) / step, numbers(slope(ARM.robot, ARM.quantity("p"), "t"), Q), atol=1e-5)
    assert np.allclose(numbers(own_quantity(ARM, "twist"), Q)[:3], numbers(slope(ARM.robot, ARM.quantity("p"), "t"), Q))
    # the angular velocity by dR/dt R^T
    turn = ARM.quantity("T")[:3, :3]
    spin = numbers(slope(ARM.robot, turn, "t"), Q) @ numbers(turn, Q).T
    assert np.allclose(numbers(own_quantity(ARM, "omega[3,0]"), Q).ravel(), [spin[2, 1], spin[0, 2], spin[1, 0]])
    assert {"twist", "omega"} <= {*OWN}


@pytest.mark.parametrize("name", ["qd4", "T"])
def test_names_that_poses_do_not_have_are_written_as_they_stand(name: str) -> None:
    symbol = sympy.Symbol(name, real=True)
    assert written(Model(Robot.load("scara-perugia")), 2 * symbol) == 2 * symbol
