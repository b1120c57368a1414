"""Arms without formulas, with their programs, each derived once."""

from functools import cache
from types import ModuleType

import numpy as np

from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import InverseSearch, Program
from derive.robot.robot import Robot
from tests.rows import text_of_rows
from tests.targets.generated_models import numpy_model

GENERAL = text_of_rows(
    "R d: 0.3 | R alpha: -1.3, a: 0.1, d: 0.12, limits: [-2, 2] | R alpha: 0.4, a: a3, d: 0.1, theta: 0.4 - q3"
    "| P a: 0.05, alpha: 0.5 | R alpha: 1.1, a: 0.12, d: 0.2 | R alpha: 0.9, a: 0.2, d: 0.11"
    "| R alpha: 0.7, a: 0.15, d: 0.1, limits: [-4, 4]",
    "inverse: {given: [q4]}",
    convention="modified",
)
"""Six joints of which none follows by itself, and a slide that is given; one length is a parameter."""

LOOSE = text_of_rows(
    "R a: 0.3, alpha: 0.7, d: 0.2 | R a: 0.25, alpha: -1.1, d: 0.1 | R a: 0.2, alpha: 0.9, d: 0.15"
    "| R a: 0.1, alpha: 0.4, d: 0.1",
    "inverse: {task: [x, y, z, phi]}",
)
"""A task for which there is no elimination."""

BASE = "base: [[0.70710678, -0.70710678, 0, 0.1], [0.70710678, 0.70710678, 0, 0], [0, 0, 1, 0.2], [0, 0, 0, 1]]"
CROOKED = text_of_rows("R d: 0.3, alpha: pi/2 | R a: 0.4 | R a: 0.3", f"{BASE}\ninverse: {{task: position}}")
"""An arm with formulas, but for its base, which is a rotation to eight digits."""

PARAMETERS = {"a3": 0.35}


@cache
def robot_of(text: str) -> Robot:
    return Robot.from_text(text)


@cache
def program_of(text: str) -> Program:
    return build_program(robot_of(text), Effort.QUICK, names={"forward_kinematics"}, inverse=True)


def search_of(text: str) -> InverseSearch:
    search = program_of(text).search
    assert search is not None
    return search


@cache
def model_of(text: str) -> ModuleType:
    return numpy_model(robot_of(text), program_of(text))


def poses_of(text: str, count: int) -> tuple[np.ndarray, np.ndarray]:
    q = np.random.default_rng(3).uniform(-1.5, 1.5, (count, robot_of(text).n))
    options = {"params": PARAMETERS} if program_of(text).parameters else {}
    return q, np.asarray(model_of(text).forward_kinematics(q, **options))
