"""Base parameters, exactly."""

import math
import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from operator import mul, truediv

import numpy as np
import numpy.typing as npt
import pytest
from flint import fmpq

from derive.algebra.domain import polynomial_expression
from derive.algebra.quotients import Quotient
from derive.errors import ExpressionError, Location
from derive.mechanics.chain import build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.regressor import Regressor, with_unit_rotors
from derive.mechanics.space import exactly
from derive.model.identification.base_parameters import base_set, base_values, standard_values
from derive.model.identification.exact_scalars import ExactDomain, as_fraction, is_zero, null_space
from derive.model.identification.unit_dynamics import UnitDynamics
from derive.model.identification.witness import WIDTH, bare_chain, combined, directions, fixing
from derive.robot.evaluate import to_float
from derive.robot.expression import Expression
from derive.robot.inertial_parameters import LINK_PARTS, Parameter, standard_parameters
from derive.robot.names import robot_symbols
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.mechanics.arms import SEEDS, arm_of, assert_close
from tests.places import ROOT
from tests.random_robots import catalogue, random_robot, seeds
from tests.rows import robot_of_rows

BENCH = ROOT / "bench" / "robots"
LINK = "{mass: m, com: [x, y, z], inertia: {xx: a, yy: b, zz: c, xy: d, xz: e, yz: f}}"

Array = npt.NDArray[np.float64]


def names(robot: Robot) -> list[str]:
    return [parameter.name for parameter in base_set(robot).parameters]


def arm(
    rows: str, gravity: str = "[0, 0, -9.81]", convention: str = "modified", link: str = LINK, more: str = ""
) -> Robot:
    links = "links:\n" + f"  - {link}\n" * (rows.count("|") + 1)
    gravity = f"gravity: {gravity}\n" if gravity else ""
    return robot_of_rows(rows, f"{gravity}{links}{more}", convention=convention)


def torque_errors(robot: Robot, values: dict[str, float], seed: int) -> tuple[float, float]:
    """Relative errors of the torques from standard and from base parameters, in floats."""
    q, qd, qdd = np.random.default_rng(seed).uniform(-1.5, 1.5, (3, robot.n))
    domain = FloatDomain(robot, list(q))
    domain.values.update(values)
    base, standard = base_set(robot), standard_parameters(robot)
    wanted = Oracle.of(robot, values).evaluate("inverse_dynamics", q, qd, qdd)
    chain = build_chain(with_unit_rotors(robot), domain)

    def error(parameters: tuple[Parameter, ...], values: list[float], ends: bool) -> float:
        rows = Regressor(chain, list(qd), list(qdd), ends=ends, sign=lambda x: float(np.sign(x))).rows(parameters)
        return float(np.abs(np.array(rows) @ values - wanted).max() / np.abs(wanted).max())

    def number(c: Quotient) -> float:
        parts = (polynomial_expression(p, base.domain) for p in (c.numerator, c.denominator))
        return truediv(*(to_float(part, domain.values) for part in parts))

    grouped = base_values(robot, base, domain, number)
    return error(standard, standard_values(robot, standard, domain), True), error(base.parameters, grouped, False)


@pytest.mark.parametrize("seed", seeds(200, 21, 200))
def test_torques_of_random_robots_agree_with_the_oracle(seed: int) -> None:
    drawn = random_robot(random.Random(seed), 1 + seed % 7)
    assert max(torque_errors(Robot.from_text(drawn.text), drawn.values, seed)) < 1e-12


@pytest.mark.parametrize(
    "robot", [r for r in catalogue().values() if r.has_dynamics and not r.coupled], ids=lambda robot: robot.name
)
def test_torques_of_the_catalogue_agree_with_the_oracle(robot: Robot) -> None:
    rng = random.Random(robot.name)
    for seed in range(5):
        values = {name: rng.uniform(0.3, 1.7) for name in robot_symbols(robot) if name not in dict(robot.parameters)}
        assert max(torque_errors(robot, values, seed)) < 1e-12


@pytest.mark.parametrize("seed", SEEDS)
def test_inertia_and_gravity_are_sums_over_unit_parameters(seed: int) -> None:
    arm = arm_of(seed)
    units = UnitDynamics(arm.chain_of(with_unit_rotors(arm.robot)), ends=True)
    n, parameters = arm.robot.n, standard_parameters(arm.robot)
    inertia, gravity = np.zeros((n, n)), np.zeros(n)
    values = standard_values(arm.robot, parameters, FloatDomain(arm.robot, arm.q.tolist()))
    for parameter, value in zip(parameters, values, strict=True):
        for place, entry in units.inertia(parameter).items():
            inertia[place] += value * entry
        for i, torque in units.gravity(parameter).items():
            gravity[i] += value * torque
    assert_close(inertia + np.triu(inertia, 1).T, arm.expected("inertia_matrix"))
    assert_close(gravity, arm.expected("gravity_vector"))


