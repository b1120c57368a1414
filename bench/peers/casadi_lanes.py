"""CasADi's scalar operations printed as C on short vectors: one configuration per lane, libmvec's sine and cosine.

No tool offers this. It is what somebody gets from another generator's lines who vectorises them by hand, and so the
closest rival of a native target.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import casadi

from bench.compilers import library

_TEMPLATE = """\
typedef double vector __attribute__((vector_size(8 * LANES)));
vector VECTOR_SIN(vector);
vector VECTOR_COS(vector);

static void lines({declared}) {{
    double *restrict value = out;
{body}
}}

void loop(long count, long inputs, const long *widths, const double *const *input, long width, double *out) {{
    (void)inputs;
    for (long k = 0; k + LANES <= count; k += LANES) {{
{gathered}
        lines({given});
    }}
}}
"""

_GATHERED = """\
        vector x{i}[{size}];
        for (int l = 0; l < LANES; ++l)
            for (int j = 0; j < {size}; ++j) x{i}[j][l] = input[{i}][(k + l) * widths[{i}] + j];"""

_INFIX = {casadi.OP_ADD: "+", casadi.OP_SUB: "-", casadi.OP_MUL: "*", casadi.OP_DIV: "/"}
_CALLS = {
    casadi.OP_SQ: "{0} * {0}",
    casadi.OP_TWICE: "{0} + {0}",
    casadi.OP_NEG: "-{0}",
    casadi.OP_INV: "1.0 / {0}",
    casadi.OP_SIN: "VECTOR_SIN({0})",
    casadi.OP_COS: "VECTOR_COS({0})",
}


def lanes_loop(function: Any, lanes: int) -> ctypes.CDLL:
    """The compiled loop, with the interface of ``native/casadi_loop.c``; the batch is a multiple of ``lanes``."""
    letter = {2: "b", 4: "d", 8: "e"}[lanes]
    flags = [f"-DLANES={lanes}", "-ffp-contract=fast"]
    flags += [f"-DVECTOR_{kind.upper()}=_ZGV{letter}N{lanes}v_{kind}" for kind in ("sin", "cos")]
    with TemporaryDirectory() as folder:
        source = Path(folder) / "lanes.c"
        source.write_text(lanes_source(function), encoding="utf-8")
        return library(source, [*flags, "-lmvec", "-lm"])


def lanes_source(function: Any) -> str:
    """The C of a function of scalars with one dense output."""
    names = [f"x{i}" for i in range(function.n_in())]
    gathered = [_GATHERED.format(i=i, size=function.size1_in(i)) for i in range(function.n_in())]
    return _TEMPLATE.format(
        declared=", ".join([*(f"const vector *{name}" for name in names), "long width", "double *out"]),
        given=", ".join([*names, "width", "out + k * width"]),
        gathered="\n".join(gathered),
        body="\n".join(f"    {line}" for line in _lines(function)),
    )


def _lines(function: Any) -> Iterator[str]:
    """One statement per instruction; places of CasADi's work vector are written again, so each gets a new name."""
    names: dict[int, str] = {}
    for k in range(function.n_instructions()):
        code, places = function.instruction_id(k), function.instruction_output(k)
        operands = function.instruction_input(k)
        if code == casadi.OP_OUTPUT:
            yield f"for (int l = 0; l < LANES; ++l) value[l * width + {places[1]}] = {names[operands[0]]}[l];"
            continue
        if code == casadi.OP_INPUT:
            text = f"x{operands[0]}[{operands[1]}]"
        elif code == casadi.OP_CONST:
            text = f"(vector){{0}} + {function.instruction_constant(k)!r}"
        else:
            text = _operation(code, [names[place] for place in operands])
        yield f"const vector t{k} = {text};"
        names[places[0]] = f"t{k}"


def _operation(code: int, operands: list[str]) -> str:
    if code in _INFIX:
        return f"{operands[0]} {_INFIX[code]} {operands[1]}"
    return _CALLS[code].format(*operands)
