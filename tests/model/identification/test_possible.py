"""Bodies that exist and move as the given ones, by the oracle and by MuJoCo; proofs that there are none."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.mechanics.space import exactly
from derive.model.identification import possible
from derive.model.identification.base_parameters import parameters_of
from derive.model.identification.exact_scalars import ExactDomain, as_fraction
from derive.model.identification.semidefinite import Cone, Limit, least, packed, unpacked
from derive.model.identification.witness import NoSuchBodies, bare_chain, combined, directions
from derive.robot.description import Inertia, Link
from derive.robot.evaluate import to_float
from derive.robot.expression import ZERO, number
from derive.robot.inertial_parameters import LINK_PARTS, Parameter
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import TABLES, arm, with_links
from tests.rows import robot_of_rows

pytest.importorskip("clarabel")


def spoiled(robot: Robot, by: float) -> Robot:
    """The same torques from bodies that are moved far along a direction that no torque notices."""
    random = np.random.default_rng(1)
    with exactly():
        domain = ExactDomain(robot)
        chain = bare_chain(robot, domain)
        basis = directions(robot, chain, domain)
        weights = [domain.number(Fraction(round(float(w) * 1000), 1000)) for w in random.normal(0, by, len(basis))]
        moved = combined(basis, weights)
        links = []
        for i, (link, body) in enumerate(zip(robot.links, chain.bodies, strict=True)):
            change = moved[10 * i : 10 * i + 10]
            if robot.convention == "standard":
                links.append(link)
                continue
            m, hx, hy, hz, *tensor = (
                as_fraction(a) + as_fraction(b) for a, b in zip(parameters_of(body), change, strict=True)
            )
            r = np.array([hx / m, hy / m, hz / m])
            steiner = m * (np.dot(r, r) * np.eye(3, dtype=int) - np.outer(r, r))
            places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
            own = (number(Fraction(t - steiner[place])) for t, place in zip(tensor, places, strict=True))
            links.append(replace(link, mass=number(m), com=tuple(map(number, r)), inertia=Inertia(*own)))
    return replace(robot, links=tuple(links))


def slack(robot: Robot) -> float:
    """How far all bodies are from the limit of the triangle inequality, as a part of their largest moment."""
    oracle = Oracle.of(robot).arm
    assert (oracle.mass > 0).all()
    moments = np.linalg.eigvalsh(oracle.inertia)
    return float(((moments[:, 0] + moments[:, 1] - moments[:, 2]) / moments[:, 2]).min())


def same_torques(one: Robot, other: Robot) -> None:
    random = np.random.default_rng(3)
    q, qd, qdd = random.uniform(-2, 2, (3, 30, one.n))
    given, found = Oracle.of(one), Oracle.of(other)
    calls = {"inverse_dynamics": (q, qd, qdd), "inertia_matrix": (q,), "gravity_vector": (q,)}
    torque = np.abs(given.evaluate("inverse_dynamics", q, qd, qdd)).max()
    for name, arguments in (calls | {"coriolis_vector": (q, qd)}).items():
        expected = given.evaluate(name, *arguments)
        largest, all_of_them = np.abs(expected).max(axis=0), np.abs(expected).max()
        if all_of_them < 1e-9 * torque:  # nothing but rounding, as the Coriolis terms of an arm without masses
            all_of_them = torque
        error = np.abs(found.evaluate(name, *arguments) - expected).max(axis=0)
        assert (error <= 1e-12 * np.where(largest > 1e-9 * all_of_them, largest, all_of_them)).all(), name


def test_corke_s_puma_has_bodies_that_exist_and_move_the_same() -> None:
    robot = Robot.load("puma560-corke")
    found = possible.possible(robot)
    assert slack(robot.of(replace(robot, links=robot.links[1:3] * 3))) < 0 < slack(found.robot)
    same_torques(robot, found.robot)
    assert [change.link for change in found.changes] == [1, 3]
    for i in (1, 3, 4, 5):  # nothing moved that need not
        assert found.robot.links[i] == robot.links[i]
    assert not found.border
    assert to_float(found.robot.links[0].mass, {}) > 0.1  # not a body of a gram that is kilometres wide
    assert "2 of 6 links changed" in found.report[0]


@pytest.mark.parametrize("name", TABLES)
def test_bodies_that_exist_are_found_from_others_with_the_same_torques_and_stay_as_they_are(name: str) -> None:
    robot = arm(name, "modified")
    wrong = spoiled(robot, 0.5)
    same_torques(robot, wrong)
    found = possible.possible(wrong)
    same_torques(robot, found.robot)
    assert found.changes
    assert slack(found.robot) > 1e-6
    kept = possible.possible(arm(name))
    assert kept.robot == arm(name)
    assert kept.report == ("all links exist as they are",)


def test_robots_without_numbers_or_links_are_refused_by_name() -> None:
    with pytest.raises(DeriveError, match="a1, a2"):
        possible.possible(replace(Robot.load("planar-2r-perugia"), parameters=()))
    with pytest.raises(DeriveError, match="no masses"):
        possible.possible(Robot.load("kuka-kr5"))


def test_a_massless_link_gets_a_mass_where_torques_allow_it() -> None:
    robot = arm("upright")
    bare = replace(robot, links=(Link(inertia=robot.links[0].inertia), *robot.links[1:]))
    found = possible.possible(bare)
    assert [change.link for change in found.changes] == [1]
    same_torques(bare, found.robot)
    assert slack(found.robot) > 1e-6


def test_a_link_whose_mass_torques_keep_at_zero_gets_no_first_moment() -> None:
    """The slide's mass is seen by gravity; a first moment beside its second ones would be within rounding."""
    given = with_links(
        arm("upright", "modified"),
        ("3.6", "0.1 0.2 0.1", "0.2 0.2 0.1 0 0 0"),
        ("2.8", "0.26 -0.06 -0.05", "0.2 0.01 0.1 0.05 0 0"),
        ("0", "0 0 0", "0.3 0.2 0.4 0 0 0"),
    )
    found = possible.possible(given)
    same_torques(given, found.robot)
    assert found.border == (3,)
    assert found.report[-1].startswith("link 3 is at the limit of what exists")
    assert found.robot.links[2].mass == given.links[2].mass
    assert found.robot.links[2].com == given.links[2].com
    moments = np.linalg.eigvalsh(Oracle.of(found.robot).arm.inertia)
    assert (moments[:, 0] + moments[:, 1] > (1 - 1e-7) * moments[:, 2]).all()


