"""The tally of many poses: it misses nothing that is lost, wrong, repeated or counted wrongly."""

from __future__ import annotations

import numpy as np
import pytest

from derive.verification.oracle.frames import forward_kinematics
from tests.inverse.arms import PUBLISHED, random_arm
from tests.inverse.mass import GENERAL, main, tally, tried, with_truth
from tests.inverse.solvers import solver_of
from tests.inverse.trial import Trial

CASE = next(case for case in PUBLISHED if case.name == "elbow-offset-position")


@pytest.fixture(scope="module")
def solved():
    """Poses of one arm, their branches, and the number of solutions."""
    trial, solver = Trial(CASE), solver_of(CASE)
    q = trial.configurations(20)
    return q, solver(forward_kinematics(trial.arm, q), q[:, :0])[0], solver.count


def own_branch(q, branches, k):
    return int(np.abs(np.nan_to_num(branches[k], nan=9.0) - q[k]).max(axis=-1).argmin())


def test_the_tally_of_all_branches_is_clean(solved):
    q, branches, count = solved
    found = tally(CASE, q, branches, count)
    assert found.is_clean, found.examples
    assert (found.poses, found.solutions) == (20, 20)
    assert found.residual < 1e-14


def test_the_tally_sees_a_lost_a_wrong_and_a_repeated_solution_and_an_odd_number(solved):
    q, branches, count = solved
    own, some = own_branch(q, branches, 3), np.flatnonzero(np.isfinite(branches[4]).all(axis=-1))

    def changed(k, row, value):
        new = np.array(branches)
        new[k, row] = value
        return tally(CASE, q, new, count)

    lost = changed(3, own, np.nan)
    assert (lost.lost, lost.wrong, lost.spurious) == (1, 1, 0)
    assert any(text.startswith("lost") for text in lost.examples)
    assert changed(3, own, q[3] + 1e-3).spurious == 1
    repeated = np.concatenate([branches, np.full_like(branches[:, :1], np.nan)], axis=1)
    repeated[4, -1] = branches[4, some[0]]
    found = tally(CASE, q, repeated, count)
    assert (found.repeated, found.wrong) == (1, 1)


def test_a_second_solver_that_finds_less_is_counted(solved):
    solver = solver_of(CASE)
    assert tried(CASE, solver, 20, 0, second=solver).is_clean
    found = tried(CASE, solver, 20, 0, second=lambda poses, given: (solver(poses, given)[0][:, :1], None))
    assert found.wrong > 0
    assert "second solver" in found.examples[0]


def test_true_solutions_of_an_arm_are_all_asked_for(solved):
    found, unsure = with_truth(CASE, solver_of(CASE), 5, 1)
    assert found.is_clean, found.examples
    assert unsure == 0
    assert found.solutions > found.poses == 5


@pytest.mark.parametrize("way", [[], ["--build"]], ids=["alone", "built"])
def test_random_arms_are_generated_and_tried(way, capsys):
    assert main(["arms", "--class", "1dof", "--first", "3", "--arms", "2", "--poses", "3", *way]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("1dof")
    assert "2 arms, 0 failed; 6 poses" in lines[0]


@pytest.mark.sweep
@pytest.mark.parametrize(("kind", "number"), GENERAL[::5])
def test_general_arms_lose_no_solution(kind, number):
    case = random_arm(kind, number)
    found = tried(case, solver_of(case), 100, 3, bar=1e-8)
    assert found.is_clean, found.examples
