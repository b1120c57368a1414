"""Random straight-line programs: as tape values, and as plain arithmetic on rationals."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from hypothesis import strategies as st

from derive.programs.tape.graph import Graph
from derive.programs.tape.tape import PARAMETER
from derive.programs.tape.value import Value

INPUTS = 3
PARAMETERS = 2

RATIONAL = {
    "number": lambda value: value,
    "sin": lambda x: 2 * x / (1 + x * x),
    "cos": lambda x: (1 - x * x) / (1 + x * x),
    "sqrt": lambda x: x + 7,
    "sign": lambda x: Fraction((x > 0) - (x < 0)),
}
"""Rational points of the unit circle stand for sine and cosine: then every identity can be tested exactly."""


def variables() -> list[Value]:
    graph = Graph()
    return [Value(graph, graph.input("q", i)) for i in range(3)]


@dataclass(frozen=True)
class Step:
    name: str
    left: int
    right: int


@dataclass(frozen=True)
class RandomProgram:
    """Numbers, steps and which values are results; value k is input, parameter, number or step in this order."""

    numbers: tuple[Fraction, ...]
    steps: tuple[Step, ...]
    results: tuple[int, ...]

    def trace(self, graph: Graph) -> list[int]:
        values = [Value(graph, graph.input("q", i)) for i in range(INPUTS)]
        values += [Value(graph, graph.input(PARAMETER, i)) for i in range(PARAMETERS)]
        values += [Value(graph, graph.number(number)) for number in self.numbers]
        operations = {"sin": Value.sin, "cos": Value.cos, "sign": Value.sign}
        return [value.ref for value in self._run(values, operations)]

    def evaluate(self, inputs: Sequence[Fraction], parameters: Sequence[Fraction]) -> list[Fraction]:
        return self._run([*inputs, *parameters, *self.numbers], RATIONAL)

    def _run(self, values: list[Any], functions: dict[str, Any]) -> list[Any]:
        for step in self.steps:
            values.append(self._step(step, values, functions))
        return [values[k % len(values)] for k in self.results]

    def _step(self, step: Step, values: list[Any], functions: dict[str, Any]) -> Any:
        a, b = values[step.left % len(values)], values[step.right % len(values)]
        match step.name:
            case "add":
                return a + b
            case "subtract":
                return a - b
            case "multiply":
                return a * b
            case "negate":
                return -a
        return functions[step.name](a)


def fractions() -> st.SearchStrategy[Fraction]:
    """Small rationals; zero and one often."""
    small = st.builds(Fraction, st.integers(-5, 5), st.integers(1, 4))
    return st.one_of(st.sampled_from([Fraction(0), Fraction(1), Fraction(-1), Fraction(2)]), small)


def programs() -> st.SearchStrategy[RandomProgram]:
    """Random programs, arithmetic more often than functions."""
    arithmetic = ["add", "subtract", "multiply"]
    names = st.sampled_from([*arithmetic * 4, "negate", "sin", "cos", "sign"])
    places = st.integers(0, 40)
    steps = st.lists(st.builds(Step, names, places, places), max_size=14)
    return st.builds(
        lambda numbers, steps, results: RandomProgram(tuple(numbers), tuple(steps), tuple(results)),
        st.lists(fractions(), max_size=3),
        steps,
        st.lists(places, min_size=1, max_size=4),
    )
