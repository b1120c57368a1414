"""Tapes of a robot's functions evaluated at numbers."""

import cmath
import random
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from derive.algebra.constants import to_float
from derive.programs.program import Program
from derive.programs.tape.tape import PARAMETER, evaluate

ARITHMETIC = {
    "number": to_float,
    "sin": cmath.sin,
    "cos": cmath.cos,
    "sqrt": cmath.sqrt,
    "sign": lambda x: float(np.sign(x.real)),
}
Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class State:
    q: Floats
    qd: Floats
    qdd: Floats
    tau: Floats
    parameters: tuple[float, ...]  # numbers of the free ones


def random_state(program: Program, n: int, values: dict[str, float], seed: int) -> State:
    """A state at random, away from zero velocities."""
    rng = random.Random(seed)
    draw = lambda: np.array([rng.choice((-1, 1)) * rng.uniform(0.1, 1.5) for _ in range(n)])  # noqa: E731
    return State(draw(), draw(), draw(), draw(), tuple(values.get(name, 0.7) for name in program.parameters))


def inputs_of(state: State, **changed: Floats) -> dict[str, list[float]]:
    inputs = {kind: list(changed.get(kind, getattr(state, kind))) for kind in ("q", "qd", "qdd", "tau")}
    return {**inputs, PARAMETER: list(state.parameters)}


def value(program: Program, name: str, state: State, **changed: Floats) -> Floats:
    """A function at a state, with some arguments changed."""
    function = program[name]
    return np.array(evaluate(function.tape, inputs_of(state, **changed), ARITHMETIC)).reshape(function.shape).real
