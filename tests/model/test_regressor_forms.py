"""Closed forms of identification: torques are regressors times parameters, standard and base ones."""

from __future__ import annotations

from math import comb

import pytest
import sympy

from derive.mechanics.chain import build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.regressor import with_unit_rotors
from derive.model.identification.unit_dynamics import UnitDynamics
from derive.model.model import Model
from derive.model.regressor_forms import IdentifiedModel
from derive.robot.inertial_parameters import standard_parameters
from derive.robot.robot import Robot
from tests.mechanics.arms import SEEDS, arm_of, assert_close


@pytest.mark.parametrize("name", ["planar-2r-perugia", "scara-matlab"])
def test_torques_are_regressors_times_parameters(name: str) -> None:
    model = Model(Robot.load(name))
    assert isinstance(model, IdentifiedModel)
    for regressor, values in (
        (model.regressor, model.standard_parameters),
        (model.regressor_base, model.base_parameters),
    ):
        assert all(entry.expand(trig=True).equals(0) for entry in regressor * values - model.tau)
    assert len(model.base_set.parameters) <= len(model.standard_set)


def test_base_parameters_collect_what_they_have_in_common() -> None:
    """The masses that link 1 carries, once: by geometry where that is shorter, else by body."""
    model = Model(Robot.load("planar-2r-perugia"))
    a1, ml2, mm2 = sympy.symbols("a1 ml2 mm2")
    assert a1**2 * (ml2 + mm2) in model.base_parameters[2].args
    assert a1 * (ml2 + mm2) in model.base_parameters[0].args


@pytest.mark.parametrize("seed", [s for s in SEEDS if s % 7 < 4])
def test_the_inertia_of_unit_parameters_adds_up(seed: int) -> None:
    """B is linear in the parameters: its entries per unit, times their values, give what the chain has."""
    arm = arm_of(seed)
    robot = with_unit_rotors(arm.robot)
    units = UnitDynamics(build_chain(robot, FloatDomain(robot, arm.q.tolist())), ends=True)
    parameters = standard_parameters(arm.robot)
    for parameter in parameters:
        pairs = units.inertia(parameter)
        assert len(pairs) <= comb(arm.robot.n + 1, 2)
        if parameter.part == "m":  # the mass of a link: never less than nothing on the diagonal
            assert_close([min(0.0, pairs.get((i, i), 0.0)) for i in range(arm.robot.n)], [0.0] * arm.robot.n)
