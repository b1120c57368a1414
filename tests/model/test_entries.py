"""Closed forms entry by entry: how long they are, and that they are those of the model."""

from functools import cache

import pytest
import sympy

from derive.algebra.ring import TooManyTerms
from derive.mechanics import exact as dynamics
from derive.model.entries import Entries, ModelEntries, expanded_terms, of_matrix
from derive.model.model import Model
from derive.robot.robot import Robot
from tests.rows import robot_of_rows

NAMES = ["planar-2r-perugia", "scara-perugia"]


@cache
def of(name: str) -> ModelEntries:
    return ModelEntries(Model(Robot.load(name)))


def matrix(entries: Entries) -> sympy.Matrix:
    return sympy.Matrix(*entries.shape, lambda i, j: entries.entry(i + 1, j + 1))


def is_zero(value: sympy.Expr) -> bool:
    return sympy.expand(value, trig=True) == 0


@pytest.mark.parametrize("name", NAMES)
def test_entries_of_dynamics_are_those_of_the_model(name: str) -> None:
    entries, model = of(name), of(name).model
    for quantity in ("B", "Bdot", "C", "N", "g", "tau"):
        assert matrix(getattr(entries, quantity)) == getattr(model, quantity)
    assert is_zero(entries.kinetic.entry(1, 1) - model.energy.kinetic)
    assert entries.potential.entry(1, 1) == model.energy.potential


@pytest.mark.parametrize("name", NAMES)
def test_sums_over_rates_are_the_matrices(name: str) -> None:
    entries, model = of(name), of(name).model
    for i, j in entries.C.places:
        assert is_zero(entries.rate_value(entries.coriolis_sum(i, j)) - model.C[i - 1, j - 1])
        assert is_zero(entries.rate_value(entries.skew_sum(i, j)) - model.N[i - 1, j - 1])
    for i in range(1, model.n + 1):
        assert is_zero(entries.torque_value(i) - model.tau[i - 1])


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_of_the_inertia_matrix_are_sums_of_christoffel_symbols(name: str) -> None:
    entries = of(name)
    joints = range(1, entries.robot.n + 1)
    assert set(entries.triples) == set(entries.model.christoffel_table())
    for i, j, k in ((i, j, k) for i in joints for j in joints for k in joints):
        total = entries.christoffel(i, j, k).entry(1, 1) + entries.christoffel(j, i, k).entry(1, 1)
        assert is_zero(entries.inertia_derivative(i, j, k).entry(1, 1) - total)


def test_gravity_is_an_acceleration_of_the_base_in_its_own_axes() -> None:
    g, turned = sympy.Symbol("g"), "base: [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]"
    for base, wanted in (("", (0, 0, g)), (turned, (0, g, 0))):
        robot = robot_of_rows("R", f"links: [{{mass: 1}}]\ngravity: [0, 0, -g]\n{base}")
        assert ModelEntries(Model(robot)).base_acceleration == wanted


def test_what_exceeds_the_budget_of_the_model_is_not_derived_and_skew_symmetry_not_stated_unchecked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(*_: object) -> None:
        raise TooManyTerms(1)

    monkeypatch.setattr(dynamics.Dynamics, "christoffel", refuse)
    entries = ModelEntries(Model(Robot.load("planar-2r-perugia")))
    assert not entries.B.is_short(1000)
    with pytest.raises(TooManyTerms):
        entries.christoffel(1, 1, 2).entry(1, 1)
    monkeypatch.undo()
    assert of("planar-2r-perugia").is_skew(limit=60)
    assert not of("planar-2r-perugia").is_skew(limit=0)


@pytest.mark.parametrize("name", ["scara-perugia", "dh-modified-deluca", "puma560-corke"])
def test_entries_are_those_of_the_model(name: str) -> None:
    entries, model, n = of(name), of(name).model, of(name).model.n
    assert matrix(entries.T) == model.T
    assert matrix(entries.J) == model.J
    assert matrix(entries.A(1)) == model.A(1)
    assert matrix(entries.frame(n)) == model.frame(n)
    assert matrix(entries.transform(n, 0)) == model.transform(n, 0)


@pytest.mark.parametrize("name", ["scara-perugia", "puma560-corke"])
def test_entries_without_terms_are_those_that_are_zero(name: str) -> None:
    entries = of(name)
    for quantity in (entries.T, entries.J):
        assert all(bool(quantity.terms(*place)) == (quantity.entry(*place) != 0) for place in quantity.places)


def test_entries_of_links_and_rotors_are_those_of_the_model() -> None:
    entries, model = of("planar-2r-perugia"), of("planar-2r-perugia").model
    for of_rotor, linear, angular in ((False, model.Jv_com, model.Jw_com), (True, model.Jv_motor, model.Jw_motor)):
        assert matrix(entries.linear_jacobian(2, of_rotor)) == linear(2)
        assert matrix(entries.angular_jacobian(2, of_rotor)) == angular(2)
    place = matrix(entries.body_position(2, of_rotor=False))
    assert sympy.expand(place.jacobian(model.q) - matrix(entries.linear_jacobian(2, of_rotor=False))).is_zero_matrix


def test_a_long_arm_is_counted_without_being_written() -> None:
    rows = "|".join(f"R a: a{i}, alpha: pi/{2 + i % 2}" for i in range(1, 31))
    entries = ModelEntries(Model(robot_of_rows(rows)))
    assert not entries.T.is_short(10**6)
    assert [entries.T.entry(4, j) for j in range(1, 5)] == [0, 0, 0, 1]
    assert entries.J.terms(6, 1) == 1
    assert entries.J.entry(6, 1) == 1


def test_entries_keep_the_order_that_is_asked_for_and_their_terms_are_those_multiplied_out() -> None:
    x, y, z = sympy.symbols("x y z")
    assert expanded_terms(sympy.S.Zero) == 0
    assert expanded_terms(x * (x + y + z) * (y + 1)) == 6
    assert expanded_terms((x + y) ** 3) == 8
    assert expanded_terms(sympy.sqrt(x + y)) == 1
    whole = of_matrix(sympy.Matrix([[1, x], [x + y, 0]]))
    part = whole.part((2, 1), (2,))
    assert part.shape == (2, 1)
    assert [part.entry(i, 1) for i in (1, 2)] == [0, x]
    assert [part.terms(i, 1) for i in (1, 2)] == [0, 1]
    assert whole.is_short(4)
    assert not whole.is_short(3)