def test_a_last_link_that_weighs_nothing_stays_so_beside_one_that_changes() -> None:
    given = with_links(
        arm("spatial", "modified"),
        ("0.9", "0.1 -0.2 0.1", "0.1 0.1 0.08 0 0 0.01"),
        ("1.9", "-0.13 -0.23 0.07", "0.23 0.015 0.2 0 0 0"),
        ("1.7", "-0.11 0.01 0.25", "0.16 0.25 0.19 0.01 0.02 -0.02"),
        ("0", "0 0 0", "0 0 0 0 0 0"),
    )
    found = possible.possible(given)
    same_torques(given, found.robot)
    assert found.border == (4,)
    assert 2 in [change.link for change in found.changes]
    assert found.robot.links[3] == given.links[3]


def test_a_symbol_whose_cells_become_numbers_is_no_parameter_any_more() -> None:
    """Otherwise the file that is written could not be read: no cell uses this parameter."""
    found = possible.possible(robot_of_rows("R a: a1 | R a: 0.3, alpha: pi/2", SYMBOLS))
    assert [change.link for change in found.changes] == [1, 2]
    again = Robot.from_text(found.text)
    assert dict(again.parameters).keys() == {"a1", "g"}
    assert again.runtime == ("a1",)


SYMBOLS = """
gravity: [0, -g, 0]
links:
  - {mass: 0, com: [0, 0, 0], inertia: {xx: I1, yy: 0.01, zz: 0.02}}
  - {mass: m2, com: [-0.1, 0, 0], inertia: {xx: I2, yy: 0.01, zz: 0.02}}
parameters: {a1: 0.5, g: 9.81, I1: 0.5, I2: -0.1, m2: 2}
runtime: [a1, I2]
"""


def coefficients(matrix: np.ndarray) -> np.ndarray:
    """What multiplies a body's ten parameters in the integral of a function over its mass."""
    (xx, xy, xz, x), (_, yy, yz, y), (_, _, zz, z), (*_, one) = matrix
    turning = [(yy + zz - xx) / 2, (xx + zz - yy) / 2, (xx + yy - zz) / 2, -2 * xy, -2 * xz, -2 * yz]
    return np.array([one, 2 * x, 2 * y, 2 * z, *turning])


