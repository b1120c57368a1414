"""Operations of a CasADi expression: expanded to SX, common subexpressions merged, counted by opcode."""

from __future__ import annotations

from collections import Counter
from typing import Any

import casadi

from bench.counting.counts import Counts

_NAMES = {
    casadi.OP_MUL: "mul",
    casadi.OP_SQ: "mul",
    casadi.OP_TWICE: "mul",
    casadi.OP_ADD: "add",
    casadi.OP_SUB: "add",
    casadi.OP_DIV: "div",
    casadi.OP_INV: "div",
    casadi.OP_SIN: "trig",
    casadi.OP_COS: "trig",
}
_FREE = {casadi.OP_NEG, casadi.OP_CONST, casadi.OP_INPUT, casadi.OP_OUTPUT, casadi.OP_PARAMETER, casadi.OP_ASSIGN}


def shared(function: Any) -> Any:
    """The function on scalars with equal subexpressions computed once."""
    expanded = function.expand()
    inputs = expanded.sx_in()
    outputs = casadi.cse(expanded.call(inputs))
    return casadi.Function(function.name(), inputs, outputs, function.name_in(), function.name_out())


def count_casadi(function: Any) -> Counts:
    """Operations of a function of scalars, as `shared` returns it."""
    counter: Counter[str] = Counter()
    for k in range(function.n_instructions()):
        code = function.instruction_id(k)
        if code not in _FREE:
            counter[_NAMES.get(code, "other")] += 1
    return Counts(**counter)
