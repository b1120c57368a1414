"""Kernels as Python functions, shared by the targets that run on Python."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

from derive.programs.interface import ARGUMENTS, WORDING, function_notes
from derive.programs.program import Function, Program
from derive.targets.kernel import Kernel, rows_of, write_kernel
from derive.targets.printer import PythonPrinter

_WIDTH = 104


@dataclass(frozen=True, slots=True)
class PythonFunction:
    """One function, ready for a template; every text is finished.

    Attributes:
        name: Its name.
        arguments: ``q, qd``.
        signature: ``q, qd, params=None, out=None``.
        kernel_arguments: ``functions, k, q, qd``.
        arguments_tuple: The same as the inside of a tuple.
        argument_names: Quoted, as the inside of a tuple.
        symbol: How the notes write its result.
        shape: As a Python tuple.
        parameter_places: Indices of the run-time parameters that it needs, in lines.
        hoists: Whether it needs any.
        unpack_parameters: Statement that names the parameters.
        hoisted: Statements on parameters alone.
        hoisted_results: The values that the body takes from there.
        hoisted_calls: Whether sines and the like occur in them.
        unpack: Statements that name the entries of the arguments.
        body: Statements.
        results: Rows of outputs.
        calls: Whether sines and the like occur in the statements or results.
        summary: First line of the docstring.
        documentation: The other lines.
        operations: Counts as a Python dictionary.
    """

    name: str
    arguments: str
    signature: str
    kernel_arguments: str
    arguments_tuple: str
    argument_names: str
    symbol: str
    shape: str
    parameter_places: tuple[str, ...]
    hoists: bool
    unpack_parameters: str
    hoisted: tuple[str, ...]
    hoisted_results: tuple[str, ...]
    hoisted_calls: bool
    unpack: tuple[str, ...]
    body: tuple[str, ...]
    results: tuple[str, ...]
    calls: bool
    summary: str
    documentation: tuple[str, ...]
    operations: str


def python_functions(program: Program, joints: int) -> tuple[PythonFunction, ...]:
    """All functions of a program."""
    return tuple(_python_function(function, program.parameters, joints) for function in program)


def _python_function(function: Function, parameters: Sequence[str], joints: int) -> PythonFunction:
    kernel = write_kernel(function.tape, PythonPrinter(), parameters)
    return PythonFunction(
        name=function.name,
        arguments=", ".join(function.arguments),
        signature=", ".join((*function.arguments, "params=None", "out=None")),
        kernel_arguments=", ".join(("functions", "k", *function.arguments)),
        arguments_tuple=python_tuple(function.arguments),
        argument_names=python_tuple([f'"{name}"' for name in function.arguments]),
        symbol=WORDING[function.name].symbol,
        shape=str(function.shape),
        parameter_places=wrapped([str(index) for index in kernel.parameters]),
        hoists=bool(kernel.parameters),
        unpack_parameters=_unpack([f"p_{parameters[i]}" for i in kernel.parameters], "p"),
        hoisted=kernel.hoisted,
        hoisted_results=wrapped(kernel.constant_values),
        hoisted_calls=_calls(kernel.hoisted, kernel.constant_values),
        unpack=_unpacking(kernel, joints),
        body=kernel.body,
        results=tuple(row for columns in rows_of(kernel.results, function.shape[-1]) for row in wrapped(columns)),
        calls=_calls(kernel.body, kernel.results),
        summary=WORDING[function.name].summary,
        documentation=_documentation(function),
        operations=_counts(function),
    )


def _unpacking(kernel: Kernel, joints: int) -> tuple[str, ...]:
    lines = [_unpack([f"{kind}{i + 1}" for i in range(joints)], kind) for kind in kernel.arguments]
    if kernel.constants:
        lines.append(_unpack(kernel.constants, "k"))
    return tuple(lines)


def _unpack(names: Sequence[str], source: str) -> str:
    lines = textwrap.wrap(", ".join(names) + ",", _WIDTH)
    if len(lines) == 1 and len(names) > 1:
        return f"{lines[0][:-1]} = {source}"
    return f"({lines[0]}) = {source}" if len(lines) == 1 else _block("(", lines, f") = {source}")


def _block(opening: str, lines: Sequence[str], closing: str) -> str:
    return "\n".join([opening, *(f"        {line}" for line in lines), f"    {closing}"])


def wrapped(values: Sequence[str]) -> tuple[str, ...]:
    """Values with a comma after each, in lines; no value is broken."""
    lines: list[str] = []
    line = ""
    for value in values:
        text = f"{value}, "
        if line and len(line) + len(text) > _WIDTH:
            lines.append(line.rstrip())
            line = ""
        line += text
    return (*lines, line.rstrip()) if line else tuple(lines)


def _calls(*texts: Sequence[str]) -> bool:
    names = ("sin(", "cos(", "sqrt(", "sign(")
    return any(name in text for group in texts for text in group for name in names)


def python_tuple(texts: Sequence[str]) -> str:
    """What stands in the parentheses of a tuple."""
    return f"{texts[0]}," if len(texts) == 1 else ", ".join(texts)


def _documentation(function: Function) -> tuple[str, ...]:
    wording = WORDING[function.name]
    shape = ", ".join(str(k) for k in function.shape)
    lines = (
        "Args:",
        *(f"    {name}: {ARGUMENTS[name]}, (..., n)." for name in function.arguments),
        "    params: Numbers of the free parameters; see the module's docstring.",
        "    out: Where to write the result, if not to a new array.",
        "",
        "Returns:",
        f"    {wording.symbol}, (..., {shape}):",
        f"    {wording.result}.",
        "",
        *function_notes(function),
    )
    return tuple(f"    {line}" if line else "" for line in lines)


def _counts(function: Function) -> str:
    return "{" + ", ".join(f'"{name}": {count}' for name, count in function.operations.as_dict().items()) + "}"
