"""Every arm's solutions against the truth: all of them, none twice, none wrong, none of poses out of reach."""

from __future__ import annotations

import numpy as np
import pytest

from tests.inverse.arms import CLASSES, HARD, PUBLISHED, random_arm
from tests.inverse.coverage import main
from tests.inverse.solvers import generated_solver, numeric_solver, solver_of
from tests.inverse.trial import Trial
from tests.inverse.truth import by_many_starts, smallest_singular_value

ARMS = {case.name: case for case in PUBLISHED}
USUAL = ("planar-2r-position", "elbow-offset-position", "scara-rrpr", "stanford")
RANDOM = [(kind, number) for number in range(5) for kind in CLASSES]


def some_swept(values, count):
    """The first ones for the sweep, the others before a release: the truth takes seconds for each pose."""
    marks = [pytest.mark.sweep] * count + [pytest.mark.release] * (len(values) - count)
    return [pytest.param(*(v if isinstance(v, tuple) else (v,)), marks=m) for v, m in zip(values, marks, strict=True)]


def assert_clean(trial, poses, solver, residual=1e-10):
    verdict = trial.judge(poses, solver)
    assert verdict.is_clean, (trial.case.name, poses.kind, verdict.missing[:3])
    assert verdict.residual < residual


def check(case, solver, count=2):
    trial = Trial(case, count)
    for poses in (trial.regular(), trial.special(count + 1), trial.boundary(count), trial.unreachable(1)):
        assert_clean(trial, poses, solver, 1.1e-10)


@pytest.mark.parametrize("name", USUAL)
def test_an_arm_of_a_book_has_every_solution_and_nothing_else(name):
    check(ARMS[name], solver_of(ARMS[name]))


@pytest.mark.parametrize("kind", ["3dof-planar", "4dof"])
def test_a_random_arm_has_every_solution_and_nothing_else(kind):
    case = random_arm(kind, 7)
    check(case, solver_of(case), 1)


@pytest.mark.parametrize("name", some_swept(sorted(set(ARMS) - set(USUAL), key=lambda name: name[::-1]), 16))
def test_any_arm_of_a_book_has_every_solution_and_nothing_else(name):
    check(ARMS[name], solver_of(ARMS[name]), 5)


@pytest.mark.parametrize("case", some_swept(HARD, 8), ids=lambda case: case.name)
def test_an_arm_on_which_solvers_stumble_has_every_solution_and_nothing_else(case):
    check(case, solver_of(case), 4)


@pytest.mark.parametrize(("kind", "number"), some_swept(RANDOM, len(CLASSES)))
def test_any_random_arm_has_every_solution_and_nothing_else(kind, number):
    case = random_arm(kind, number)
    check(case, solver_of(case), 4)


LOST_ONCE = [
    ("6R-three-parallel", 0, [2.332179, 0, -np.pi / 2, 3 * np.pi / 2, 0, 2.673796]),
    ("6DOF-P-other", 1, [-0.8047974, -0.7480646, 0, 1.375375, 1.820017, -0.4915693]),
    ("6DOF-P-other", 1, [0.3633811, 2.319763, 0, 2.248554, -0.9955701, -0.7064286]),
    ("5dof", 17, [np.radians(-35), 0, -np.pi / 2, 1.112214, -np.pi / 2]),
]
"""Singular poses at which generated code once had no solution, or lost some."""


@pytest.mark.sweep
@pytest.mark.parametrize(("kind", "number", "q"), LOST_ONCE)
def test_generated_code_has_solutions_of_poses_that_were_lost_once(kind, number, q):
    case = random_arm(kind, number)
    trial, nothing = Trial(case, 1), np.empty((0, case.arm.n))
    assert_clean(trial, trial.poses(np.array([q]), "singular", [nothing]), generated_solver(case))


LOST_BESIDE_OTHERS = [
    ("6R-offset", 20, [-3 * np.pi / 2, 0, -np.pi / 2, 0, np.radians(-35), 2.530727]),
    ("6R-offset", 21, [-np.pi / 2, -np.pi / 2, 0, np.pi / 2, 0, np.pi]),
    ("5dof", 11, [0, -np.pi / 2, 0, -np.pi / 2, 0.519]),
    ("5dof", 17, [0.165268, 0, 2.24137, 1.112214, -np.pi / 2]),
    ("hard", 1, [np.pi, 0, -np.pi / 2, -np.pi / 2, np.pi, 0]),
]
"""Singular poses at which solutions that stand alone were lost once: beside many others, or on sheets of their own."""


@pytest.mark.sweep
@pytest.mark.parametrize("make", [solver_of, generated_solver])
@pytest.mark.parametrize(("kind", "number", "q"), LOST_BESIDE_OTHERS)
def test_solutions_that_stand_alone_at_a_singular_pose_are_found(kind, number, q, make):
    case = HARD[number] if kind == "hard" else random_arm(kind, number)
    trial, q = Trial(case, 1), np.array(q)
    found = by_many_starts(trial.chain, q, starts=150)
    alone = found[smallest_singular_value(trial.chain, found) > 1e-4]
    assert len(alone) > 1
    assert_clean(trial, trial.poses(q[None], "singular", [alone]), make(case))


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["scara-wrist", "ur5", "paul-elbow", "rhino-xr3", "stanford"])
def test_generated_code_loses_nothing_at_poses_of_eighth_turns(name):
    case = ARMS[name]
    solver, trial = generated_solver(case), Trial(case, 1)
    q = np.random.default_rng(3).integers(-3, 5, (1000, case.arm.n)) * np.pi / 4
    assert_clean(trial, trial.poses(q, "singular"), solver)


def test_the_numeric_solver_finds_every_solution_too():
    for name in ("anthropomorphic-position", "scara-rprr"):
        trial = Trial(ARMS[name], 1)
        verdict = trial.judge(trial.regular(), numeric_solver(ARMS[name]))
        assert verdict.is_clean, verdict.missing


def test_the_harness_prints_a_line_for_each_class(capsys):
    assert main(["--class", "1dof", "--random-only", "--arms", "1", "--poses", "1"]) == 0
    assert capsys.readouterr().out.split()[:3] == ["1dof", "1/1", "arms,"]
