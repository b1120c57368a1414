"""Random arms with many parallel axes: aligned and opposed, slides between them, odd offsets, both conventions."""

import random
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from derive.programs.formulations.trace import Trace
from derive.programs.tape.build import cut
from derive.programs.tape.scalars import QD, QDD, Q
from derive.programs.tape.tape import PARAMETER, evaluate
from derive.programs.tape.value import Value
from derive.robot.evaluate import evaluate as number
from derive.robot.names import number_of, robot_symbols
from derive.robot.robot import Robot
from tests.programs.recursion_values import ARITHMETIC

TWISTS = ["0", "0", "0", "pi", "pi", "pi/2", "-pi/2", "0.4", "w"]
TOOL = "[[0, 0, 1, 0.1], [cos(e), sin(e), 0, f], [-sin(e), cos(e), 0, 0.3], [0, 0, 0, 1]]"


def parallel_arm(seed: int, joints: int | None = None) -> Trace:
    rng = random.Random(seed)
    rows = [_row(rng, i) for i in range(1, (joints or rng.randint(2, 6)) + 1)]
    lines = ["name: arm", f"convention: {rng.choice(['standard', 'modified'])}", "joints:", *rows]
    lines += [f"{key}: {TOOL}" for key in ("base", "tool") if rng.random() < 0.3]
    return Trace(Robot.from_text("\n".join(lines) + "\n"))


def _row(rng: random.Random, i: int) -> str:
    sign, offset = rng.choice(["", "", "-"]), rng.choice(["", "", " + pi/2", " - 0.3", " + t"])
    cells = f"a: {rng.choice(['0', f'a{i}', '-0.4'])}, alpha: {rng.choice(TWISTS)}"
    if rng.random() < 0.7:
        return f"  - {{type: revolute, q: q{i}, theta: '{sign}q{i}{offset}', d: {rng.choice(['0', f'd{i}'])}, {cells}}}"
    return f"  - {{type: prismatic, q: q{i}, d: '{sign}q{i}', theta: {rng.choice(['0', '0.7', 'u'])}, {cells}}}"


def numbers(trace: Trace, values: Sequence[Value]) -> npt.NDArray[np.float64]:
    """The values as traced, at q = 0.3, 0.7, ..., qd = 1.3, ..., qdd = 2.3, ... and free symbols 0.5, 0.6, ..."""
    tape = cut(trace.graph, [value.ref for value in values])
    given, symbols = number_of(trace.robot), robot_symbols(trace.robot)
    inputs = {kind: [0.3 + 0.4 * i + k for i in range(trace.n)] for k, kind in enumerate((Q, QD, QDD))}
    inputs[PARAMETER] = [number(given[x], {}) if x in given else 0.5 + 0.1 * k for k, x in enumerate(symbols)]
    return np.array(evaluate(tape, inputs, ARITHMETIC)).real
