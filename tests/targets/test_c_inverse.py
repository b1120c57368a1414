"""Inverse kinematics in C: limits, lengths, given joints and what may be left out, as the robot has them."""

import json

import numpy as np

from derive.robot.robot import Robot
from derive.targets.c import c_inverse
from tests.targets.c_models import c_model, needs_compiler
from tests.targets.generated_models import source_of
from tests.targets.javascript_model import JavaScriptModel
from tests.targets.test_inverse import elbow, model_of, program_of


def test_joints_without_limits_have_infinite_ones() -> None:
    robot, program = elbow(), program_of(elbow())
    assert program.inverse is not None
    text = c_inverse(program.inverse, source_of(robot, program))
    assert text["lower"] == "-2.0, -INFINITY, -INFINITY, -1.0"
    assert text["upper"] == "2.0, INFINITY, INFINITY, 1.0"
    assert text["revolute"] == "1, 1, 1, 0"


def test_what_is_loaded_has_the_length_that_the_program_reads() -> None:
    robot, program = elbow(), program_of(elbow())
    assert program.inverse is not None
    text = c_inverse(program.inverse, source_of(robot, program))
    assert text["size"] == text["branches"] * robot.n
    assert {load["name"]: load["width"] for load in text["loads"]}["T"] == 16
    assert {load["name"] for load in text["loads"] if load["is_optional"]} <= {"near"}


PLANAR = """
name: planar
convention: standard
joints:
  - {type: revolute, a: 0.5}
  - {type: revolute, a: 0.4, theta: pi/3 - q2}
  - {type: revolute, a: 0.4}
  - {type: revolute, a: 0.2}
inverse: {task: [x, y, phi], given: [q2]}
"""


def test_joints_that_are_given_keep_their_numbers_in_every_language() -> None:
    robot = Robot.from_text(PLANAR)
    model = model_of(robot)
    q = np.random.default_rng(4).integers(-8, 9, (24, robot.n)) * np.pi / 4
    q[12:] += np.random.default_rng(5).uniform(-1e-5, 1, (12, robot.n))
    poses = model.forward_kinematics(q)
    found, status = model.inverse_kinematics(poses, given=q[:, [1]], status=True)
    assert (status > 0).any(axis=1).all()
    assert ((found[..., 1] == q[:, [1]]) | (status == 0)).all()
    javascript = JavaScriptModel(robot, program_of(robot))
    for pose, row in zip(poses[::8].tolist(), q[::8, 1].tolist(), strict=True):
        branches = javascript.value(f"model.inverseKinematics({json.dumps(pose)}, [{row!r}])")["q"]
        assert {branch[1] for branch in branches if branch} == {row}


@needs_compiler
def test_joints_that_are_given_keep_their_numbers_in_c() -> None:
    robot = Robot.from_text(PLANAR)
    q = np.random.default_rng(4).integers(-8, 9, (24, robot.n)) * np.pi / 4
    found, status = c_model(robot, program_of(robot)).inverse(model_of(robot).forward_kinematics(q), q[:, [1]], {})
    assert (status > 0).any(axis=1).all()
    assert ((found[..., 1] == q[:, [1]]) | (status == 0)).all()
