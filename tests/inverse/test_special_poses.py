"""Arms and poses at which solutions were lost: by slides whose equations end at infinity, beside singular poses."""

from __future__ import annotations

import itertools
import random
from functools import cache

import numpy as np
import pytest

from derive import Model
from derive.errors import QuantityError
from derive.handouts.notation.derivation import headline
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.solve import solve
from derive.verification.oracle.frames import forward_kinematics
from tests.inverse.arms import LOST, ArmCase
from tests.inverse.solvers import built_modules, solver_of, solver_of_module
from tests.inverse.trial import Trial
from tests.inverse.truth import by_many_starts, smallest_singular_value


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The generated modules of an arm, built once."""
    return cache(lambda name: built_modules(LOST[name].robot(), tmp_path_factory.mktemp(name), "native"))


def beside_eighth_turns(trial, count, seed):
    """Most angles 1e-9 to 1e-3 from multiples of pi/4, or there."""
    draw, q = np.random.default_rng(seed), trial.configurations(count)
    beside = 10.0 ** draw.uniform(-9, -3, (count, 1)) * draw.integers(-1, 2, q.shape)
    turns = draw.integers(-4, 5, q.shape) * np.pi / 4
    return np.where(draw.random(q.shape) < draw.choice([0.5, 0.8, 1.0], (count, 1)), turns, q) + beside


def test_a_slide_whose_equations_are_singular_at_infinity_is_solved():
    trial = Trial(LOST["prrprr"])
    found = trial.judge(trial.poses(trial.configurations(100), "random"), solver_of(trial.case))
    assert (found.empty, found.found) == (0, 100)


@pytest.mark.parametrize("name", ["parallel-123", pytest.param("tiago", marks=pytest.mark.sweep)])
def test_no_solution_is_lost_beside_singular_poses(name, built):
    case, trial = LOST[name], Trial(LOST[name])
    poses = trial.poses(beside_eighth_turns(trial, 300, 5), "beside")
    for solver in (solver_of(case), *(solver_of_module(module, case) for module in built(name).values())):
        found = trial.judge(poses, solver)
        assert (found.empty, found.spurious, found.found) == (0, 0, 300), found.missing


@pytest.mark.parametrize("target", ["numpy", "native"])
def test_a_rounded_pose_is_refused_with_the_tolerance_that_takes_its_nearest_rotation(target, built):
    arm, q = LOST["parallel-123"].arm, np.array([0.3, 0.5, -0.4, 0.2, 0.7, 0.1])
    module, poses = built("parallel-123")[target], np.round(forward_kinematics(arm, q[None]), 4)
    with pytest.raises(ValueError, match=r"not orthonormal .*; tolerance=0\.0001 uses the nearest rotation"):
        module.inverse_kinematics(poses)
    found = module.inverse_kinematics(poses, tolerance=1e-4)[0]
    assert np.nanmin(np.abs(found - q).max(axis=1)) < 1e-3
    near = module.inverse_kinematics_nearest(poses[0], q, tolerance=1e-4)
    assert np.abs(near - q).max() < 1e-3
    rotation = forward_kinematics(arm, near[None])[0, :3, :3]
    left, _, right = np.linalg.svd(poses[0, :3, :3])
    assert np.abs(rotation - left @ right).max() < 1e-9
    with pytest.raises(ValueError, match="not orthonormal"):
        module.inverse_kinematics(poses, tolerance=1e-5)
    with pytest.raises(ValueError, match="tolerance must be a number from 0 to 1"):
        module.inverse_kinematics(poses, tolerance=-1e-3)
    with pytest.raises(ValueError, match="reflection"):
        module.inverse_kinematics(poses * [-1, 1, 1, 1], tolerance=1e-3)


def test_the_solver_takes_the_nearest_rotation_of_a_rounded_pose():
    robot, q = LOST["tiago"].robot(), np.array([0.3, 0.5, -0.4, 0.9, 0.7, 0.1, 0.2])
    solver = InverseSolver.of(robot, solve(robot))
    pose, given = np.round(forward_kinematics(LOST["tiago"].arm, q), 4), q[list(solver.graph.given)]
    with pytest.raises(ValueError, match="tolerance="):
        solver.solve(pose, given)
    assert np.nanmin(np.abs(solver.solve(pose, given, tolerance=1e-3).q - q).max(axis=1)) < 1e-2


@pytest.mark.parametrize(
    ("name", "q"),
    [
        ("rrrp", [0, 0, 0, 0]),
        pytest.param("prrr", [0, 0, np.pi / 2, 0], marks=pytest.mark.sweep),
    ],
)
def test_every_solution_that_stands_alone_is_listed_and_no_more_is_not_claimed(name, q, built):
    case, trial, q = LOST[name], Trial(LOST[name]), np.array([q], dtype=float)
    true = by_many_starts(trial.chain, q[0], starts=60)
    assert len(true) == 2
    assert smallest_singular_value(trial.chain, true).min() > 1e-3
    for solver in (solver_of(case), solver_of_module(built(name)["native"], case)):
        verdict = trial.judge(trial.poses(q, "special", [true]), solver, count=2)
        assert verdict.is_clean, verdict.missing
    solved = Model(case.robot()).inverse
    assert (solved.count, solved.complete, solved.everywhere) == (1, True, False)
    assert headline(solved) == "1 solution for almost every reachable pose; special poses may have more"


def right_angled(pattern, seed):
    """An arm of right angles and many zero lengths."""
    draw, rows = random.Random(f"{pattern} {seed}"), []
    for kind in pattern:
        a, d = (draw.choice(["0", "0", "0.3", "0.4", "-0.25"]) for _ in "ad")
        rows.append((kind, "0", d, a, draw.choice(["0", "90", "-90", "90", "180"])))
    return ArmCase("arm", "", tuple(rows), draw.random() < 0.5)


PATTERNS = ["".join(kinds) for n in (2, 3, 4) for kinds in itertools.product("RP", repeat=n) if kinds.count("P") < 3]


@pytest.mark.parametrize("seed", [pytest.param(k, marks=[pytest.mark.sweep] * (k > 0)) for k in range(4)])
def test_arms_with_few_joints_list_every_solution_at_right_angles(seed):
    """The first round a few patterns alone; many starts are the truth."""
    for pattern in PATTERNS if seed else PATTERNS[::7]:
        trial = Trial(right_angled(pattern, seed))
        robot, chain = trial.case.robot(), trial.chain
        try:
            graph = solve(robot)
        except QuantityError:  # joints that do not move the end effector
            continue
        if graph.given or not graph.is_closed:
            continue
        draw = np.random.default_rng(seed)
        turns, shifts = draw.integers(-1, 3, (3, robot.n)), draw.integers(-1, 2, (3, robot.n))
        q = np.where(chain.arm.revolute, turns * np.pi / 2, shifts * 0.3)
        every = [by_many_starts(chain, one, starts=60) for one in q]
        alone = [true[smallest_singular_value(chain, true) > 1e-4] for true in every]
        verdict = trial.judge(trial.poses(q, pattern, alone), solver_of(trial.case))
        assert verdict.found == verdict.true, (seed, verdict.missing)
        assert not graph.everywhere or max(map(len, alone)) <= graph.count, (pattern, seed, q)
