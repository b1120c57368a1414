"""The model against the independent recursion, angle offsets and singular angles included."""

import random
from typing import Any

import numpy as np
import pytest
import sympy

from derive.api.check import check_formula
from derive.checking import frames_file
from derive.errors import QuantityError
from derive.handouts.notation.printer import TextPrinter
from derive.handouts.render import fragment_text
from derive.lecture.sympy_conversion import columns_matrix, expression_to_sympy, frame_matrix
from derive.model.dynamic_form import only_body
from derive.model.long_chain import LongChain, nested_kinematics
from derive.model.model import Model
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot
from derive.verification.oracle import rates
from derive.verification.oracle.frames import chain_frames
from derive.verification.oracle.functions import Oracle
from derive.verification.oracle.lagrange import link_jacobians, rotor_jacobians
from tests.evaluate import evaluate
from tests.mechanics.arms import SEEDS, arm_of, assert_close
from tests.random_robots import chains, robot_text, seeds
from tests.rows import robot_of_rows


class Numbers:
    """A model with a number for everything: symbols by name, a configuration, rates and accelerations."""

    def __init__(self, robot: Robot, seed: int, contraction: str | None = None) -> None:
        rng = random.Random(seed)
        self.model = Model(robot, contraction=contraction)
        parameters = {s: rng.uniform(0.3, 1.7) for s in robot_symbols(robot) if s not in dict(robot.parameters)}
        self.oracle = Oracle.of(robot, parameters)
        self.q, self.qd, self.qdd = (np.array([rng.uniform(-2, 2) for _ in range(robot.dof)]) for _ in range(3))
        self.values: dict[str, float] = dict(parameters)
        self.values |= {name: float(expression_to_sympy(value)) for name, value in dict(robot.parameters).items()}
        rates = ((self.model.q, self.q), (self.model.qd, self.qd), (self.model.qdd, self.qdd))
        for symbols, numbers in rates:
            self.values |= {s.name: float(x) for s, x in zip(symbols, numbers, strict=True)}

    def value(self, expression: Any) -> Any:
        return evaluate(expression, self.values)

    def check(self, function: str, ours: Any, *rates: Any) -> Any:
        """The value of the oracle, which ours has to have, too."""
        expected = self.oracle.evaluate(function, self.q, *rates)
        close(self.value(ours), expected)
        return expected


def close(ours: Any, theirs: Any) -> None:
    theirs = np.asarray(theirs, dtype=float).reshape(np.shape(ours))
    scale = max(1.0, float(np.max(np.abs(theirs), initial=0.0)))
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12 * scale)


def check_kinematics(n: Numbers) -> None:
    pose, jacobian = n.check("forward_kinematics", n.model.T), n.check("jacobian", n.model.J)
    links, slopes = n.oracle.evaluate("link_transforms", n.q), rates.jacobian_hessian(n.oracle.arm, n.q)
    for i in range(1, n.model.n + 1):
        close(n.value(n.model.frame(i)), links[i - 1])
        close(n.value(n.model.hessian(i)), slopes[..., i - 1])
    if n.model.n <= 6:
        w = n.oracle.evaluate("manipulability", n.q)
        close(n.value(n.model.quantity("manipulability")) ** 2, w**2)
    turned = pose[:3, :3].T
    close(n.value(n.model.J_end), np.vstack([turned @ jacobian[:3], turned @ jacobian[3:]]))


def check_dynamics(n: Numbers) -> tuple[Any, Any]:
    """The numbers of C and tau; B, g and the energies have to be right, too."""
    model = n.model
    b, c = n.check("inertia_matrix", model.B), n.check("coriolis_matrix", model.C, n.qd)
    n.check("gravity_vector", model.g)
    close(n.value(model.energy.kinetic), n.qd @ b @ n.qd / 2)
    n.check("potential_energy", model.energy.potential)
    return c, n.check("inverse_dynamics", model.tau, n.qd, n.qdd)


def check(n: Numbers) -> None:
    check_kinematics(n)
    model = n.model
    if not model.robot.has_dynamics:
        return
    c, _ = check_dynamics(n)
    skew = n.value(model.N)
    close(skew, -skew.T)
    close(skew, n.value(model.Bdot) - 2 * c)
    frames = n.oracle.arm.base @ chain_frames(n.oracle.arm, n.q)
    coms, rotors = link_jacobians(n.oracle.arm, frames), rotor_jacobians(n.oracle.arm, frames)
    for i in range(1, model.n + 1):
        close(n.value(model.Jv_com(i)), coms[0][i - 1])
        close(n.value(model.Jw_com(i)), coms[1][i - 1])
        close(n.value(model.Jv_motor(i)), rotors[0][i - 1])


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.sweep] * (n == "human-body")) for n in chains()])
def test_every_built_in_robot_agrees_with_the_oracle(name: str) -> None:
    check(Numbers(Robot.load(name), seed=7))


