"""Random robots from the text of their file to generated NumPy and CasADi code, against Pinocchio and the oracle.

Programs are searched with the effort that users get.
"""

import random
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

from derive.model.identification.base_parameters import base_set
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot
from derive.robot.task_rows import task_rows
from derive.targets.casadi import render_casadi
from derive.targets.numpy import render_numpy
from derive.targets.target import Source
from derive.verification.generated import GeneratedModel, load_models
from derive.verification.oracle.functions import FUNCTIONS, Oracle
from derive.verification.tolerance import TOLERANCE
from derive.verification.verify import verify
from tests.random_robots import RandomRobot, configurations, random_robot, robots, seeds, swept
from tests.targets.generated_models import numpy_model
from tests.verification.oracle.pinocchio_reference import Array, reference

SEEDS = 28


def generate(robot: Robot, folder: Path, effort: Effort = Effort.FULL) -> tuple[GeneratedModel, ...]:
    """Write both modules into ``folder`` and load them."""
    source = Source(robot, build_program(robot, effort), "0.0.0")
    for name, text in {**render_numpy(source), **render_casadi(source)}.items():
        (folder / name).write_text(text, encoding="utf-8")
    return load_models(folder)


def check_with_pinocchio(robot: RandomRobot, models: tuple[GeneratedModel, ...]) -> None:
    """Every function of every target at one random state."""
    outside = reference(robot)
    q, qd, qdd, tau = configurations(random.Random(robot.n), robot.n, 4)
    h = configurations(random.Random(robot.n), 6, 1)[0]
    state: Mapping[str, Array] = {"q": q, "qd": qd, "qdd": qdd, "tau": 20 * tau, "h": h}
    for model in models:
        for name in Oracle.of(Robot.from_text(robot.text), robot.values).functions:
            arguments = [state[argument] for argument in FUNCTIONS[name].arguments]
            got: Any = model.call(name, arguments, robot.values)
            wanted = getattr(outside, name)(*arguments)
            assert got.shape == wanted.shape
            if outside.determines(name, q):
                assert np.abs(got - wanted).max() < TOLERANCE * max(1.0, np.abs(wanted).max()), (model.target, name)


def check_with_the_oracle(robot: RandomRobot, loaded: Robot, folder: Path, seed: int) -> None:
    """Everything that `derive verify` looks at, and that it looks at everything."""
    report = verify(loaded, folder, samples=6, seed=seed)
    base = base_set(loaded).parameters if loaded.has_dynamics else None
    assert report.worst < 1e-10
    assert {(row.target, row.function) for row in report.rows} == {
        (target, function)
        for target in ("numpy", "casadi")
        for function in Oracle.of(loaded, robot.values, base).functions
    }


@pytest.mark.parametrize(("examples", "joints"), [(2, 3), *swept((30, 5))])
def test_generated_code_agrees_with_pinocchio_and_the_oracle(tmp_path: Path, examples: int, joints: int) -> None:
    """Every robot writes over the files of the one before."""

    @given(robots(max_joints=joints))
    @settings(max_examples=examples, deadline=None)
    def check(robot: RandomRobot) -> None:
        loaded = Robot.from_text(robot.text)
        models = generate(loaded, tmp_path)
        assert [model.target for model in models] == ["numpy", "casadi"]
        check_with_pinocchio(robot, models)
        check_with_the_oracle(robot, loaded, tmp_path, seed=0)

    check()


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds(SEEDS, usual=2))
def test_generated_code_of_many_robots_agrees_with_pinocchio_and_the_oracle(tmp_path: Path, seed: int) -> None:
    """The same robots in every run: one to seven joints of all kinds, every fifth without links."""
    robot = random_robot(random.Random(seed), 1 + seed % 7, dynamics=seed % 5 > 0)
    loaded = Robot.from_text(robot.text)
    check_with_pinocchio(robot, generate(loaded, tmp_path))
    check_with_the_oracle(robot, loaded, tmp_path, seed)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("joints", "standard", "effort"),
    swept(*((18, each, Effort.QUICK) for each in (True, False)), (32, True, Effort.FULL), (64, False, Effort.FULL)),
)
def test_generated_code_of_a_long_chain_agrees_with_pinocchio(
    tmp_path: Path, joints: int, standard: bool, effort: Effort
) -> None:
    """Eighteen joints with dynamics, for which a long search would take minutes; more of them without."""
    robot = random_robot(random.Random(joints), joints, standard=standard, dynamics=joints == 18)
    check_with_pinocchio(robot, generate(Robot.from_text(robot.text), tmp_path, effort))


