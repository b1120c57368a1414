"""Closed forms give what the recursions give, in either choice of angles."""

import random
from dataclasses import replace

import numpy as np
import pytest

from derive.mechanics.coriolis import coriolis_matrix
from derive.mechanics.energy import kinetic_energy, potential_energy
from derive.mechanics.inertia_matrix import gravity_vector, inertia_matrix
from derive.mechanics.newton_euler import inverse_dynamics
from derive.programs.build import build_program
from derive.programs.formulations.closed_form import CLOSED_FORMS, ClosedForm
from derive.programs.formulations.trace import Trace, flat
from derive.programs.optimise.search_policy import POLICY
from derive.programs.tape.scalars import QD, QDD
from derive.programs.tape.value import Value
from derive.robot.robot import Robot
from tests.programs.parallel_arms import numbers
from tests.random_robots import random_robot

PLANAR = """
name: two
convention: standard
joints: [{type: revolute, a: a1}, {type: revolute, a: a2}]
gravity: [0, -g, 0]
links:
  - {mass: m1, com: [-l1, 0, 0], inertia: {zz: I1}}
  - {mass: m2, com: [-l2, 0, 0], inertia: {zz: I2}}
"""


def recursions(trace: Trace) -> list[list[Value]]:
    chain, rates = trace.chain, trace.arguments(QD)
    return [
        flat(inertia_matrix(chain)),
        flat(coriolis_matrix(chain, rates, trace.half)),
        gravity_vector(chain),
        [kinetic_energy(chain, rates, trace.half)],
        [potential_energy(chain)],
        inverse_dynamics(chain, rates, trace.arguments(QDD)),
    ]


@pytest.mark.parametrize("sums", [False, True], ids=["angles", "sums"])
@pytest.mark.parametrize("seed", range(8))
def test_closed_forms_are_the_recursions(seed: int, sums: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("derive.programs.formulations.closed_form.POLICY", replace(POLICY, closed_form_terms=4000))
    robot = random_robot(random.Random(seed), 1 + seed % 2)
    trace = Trace(Robot.from_text(robot.text))
    form = ClosedForm(trace.robot, trace.domain, sums=sums)
    found = [form.values(name) for name in CLOSED_FORMS]
    for values, wanted in zip(found, recursions(trace), strict=True):
        if values is not None:
            expected = numbers(trace, wanted)
            assert np.abs(numbers(trace, values) - expected).max() <= 1e-12 * max(1, np.abs(expected).max())
    assert found[0] is not None


def test_a_textbook_arm_is_written_as_in_the_textbook() -> None:
    program = build_program(Robot.from_text(PLANAR))
    assert program["inertia_matrix"].operations.arithmetic <= 4
    assert program["coriolis_matrix"].operations.arithmetic <= 4
    assert program["gravity_vector"].operations.arithmetic <= 5
    assert program["inverse_dynamics"].operations.arithmetic <= 26


def test_long_closed_forms_are_not_offered() -> None:
    robot = Robot.from_text(random_robot(random.Random(4), 6).text)
    trace = Trace(robot)
    assert [form.values("inverse_dynamics") for form in trace.closed_forms] == [None] * len(trace.closed_forms)
