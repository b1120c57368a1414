"""Numbers for the example of a handout: the recursions of the generated functions at a configuration, in floats."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.forward_kinematics import forward_kinematics, jacobian
from derive.mechanics.inertia_matrix import gravity_vector, inertia_matrix
from derive.robot.robot import Robot

Rows = Sequence[Sequence[float]]


@dataclass(frozen=True, slots=True)
class Example:
    """Values of T, J, B and g of one robot.

    Attributes:
        robot: The robot.
    """

    robot: Robot

    def __call__(self, name: str, q: Sequence[float]) -> Rows:
        """The value of a quantity; symbols without a number have those of the figure.

        Args:
            name: T (4x4), J (6xn), B (nxn) or g (nx1).
            q: Joint variables [rad or m], n entries.

        Raises:
            KeyError: Another name.
            ExpressionError: A symbol has no number, or a cell has no finite value.
        """
        kinematic = name in ("T", "J")
        robot = _with_figure_values(replace(self.robot, links=(), gravity=None) if kinematic else self.robot)
        return _evaluate(name, build_chain(robot, FloatDomain(robot, q)))


def _evaluate(name: str, chain: Chain[float]) -> Rows:
    match name:
        case "T":
            return forward_kinematics(chain).rows(chain.zero, chain.one)
        case "J":
            return jacobian(chain)
        case "B":
            return inertia_matrix(chain)
        case "g":
            return [[torque] for torque in gravity_vector(chain)]
    raise KeyError(name)


def _with_figure_values(robot: Robot) -> Robot:
    known = {name for name, _ in robot.parameters}
    further = tuple((name, value) for name, value in robot.figure.values if name not in known)
    return replace(robot, parameters=robot.parameters + further)
