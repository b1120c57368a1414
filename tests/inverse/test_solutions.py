"""Every arm's solutions against the truth: all of them, none twice, none wrong, none of poses out of reach."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from tests.inverse.arms import CLASSES, HARD, PUBLISHED, random_arm
from tests.inverse.coverage import main
from tests.inverse.solvers import numeric_solver, solver_of
from tests.inverse.trial import Trial

ARMS = {case.name: case for case in PUBLISHED}
USUAL = ("planar-2r-position", "elbow-offset-position", "scara-rrpr", "stanford")
RANDOM = [(kind, number) for kind in CLASSES for number in range(5)]


def check(case, solver, count=2):
    trial = Trial(case, count)
    for poses in (trial.regular(), trial.special(count + 1), trial.boundary(count), trial.unreachable(1)):
        with np.errstate(all="ignore"):
            verdict = trial.judge(poses, solver)
        assert verdict.is_clean, (case.name, poses.kind, verdict.missing)
        assert verdict.residual < 1.1e-10


@pytest.mark.parametrize("name", USUAL)
def test_an_arm_of_a_book_has_every_solution_and_nothing_else(name):
    check(ARMS[name], solver_of(ARMS[name]))


@pytest.mark.parametrize("kind", ["3dof-planar", "4dof"])
def test_a_random_arm_has_every_solution_and_nothing_else(kind):
    case = random_arm(kind, 7)
    check(case, solver_of(case), 1)


@pytest.mark.sweep
@pytest.mark.parametrize("name", sorted(set(ARMS) - set(USUAL)))
def test_any_arm_of_a_book_has_every_solution_and_nothing_else(name):
    check(ARMS[name], solver_of(ARMS[name]), 5)


@pytest.mark.sweep
@pytest.mark.parametrize("case", HARD, ids=lambda case: case.name)
def test_an_arm_on_which_solvers_stumble_has_every_solution_and_nothing_else(case):
    check(case, solver_of(case), 4)


@pytest.mark.sweep
@pytest.mark.parametrize(("kind", "number"), RANDOM)
def test_any_random_arm_has_every_solution_and_nothing_else(kind, number):
    case = random_arm(kind, number)
    check(case, solver_of(case), 4)


def test_the_numeric_solver_finds_every_solution_too():
    for name in ("anthropomorphic-position", "scara-rprr"):
        trial = Trial(ARMS[name], 1)
        verdict = trial.judge(trial.regular(), numeric_solver(ARMS[name]))
        assert verdict.is_clean, verdict.missing


def test_the_trial_sees_what_is_lost_wrong_or_repeated():
    case = ARMS["elbow-offset-position"]
    trial, solver = Trial(case, 2), solver_of(case)
    poses = trial.regular()
    branches, status = solver(poses.poses, poses.given)
    q = branches[0][np.isfinite(branches[0]).all(axis=-1)][0]

    def judged(first):
        changed = np.array(branches)
        changed[0, 0] = first
        return trial.judge(poses, lambda *_: (changed, status))

    assert judged(branches[0, 0]).is_clean
    lost = judged(np.nan)
    assert (lost.complete, lost.true - lost.found) == (1, 1)
    assert judged(q + 0.1).spurious == 1
    repeated = dataclasses.replace(poses, true=[poses.true[0][:0], poses.true[1]])
    doubled = np.concatenate([branches, branches[:, -1:]], axis=1)
    assert trial.judge(repeated, lambda *_: (doubled, status)).duplicates >= 1
    nothing = np.full_like(branches, np.nan)
    assert trial.judge(poses, lambda *_: (nothing, status)).empty == 2
    away = trial.unreachable(2)
    assert trial.judge(away, lambda *_: (branches[: len(away.poses)], status)).claims == len(away.poses)


def test_the_harness_prints_a_line_for_each_class(capsys):
    assert main(["--class", "1dof", "--random-only", "--arms", "1", "--poses", "1"]) == 0
    head, line = [text for text in capsys.readouterr().out.splitlines() if text.strip()]
    assert head.split()[:3] == ["class", "arms", "poses"]
    assert line.split()[:2] == ["1dof", "1/1"]
