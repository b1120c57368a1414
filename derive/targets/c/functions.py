"""The functions of a program as the C templates ask for them: every text is finished."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import prod

from derive.programs.interface import ARGUMENTS, WORDING, function_notes
from derive.programs.program import Function, Program
from derive.programs.tape.tape import PARAMETER
from derive.targets.c.kernel import CKernel, Part, Read, write_c_kernel

_ARRAYS = {PARAMETER: "params", "s": "sines", "c": "cosines"}
_ORDER = ("q", "qd", "qdd", "tau", "sines", "cosines", "k", "params")

_LANES = ((128, 32), (256, 16))
"""Lanes of a block by the most entries that its result may have; larger ones have 8."""


@dataclass(frozen=True, slots=True)
class CPart:
    """A static function: its statements, and how it is declared and called.

    Attributes:
        declaration: Its parameters.
        one: The arguments of its call for one configuration.
        lane: The same for one lane of a block.
        varying: The same where the constants differ from lane to lane.
        body: Statements.
        results: Assignments to the entries of the result.
    """

    declaration: str
    one: str
    lane: str
    varying: str
    body: tuple[str, ...]
    results: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class CFunction:
    """One generated function.

    Attributes:
        name: Its name, without the robot's.
        arguments: Arguments from the user.
        used: Those that have a say in the result.
        unused: The others.
        size: Entries of the result.
        lanes: Configurations in a block.
        shape: ``6 x 6``.
        angle_count: Angles whose sine or cosine is taken.
        has_sines: Whether a sine is taken of any.
        has_cosines: Whether a cosine is.
        constant_count: Constants that come from the parameters.
        constants: From the parameters to the constants.
        angles: From the arguments to the angles.
        lane: From the arguments and sines to the result, for one configuration of a block.
        declaration: Parameters of the public function.
        batch_declaration: The same for a batch.
        prototype: As in the header.
        batch_prototype: The same for a batch.
        block_declaration: Parameters of the function of one block.
        block_call: The arguments of its call.
        documentation: Lines of its comment.
    """

    name: str
    arguments: tuple[str, ...]
    used: tuple[str, ...]
    unused: tuple[str, ...]
    size: int
    lanes: int
    shape: str
    angle_count: int
    has_sines: bool
    has_cosines: bool
    constant_count: int
    constants: CPart
    angles: CPart
    lane: CPart
    declaration: str
    batch_declaration: str
    prototype: str
    batch_prototype: str
    block_declaration: str
    block_call: str
    documentation: tuple[str, ...]


def c_functions(program: Program) -> tuple[CFunction, ...]:
    """All functions of a program."""
    return tuple(_function(function, program.parameters) for function in program)


def _function(function: Function, parameters: Sequence[str]) -> CFunction:
    kernel = write_c_kernel(function.tape, parameters)
    used = tuple(a for a in function.arguments if a in _arrays(kernel.angles.reads + kernel.body.reads))
    hoists = bool(kernel.constants.results)
    inputs = [*function.arguments, *(["k"] if hoists else [])]
    blocks = [*used, *(["k"] if hoists else [])]
    return CFunction(
        name=function.name,
        arguments=function.arguments,
        used=used,
        unused=tuple(a for a in function.arguments if a not in used),
        size=prod(function.shape),
        lanes=next((lanes for size, lanes in _LANES if prod(function.shape) <= size), 8),
        shape=" x ".join(str(k) for k in function.shape),
        angle_count=len(kernel.angles.results),
        has_sines="sines" in _arrays(kernel.body.reads),
        has_cosines="cosines" in _arrays(kernel.body.reads),
        constant_count=len(kernel.constants.results),
        constants=_part(kernel.constants, "k", "", step=False),
        angles=_part(kernel.angles, "angles", f"{function.name}_lanes"),
        lane=_part(kernel.body, "result", f"{function.name}_lanes"),
        declaration=_pointers([*inputs], "result", "restrict "),
        batch_declaration=f"size_t count, {_pointers(inputs, 'result', 'restrict ')}",
        prototype=_pointers(inputs, "result"),
        batch_prototype=f"size_t count, {_pointers(inputs, 'result')}",
        block_declaration=_pointers(blocks, "result", "restrict "),
        block_call=", ".join([*(f"{a}_block" for a in used), *(["k"] if hoists else []), "result_block"]),
        documentation=_documentation(function, kernel),
    )


def _pointers(inputs: Iterable[str], output: str, qualifier: str = "") -> str:
    names = [f"const double *{qualifier}{name}" for name in inputs]
    return ", ".join([*names, f"double *{qualifier}{output}"])


def _part(part: Part, output: str, lanes: str, *, step: bool = True) -> CPart:
    arrays = [name for name in _ORDER if name in _arrays(part.reads)]
    steps = _steps(part) if step else ()
    reads = tuple(f"const double {read.name} = {_entry(_array(read), read.index, step)};" for read in part.reads)
    return CPart(
        declaration=", ".join([_pointers(arrays, output, "restrict "), *(f"const size_t {name}" for name in steps)]),
        one=", ".join([*arrays, output, *("1" for _ in steps)]),
        lane=_lane_call(arrays, output, steps, lanes, varying=False),
        varying=_lane_call(arrays, output, steps, lanes, varying=True),
        body=reads + part.body,
        results=tuple(f"{_entry(output, i, step)} = {text};" for i, text in enumerate(part.results)),
    )


def _steps(part: Part) -> tuple[str, ...]:
    """Distances between the entries of one lane, where there are two entries."""
    further = [_array(read) for read in part.reads if read.index]
    lanes = len(part.results) > 1 or any(array != "k" for array in further)
    return ("lanes",) * lanes + ("k_lanes",) * ("k" in further)


def _lane_call(arrays: Sequence[str], output: str, steps: Sequence[str], lanes: str, *, varying: bool) -> str:
    """A call for lane ``i`` of a block; constants are the same in all lanes, or not."""
    moved = [name if name == "k" and not varying else f"{name} + i" for name in (*arrays, output)]
    return ", ".join([*moved, *(lanes if step == "lanes" or varying else "1" for step in steps)])


def _arrays(reads: Iterable[Read]) -> frozenset[str]:
    return frozenset(_array(read) for read in reads)


def _array(read: Read) -> str:
    return _ARRAYS.get(read.array, read.array)


def _entry(array: str, index: int, step: bool) -> str:
    """``qd[2 * lanes]``: entry 2 of this lane."""
    if not step or index == 0:
        return f"{array}[{index}]"
    lanes = "k_lanes" if array == "k" else "lanes"
    return f"{array}[{lanes}]" if index == 1 else f"{array}[{index} * {lanes}]"


def _documentation(function: Function, kernel: CKernel) -> tuple[str, ...]:
    wording = WORDING[function.name]
    shape = " x ".join(str(k) for k in function.shape)
    layout = ", row by row" if len(function.shape) > 1 else ""
    constants = len(kernel.constants.results)
    return (
        wording.summary,
        "",
        *(f"@param[in]  {name}       {ARGUMENTS[name]}, one entry per joint." for name in function.arguments),
        *([f"@param[in]  k       {constants} constants from {function.name}_constants()."] if constants else []),
        f"@param[out] result  {wording.symbol}, {shape}{layout}: {wording.result}.",
        "",
        *function_notes(function),
    )
