"""All formulations of one function compute the same values: whichever is the cheapest, it is right."""

import random
from functools import cache

import numpy as np
import pytest

from derive.programs.formulations import dynamics, kinematics
from derive.programs.formulations.parallel_axes import parallel_runs
from derive.programs.formulations.trace import Trace
from derive.programs.optimise.search_policy import Effort
from derive.programs.tape.value import Value
from derive.robot.robot import Robot
from tests.programs.parallel_arms import numbers, parallel_arm
from tests.random_robots import random_robot

FORMULATIONS = {
    "T": kinematics.poses,
    "T_i": kinematics.link_poses,
    "J": kinematics.jacobians,
    "J_end": kinematics.end_jacobians,
    "dJ/dt": kinematics.jacobian_rates,
    "B": dynamics.inertia_matrices,
    "C": dynamics.coriolis_matrices,
    "g": dynamics.gravity_vectors,
    "kinetic": dynamics.kinetic_energies,
    "potential": dynamics.potential_energies,
    "tau": dynamics.torques,
    "C qd": dynamics.coriolis_vectors,
    "d tau / d q": dynamics.torque_position_derivatives,
    "d tau / d qd": dynamics.torque_velocity_derivatives,
    "Y": dynamics.regressors,
    "Y_b": dynamics.base_regressors,
    "beta": dynamics.base_parameters,
}


@cache
def trace_of(seed: int) -> Trace:
    return Trace(Robot.from_text(random_robot(random.Random(seed), 1 + seed % 3).text), Effort.QUICK)


@pytest.mark.parametrize("name", FORMULATIONS)
@pytest.mark.parametrize("seed", range(6))
def test_formulations_agree(name: str, seed: int) -> None:
    trace = trace_of(seed)
    found = {way.words: numbers(trace, way.trace()) for way in FORMULATIONS[name](trace)}
    assert found
    first = next(iter(found.values()))
    for words, values in found.items():
        assert np.abs(values - first).max(initial=0.0) <= 1e-11 * max(1.0, np.abs(first).max(initial=0.0)), words


def test_most_functions_can_be_computed_in_several_ways() -> None:
    several = {name for name, ways in FORMULATIONS.items() for seed in range(6) if len(list(ways(trace_of(seed)))) > 1}
    assert len(several) >= 8


@pytest.mark.parametrize("seed", range(8))
def test_runs_of_parallel_axes_take_every_joint_once(seed: int) -> None:
    trace = parallel_arm(seed)

    def total(turns: object) -> tuple[Value, Value]:
        return trace.chain.one, trace.chain.zero

    runs = parallel_runs(trace.chain, total)
    assert [run.first for run in runs] == [sum(len(run.placements) for run in runs[:k]) for k in range(len(runs))]
    assert sum(len(run.placements) for run in runs) == trace.n
