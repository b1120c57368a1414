"""Tapes of a robot's functions evaluated at any numbers, complex ones too: derivatives by complex steps."""

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
STEP = 1e-40


@dataclass(frozen=True)
class State:
    """A point of the state space, with numbers for the free parameters."""

    q: npt.NDArray[np.float64]
    qd: npt.NDArray[np.float64]
    qdd: npt.NDArray[np.float64]
    tau: npt.NDArray[np.float64]
    parameters: tuple[float, ...]


def random_state(program: Program, n: int, values: dict[str, float], seed: int) -> State:
    """A state at random, away from zero velocities."""
    rng = random.Random(seed)
    draw = lambda: np.array([rng.choice((-1, 1)) * rng.uniform(0.1, 1.5) for _ in range(n)])  # noqa: E731
    return State(draw(), draw(), draw(), draw(), tuple(values.get(name, 0.7) for name in program.parameters))


def inputs_of(state: State, **changed: npt.NDArray[np.complex128]) -> dict[str, list[complex]]:
    """The inputs of a tape at a state, with some arguments changed."""
    inputs = {kind: list(changed.get(kind, getattr(state, kind))) for kind in ("q", "qd", "qdd", "tau")}
    return {**inputs, PARAMETER: list(state.parameters)}


def value(program: Program, name: str, state: State, **changed: npt.NDArray[np.complex128]) -> npt.NDArray[np.float64]:
    """A function at a state, with some arguments changed; complex where they are."""
    function = program[name]
    result = np.array(evaluate(function.tape, inputs_of(state, **changed), ARITHMETIC)).reshape(function.shape)
    return result if any(np.iscomplexobj(c) for c in changed.values()) else result.real


def derivative(
    program: Program, name: str, state: State, direction: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    moved = state.q + 1j * STEP * direction
    return value(program, name, state, q=moved).imag / STEP
