"""Entries of the dynamics: those of the model, also where they are put together from Christoffel symbols."""

from __future__ import annotations

from functools import cache

import pytest
import sympy

from derive.algebra.ring import TooManyTerms
from derive.mechanics import exact_dynamics as dynamics
from derive.model.dynamic_entries import ModelEntries
from derive.model.entries import Entries
from derive.model.model import Model
from derive.robot.robot import Robot

NAMES = ["planar-2r-perugia", "scara-perugia"]


@cache
def of(name: str) -> ModelEntries:
    return ModelEntries(Model(Robot.load(name)))


def matrix(entries: Entries) -> sympy.Matrix:
    return sympy.Matrix(*entries.shape, lambda i, j: entries.entry(i + 1, j + 1))


def is_zero(value: sympy.Expr) -> bool:
    return sympy.expand(value, trig=True) == 0


@pytest.mark.parametrize("name", NAMES)
def test_entries_are_those_of_the_model(name: str) -> None:
    entries = of(name)
    model = entries.model
    for quantity, expected in (
        (entries.B, model.B),
        (entries.Bdot, model.Bdot),
        (entries.C, model.C),
        (entries.N, model.N),
        (entries.g, model.g),
        (entries.tau, model.tau),
    ):
        assert matrix(quantity) == expected
    assert is_zero(entries.kinetic.entry(1, 1) - model.energy.kinetic)
    assert entries.potential.entry(1, 1) == model.energy.potential


@pytest.mark.parametrize("name", NAMES)
def test_sums_over_rates_are_the_matrices(name: str) -> None:
    entries = of(name)
    model = entries.model
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


def test_skew_symmetry_is_stated_only_where_it_is_checked() -> None:
    assert of("planar-2r-perugia").is_skew(limit=60)
    assert not of("planar-2r-perugia").is_skew(limit=0)


def test_gravity_is_an_acceleration_of_the_base_in_its_own_axes() -> None:
    text = "name: arm\nconvention: standard\njoints: [{type: revolute}]\nlinks: [{mass: 1}]\ngravity: [0, 0, -g]\n"
    turned = text + "base: [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]\n"
    g = sympy.Symbol("g")
    assert ModelEntries(Model(Robot.from_text(text))).base_acceleration == (0, 0, g)
    assert ModelEntries(Model(Robot.from_text(turned))).base_acceleration == (0, g, 0)


def test_what_exceeds_the_budget_of_the_model_is_not_derived(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise TooManyTerms(1)

    monkeypatch.setattr(dynamics.Dynamics, "christoffel", refuse)
    entries = ModelEntries(Model(Robot.load("planar-2r-perugia")))
    assert not entries.B.is_short(1000)
    with pytest.raises(TooManyTerms):
        entries.christoffel(1, 1, 2).entry(1, 1)
