"""The truth is true, and the tally of many poses misses nothing."""

from __future__ import annotations

import numpy as np
import pytest

from derive.verification.oracle.frames import forward_kinematics
from tests.inverse import truth
from tests.inverse.arms import CLASSES, PUBLISHED, is_regular, random_arm
from tests.inverse.mass import GENERAL, main, tried, with_truth
from tests.inverse.solvers import solver_of
from tests.inverse.trial import Trial
from tests.random_robots import swept

ARMS = {case.name: case for case in PUBLISHED}

COUNTS = {"planar-2r-position": 2, "anthropomorphic-position": 4, "scara-rrpr": 2}
"""Siciliano et al., section 2.12; Spong et al., chapter 5; Pieper 1968."""

MORE_COUNTS = {"puma560": 8, "ur5": 8, "stanford": 8, "dvrk-psm": 8, "panda": 8}
MORE_COUNTS |= {"jaco": 16, "crx-10ia": 16, "manseur-doty": 16}
"""Lee and Liang 1988, Raghavan and Roth 1993: sixteen at the most."""


@pytest.mark.parametrize(("name", "count"), [*COUNTS.items(), *swept(*MORE_COUNTS.items())])
def test_solutions_are_as_many_as_books_and_papers_say(name, count):
    chain = Trial(ARMS[name]).chain
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
    chain, q = Trial(case).chain, np.random.default_rng(1).uniform(-2, 2, (4, 6))
    assert np.allclose(chain.pose(q)[0], forward_kinematics(case.arm, q), atol=1e-13)
    exact = forward_kinematics(case.arm, q[:, None] + 1e-30j * np.eye(6)).imag[..., :3, :].reshape(4, 6, 12) / 1e-30
    units = np.tile(chain.weight, (6, 1)) * chain.scale[:, None]
    assert np.allclose(chain.values_and_slopes(q)[1], np.swapaxes(exact * units, -1, -2), atol=1e-12)


CASE = ARMS["elbow-offset-position"]


@pytest.fixture(scope="module")
def solved():
    """A trial of one arm, some of its poses, their branches, and the solver."""
    trial, solver = Trial(CASE), solver_of(CASE)
    poses = trial.poses(trial.configurations(20), "random")
    return trial, poses, solver(poses.poses, poses.given)[0], solver


def test_the_verdict_on_all_branches_is_clean(solved):
    trial, poses, branches, solver = solved
    found = trial.judge(poses, lambda *_: (branches, None), count=solver.count)
    assert found.is_clean, found.missing
    assert (found.poses, found.complete, found.true, found.found) == (20, 20, 20, 20)
    assert found.residual < 1e-14


def test_the_verdict_sees_what_is_lost_wrong_repeated_or_too_much_and_an_odd_number(solved):
    trial, poses, branches, solver = solved
    own = int(np.abs(np.nan_to_num(branches[3], nan=9.0) - poses.q[3]).max(axis=-1).argmin())
    other = np.flatnonzero(np.isfinite(branches[4]).all(axis=-1))[0]

    def changed(k, row, value, poses=poses):
        new = np.concatenate([branches, np.full_like(branches[:, :1], np.nan)], axis=1)
        new[k, row] = value
        return trial.judge(poses, lambda *_: (new, None), count=solver.count)

    lost = changed(3, own, np.nan)
    assert (lost.true - lost.found, lost.complete, lost.wrong, lost.spurious) == (1, 19, 1, 0)
    assert lost.missing[0].startswith("random: 1 lost, wrong count at q = ")
    assert changed(3, own, poses.q[3] + 1e-3).spurious == 1
    repeated = changed(4, -1, branches[4, other])
    assert (repeated.repeated, repeated.wrong, repeated.is_clean) == (1, 1, False)
    assert changed(slice(None), slice(None), np.nan).empty == 20
    away = trial.unreachable(20)
    assert len(away.poses) == 20
    assert changed(0, -1, np.nan, away).claims == 20


def test_a_second_solver_that_finds_less_is_counted(solved):
    solver = solved[-1]
    assert tried(CASE, solver, 20, 0, second=solver).is_clean
    found = tried(CASE, solver, 20, 0, second=lambda poses, given: (solver(poses, given)[0][:, :1], None))
    assert found.wrong > 0
    assert "second solver" in found.missing[0]


def test_true_solutions_of_an_arm_are_all_asked_for(solved):
    found, unsure = with_truth(CASE, solved[-1], 5, 1)
    assert found.is_clean, found.missing
    assert unsure == 0
    assert found.true > found.poses == 5


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
    assert found.is_clean, found.missing