def contradictory(turned: bool) -> Robot:
    """Corke's PUMA with a last link whose moments across its axis differ by more than the one about it."""
    robot = Robot.load("puma560-corke")
    last = Inertia(*(number(Fraction(cell)) for cell in ("0.0005", "0.0001", "0.0002", "0", "0", "0")))
    joints = list(robot.joints)
    if turned:
        joints[3] = replace(joints[3], alpha=number(Fraction(13, 10)))
    return replace(robot, joints=tuple(joints), links=(*robot.links[:5], replace(robot.links[5], inertia=last)))


def prove(robot: Robot) -> NoSuchBodies:
    """The refusal of a robot, whose witness is nowhere negative, seen by torques, and negative."""
    with pytest.raises(NoSuchBodies, match="torques fix the integral") as caught:
        possible.possible(robot)
    witness = caught.value.witness
    factors = np.zeros(10 * robot.n)
    for link, matrix in witness.functions:
        numbers = np.array([[float(entry) for entry in row] for row in matrix])
        values = np.linalg.eigvalsh(numbers)
        assert values[0] >= -1e-12 * values[-1]
        factors[10 * link - 10 : 10 * link] = coefficients(numbers)
    # a sum of torques: in the row space of the oracle's regressor of all links
    columns = tuple(Parameter(i, part) for i in range(1, robot.n + 1) for part in LINK_PARTS)
    q, qd, qdd = np.random.default_rng(1).uniform(-2, 2, (3, 80, robot.n))
    regressor = Oracle.of(robot, base=columns).evaluate("base_regressor", q, qd, qdd).reshape(-1, len(columns))
    _, sizes, rows = np.linalg.svd(regressor, full_matrices=False)
    rows = rows[sizes > 1e-9 * sizes[0]]
    assert np.abs(rows.T @ (rows @ factors) - factors).max() <= 1e-9 * np.abs(factors).max()
    with exactly():
        bodies = bare_chain(robot, ExactDomain(robot)).bodies
        given = np.array([float(value) for body in bodies for value in parameters_of(body)])
    assert witness.value < 0
    assert abs(factors @ given - float(witness.value)) <= 1e-12 * np.abs(factors * given).max()
    return caught.value


@pytest.mark.parametrize("turned", [False, True])
def test_a_witness_is_exact_where_the_geometry_is_rational(turned: bool) -> None:
    error = prove(contradictory(turned))
    assert error.witness.exact is not turned
    assert str(error).startswith(
        "puma560-corke: no bodies have these torques: torques fix the integral of f dm over all links at -0.0001 "
        "kg m^2, though f is nowhere negative (link 6: f = x^2; in joint frames, rounded)"
    )


NO_BODIES = {
    # points that never move on the first axis, and along it in the frame of the slide: rounding would make functions
    # negative beside them
    "slanted axes": (
        ("4.4", "0.14 0.04 0.28", "0.15 0.24 0.23 0.07 0.03 0.04"),
        ("0.72", "0.06 -0.39 0.07", "0.33 0.34 0.08 -0.02 -0.06 -0.09"),
        ("2.37", "0.05 -0.06 -0.18", "0.13 -0.01 0.1 0.02 -0.02 0"),
        ("3.12", "-0.08 0.31 -0.19", "0.07 0.1 0.05 0.01 0.04 -0.02"),
    ),
    # the function of a link without weight is of another size; what is near is seen in their units
    "a last link that weighs nothing": (
        ("0.9", "0.1 -0.2 0.1", "0.1 0.1 0.08 0 0 0.01"),
        ("1.9", "-0.13 -0.23 0.07", "0.4 0.015 0.2 -0.07 -0.01 -0.08"),
        ("1.7", "-0.11 0.01 0.25", "0.16 0.35 0.19 0.01 0.08 -0.02"),
        ("0", "0 0 0", "0 0 0 0 0 0"),
    ),
}


@pytest.mark.parametrize("links", NO_BODIES.values(), ids=NO_BODIES)
def test_a_witness_is_found_beside_slanted_axes_and_weightless_links(links: tuple[tuple[str, str, str], ...]) -> None:
    prove(with_links(arm("spatial", "modified"), *links))


