"""Witnesses that no bodies move as some numbers say, checked by numbers that share nothing with them."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.mechanics.space import exactly
from derive.model.identification.exact_scalars import ExactDomain
from derive.model.identification.possible import possible
from derive.model.identification.regressor_null_space import bare_chain, parameters_of
from derive.model.identification.witness import NoSuchBodies, Witness, function_matrix, is_semidefinite
from derive.robot.description import Inertia
from derive.robot.expression import number
from derive.robot.inertial_parameters import LINK_PARTS, Parameter
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.bodied import arm, with_links

pytest.importorskip("clarabel")


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


def factors_of(witness: Witness, n: int) -> np.ndarray:
    rows = np.zeros((n, 10))
    for link, matrix in witness.functions:
        rows[link - 1] = coefficients(np.array([[float(entry) for entry in row] for row in matrix]))
    return rows.ravel()


def prove(robot: Robot) -> NoSuchBodies:
    """The refusal of a robot, whose witness is nowhere negative, seen by torques, and negative."""
    with pytest.raises(NoSuchBodies, match="torques fix the integral") as caught:
        possible(robot)
    witness = caught.value.witness
    assert witness is not None
    for _, matrix in witness.functions:
        values = np.linalg.eigvalsh(np.array([[float(entry) for entry in row] for row in matrix]))
        assert values[0] >= -1e-12 * values[-1]
    factors = factors_of(witness, robot.n)
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
    assert error.witness is not None
    assert error.witness.exact is not turned
    assert str(error).startswith(
        "puma560-corke: no bodies have these torques: torques fix the integral of f dm over all links at -0.0001 "
        "kg m^2, though f is nowhere negative (link 6: f = x^2; in joint frames, rounded)"
    )


def test_a_witness_is_found_where_slanted_axes_leave_points_that_never_move() -> None:
    """On the first axis, and along it in the frame of the slide: rounding would make functions negative beside them."""
    robot = with_links(
        arm("spatial", "modified"),
        ("4.4", "0.14 0.04 0.28", "0.15 0.24 0.23 0.07 0.03 0.04"),
        ("0.72", "0.06 -0.39 0.07", "0.33 0.34 0.08 -0.02 -0.06 -0.09"),
        ("2.37", "0.05 -0.06 -0.18", "0.13 -0.01 0.1 0.02 -0.02 0"),
        ("3.12", "-0.08 0.31 -0.19", "0.07 0.1 0.05 0.01 0.04 -0.02"),
    )
    prove(robot)


def test_a_witness_is_found_beside_a_last_link_that_weighs_nothing() -> None:
    """Its function is of another size than those of links that weigh something; what is near is seen in their units."""
    robot = with_links(
        arm("spatial", "modified"),
        ("0.9", "0.1 -0.2 0.1", "0.1 0.1 0.08 0 0 0.01"),
        ("1.9", "-0.13 -0.23 0.07", "0.4 0.015 0.2 -0.07 -0.01 -0.08"),
        ("1.7", "-0.11 0.01 0.25", "0.16 0.35 0.19 0.01 0.08 -0.02"),
        ("0", "0 0 0", "0 0 0 0 0 0"),
    )
    prove(robot)


def test_functions_and_factors_of_parameters_are_each_other_s_inverse() -> None:
    random = np.random.default_rng(2).normal(size=(4, 4))
    matrix = random + random.T
    assert np.allclose(np.array(function_matrix(list(coefficients(matrix)))), matrix)
    points, masses = np.random.default_rng(3).normal(size=(7, 3)), np.arange(1.0, 8.0)
    places = np.column_stack([points, np.ones(7)])
    integral = np.einsum("p,pa,ab,pb->", masses, places, matrix, places)
    second = np.einsum("p,pa,pb->ab", masses, points, points)
    tensor = np.trace(second) * np.eye(3) - second
    entries = [tensor[k] for k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    assert np.isclose(coefficients(matrix) @ [masses.sum(), *(masses @ points), *entries], integral)


def test_semidefinite_matrices_are_told_from_others_exactly() -> None:
    def rational(rows: list[list[int]]) -> list[list[Fraction]]:
        return [[Fraction(entry) for entry in row] for row in rows]

    with exactly():
        domain = ExactDomain(Robot.load("puma560-corke"))
        for rows, expected in (
            ([[1, 2], [2, 4]], True),
            ([[1, 2], [2, 3]], False),
            ([[0, 0], [0, 1]], True),
            ([[0, 1], [1, 5]], False),
            ([[-1]], False),
        ):
            assert is_semidefinite([[domain.number(entry) for entry in row] for row in rational(rows)]) is expected
