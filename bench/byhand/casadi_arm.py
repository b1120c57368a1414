"""The recursions by hand through CasADi's scalar expressions, equal subexpressions merged by `casadi.cse`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import casadi

from bench.byhand.axis_arm import axis_arm
from bench.byhand.base_parameters import named, regrouped
from bench.byhand.quantities import by_symbol
from bench.byhand.symbols import Arithmetic
from bench.quantities import BY_SYMBOL
from bench.robots import Case

SYSTEM = Arithmetic(
    number=casadi.SX,
    functions={"sin": casadi.sin, "cos": casadi.cos, "tan": casadi.tan, "sqrt": casadi.sqrt},
    symbol=casadi.SX.sym,
    is_number=lambda value: bool(casadi.SX(value).is_constant()),
)


@dataclass(frozen=True)
class CasadiFunction:
    """A quantity as a function of its arguments and of what is computed beforehand.

    Attributes:
        function: (q, ..., parameters) -> matrix.
        parameters: Numbers of the parameters of this case.
    """

    function: Any
    parameters: Any


def functions(case: Case, base: bool) -> Iterator[tuple[str, CasadiFunction]]:
    """The quantities of a robot by their symbols.

    Args:
        case: The robot; symbols without a number stay symbols.
        base: Whether inertial parameters are regrouped.
    """
    robot = case.robot
    free = {name: casadi.SX.sym(name) for name in case.numbers}
    fixed = {name: casadi.SX(value) for name, value in case.values.items() if name not in free}
    arm = axis_arm(robot, SYSTEM, {**fixed, **free})
    pairs = [(symbol, symbol) for symbol in free.values()]
    arm = named(regrouped(arm, SYSTEM) if base else arm, SYSTEM, lambda symbol, value: pairs.append((symbol, value)))
    motion = [casadi.SX.sym(name, robot.n) for name in ("q", "qd", "qdd")]
    parameters = casadi.vertcat(*(symbol for symbol, _ in pairs))
    numbers = casadi.Function("numbers", list(free.values()), [casadi.vertcat(*(value for _, value in pairs))])
    known = numbers(*case.numbers.values())
    known = known["o0"] if isinstance(known, dict) else known
    for symbol, rows in by_symbol(arm, SYSTEM, [casadi.vertsplit(v) for v in motion]).items():
        yield symbol, _function(symbol, _matrix(rows()), motion, parameters, known)
        if symbol == "B":
            yield "C", _function("C", christoffel(_matrix(rows()), *motion[:2]), motion, parameters, known)


def _function(symbol: str, value: Any, motion: list[Any], parameters: Any, numbers: Any) -> CasadiFunction:
    inputs = motion[: len(BY_SYMBOL[symbol].arguments)]
    merged = casadi.cse(value)
    return CasadiFunction(casadi.Function(symbol, [*inputs, parameters], [merged]), numbers)


def _matrix(rows: list[list[Any]]) -> Any:
    return casadi.vertcat(*(casadi.horzcat(*row) for row in rows))


def christoffel(b: Any, q: Any, qd: Any) -> Any:
    """C(q, qd) by Christoffel's symbols of the entries of B."""
    n = q.size1()
    slopes = [casadi.jacobian(b[:, j], q) for j in range(n)]

    def entry(i: int, j: int) -> Any:
        terms = (slopes[j][i, k] + slopes[k][i, j] - slopes[k][j, i] for k in range(n))
        return sum((0.5 * term * qd[k] for k, term in enumerate(terms)), casadi.SX(0))

    return _matrix([[entry(i, j) for j in range(n)] for i in range(n)])
