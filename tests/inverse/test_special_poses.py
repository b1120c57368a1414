"""Arms and poses at which solutions were lost: by slides whose equations end at infinity, beside singular poses."""

from __future__ import annotations

import itertools
import random
from pathlib import Path

import numpy as np
import pytest

from derive import Model
from derive.errors import QuantityError
from derive.handouts.notation.derivation import headline
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.solve import solve
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, numeric_arm
from tests.inverse.solvers import built_module
from tests.inverse.truth import POSE, Chain, by_many_starts, smallest_singular_value

ROBOTS = Path(__file__).parent / "robots"


def python_solver(robot):
    """Poses and given joints in, branches out."""
    solver = InverseSolver.of(robot, solve(robot))
    return lambda poses, given: solver.solve(poses, given).q


def built_solver(robot, folder, target):
    """The same as `python_solver` by a generated module."""
    module = built_module(robot, folder, target, "c")
    return lambda poses, given: module.inverse_kinematics(poses, given=given if given.shape[1] else None)


def judged(robot, solver, q):
    """At how many poses there is no solution, the configuration is none of them, and the worst error of one."""
    arm, graph = numeric_arm(robot, {}), solve(robot)
    chain, poses = Chain(arm, POSE, graph.given), forward_kinematics(arm, q)
    with np.errstate(all="ignore"):
        found = solver(poses, q[:, list(graph.given)])
    exists = np.isfinite(found).all(axis=-1)
    errors = np.abs(chain.values(np.nan_to_num(found)) - chain.values(q)[:, None]).max(axis=-1)
    away = np.where(exists, chain.distance(np.nan_to_num(found), q[:, None]), np.inf).min(axis=1, initial=np.inf)
    lost = (away > 1e-4) & (smallest_singular_value(chain, q) > 1e-4)
    return int((~exists.any(axis=1)).sum()), int(lost.sum()), float(np.where(exists, errors, 0.0).max())


def random_configurations(robot, count, seed=0):
    """Angles of 3 rad at most, slides of a third of the reach."""
    arm = numeric_arm(robot, {})
    wide = np.where(arm.revolute, 3.0, Chain(arm).unit / 3)
    return np.random.default_rng(seed).uniform(-wide, wide, (count, arm.n))


def beside_eighth_turns(robot, count, seed):
    """Most angles 1e-9 to 1e-3 from multiples of pi/4, or there."""
    draw, q = np.random.default_rng(seed), random_configurations(robot, count, seed)
    beside = 10.0 ** draw.uniform(-9, -3, (count, 1)) * draw.integers(-1, 2, q.shape)
    turns = draw.integers(-4, 5, q.shape) * np.pi / 4
    return np.where(draw.random(q.shape) < draw.choice([0.5, 0.8, 1.0], (count, 1)), turns, q) + beside


def test_a_slide_whose_equations_are_singular_at_infinity_is_solved():
    robot = Robot.load(ROBOTS / "prrprr.yaml")
    assert judged(robot, python_solver(robot), random_configurations(robot, 100))[:2] == (0, 0)


@pytest.mark.parametrize("name", ["parallel-123", pytest.param("tiago", marks=pytest.mark.sweep)])
def test_no_solution_is_lost_beside_singular_poses(name, tmp_path):
    robot = Robot.load(ROBOTS / f"{name}.yaml")
    q = beside_eighth_turns(robot, 300, 5)
    for solver in (python_solver(robot), *(built_solver(robot, tmp_path, target) for target in ("native", "numpy"))):
        empty, lost, worst = judged(robot, solver, q)
        assert (empty, lost) == (0, 0)
        assert worst < 1e-9


@pytest.mark.parametrize("target", ["numpy", "native"])
def test_a_rounded_pose_is_refused_with_the_tolerance_that_takes_its_nearest_rotation(target, tmp_path):
    robot, q = Robot.load(ROBOTS / "parallel-123.yaml"), np.array([0.3, 0.5, -0.4, 0.2, 0.7, 0.1])
    module = built_module(robot, tmp_path, target, "c")
    poses = np.round(forward_kinematics(numeric_arm(robot, {}), q[None]), 4)
    with pytest.raises(ValueError, match=r"from orthonormal .*; with tolerance=0\.0001 the nearest rotation is taken"):
        module.inverse_kinematics(poses)
    found = module.inverse_kinematics(poses, tolerance=1e-4)[0]
    assert np.nanmin(np.abs(found - q).max(axis=1)) < 1e-3
    near = module.inverse_kinematics_nearest(poses[0], q, tolerance=1e-4)
    assert np.abs(near - q).max() < 1e-3
    rotation = forward_kinematics(numeric_arm(robot, {}), near[None])[0, :3, :3]
    left, _, right = np.linalg.svd(poses[0, :3, :3])
    assert np.abs(rotation - left @ right).max() < 1e-9
    with pytest.raises(ValueError, match="from orthonormal"):
        module.inverse_kinematics(poses, tolerance=1e-5)
    with pytest.raises(ValueError, match="tolerance must be a number from 0 to 1"):
        module.inverse_kinematics(poses, tolerance=-1e-3)
    with pytest.raises(ValueError, match="mirrors"):
        module.inverse_kinematics(poses * [-1, 1, 1, 1], tolerance=1e-3)