def cloud() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Masses, homogeneous places, and the ten parameters of their body."""
    points, masses = np.random.default_rng(3).normal(size=(7, 3)), np.arange(1.0, 8.0)
    second = np.einsum("p,pa,pb->ab", masses, points, points)
    tensor = np.trace(second) * np.eye(3) - second
    entries = [tensor[k] for k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return masses, np.column_stack([points, np.ones(7)]), np.array([masses.sum(), *(masses @ points), *entries])


def bodies_of(robot: Robot) -> possible.Bodies:
    with exactly():
        domain = ExactDomain(robot)
        chain = bare_chain(robot, domain)
        return possible.in_own_units(chain, directions(robot, chain, domain))


def test_a_pseudo_inertia_is_an_integral_and_of_mass_one_in_its_own_units() -> None:
    masses, places, parameters = cloud()
    assert np.allclose(possible.pseudo_inertias(parameters[None]), [np.einsum("p,pa,pb->ab", masses, places, places)])
    found = bodies_of(arm("spatial"))
    assert np.allclose(found.given[:, 6:9], 0, atol=1e-12)
    assert np.allclose(found.given[:, 9], 1)
    assert possible.least_eigenvalues(found).min() > 0


def test_steps_to_the_nearest_bodies_keep_to_the_targets() -> None:
    robot = arm("spatial", "modified")
    flat = replace(robot.links[1], inertia=Inertia(number(Fraction(4)), number(1), number(1), ZERO, ZERO, ZERO))
    bodies = bodies_of(replace(robot, links=(robot.links[0], flat, *robot.links[2:])))
    room = possible.most_room(bodies)
    target = possible.targets(bodies, room)
    assert possible.least_eigenvalues(bodies).min() < 0 < target.min()
    assert room.value == pytest.approx(possible.MARGIN, rel=1e-3)
    assert 1 in possible.needed(bodies, target)
    assert (possible.least_eigenvalues(bodies, possible.nearest(bodies, target)) >= 0.99 * target).all()


def test_a_link_that_needs_a_little_changes_beside_one_that_needs_much() -> None:
    given = packed(np.array([np.diag([-0.1, 1, 1, 1]), np.diag([0.0, 1, 1, 1]), np.diag([0.1, 1, 1, 1])]))
    along = np.zeros((3, 10, 3))
    along[[0, 1, 2], 0, [0, 1, 2]] = 1
    bodies = possible.Bodies(given, along, np.array([np.eye(4)] * 3), np.zeros(3))
    assert possible.needed(bodies, np.full(3, possible.MARGIN / 2)) == [0, 1]


def test_links_without_a_mass_get_as_much_of_one_as_torques_allow_each() -> None:
    """A sole Izz bounds the mass of a link that has its centre off the axis; all or nothing would leave nothing."""
    robot = arm("planar")
    small = Inertia(number(Fraction(1, 10)), number(Fraction(1, 10)), number(Fraction(1, 50)), ZERO, ZERO, ZERO)
    bare = replace(robot, links=(robot.links[0], Link(inertia=small), Link(inertia=small)))
    bodies = bodies_of(bare)
    target = possible.targets(bodies, possible.most_room(bodies))
    found = possible.weighed(bodies, target)
    assert found.masses[0] == 0
    assert (found.masses[1:] > 1e-3).all()
    assert found.masses.min() < 0.4
    steps = possible.nearest(found, target)
    assert (possible.least_eigenvalues(found, steps) >= 0.99 * target).all()
    assert ((found.given + found.along @ steps)[1:, -1] >= 0.99 * found.masses[1:]).all()


def test_the_least_of_linear_quadratic_and_semidefinite_programs_is_found_and_contradictions_told() -> None:
    matrix = np.array([[1.0, 2.0, 0.0], [2.0, -1.0, 0.5], [0.0, 0.5, 0.3]])
    found, prices = least(np.ones(1), [Limit(Cone.SEMIDEFINITE, packed(matrix), packed(np.eye(3))[:, None])])
    values, vectors = np.linalg.eigh(matrix)
    assert abs(found[0] + values[0]) < 1e-8
    assert np.allclose(unpacked(prices[0]), np.outer(vectors[:, 0], vectors[:, 0]), atol=1e-6)
    bound = Limit(Cone.NOT_NEGATIVE, np.array([-1.0]), np.array([[1.0, 1.0]]))
    assert np.allclose(least(np.zeros(2), [bound], np.diag([1.0, 3.0]))[0], [0.75, 0.25], atol=1e-7)
    length = Limit(Cone.LONGEST_FIRST, np.array([0.0, 3.0, 4.0]), np.array([[1.0], [0.0], [0.0]]))
    assert abs(least(np.ones(1), [length])[0][0] - 5) < 1e-7
    above, below = (Limit(Cone.NOT_NEGATIVE, np.array([-1.0]), np.array([[sign]])) for sign in (1.0, -1.0))
    with pytest.raises(DeriveError, match="PrimalInfeasible"):
        least(np.ones(1), [above, below])
