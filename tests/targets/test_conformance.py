"""What holds in every language: one table of languages and one of robots, and the properties of all of them."""

import random
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest

from derive.inverse.loops import without_parallelograms
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import Program
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from derive.verification.generated import NumpyModel
from derive.verification.inverse import inverse_errors
from derive.verification.samples import sample_sets
from derive.verification.tolerance import expectation
from derive.verification.verify import trials
from tests.inverse.arms import arm_of, random_arm
from tests.random_robots import random_robot, sampled, seeds
from tests.random_trees import random_tree
from tests.rows import robot_of_rows
from tests.targets.languages import languages, nearest, running
from tests.targets.test_inverse import PARAMETERS, STUCK, UR5, elbow, model_of, program_of

BUILT_IN = ("dh-classical-deluca", "planar-2r-perugia", "scara-matlab")
TOLERANCE = 1e-12
FITTED = 1e-10
"""The oracle finds base parameters by least squares, which has errors of its own."""


def assert_right(language: str, robot: Robot, program: Program) -> None:
    """Every function in every way of calling it, and every solution of inverse kinematics, against the oracle."""
    samples = sample_sets(robot, 6, np.random.default_rng(robot.n))
    with running(language, robot, program) as model, np.errstate(all="ignore"):
        for function in (function.name for function in program):
            for trial in trials(model, function, samples):
                expected = expectation(function, trial.sample_set, trial.arguments)
                got = np.asarray(trial.run(), dtype=float)
                if trial.repeated:
                    got = expected.farthest_repetitions(got)
                assert got.shape == expected.value.shape, (function, trial.how)
                tolerance = FITTED if function == "base_parameters" else TOLERANCE
                assert expected.errors(got).max(initial=0.0) <= tolerance, (function, trial.how)
        if program.inverse:
            assert [count for count, _ in inverse_errors(robot, model, samples, "")]


@pytest.mark.parametrize("language", languages())
@pytest.mark.parametrize("seed", seeds(10, usual=1))
@pytest.mark.first(3)
def test_functions_of_random_robots_are_those_of_the_oracle(language: str, seed: int) -> None:
    robot = Robot.from_text(random_robot(random.Random(900 + seed), 1 + seed % 5).text)
    assert_right(language, robot, full_program(robot))


@pytest.mark.parametrize("language", languages())
@pytest.mark.parametrize("seed", seeds(12, usual=0, swept=4))
def test_functions_of_random_trees_are_those_of_the_oracle(language: str, seed: int) -> None:
    robot = random_tree(random.Random(seed), 2 + seed % 4).robot
    assert_right(language, robot, full_program(robot))


@pytest.mark.parametrize("language", languages("octave", "javascript"))
@pytest.mark.parametrize("name", sampled(catalogue_names(), BUILT_IN))
@pytest.mark.first(3)
def test_functions_of_built_in_robots_are_those_of_the_oracle(language: str, name: str) -> None:
    """Those in Python and C are verified where they are committed."""
    robot = without_parallelograms(Robot.load(name))
    assert_right(language, robot, full_program(robot))


@cache
def full_program(robot: Robot) -> Program:
    return build_program(robot, Effort.QUICK, inverse=True)


OFFSET_SHOULDER = "R 0 0 0.3 0; R -90 0 0.1 0; R 0 0.4 0 0; R -90 0 0.4 0; R 90 0 0 0; R -90 0 0 0"
PLANAR = robot_of_rows(
    "R a: 0.5 | R a: 0.4, theta: pi/3 - q2 | R a: 0.4 | R a: 0.2", "inverse: {task: [x, y, phi], given: [q2]}"
)
"""The angle of a joint in the middle is an argument."""

ARMS = {
    "elbow": elbow(),
    "puma": Robot.load("puma560-corke"),
    "ur5": UR5,
    "offset-shoulder": arm_of("modified", OFFSET_SHOULDER),
    "planar": PLANAR,
}
USUAL = 12  # random configurations before the special ones


def configurations(name: str) -> np.ndarray:
    """Random ones, then those where branches coincide, joints are free, or choices of signs are almost right."""
    rng, n = np.random.default_rng(5), ARMS[name].n
    usual, quarters = rng.uniform(-0.9, 0.9, (USUAL, n)), rng.integers(-2, 3, (16, n)) * np.pi / 2
    wrists = [[0, 0, 0, 0, 0, 0], [0, 90, -90, 0, 0, 0], [10, 20, 30, 40, 0, 50], [0, 0, -90, 0, 45, 0]]
    special = {
        "elbow": [[0.3, 0.5, 0.0, 0.2]],  # stretched
        "puma": np.radians(wrists),
        "ur5": [*quarters, STUCK],
        "offset-shoulder": rng.choice([0, np.pi / 2, -np.pi / 2, np.pi, 0.7], (16, n)),
        "planar": [*quarters / 2, *(quarters / 2 + rng.uniform(-1e-5, 1, quarters.shape))],
    }
    return np.array([*usual, *special[name]])


@dataclass(frozen=True)
class Solver:
    """An arm in a language, and NumPy's solutions of some poses."""

    model: Any
    numpy: NumpyModel
    q: np.ndarray
    poses: np.ndarray
    places: list[int]  # of the given joints
    parameters: dict[str, float]