def test_the_solver_takes_the_nearest_rotation_of_a_rounded_pose():
    robot, q = Robot.load(ROBOTS / "tiago.yaml"), np.array([0.3, 0.5, -0.4, 0.9, 0.7, 0.1, 0.2])
    solver = InverseSolver.of(robot, solve(robot))
    pose, given = np.round(forward_kinematics(numeric_arm(robot, {}), q[None])[0], 4), q[list(solver.graph.given)]
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
def test_every_solution_that_stands_alone_is_listed_and_no_more_is_not_claimed(name, q, tmp_path):
    robot, q = Robot.load(ROBOTS / f"{name}.yaml"), np.array([q], dtype=float)
    chain = Chain(numeric_arm(robot, {}))
    true = by_many_starts(chain, q[0], starts=60)
    assert len(true) == 2
    assert smallest_singular_value(chain, true).min() > 1e-3
    poses = forward_kinematics(chain.arm, q)
    for solver in (python_solver(robot), built_solver(robot, tmp_path, "native")):
        found = solver(poses, np.empty((1, 0)))[0]
        found = found[np.isfinite(found).all(axis=1)]
        assert len(found) == 2
        assert all(chain.distance(found, one).min() < 1e-6 for one in true)
    solved = Model(robot).inverse
    assert (solved.count, solved.complete, solved.everywhere) == (1, True, False)
    assert headline(solved) == "1 solution for almost every reachable pose; special poses may have more"


def text_of(pattern, seed):
    """An arm of right angles and many zero lengths."""
    draw, rows = random.Random(f"{pattern} {seed}"), []
    for i, kind in enumerate(pattern, 1):
        cells = {key: draw.choice(["0", "0", "0.3", "0.4", "-0.25"]) for key in ("a", "d")}
        cells["alpha"] = draw.choice(["0", "pi/2", "-pi/2", "pi/2", "pi"])
        cells["type"] = "revolute" if kind == "R" else "prismatic"
        if kind == "P":
            cells["d"] = f"q{i} + {cells['d']}"
        rows.append(f"  - {{{', '.join(f'{key}: {value}' for key, value in cells.items())}}}")
    convention = draw.choice(["standard", "modified"])
    return f"name: arm\nconvention: {convention}\njoints:\n" + "\n".join(rows) + "\n"


PATTERNS = ["".join(kinds) for n in (2, 3, 4) for kinds in itertools.product("RP", repeat=n) if kinds.count("P") < 3]


@pytest.mark.parametrize("seed", [pytest.param(k, marks=[pytest.mark.sweep] * (k > 0)) for k in range(4)])
def test_arms_with_few_joints_list_every_solution_at_right_angles(seed):
    """The first round a few patterns alone; many starts are the truth."""
    for pattern in PATTERNS if seed else PATTERNS[::7]:
        robot = Robot.from_text(text_of(pattern, seed), "arm")
        try:
            graph = solve(robot)
        except QuantityError:  # joints that do not move the end effector
            continue
        if graph.given or not graph.is_closed:
            continue
        chain, draw = Chain(numeric_arm(robot, {})), np.random.default_rng(seed)
        turns, shifts = draw.integers(-1, 3, (3, robot.n)), draw.integers(-1, 2, (3, robot.n))
        q = np.where(chain.arm.revolute, turns * np.pi / 2, shifts * 0.3)
        with np.errstate(all="ignore"):
            found = InverseSolver.of(robot, graph).solve(forward_kinematics(chain.arm, q)).q
        for own, one in zip(found, q, strict=True):
            true = by_many_starts(chain, one, starts=60)
            true = true[smallest_singular_value(chain, true) > 1e-4]
            own = own[np.isfinite(own).all(axis=1)]
            assert all(len(own) and chain.distance(own, each).min() < 1e-4 for each in true), (pattern, seed, one)
            assert not graph.everywhere or len(true) <= graph.count, (pattern, seed, one)
