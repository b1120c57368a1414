"""``model_native.py``: the C functions of a robot as NumPy generalised ufuncs, compiled when the folder is built."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod
from typing import Any

from derive.programs.program import Function
from derive.targets.c.functions import CFunction
from derive.targets.c.target import c_context
from derive.targets.numpy import python_context
from derive.targets.python_kernel import PythonFunction
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
    """What the templates ask for beyond the C function itself: places in the loop's arguments and steps."""

    c: CFunction
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

    def __getattr__(self, name: str) -> Any:
        """The attributes of the C function."""
        return getattr(self.c, name)


def render_native(source: Source) -> dict[str, str]:
    """Module and code."""
    c, python = c_context(source), python_context(source)
    pairs = zip(source.program, c["functions"], strict=True)  # type: ignore[call-overload]
    loops = [_loop(function, text, source.robot.n) for function, text in pairs]
    counts = {loop.c.name: loop.c.constant_count for loop in loops}
    functions = [_Both(function, counts[function.name]) for function in python["functions"]]  # type: ignore[attr-defined]
    module = render("native/model_native.py.jinja", **{**python, "functions": functions, "library": LIBRARY})
    return {MODULE: module, CODE: render("native/model_native.c.jinja", **{**c, "functions": loops})}


@dataclass(frozen=True, slots=True)
class _Both:
    """A function's Python texts and the number of its constants in C."""

    python: PythonFunction
    constant_count: int

    @property
    def one_arguments(self) -> str:
        """Of the call for one configuration: the arguments, and an array for the result."""
        return ", ".join([text for text in (self.python.arguments, f"np.empty({self.python.shape})") if text])

    def __getattr__(self, name: str) -> Any:
        return getattr(self.python, name)


def _loop(function: Function, text: CFunction, joints: int) -> Loop:
    constants = ["k"] if text.constant_count else []
    inputs = (*function.arguments, *constants)
    count = len(inputs)
    cores = {name: count + 1 + place for place, name in enumerate(inputs)}
    lengths = [*(joints for _ in function.arguments), *(text.constant_count for _ in constants), prod(function.shape)]
    return Loop(
        c=text,
        inputs=inputs,
        loads=tuple(Input(a, joints, i, cores[a]) for i, a in enumerate(function.arguments) if a in text.used),
        constants_place=count - 1,
        constants_core=2 * count,
        result_place=count,
        result_core=2 * count + 1,
        axes=len(function.shape),
        dimensions=", ".join(map(str, function.shape)),
        lengths=", ".join(map(str, lengths)),
        buffer_count=count + 1,
        starts=", ".join(f"starts[{i}]" for i in range(count + 1)),
    )


TARGET = Target(
    name="native",
    summary="the C functions as NumPy generalised ufuncs; needs a C compiler",
    files=(MODULE, CODE),
    render=render_native,
    default=False,
    requires=("c",),
    compiled={LIBRARY: (CODE, "model.c", "model.h")},
)
