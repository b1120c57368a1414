"""Verification of inverse kinematics finds what is wrong, and nothing where all is right."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache

import numpy as np
import pytest

from derive.errors import VerificationError
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot
from derive.verification.generated import NumpyModel
from derive.verification.inverse import CLOSED, inverse_errors
from derive.verification.oracle.frames import Array
from derive.verification.samples import Parameters, SampleSet, sample_sets
from tests.targets.generated_models import numpy_model

Change = Callable[[Array, Array], tuple[Array, Array]]
ROBOT = Robot.from_text(
    "name: planar\nconvention: standard\njoints:\n  - {type: revolute, a: 0.5}\n  - {type: revolute, a: 0.4}\n"
    "inverse: {task: [x, y]}\n"
)


NAMED = Robot.from_text(
    "name: named\nconvention: standard\njoints:\n  - {type: revolute, a: 0.5}\n  - {type: revolute, a: 0.4}\n"
    "  - {type: revolute, a: 0.2, name: wrist}\ninverse: {task: [x, y], given: [q3]}\n"
)


@cache
def model(robot: Robot = ROBOT) -> NumpyModel:
    program = build_program(robot, Effort.QUICK, names={"forward_kinematics"}, inverse=True)
    assert program.inverse is not None
    assert program.inverse.branches == 2
    return NumpyModel(numpy_model(robot, program))


def samples() -> tuple[SampleSet, ...]:
    """Configurations, the first of which is singular."""
    return sample_sets(ROBOT, 12, np.random.default_rng(2))


@dataclass(frozen=True)
class Faulty:
    change: Change
    right: NumpyModel
    target = "numpy"
    file = "model_numpy.py"
    ways = ()
    constants: dict[str, object] = field(default_factory=dict)

    def call(self, function: str, arguments: list[Array], parameters: Parameters) -> Array:
        raise NotImplementedError

    def inverse(self, poses: Array, given: Array, parameters: Parameters) -> tuple[Array, Array]:
        q, status = self.right.inverse(poses, given, parameters)
        return self.change(q.copy(), status.copy())


@pytest.mark.parametrize("robot", [ROBOT, NAMED], ids=["plain", "a given joint with a name"])
def test_a_right_model_passes(robot: Robot) -> None:
    sets = sample_sets(robot, 12, np.random.default_rng(2))
    for poses, worst in inverse_errors(robot, model(robot), sets, "report it"):
        assert poses == 12
        assert worst < CLOSED / 10


def without_second(q: Array, status: Array) -> tuple[Array, Array]:
    q[:, 1], status[:, 1] = np.nan, 0
    return q, status


def everything(q: Array, status: Array) -> tuple[Array, Array]:
    found = np.where(np.isnan(q).all(axis=(1, 2), keepdims=True), 0.5, q)
    return found, np.maximum(status, ~status.any(axis=1)[:, None])


def moody(q: Array, status: Array) -> tuple[Array, Array]:
    """One pose in another order than a batch."""
    return (q[:, ::-1], status[:, ::-1]) if len(q) == 1 else (q, status)


OF_ONE_JOINT = np.array([[[0, 0], [1, 0]]])  # of the second branch


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (without_second, "misses the configuration"),
        (lambda q, status: (q[:, [0, 0, 1]], status[:, [0, 0, 1]]), "finds a solution twice"),
        (
            lambda q, status: (q + 1e-6 * OF_ONE_JOINT, status),
            r"inverse_kinematics of model_numpy.py leads to a pose that is .* off at q = \[-?\d.*report it",
        ),
        (lambda q, status: (np.nan_to_num(q), status), "marks branches that do not exist by other things than nan"),
        (lambda q, status: (np.full_like(q, np.nan), np.zeros_like(status)), "finds no solution of a reachable pose"),
        (everything, "finds solutions of poses out of reach"),
        (moody, "gives one pose other solutions than a batch"),
        (lambda q, status: (q[..., :1], status), "returns shapes"),
    ],
)
def test_every_fault_is_found(change: Change, message: str) -> None:
    with pytest.raises(VerificationError, match=message):
        list(inverse_errors(ROBOT, Faulty(change, model()), samples(), "report it"))
