"""Inverse kinematics of the ends of trees in generated NumPy, against the oracle seen from each end."""

import random
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from derive.errors import RobotFileError, VerificationError
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.publish.modules import module_of
from derive.robot.robot import Robot
from derive.robot.tree import path, way_to
from derive.targets import numpy as target
from derive.targets.target import Source
from derive.verification.generated import load_models
from derive.verification.inverse import inverse_errors, solvers
from derive.verification.oracle.functions import Oracle
from derive.verification.samples import sample_sets
from tests.motion.test_trees import TORSO
from tests.random_robots import seeds
from tests.random_trees import random_tree


def module(robot: Robot, folder: Path) -> Any:
    program = build_program(robot, Effort.QUICK, names={"forward_kinematics"}, inverse=True)
    text = target.TARGET.render(Source(robot, program, "0"))[target.FILE]
    (folder / target.FILE).write_text(text, encoding="utf-8")
    return module_of(folder / target.FILE, "model_of_ends")


@pytest.mark.parametrize("seed", seeds(60, 3, 30))
def test_every_solution_leads_the_end_to_its_pose(seed: int, tmp_path: Path) -> None:
    robot = random_tree(random.Random(seed), joints=2 + seed % 6).robot
    model, solved = module(robot, tmp_path), solvers(load_models(tmp_path)[0])
    ends = {end.name: path(robot, way_to(robot, end.after).joint) for end in robot.ends}
    assert [ends[end] for end in getattr(model, "JOINTS_OF", ())] == [*getattr(model, "JOINTS_OF", {}).values()]
    sets = sample_sets(robot, 12, np.random.default_rng(seed))
    assert all(worst < 1e-10 for solver in solved for _, worst in inverse_errors(robot, solver, sets, ""))


def test_functions_take_the_end_by_name_or_argument(tmp_path: Path) -> None:
    robot = Robot.from_text(TORSO)
    model, oracle = module(robot, tmp_path), Oracle.of(robot)
    assert model.JOINTS_OF == {"left": (0, 1, 2, 3), "right": (0, 4, 5, 6)}
    assert model.GIVEN_OF == {"left": ("waist",), "right": ("waist",)}
    q = np.array([[0.3, 0.2, 0.4, -0.9, -0.3, 0.1, -0.5], [-0.2, 0.9, -0.1, -0.4, 0.8, -0.6, -1.5]])
    for end, joints in model.JOINTS_OF.items():
        own = q[:, list(joints)]
        T = oracle.evaluate(f"forward_kinematics_{end}", q)
        solve, nearest = (getattr(model, f"inverse_kinematics{part}_{end}") for part in ("", "_nearest"))
        found, status = solve(T, given=q[:, :1], status=True)
        assert np.nanmin(np.abs(found - own[:, None]).max(axis=2), axis=1) == pytest.approx(0, abs=1e-9)
        assert status.shape == found.shape[:2]
        assert nearest(T, own + 0.01 * (np.arange(4) > 0)) == pytest.approx(own, abs=1e-9)
        again = model.inverse_kinematics(T, given=q[:, :1], end=end)
        np.testing.assert_array_equal(again, found)
        np.testing.assert_array_equal(model.inverse_kinematics_nearest(T[0], own[0], end=end), nearest(T[0], own[0]))
    with pytest.raises(ValueError, match="inverse_kinematics: end 'head'; allowed: left, right"):
        model.inverse_kinematics(T, end="head")
    with pytest.raises(ValueError, match="inverse_kinematics_nearest_left: q must be real numbers of shape"):
        model.inverse_kinematics_nearest_left(T, q)


def test_a_wrong_solution_and_wrong_joints_are_found(tmp_path: Path) -> None:
    robot = Robot.from_text(TORSO)
    module(robot, tmp_path)
    file, sets = tmp_path / target.FILE, sample_sets(robot, 6, np.random.default_rng(0))
    text = file.read_text(encoding="utf-8")
    faults = {
        "JOINTS_OF of model_numpy.py has not the joints of right": ('"right": (0, 4, 5, 6)', '"right": (0, 1, 2, 3)'),
        "inverse_kinematics_right of model_numpy.py": ("=_inverse_kinematics_right,", "=_inverse_kinematics_left,"),
    }
    for message, (old, new) in faults.items():
        file.write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(VerificationError, match=re.escape(message)):
            [list(inverse_errors(robot, solver, sets, "")) for solver in solvers(load_models(tmp_path)[0])]


def test_roots_that_move_and_names_of_functions_are_refused() -> None:
    program = build_program(Robot.load("human-skeleton"), Effort.QUICK, names=frozenset(), inverse=True)
    assert (program.of_ends, program.without_inverse) == ((), "the root moves")
    with pytest.raises(RobotFileError, match="a function such as jacobian_nearest could be another one"):
        Robot.from_text(TORSO.replace("  left:\n", "  nearest:\n"))
