"""``model_native.py``: the C functions of a robot as NumPy generalised ufuncs, compiled when the folder is built."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod

from derive.programs.program import Function
from derive.targets.c import CFunction, c_context, c_function
from derive.targets.numpy import python_context
from derive.targets.target import Source, Target
from derive.targets.templating import render

MODULE, CODE, LIBRARY = "model_native.py", "model_native.c", "libmodel_native.so"


@dataclass(frozen=True, slots=True)
class Input:
    """An argument that a loop loads into lanes.

    Attributes:
        name: Its name.
        width: Number of its entries.
        place: Its place among the loop's arguments, and of the bytes between its rows.
        core: Place of the bytes between its entries.
    """

    name: str
    width: int
    place: int
    core: int


@dataclass(frozen=True, slots=True)
class Loop:
    """NumPy's inner loop around a C function: where things are among the loop's arguments and steps.

    Attributes:
        inputs: Names of the inputs, the constants from the parameters included.
        loads: The inputs that are read.
        constants_place: Place of the constants.
        constants_core: Place of the bytes between them.
        result_place: Place of the result.
        result_core: Place of the bytes between its entries, one for each axis.
        axes: Axes of the result.
        dimensions: Its shape, as the inside of an array, which has an entry even for a scalar.
        lengths: Lengths of the inputs and of the result, as the inside of an array.
        buffer_count: Inputs and the result.
        starts: Arguments of the call for one configuration.
    """

    inputs: tuple[str, ...]
    loads: tuple[Input, ...]
    constants_place: int
    constants_core: int
    result_place: int
    result_core: int
    axes: int
    dimensions: str
    lengths: str
    buffer_count: int
    starts: str


def render_native(source: Source) -> dict[str, str]:
    """Module and code.

    Args:
        source: The robot and its program.

    Returns:
        Their texts by file name.
    """
    texts = [c_function(function, source.program.parameters) for function in source.program]
    loops = [_loop(function, text, source.robot.n) for function, text in zip(source.program, texts, strict=True)]
    counts = {text.name: text.constant_count for text in texts}
    module = python_context(source) | {"constant_counts": counts, "library": LIBRARY}
    code = c_context(source) | {"loops": list(zip(texts, loops, strict=True))}
    return {
        MODULE: render("native/model_native.py.jinja", **module),
        CODE: render("native/model_native.c.jinja", **code),
    }


TARGET = Target(
    name="native",
    summary="the C functions as NumPy generalised ufuncs; needs a C compiler",
    files=(MODULE, CODE),
    render=render_native,
    default=False,
    requires=("c",),
    compiled={LIBRARY: (CODE, "model.c", "model.h")},
)


def _loop(function: Function, text: CFunction, joints: int) -> Loop:
    constants = ["k"] if text.constant_count else []
    inputs = (*function.arguments, *constants)
    count = len(inputs)
    lengths = [*(joints for _ in function.arguments), *(text.constant_count for _ in constants), prod(function.shape)]
    return Loop(
        inputs=inputs,
        loads=tuple(Input(a, joints, i, count + 1 + i) for i, a in enumerate(function.arguments) if a in text.used),
        constants_place=count - 1,
        constants_core=2 * count,
        result_place=count,
        result_core=2 * count + 1,
        axes=len(function.shape),
        dimensions=", ".join(map(str, function.shape or (1,))),
        lengths=", ".join(map(str, lengths)),
        buffer_count=count + 1,
        starts=", ".join(f"starts[{i}]" for i in range(count + 1)),
    )