QUICK_ARMS = {"numpy": ("ur5",), "native": ("planar",), "casadi-c": ("puma",), "octave": ("elbow", "puma")}
SOLVERS = [
    pytest.param((name, arm), id=f"{name}-{arm}", marks=[*marks, *[pytest.mark.sweep] * (arm not in few)])
    for (name,), marks, _ in languages()
    for few in [QUICK_ARMS.get(name, ARMS)]
    for arm in ARMS
]


@pytest.fixture(scope="module", params=SOLVERS)
def solver(request: pytest.FixtureRequest) -> Iterator[Solver]:
    language, arm = request.param
    robot, numpy = ARMS[arm], NumpyModel(model_of(ARMS[arm]))
    parameters, q = PARAMETERS if arm == "elbow" else {}, configurations(arm)
    places = [k for k, joint in enumerate(robot.joints) if joint.variable in (robot.inverse.given or ())]
    with running(language, robot, program_of(robot)) as model:
        yield Solver(model, numpy, q, numpy.call("forward_kinematics", [q], parameters), places, parameters)


@pytest.mark.first(5)
def test_branches_are_those_of_numpy_and_lead_to_their_poses(solver: Solver) -> None:
    """CasADi's functions do not look elsewhere where joints are free; whatever they find leads there."""
    poses, given = solver.poses, solver.q[:, solver.places]
    wanted, kinds = solver.numpy.inverse(poses, given, solver.parameters)
    found, status = solver.model.inverse(poses, given, solver.parameters)
    np.testing.assert_allclose(found[:USUAL], wanted[:USUAL], rtol=0, atol=1e-9)
    compared = slice(USUAL if solver.model.target.startswith("casadi") else None)
    assert np.array_equal(status[compared], kinds[compared])
    assert (status[compared] > 0).any(axis=1).all()
    assert np.array_equal(np.isnan(found).any(axis=-1), status == 0)
    again = solver.numpy.call("forward_kinematics", [np.nan_to_num(found)], solver.parameters)
    assert np.abs(again - poses[:, None])[status > 0].max() < 1e-10
    assert ((found[..., solver.places] == given[:, None]) | (status == 0)[..., None]).all()
    for k in (0, USUAL, len(poses) - 1):
        one, code = solver.model.inverse(poses[k : k + 1], given[k : k + 1], solver.parameters)
        np.testing.assert_allclose(one[0], found[k], rtol=0, atol=1e-9)
        assert np.array_equal(code[0], status[k])


def test_the_nearest_solution_is_that_of_numpy(solver: Solver) -> None:
    """Within limits, full turns included; rounding decides no tie between two turns."""
    if solver.model.target.startswith("casadi"):
        return
    rng, q = np.random.default_rng(2), solver.q
    near = q + np.pi * rng.integers(-2, 3, q.shape) * rng.integers(0, 2, (len(q), 1))
    near[:USUAL:2] = q[:USUAL:2] + rng.uniform(-0.3, 0.3, q[:USUAL:2].shape)
    near[:, solver.places] = q[:, solver.places]
    wanted = nearest(solver.numpy, solver.poses, near, solver.parameters)
    found = nearest(solver.model, solver.poses, near, solver.parameters)
    exists = np.isfinite(wanted).all(axis=1)
    assert exists.sum() >= len(q) // 4
    assert np.array_equal(np.isfinite(found).all(axis=1), exists)
    distances = [np.square(each - near).sum(axis=1)[exists] for each in (found, wanted)]
    np.testing.assert_allclose(*distances, rtol=0, atol=1e-6)


@pytest.mark.parametrize("language", languages("c", "casadi", "casadi-c"))
def test_no_branch_exists_at_what_is_no_number_or_out_of_any_reach(language: str) -> None:
    """The other languages refuse it."""
    robot = elbow()
    poses = model_of(robot).forward_kinematics(np.full((3, 4), 0.3), params=PARAMETERS)
    with running(language, robot, program_of(robot)) as model:
        for entry, place in product((np.nan, np.inf, 1e160, 1e300), ((0, 3), (1, 1))):
            poses[1][place] = entry
            for batch in (poses, poses[1:2]):  # of several poses, and of one
                q, status = model.inverse(batch, np.zeros((len(batch), 0)), PARAMETERS)
                wrong = len(batch) // 2
                assert not status[wrong].any()
                assert np.isnan(q[wrong]).all()
                assert status.any(axis=1).sum() == len(batch) - 1


@pytest.mark.parametrize("language", languages("numpy", "native", "c", "octave", "javascript"))
@pytest.mark.first(1)
def test_solutions_that_stand_alone_beside_infinitely_many_are_listed(language: str) -> None:
    case = random_arm("5dof", 17)
    robot = case.robot()
    q = np.array([[np.radians(55), np.pi, -np.pi / 2, -2.342869, np.pi]])
    poses = model_of(robot).forward_kinematics(q, case.values)
    alone = [[0.959931, 0, 1.570796], [0.959931, np.pi, -1.570796]]
    alone += [[1.393032, 0, 2.003897], [-2.53632, np.pi, 1.925454]]
    with running(language, robot, program_of(robot)) as model:
        ((found,), _) = model.inverse(poses, q[:, :0], case.values)
    apart = np.abs(np.exp(1j * found[:, None, :3]) - np.exp(1j * np.array(alone))).max(axis=2)
    assert (np.nanmin(apart, axis=0) < 2e-3).all()
