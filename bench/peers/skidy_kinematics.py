"""skidy: T and J of small arms in closed form with its own simplification, from screws at q = 0; counts only.

Arms of more than four joints take it too long.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from contextlib import redirect_stdout
from io import StringIO
from typing import Any

import numpy as np
import sympy

from bench.byhand.axis_arm import axis_arm
from bench.byhand.recursions import poses, steps_of
from bench.byhand.sympy_arm import SYSTEM, number
from bench.counting.python_source import count_nodes
from bench.peers.peer import Counted, Peer
from bench.quantities import BY_SYMBOL
from bench.robots import Array, Case

_LARGEST = 4


def _count(case: Case) -> Iterator[tuple[str, Callable[[], Counted]]]:
    if case.robot.n > _LARGEST:
        return
    free = {name: sympy.Symbol(name) for name in case.numbers}
    fixed = {name: number(value) for name, value in case.values.items() if name not in free}
    whole = _kinematics(case, {**fixed, **free})
    halves = whole.Jh_ee
    jacobian = sympy.Matrix.vstack(halves[3:, :], halves[:3, :])
    for symbol, value in (("T", whole.fkin), ("J", jacobian)):
        yield symbol, lambda symbol=symbol, value=value: _counted(case, symbol, whole.q, free, value)  # type: ignore[misc]


def _kinematics(case: Case, values: dict[str, Any]) -> Any:
    """Its generator, run; frames and screws are those of the joint axes at q = 0."""
    from skidy import SymbolicKinDyn, generalized_vectors, joint_screw

    arm, n = axis_arm(case.robot, SYSTEM, values), case.robot.n
    zero = [sympy.Integer(0)] * n
    frames = [_frame(pose) for pose in poses(arm, steps_of(arm, zero, SYSTEM), SYSTEM)]
    screws = [
        joint_screw(list(axis.sign * frame[:3, 2]), list(frame[:3, 3]), axis.revolute)
        for axis, frame in zip(arm.axes, frames, strict=False)
    ]
    whole = SymbolicKinDyn(
        gravity_vector=sympy.Matrix(arm.gravity),
        ee=frames[n - 1].inv() * frames[n],
        body_ref_config=frames[:n],
        joint_screw_coord=screws,
        config_representation="spatial",
        Mb=[sympy.eye(6)] * n,
    )
    with redirect_stdout(StringIO()):
        whole.closed_form_kinematics_body_fixed(*generalized_vectors(n), simplify=True, parallel=False)
    return whole


def _frame(pose: Any) -> Any:
    x, y, z, p = (sympy.Matrix(vector) for vector in pose)
    return sympy.Matrix.vstack(sympy.Matrix.hstack(x, y, z, p), sympy.Matrix([[0, 0, 0, 1]]))


def _counted(case: Case, symbol: str, q: Any, free: dict[str, Any], value: Any) -> Counted:
    assignments, results = sympy.cse(list(value), symbols=sympy.numbered_symbols("t"), order="none")
    lines = [f"{name} = {sympy.pycode(entry)}" for name, entry in assignments]
    lines.append(f"result = [{', '.join(sympy.pycode(entry) for entry in results)}]")
    function = sympy.lambdify([list(q), list(free.values())], list(value), "math")
    shape, numbers = BY_SYMBOL[symbol].shape(case.robot.n), [case.numbers[name] for name in free]

    def evaluate(configuration: Array) -> Array:
        return np.array(function(configuration, numbers), dtype=float).reshape(shape)

    return Counted(count_nodes(ast.parse("\n".join(lines))), evaluate)


PEER = Peer("skidy (simplified)", ("skidy",), _count)