def rank(robot: Robot, values: dict[str, float]) -> tuple[int, int]:
    """Ranks of the standard regressor and of it with the base regressor, over random motions, in floats."""
    oracle = Oracle.of(robot, values, base_set(robot).parameters)
    states = np.random.default_rng(7).uniform(-2.0, 2.0, (3, 40, robot.n))
    standard, base = (oracle.evaluate(name, *states) for name in ("regressor", "base_regressor"))
    return _rank(standard), _rank(np.concatenate([standard, base], axis=-1))


def _rank(columns: Array) -> int:
    matrix = columns.reshape(-1, columns.shape[-1])
    size = np.abs(matrix).max(axis=0)
    return int(np.linalg.matrix_rank(matrix / np.where(size > 1e-12 * size.max(), size, 1.0), tol=1e-8))


@pytest.mark.parametrize("seed", range(16))
def test_there_are_as_many_as_the_rank_of_the_regressor(seed: int) -> None:
    drawn = random_robot(random.Random(seed), 1 + seed % 6)
    robot = Robot.from_text(drawn.text)
    base = base_set(robot)
    assert base.proven
    assert rank(robot, drawn.values) == (len(base.parameters), len(base.parameters))


@pytest.mark.parametrize(
    ("name", "count"), [("puma560-symbolic", 36), ("rx90-symbolic", 36), ("arm-7r-symbolic", 43), ("scara-symbolic", 8)]
)
def test_known_arms_have_the_known_number(name: str, count: int) -> None:
    base = base_set(Robot.load(BENCH / f"{name}.yaml"))
    assert base.proven
    assert len(base.parameters) == count


PARALLEL = "R | R a: l1 | R a: l2"


@pytest.mark.parametrize(
    ("gravity", "first"),
    [("[0, -g, 0]", ["mx1", "my1", "Izz1"]), ("[0, 0, -g]", ["Izz1"]), ("", ["Izz1"]), ("[0, 0, 0]", ["Izz1"])],
)
def test_gravity_along_parallel_axes_or_none_takes_first_moments_away(gravity: str, first: list[str]) -> None:
    rest = ["mx2", "my2", "Izz2", "mx3", "my3", "Izz3"]
    assert names(arm(PARALLEL, gravity)) == first + rest


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_a_joint_across_the_first_one_shows_all_seven_and_slides_alone_show_masses_alone(convention: str) -> None:
    seven = ["mx2", "my2", "Ixx2", "Izz2", "Ixy2", "Ixz2", "Iyz2"]
    assert names(arm("R alpha: pi/2 | R alpha: pi/2", convention=convention))[-7:] == seven
    assert names(arm("P | P alpha: pi/2 | P alpha: al", convention=convention)) == ["m1", "m2", "m3"]


def test_a_link_that_slides_at_an_angle_has_two_first_moments() -> None:
    """Of the moment along the axis of joint 1 no torque tells; it is divided among the others by a tangent."""
    base = base_set(arm("R | P alpha: al", gravity=""))
    assert [p.name for p in base.parameters] == ["Izz1", "m2", "mx2", "my2"]
    (relation,) = [r for r in base.relations if r.parameter.name == "mz2"]
    assert [(p.name, not c.denominator.is_constant) for p, c in relation.terms] == [("my2", True)]


def test_rotors_beside_armatures_are_no_parameters_of_their_own_and_friction_always_is_one() -> None:
    link = LINK.replace("{mass", "{motor: {mass: mm, inertia: Im, ratio: k}, armature: Ia, mass")
    found = names(arm("R | R alpha: al", link=link))
    assert "Ia2" in found
    assert not {"Im1", "Im2", "mm1", "mm2", "Ia1"} & set(found)
    link = LINK.replace("{mass", "{friction: {viscous: b, coulomb: f}, mass")
    assert {"b1", "f1", "b2", "f2"} <= set(names(arm("R | R", link=link)))


def test_numbers_decide_where_they_are_given() -> None:
    generic = arm("R | R alpha: al, a: l", "[0, -9.81, 0]")
    parallel = arm("R | R alpha: al", "[0, -9.81, 0]", more="parameters: {al: 0}\n")
    assert "Ixx2" in names(generic)
    assert names(parallel) == ["mx1", "my1", "Izz1", "mx2", "my2", "Izz2"]


