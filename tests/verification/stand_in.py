"""Stand-ins for generated modules: right by construction, so that faults can be planted in them.

They ask the oracle once for each configuration, however often a batch repeats it.
"""

from pathlib import Path

from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.functions import FUNCTIONS

HEAD = """
from functools import cache

import numpy as np
from derive.verification.oracle.functions import Oracle
from derive.model.identification.base_parameters import base_set
from derive.robot.inertial_parameters import has_regressor
from derive.robot.robot import Robot

ROBOT = Robot.from_text({text!r})
BASE = base_set(ROBOT).parameters if has_regressor(ROBOT) else None
DOF = {dof}
PARAMETERS = {parameters!r}


def _value(name, arguments, params):
    numbers = {{key: np.asarray(value, dtype=float) for key, value in (params or {{}}).items()}}
    batch = np.broadcast_shapes(*(np.shape(a)[:-1] for a in arguments), *(v.shape for v in numbers.values()))
    columns = [np.broadcast_to(v, batch).reshape(-1, 1) for v in numbers.values()]
    columns += [np.broadcast_to(a, (*batch, DOF)).reshape(-1, DOF) for a in arguments]
    if not columns:
        return _evaluated(name, numbers, np.zeros((1, 0)))[0]
    rows = np.ascontiguousarray(np.concatenate(columns, axis=1))
    whole = rows.view(np.dtype((np.void, rows.itemsize * rows.shape[1]))).reshape(-1)
    _, first, places = np.unique(whole, return_index=True, return_inverse=True)
    rows = rows[first]
    sets, kinds = np.unique(rows[:, : len(numbers)], axis=0, return_inverse=True)
    values = None
    for k, chosen in enumerate(sets):
        mine = kinds.reshape(-1) == k
        found = _evaluated(name, dict(zip(numbers, chosen)), rows[mine, len(numbers) :])
        values = np.empty((len(rows), *found.shape[1:])) if values is None else values
        values[mine] = found
    return values[places.reshape(-1)].reshape((*batch, *values.shape[1:]))


@cache
def _oracle(numbers):
    return Oracle.of(ROBOT, dict(numbers), BASE)


def _evaluated(name, numbers, rows):
    oracle = _oracle(tuple((key, float(value)) for key, value in numbers.items()))
    arguments = [rows[:, k : k + DOF] for k in range(0, rows.shape[1], DOF)]
    value = oracle.evaluate(name, *arguments)
    return value if arguments else np.broadcast_to(value, (len(rows), *value.shape))
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
