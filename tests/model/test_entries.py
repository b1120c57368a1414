"""Entries of kinematics, counted before they are written: the counts and the entries are those of the model."""

from __future__ import annotations

import pytest
import sympy

from derive.model.entries import Entries, KinematicEntries, expanded_terms, of_matrix
from derive.model.model import Model
from derive.robot.robot import Robot

x, y, z = sympy.symbols("x y z")


def matrix(entries: Entries) -> sympy.Matrix:
    return sympy.Matrix(*entries.shape, lambda i, j: entries.entry(i + 1, j + 1))


@pytest.mark.parametrize("name", ["scara-perugia", "dh-modified-deluca", "puma560-corke"])
def test_entries_are_those_of_the_model(name: str) -> None:
    model = Model(Robot.load(name))
    entries, n = KinematicEntries(model), model.n
    assert matrix(entries.T) == model.T
    assert matrix(entries.J) == model.J
    assert matrix(entries.A(1)) == model.A(1)
    assert matrix(entries.frame(n)) == model.frame(n)
    assert matrix(entries.transform(n, 0)) == model.transform(n, 0)


@pytest.mark.parametrize("name", ["scara-perugia", "puma560-corke"])
def test_entries_without_terms_are_those_that_are_zero(name: str) -> None:
    entries = KinematicEntries(Model(Robot.load(name)))
    for quantity in (entries.T, entries.J):
        assert all(bool(quantity.terms(*place)) == (quantity.entry(*place) != 0) for place in quantity.places)


def test_entries_of_links_and_rotors_are_those_of_the_model() -> None:
    model = Model(Robot.load("planar-2r-perugia"))
    entries = KinematicEntries(model)
    assert matrix(entries.linear_jacobian(2, of_rotor=False)) == model.Jv_com(2)
    assert matrix(entries.angular_jacobian(2, of_rotor=False)) == model.Jw_com(2)
    assert matrix(entries.linear_jacobian(2, of_rotor=True)) == model.Jv_motor(2)
    assert matrix(entries.angular_jacobian(2, of_rotor=True)) == model.Jw_motor(2)
    place = matrix(entries.body_position(2, of_rotor=False))
    assert sympy.expand(place.jacobian(model.q) - matrix(entries.linear_jacobian(2, of_rotor=False))).is_zero_matrix


def test_a_long_arm_is_counted_without_being_written() -> None:
    rows = "".join(f"  - {{type: revolute, a: a{i}, alpha: pi/{2 + i % 2}}}\n" for i in range(1, 31))
    robot = Robot.from_text(f"name: arm\nconvention: standard\njoints:\n{rows}")
    entries = KinematicEntries(Model(robot))
    assert not entries.T.is_short(10**6)
    assert [entries.T.entry(4, j) for j in range(1, 5)] == [0, 0, 0, 1]
    assert entries.J.terms(6, 1) == 1
    assert entries.J.entry(6, 1) == 1


def test_terms_are_those_of_the_product_multiplied_out() -> None:
    assert expanded_terms(sympy.S.Zero) == 0
    assert expanded_terms(x * (x + y + z) * (y + 1)) == 6
    assert expanded_terms((x + y) ** 3) == 8
    assert expanded_terms(sympy.sqrt(x + y)) == 1


def test_a_part_keeps_the_order_that_is_asked_for() -> None:
    whole = of_matrix(sympy.Matrix([[1, x], [x + y, 0]]))
    part = whole.part((2, 1), (2,))
    assert part.shape == (2, 1)
    assert [part.entry(i, 1) for i in (1, 2)] == [0, x]
    assert [part.terms(i, 1) for i in (1, 2)] == [0, 1]
    assert whole.is_short(4)
    assert not whole.is_short(3)