@pytest.mark.parametrize("make", [lambda: Robot.load("scara-perugia"), lambda: arm(PARALLEL)])
def test_the_set_does_not_depend_on_the_order_of_calls(make: Callable[[], Robot]) -> None:
    first = base_set(make())
    base_set.cache_clear()
    second = base_set(make())
    assert first.parameters == second.parameters
    assert [r.parameter for r in first.relations] == [r.parameter for r in second.relations]


def cell(text: str) -> Expression:
    return parse_expression(text, Location("cell"))


def test_rational_cells_and_cosines_stay_rational_and_others_are_enclosed() -> None:
    with exactly():
        domain = ExactDomain(Robot.load("puma560-corke"))
        product = domain.constant(cell("a2*a3 - 0.4318**2/2"))
        assert isinstance(product, fmpq)
        assert as_fraction(product) == Fraction("0.4318") * Fraction("0.0203") - Fraction("0.4318") ** 2 / 2
        for text, value in (("sqrt(2)*pi", math.sqrt(2) * math.pi), ("sin(1/3)", math.sin(1 / 3))):
            found = domain.constant(cell(text))
            assert not isinstance(found, fmpq)
            assert abs(float(found) - value) < 1e-15
        assert is_zero(domain.constant(cell("sin(pi)")))
        with pytest.raises(ExpressionError):
            domain.constant(cell("1/sin(pi)"))
        cosine, sine = domain.cosine_sine(cell("-3*pi/2"))
        assert isinstance(cosine, fmpq)
        assert (cosine, sine) == (0, 1)
        cosine, sine = domain.cosine_sine(cell("pi/3"))
        assert not isinstance(cosine, fmpq)
        assert cosine.overlaps(domain.number(Fraction(1, 2)) + 0 * cosine)


def test_symbols_without_numbers_are_named() -> None:
    robot = Robot.load("puma560-corke")
    with pytest.raises(ExpressionError, match="no number for a2, d3, d4, g"):
        ExactDomain(replace(robot, parameters=tuple(pair for pair in robot.parameters if pair[0] == "a3")))


def test_the_null_space_is_what_all_rows_send_to_zero() -> None:
    with exactly():
        domain = ExactDomain(Robot.load("puma560-corke"))
        root = domain.constant(cell("sqrt(2)"))
        rows = [[domain.number(k) for k in (1, 2, 3)] + [root], [domain.number(k) for k in (2, 4, 6)] + [2 * root]]
        basis = null_space(rows, 4)
        assert set(basis) == {1, 2, 3}
        assert all(is_zero(sum(map(mul, row, vector))) for row in rows for vector in basis.values())


@pytest.mark.parametrize("name", ["puma560-corke", "scara-matlab"])
def test_no_torque_notices_any_direction_and_there_are_no_more(name: str) -> None:
    robot = Robot.load(name)
    with exactly():
        domain = ExactDomain(robot)
        basis = directions(robot, bare_chain(robot, domain), domain)
        matrix = np.array([[float(entry) for entry in direction] for direction in basis])
    # the oracle's columns in joint frames: any link parameter may be asked for as if it were a base parameter
    columns = tuple(Parameter(i, part) for i in range(1, robot.n + 1) for part in LINK_PARTS)
    q, qd, qdd = np.random.default_rng(1).uniform(-2, 2, (3, 60, robot.n))
    regressor = Oracle.of(robot, base=columns).evaluate("base_regressor", q, qd, qdd).reshape(-1, len(columns))
    assert np.abs(regressor @ matrix.T).max() <= 1e-12 * np.abs(regressor).max()
    rank = np.linalg.matrix_rank(regressor, tol=1e-9 * np.abs(regressor).max())
    assert np.linalg.matrix_rank(matrix) == len(matrix) == len(columns) - rank
    assert rank <= len(base_set(robot).parameters)


def test_links_that_are_to_stay_do_not_change() -> None:
    robot = Robot.load("puma560-corke")
    with exactly():
        domain = ExactDomain(robot)
        basis = directions(robot, bare_chain(robot, domain), domain)
        fewer = fixing(basis, [WIDTH * i + k for i in (1, 3) for k in range(WIDTH)])
        assert 0 < len(fewer) < len(basis)
        for direction in fewer:
            assert all(is_zero(direction[WIDTH * i + k]) for i in (1, 3) for k in range(WIDTH))
        total = combined(fewer, [domain.number(k) for k in range(len(fewer))])
        assert all(total[k] == sum(w * d[k] for w, d in enumerate(fewer)) for k in range(len(total)))