@pytest.mark.parametrize("seed", seeds(100, usual=4))
def test_dynamics_under_a_wrench_are_those_of_pinocchio(seed: int) -> None:
    drawn = random_robot(random.Random(seed), 1 + seed % 7)
    robot, outside = Robot.from_text(f"{drawn.text}\nwrench: [world, end]"), reference(drawn)
    names = [name for name, each in FUNCTIONS.items() if each.wrench]
    model = numpy_model(robot, build_program(robot, Effort.QUICK, names=names))
    q, qd, last = configurations(random.Random(seed), robot.n, 3)
    h = 10 * configurations(random.Random(seed), 6, 1)[0]
    for name in names:
        found, wanted = (
            getattr(model, name)(q, qd, last, h, params=drawn.values),
            getattr(outside, name)(q, qd, last, h),
        )
        assert np.abs(found - wanted).max() < 1e-10 * max(1.0, np.abs(wanted).max()), name


@pytest.mark.parametrize("seed", seeds(100, usual=6))
def test_the_inertia_of_the_task_is_that_of_pinocchio_where_its_rows_are_independent(seed: int) -> None:
    drawn = random_robot(random.Random(seed), 1 + seed % 7)
    robot, outside = Robot.from_text(drawn.text), reference(drawn)
    if len(task_rows(robot)) <= robot.n:
        model = numpy_model(robot, build_program(robot, Effort.QUICK, names=("task_inertia",)))
        for q in configurations(random.Random(seed), robot.n, 4):
            if outside.determines("task_inertia", q):
                found, wanted = model.task_inertia(q, params=drawn.values), outside.task_inertia(q)
                assert np.abs(found - wanted).max() < 1e-10 * np.abs(wanted).max()


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_where_its_rows_lose_rank_the_inertia_of_the_task_has_no_finite_diagonal() -> None:
    """Alone and in batches, however the other joints stand, but nearby; and of an arm that keeps to a plane."""
    planar = random_robot(random.Random(146196), 5)
    arms = [(Robot.load("scara-matlab"), 1), (Robot.load("puma560-corke"), 4), (Robot.from_text(planar.text), 0)]
    for robot, joint in arms:
        model = numpy_model(robot, build_program(robot, Effort.QUICK, names=("task_inertia",)))
        params = {name: planar.values[name] for name in model.PARAMETERS}
        q = np.random.default_rng(6).uniform(-1, 1, (40, robot.n))
        for q[:, joint] in (0, np.pi):
            for found in (model.task_inertia(q, params), [model.task_inertia(each, params) for each in q]):
                assert not np.isfinite(np.diagonal(found, axis1=-2, axis2=-1)).any()
        q[:, joint] = 1e-3
        assert np.isfinite(model.task_inertia(q, params)).all() == (joint > 0)


def test_a_force_accelerates_the_task_as_its_equation_of_motion_says() -> None:
    """Lambda a + mu + p = F (Khatib 1987): mu + p by the consistent inverse, and by the motion without torques."""
    model = numpy_model(puma := Robot.load("puma560-corke"), build_program(puma, Effort.QUICK))
    q, qd, force = np.random.default_rng(7).uniform(0.3, 1, (3, 6))
    jacobian, inertia = model.jacobian(q), model.task_inertia(q)
    turning, inverse = model.jacobian_dot(q, qd) @ qd, np.linalg.solve(model.inertia_matrix(q), jacobian.T) @ inertia
    bias = inverse.T @ model.inverse_dynamics(q, qd, 0 * q) - inertia @ turning
    for push in (0 * q, force):
        acceleration = jacobian @ model.forward_dynamics(q, qd, jacobian.T @ push) + turning
        assert np.abs(inertia @ acceleration + bias - push).max() < 1e-10 * np.abs(bias).max()