@pytest.mark.parametrize("seed", seeds(60, usual=4, swept=12))
def test_closed_forms_of_random_robots_agree_with_the_oracle(seed: int) -> None:
    check(Numbers(Robot.from_text(robot_text(random.Random(seed), 1 + seed % 6)), seed))


@pytest.mark.parametrize("seed", seeds(60, usual=6, swept=20))
def test_analytic_jacobians_are_the_derivatives_of_the_angles(seed: int) -> None:
    numbers = Numbers(Robot.from_text(robot_text(random.Random(seed), 1 + seed % 3)), seed)
    model, step = numbers.model, 1e-6
    for kind, angles in (("rpy", model.rpy), ("zyz", model.euler_zyz)):
        column = 0 if kind == "rpy" else 2
        rotation = numbers.value(model.R)
        if np.hypot(rotation[0, column], rotation[1, column]) < 0.05:
            continue
        jacobian = numbers.value(model.J_analytic(kind))
        for k, symbol in enumerate(model.q):
            here = numbers.values[symbol.name]
            samples = []
            for shift in (step, -step):
                numbers.values[symbol.name] = here + shift
                samples.append(numbers.value(angles).ravel())
            numbers.values[symbol.name] = here
            change = (samples[0] - samples[1] + np.pi) % (2 * np.pi) - np.pi
            np.testing.assert_allclose(jacobian[3:, k], change / (2 * step), atol=1e-5)


WITH_LINKS = "links: [{mass: m1}, {mass: m2, com: [-l2, 0, 0]}, {mass: m3, com: [-l3, 0, 0]}]\n"


def _robot(*angles: str, convention: str = "standard", unit: str = "rad", right: str = "pi/2", more: str = "") -> Robot:
    first, second, third = angles
    rows = f"R theta: {first}, alpha: {right}, d: d1 | R theta: {second}, a: a2 | R theta: {third}, a: a3"
    return robot_of_rows(rows, f"units: {{angle: {unit}}}\n{more}", convention=convention)


def _shown(robot: Robot, name: str) -> str:
    return str(TextPrinter(robot).doprint(Model(robot).quantity(name)))


@pytest.mark.parametrize(
    ("angles", "expected"),
    [
        (("q1 + pi/4", "q2 - pi/6", "q3"), "cos(q1 + pi/4)*cos(q2 + q3 - pi/6)"),
        (("q1 + 3*pi/4", "q2", "q3"), "cos(q1 + 3*pi/4)*c23"),
        (("q1", "q2 + pi/4", "q3 + pi/4"), "-c1*s23"),
        (("q1", "q2 - pi/3", "q3 + pi/3"), "c1*c23"),
        (("q1 + pi/2", "-q2 + pi/5", "-q3"), "-s1*cos(q2 + q3 - pi/5)"),
        (("q1 + 1/5", "q2 + pi", "q3"), "-cos(q1 + 1/5)*c23"),
        (("q1 + beta", "q2 + pi/2", "q3"), "-cos(q1 + beta)*s23"),
    ],
)
def test_a_constant_that_is_no_right_angle_stays_in_the_sine(angles: tuple[str, ...], expected: str) -> None:
    assert _shown(_robot(*angles), "T[][1,1]") == expected


def test_every_quantity_takes_the_angles_of_the_table_and_zeros_of_sines_subtract_them() -> None:
    robot = _robot("q1 + pi/4", "q2 - pi/6", "q3", more=WITH_LINKS)
    assert _shown(robot, "B[2,3]") == "m3*(a3 - l3)*(a3 - l3 + a2*c3)"
    assert _shown(robot, "g[3]") == "m3*g*cos(q2 + q3 - pi/6)*(a3 - l3)"
    assert "sqrt" not in "".join(_shown(robot, name) for name in ("T", "J", "B", "C", "g", "tau", "detJ"))
    (elbow,) = (c for c in Model(robot).singularities.conditions if c.joints == (3,))
    assert [str(value) for value in elbow.values] == ["0", "pi"]
    (elbow,) = (c for c in Model(_robot("q1", "q2 + beta", "q3 - 3*pi/4")).singularities.conditions if c.joints == (3,))
    assert [str(value) for value in elbow.values] == ["3*pi/4", "-pi/4"]


@pytest.mark.parametrize("formula", ["cos(q1 + pi/4)*c23", "sqrt(2)/2*(c1 - s1)*c23", "sin(pi/4 - q1)*(c2*c3 - s2*s3)"])
def test_formulas_with_and_without_the_constant_are_the_same(formula: str) -> None:
    assert Model(_robot("q1 + pi/4", "q2", "q3")).equal("T[][1,1]", formula)


