"""The truth is true, and the tally of many poses misses nothing."""

from __future__ import annotations

import numpy as np
import pytest

from derive.verification.oracle.frames import forward_kinematics
from tests.inverse import truth
from tests.inverse.arms import CLASSES, PUBLISHED, is_regular, random_arm
from tests.inverse.mass import GENERAL, main, tally, tried, with_truth
from tests.inverse.solvers import solver_of
from tests.inverse.trial import Trial
from tests.random_robots import swept

ARMS = {case.name: case for case in PUBLISHED}

COUNTS = {"planar-2r-position": 2, "anthropomorphic-position": 4, "scara-rrpr": 2}
"""Siciliano et al., section 2.12; Spong et al., chapter 5; Pieper 1968."""

MORE_COUNTS = {"puma560": 8, "ur5": 8, "stanford": 8, "dvrk-psm": 8, "panda": 8}
MORE_COUNTS |= {"jaco": 16, "crx-10ia": 16, "manseur-doty": 16}
"""Lee and Liang 1988, Raghavan and Roth 1993: sixteen at the most."""


def chain_of(case):
    return truth.Chain(case.arm, {"pose": truth.POSE, "position": truth.POSITION}[case.task], case.given)


@pytest.mark.parametrize(("name", "count"), [*COUNTS.items(), *swept(*MORE_COUNTS.items())])
def test_solutions_are_as_many_as_books_and_papers_say(name, count):
    chain = chain_of(ARMS[name])
    q = np.random.default_rng(5).uniform(-3, 3, (3, chain.arm.n))
    everything = truth.AllSolutions(chain)
    assert everything.count == count
    real, sure = everything.real(q)
    assert sure.all()
    for own, one in zip(real, q, strict=True):
        assert chain.distance(own, one).min() < 1e-9
        assert np.abs(chain.values(own) - chain.values(one)).max() < 1e-10
        others = truth.by_many_starts(chain, one)
        assert len(others) <= len(own)
        assert all(chain.distance(own, other).min() < 1e-6 for other in others)


def test_random_arms_are_regular_the_same_again_and_in_both_conventions():
    cases = [random_arm(kind, number) for number, kind in enumerate(CLASSES)]
    assert cases[5] == random_arm(list(CLASSES)[5], 5)
    assert all(map(is_regular, cases))
    assert {case.modified for case in cases} == {False, True}


def test_poses_and_slopes_of_the_truth_are_those_of_the_oracle():
    case = random_arm("6DOF-P-other", 0)
    chain, q = chain_of(case), np.random.default_rng(1).uniform(-2, 2, (4, 6))
    assert np.allclose(chain.pose(q)[0], forward_kinematics(case.arm, q), atol=1e-13)
    exact = forward_kinematics(case.arm, q[:, None] + 1e-30j * np.eye(6)).imag[..., :3, :].reshape(4, 6, 12) / 1e-30
    units = np.tile(chain.weight, (6, 1)) * chain.scale[:, None]
    assert np.allclose(chain.values_and_slopes(q)[1], np.swapaxes(exact * units, -1, -2), atol=1e-12)


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
