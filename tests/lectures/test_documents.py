"""Documents 001 and 004: matrices of the skeleton slide by slide, and what follows from the simulation's numbers."""

from dataclasses import replace
from math import prod

import numpy as np
import pytest
from sympy import Expr, Matrix, Symbol, cos, exp, eye, sin, symbols

from derive.model.kinematic_model import KinematicModel
from derive.model.model import Model
from derive.motion.motion import Motion
from derive.motion.torques.functions import Functions
from derive.robot.expression import Power, Product
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle

l0, l1, Tx, Ty = symbols("l0 l1 Tx Ty")
beta, alpha = symbols("q1 q2")

ORIGIN = Matrix([0, 0, 0, 1])


def turned(angle: Symbol) -> Matrix:
    """The document's rotation, clockwise seen from +z."""
    return Matrix([[cos(angle), sin(angle), 0, 0], [-sin(angle), cos(angle), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def shifted(x: object, y: object = 0) -> Matrix:
    found = eye(4)
    found[0, 3], found[1, 3] = x, y
    return found


FACTORS = [shifted(Tx, Ty), turned(beta), shifted(l0), turned(alpha), shifted(l1)]
"""From the root to the hand, as slides 6 to 10 collect them from the hand to the root."""


@pytest.fixture(scope="module")
def model() -> Model:
    return Model(Robot.load("skeleton"))


@pytest.fixture(scope="module")
def modified() -> Model:
    """The same chain as slide 17 writes its matrices: first the link, then the turn."""
    return Model(Robot.load("skeleton-modified"))


def vanishes(expression: Expr) -> bool:
    """Decided: exponentials of sums of angles are independent."""
    return bool(expression.rewrite(exp).expand() == 0)


def equal(ours: Matrix, theirs: Matrix) -> bool:
    return ours.shape == theirs.shape and all(map(vanishes, ours - theirs))


def test_slides_6_to_10_the_end_point_grows_factor_by_factor(model: Model, modified: Model) -> None:
    both = alpha + beta
    printed = {
        6: (1, (l1, 0)),
        7: (2, (l1 * cos(alpha), -l1 * sin(alpha))),
        8: (3, (l1 * cos(alpha) + l0, -l1 * sin(alpha))),
        9: (4, (l1 * cos(both) + l0 * cos(beta), -l1 * sin(both) - l0 * sin(beta))),
        10: (5, (l1 * cos(both) + l0 * cos(beta) + Tx, -l1 * sin(both) - l0 * sin(beta) + Ty)),
    }
    for slide, (count, place) in printed.items():
        assert equal(prod(FACTORS[-count:], start=eye(4)) * ORIGIN, Matrix([*place, 0, 1])), slide
    assert equal(model.A(2) * ORIGIN, Matrix([*printed[7][1], 0, 1]))
    assert equal((model.A(1) * model.A(2)) * ORIGIN, Matrix([*printed[9][1], 0, 1]))
    assert equal(model.T, prod(FACTORS, start=eye(4)))
    assert equal(modified.T, model.T)


def test_slide_17_the_planar_matrix_is_a_row_of_a_modified_table(modified: Model) -> None:
    assert equal(modified.A(2), shifted(l0) * turned(alpha))
    assert equal(modified.A(1), turned(beta))


def test_slides_18_and_19_the_product_as_printed_is_not_the_initial_transform(model: Model) -> None:
    """'verificare che risulta la trasformazione iniziale': with the printed columns (l, 0, 0) it does not."""
    printed = [shifted(l0) * turned(beta), shifted(l1) * turned(alpha)]
    found = shifted(Tx, Ty) * printed[0] * printed[1] * ORIGIN
    assert equal(found, Matrix([Tx + l0 + l1 * cos(beta), Ty - l1 * sin(beta), 0, 1]))
    assert not equal(found, model.T * ORIGIN)
    corrected = [turned(beta) * shifted(l0), turned(alpha) * shifted(l1)]
    assert equal(shifted(Tx, Ty) * corrected[0] * corrected[1], model.T)
    assert [equal(ours, model.A(k)) for k, ours in enumerate(corrected, start=1)] == [True, True]


@pytest.fixture(scope="module")
def motion() -> Motion:
    return Motion.load("scara-pick-and-place")


@pytest.fixture(scope="module")
def diagonal(motion: Motion) -> Oracle:
    """The robot with rotors as the Robotics Toolbox has them: G^2 Jm on the diagonal of B, and nothing else."""
    links = []
    for link in motion.plan.robot.links:
        reflected = Product((Power(link.motor.ratio, 2), link.motor.inertia))
        links.append(replace(link, motor=None, armature=reflected))
    return Oracle.of(replace(motion.plan.robot, links=tuple(links)))


def test_inertia_matrix_at_rest(motion: Motion, diagonal: Oracle) -> None:
    """B11 = 273.530, B22 = 51.0303, B12 = 101.7273 with rotors that couple, 101.7055 without."""
    rest = np.array([0.0, 0.0, 1.0, 0.0])
    functions = Functions(motion.plan.robot, frozenset({"inertia_matrix"}), motion.values)
    coupled, plain = functions("inertia_matrix", rest), diagonal.evaluate("inertia_matrix", rest)
    assert coupled == pytest.approx(Oracle.of(motion.plan.robot).evaluate("inertia_matrix", rest), rel=1e-12, abs=1e-12)
    exact = Model(motion.plan.robot).at("B", [0, 0, 1, 0], exact=True)
    assert coupled == pytest.approx(np.array(exact.tolist(), dtype=float), rel=1e-12, abs=1e-12)
    assert (round(coupled[0, 0], 3), round(coupled[0, 1], 4)) == (273.530, 101.7273)
    assert (round(plain[0, 0], 3), round(plain[1, 1], 4), round(plain[0, 1], 4)) == (273.530, 51.0303, 101.7055)
    rotors_behind = 0.0002 + 0.000033
    assert coupled[1, 1] - plain[1, 1] == pytest.approx(rotors_behind, rel=1e-9)


@pytest.mark.parametrize(
    ("segment", "joint", "peak", "coupled", "time"),
    [
        (0, 0, 376.817, 376.839, 0.62),
        (0, 1, 159.052, 159.074, 0.66),
        (1, 2, -70.9426, -70.9426, 2.49),
        (2, 2, -75.4014, -75.4014, 0.78),
        (3, 0, 101.271, 101.293, 2.39),
        (3, 1, -55.791, -55.791, 0.68),
        (4, 2, -70.9426, -70.9426, 2.49),
    ],
)
def test_peak_torques_with_rotors_of_the_toolbox_and_of_the_notes(
    motion: Motion, diagonal: Oracle, segment: int, joint: int, peak: float, coupled: float, time: float
) -> None:
    local = np.arange(301) / 100
    states = motion(np.minimum(3 * segment + local, np.nextafter(3 * segment + 3, 0)))
    digits = len(str(peak).split(".")[1])
    for oracle, said in ((diagonal, peak), (Oracle.of(motion.plan.robot), coupled)):
        tau = oracle.evaluate("inverse_dynamics", *states)[:, joint]
        at = int(np.abs(tau).argmax())
        assert (round(float(tau[at]), digits), local[at]) == (said, pytest.approx(time))


def test_figure_14_is_a_disc_of_radius_4(motion: Motion) -> None:
    """The square of the distance from the axis is 8 + 8 cos theta2: all from 0 to 16, in any direction."""
    x, y, _ = KinematicModel(motion.plan.robot).p
    q2, a1, a2 = symbols("q2 a1 a2")
    square = (x**2 + y**2).expand(trig=True).subs({a1: 2, a2: 2}) - (8 + 8 * cos(q2))
    assert square.rewrite(exp).expand() == 0


@pytest.mark.sweep
def test_figure_14_is_what_the_inverse_kinematics_says(motion: Motion) -> None:
    (bound,) = Model(motion.plan.robot).workspace.bounds
    px, py, a1, a2 = symbols("px py a1 a2")
    assert (bound.quantity, bound.least) == (px**2 + py**2, None)
    assert bound.most.subs({a1: 2, a2: 2}) == 16
