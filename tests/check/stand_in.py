"""Stand-ins for generated modules: right by construction, so that faults can be planted in them."""

from __future__ import annotations

from pathlib import Path

from derive.check.oracle import FUNCTIONS
from derive.robot.names import free_symbols
from derive.robot.robot import Robot

HEAD = """
import numpy as np
from derive.check.oracle import Oracle
from derive.mechanics.base_parameters import base_set
from derive.robot.inertial import has_regressor
from derive.robot.robot import Robot

ROBOT = Robot.from_text({text!r})
BASE = base_set(ROBOT).parameters if has_regressor(ROBOT) else None
DOF = {dof}
PARAMETERS = {parameters!r}


def _oracle(numbers):
    return Oracle.of(ROBOT, numbers, BASE)


def _value(name, arguments, params):
    numbers = {{key: np.asarray(value, dtype=float) for key, value in (params or {{}}).items()}}
    batch = np.broadcast_shapes(*(np.shape(a)[:-1] for a in arguments), *(v.shape for v in numbers.values()))
    arguments = [np.broadcast_to(a, (*batch, DOF)) for a in arguments]
    if all(v.ndim == 0 for v in numbers.values()):
        return _oracle({{key: float(v) for key, v in numbers.items()}}).evaluate(name, *arguments)
    numbers = {{key: np.broadcast_to(value, batch) for key, value in numbers.items()}}
    values = {{}}
    for k in np.ndindex(batch):
        oracle = _oracle({{key: float(value[k]) for key, value in numbers.items()}})
        values[k] = oracle.evaluate(name, *(a[k] for a in arguments))
    first = next(iter(values.values()))
    return np.array(list(values.values())).reshape(*batch, *first.shape)
"""

FUNCTION = """

def {name}({signature}):
    return _value({name!r}, [{arguments}], params)
"""


def write_stand_in(folder: Path, text: str, fault: str = "") -> Robot:
    """Write a ``model_numpy.py`` that is right but for the code ``fault`` at its end."""
    robot = Robot.from_text(text)
    source = HEAD.format(text=text, dof=robot.n, parameters=free_symbols(robot))
    for name, definition in FUNCTIONS.items():
        if robot.has_dynamics or not definition.dynamic:
            signature = ", ".join((*definition.arguments, "params=None"))
            source += FUNCTION.format(name=name, arguments=", ".join(definition.arguments), signature=signature)
    (folder / "model_numpy.py").write_text(source + fault, encoding="utf-8")
    return robot