def test_what_is_printed_is_checked() -> None:
    robot = _robot("q1 + 45", "q2 - 30", "q3", unit="deg", right="90")
    assert check_formula(robot, "T[][1,4]", _shown(robot, "T[][1,4]")).outcome == "same form"
    assert "45^{\\circ}" in fragment_text(robot, robot.handout, "T[][1,1]")


@pytest.mark.parametrize("contraction", ["aligned", "opposed"])
@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize(
    "angles",
    [("q1 + pi/4", "-q2 + pi/4", "q3 - pi/4"), ("q1 - 2*pi/3", "q2 + pi/4", "q3 + pi/4"), ("-q1 + 1", "q2", "q3")],
)
def test_transforms_and_jacobians_are_the_oracle_s(angles: tuple[str, ...], convention: str, contraction: str) -> None:
    check_kinematics(Numbers(_robot(*angles, convention=convention), seed=3, contraction=contraction))


@pytest.mark.parametrize("seed", SEEDS)
def test_nested_kinematics_is_that_of_the_oracle(seed: int) -> None:
    arm = arm_of(seed)
    found = nested_kinematics(arm.chain)
    assert_close(found.end.rows(0.0, 1.0), arm.expected("forward_kinematics"))
    assert_close(np.vstack([np.array(found.linear).T, np.array(found.angular).T]), arm.expected("jacobian"))


@pytest.mark.parametrize("name", ["scara-perugia", "stanford-deluca", "puma560-corke"])
def test_nested_expressions_have_the_values_of_expanded_polynomials(name: str) -> None:
    robot = Robot.load(name)
    model = Model(robot)
    nested = LongChain(robot).kinematics
    symbols = sorted({*model.T.free_symbols, *frame_matrix(nested.end).free_symbols}, key=str)
    values = {symbol.name: 0.3 + 0.1 * k for k, symbol in enumerate(symbols)}
    assert_close(evaluate(frame_matrix(nested.end), values), evaluate(model.T, values))
    assert_close(evaluate(columns_matrix(nested.linear, nested.angular), values), evaluate(model.J, values))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_inertia_matrix_is_the_sum_over_links_and_rotors(seed: int) -> None:
    arm = arm_of(seed)
    values = parameter_values(arm.robot)
    total = np.diag([to_float(link.armature, values) for link in arm.robot.links])
    for i in range(1, arm.robot.n + 1):
        for part in (only_body(arm.robot, i, of_rotor=False), only_body(arm.robot, i, of_rotor=True)):
            total = total + Oracle.of(part).evaluate("inertia_matrix", arm.q)
    assert_close(total, arm.expected("inertia_matrix"))


VALUES = {"q1": 0.3, "q2": -0.8, "q3": 0.5, "q4": 1.1, "q5": -0.7, "q6": 0.2}
VALUES |= {"a1": 1.0, "a2": 1.0, "a3": 1.0, "d4": 0.2}


def rotation(axis: str, angle: float) -> np.ndarray:
    return np.array(frames_file.rotation(axis, angle)[:3, :3].tolist(), dtype=float)


@pytest.mark.parametrize("name", ["planar-3r", "scara-perugia", "spherical-wrist", "spherical-arm"])
def test_euler_angles_of_short_arms_give_the_rotation_without_the_root_of_a_square(name: str) -> None:
    model = Model(Robot.load(name))
    assert "sqrt" not in str(model.euler_zyz)
    phi, theta, psi = evaluate(model.euler_zyz, VALUES).ravel()
    product = rotation("z", phi) @ rotation("y", theta) @ rotation("z", psi)
    np.testing.assert_allclose(product, evaluate(model.R, VALUES), atol=1e-12)


def test_roll_pitch_yaw_with_the_pitch_fixed_at_a_right_angle_give_the_rotation() -> None:
    model = Model(robot_of_rows("P", "base: [[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]"))
    roll, pitch, yaw = (float(sympy.N(x)) for x in model.rpy)
    product = rotation("z", yaw) @ rotation("y", pitch) @ rotation("x", roll)
    np.testing.assert_allclose(product, np.array(model.R.tolist(), dtype=float), atol=1e-12)


def test_the_analytic_jacobian_of_a_planar_arm_is_refused_for_zyz_and_given_for_rpy() -> None:
    model = Model(Robot.load("planar-3r"))
    with pytest.raises(QuantityError, match="singular in every configuration"):
        model.J_analytic("zyz")
    assert model.J_analytic("rpy")[5, :] == sympy.ones(1, 3)


def test_the_manipulability_of_one_joint_is_the_length_of_its_link() -> None:
    assert str(Model(robot_of_rows("R a: a1")).quantity("manipulability")) == "Abs(a1)"
