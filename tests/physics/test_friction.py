"""Coulomb friction by direction: f_plus where qd > 0, -f_minus where qd < 0, nothing at rest."""

import random
from dataclasses import replace

import numpy as np
import pytest
import sympy

from derive.model.identification.base_parameters import base_set
from derive.model.model import Model
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.expression import Name
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.random_robots import configurations, random_robot, seeds
from tests.rows import robot_of_rows
from tests.targets.generated_models import numpy_model
from tests.verification.oracle.pinocchio_reference import reference

BODIES = "{mass: 1, armature: 1, friction: {viscous: b, coulomb: [p, m]}}, {mass: 1, friction: {coulomb: [0.5, 0]}}"
ARM = robot_of_rows("P | P alpha: pi/2", f"links: [{BODIES}]")


@pytest.mark.parametrize("seed", seeds(24, usual=3))
def test_torques_are_pinocchios_with_the_friction_of_the_way_in_which_each_joint_moves(seed: int) -> None:
    drawn = random_robot(random.Random(seed), 1 + seed % 4)
    plain, (ahead, back) = Robot.from_text(drawn.text), np.random.default_rng(seed).uniform(0, 2, (2, drawn.n))
    pairs = [(Name(f"ahead{i}"), Name(f"back{i}")) for i in range(drawn.n)]
    links = (replace(link, coulomb=pair) for link, pair in zip(plain.links, pairs, strict=True))
    robot = replace(plain, links=tuple(links))
    numbers = zip((name.name for pair in pairs for name in pair), np.stack([ahead, back], 1).ravel(), strict=True)
    values = {name: value for name, value in [*drawn.values.items(), *numbers] if name in free_symbols(robot)}
    q, qd, qdd = configurations(random.Random(seed), drawn.n, 3)
    qd[0] *= seed % 3 > 0
    friction, outside = np.where(qd > 0, ahead, np.where(qd < 0, -back, 0)), reference(drawn)
    wanted = outside.rigid_torque(q, qd, qdd) + outside.viscous * qd + friction
    model = numpy_model(robot, build_program(robot, Effort.QUICK))
    fitted = model.base_regressor(q, qd, qdd, params=values) @ model.base_parameters(params=values)
    oracle = Oracle.of(robot, values).evaluate("inverse_dynamics", q, qd, qdd)
    for found in (model.inverse_dynamics(q, qd, qdd, params=values), fitted, oracle):
        assert found == pytest.approx(wanted, rel=1e-10, abs=1e-10 * np.abs(wanted).max())
    assert "(coulomb of the direction)*sign(qd)" in model.inverse_dynamics.__doc__
    slopes = model.inverse_dynamics_dqd(q, qd, params=values)
    assert slopes == pytest.approx(outside.inverse_dynamics_dqd(q, qd), rel=1e-9, abs=1e-9 * np.abs(slopes).max())


@pytest.mark.parametrize(("rate", "friction"), [(2, "2*b + p"), (-2, "-2*b - m"), (0, "0")])
def test_closed_forms_are_the_regressor_times_the_parameters(rate: int, friction: str) -> None:
    model = Model(ARM)
    at = dict.fromkeys(model.qd, rate) | dict.fromkeys((*model.q, *model.qdd), 1)
    found = [str(sympy.expand(entry)) for entry in model.friction.subs(at)]
    assert found == [friction, "1/2" if rate > 0 else "0"]
    fitted = (model.regressor * model.standard_parameters - model.tau).subs(at)
    assert list(fitted.applyfunc(sympy.expand)) == [0, 0]
    assert {"b1", "fp1", "fm1", "fp2", "fm2"} < set(model.base_parameter_names)


def test_base_parameters_are_told_apart_where_gravity_loads_a_slide_as_constantly_as_friction_does() -> None:
    robot, values = ARM, {"b": 0.1, "p": 0.7, "m": 0.2, "g": 9.81}
    found = Oracle.of(robot, values, base_set(robot).parameters).evaluate("base_parameters")
    wanted = numpy_model(robot, build_program(robot, Effort.QUICK)).base_parameters(params=values)
    assert found == pytest.approx(wanted, abs=1e-12)
