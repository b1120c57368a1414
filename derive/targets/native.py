"""``model_native.py``: the C functions of a robot as NumPy generalised ufuncs, compiled when the folder is built."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod

from derive.programs.program import GIVEN, NEAR, POSE, POSE_ENTRIES, Function, Inverse, InverseSearch
from derive.targets.c import c_context, solvable
from derive.targets.c_function import CFunction, c_function
from derive.targets.c_inverse import c_inverse
from derive.targets.numpy import python_context
from derive.targets.target import Source, Target
from derive.targets.templating import render

MODULE, CODE, LIBRARY = "model_native.py", "model_native.c", "libmodel_native.so"


@dataclass(frozen=True, slots=True)
class Input:
    """An argument that a loop loads into lanes."""

    name: str  # its name
    width: int  # number of its entries
    place: int  # its place among the loop's arguments, and of the bytes between its rows
    core: int  # place of the bytes between its entries


@dataclass(frozen=True, slots=True)
class Loop:
    """NumPy's inner loop around a C function: where things are among the loop's arguments and steps."""

    inputs: tuple[str, ...]  # names of the inputs, the constants from the parameters included
    loads: tuple[Input, ...]  # the inputs that are read
    constants_place: int  # place of the constants
    constants_core: int  # place of the bytes between them
    result_place: int  # place of the result
    result_core: int  # place of the bytes between its entries, one for each axis
    axes: int  # axes of the result
    dimensions: str  # its shape, as the inside of an array, which has an entry even for a scalar
    lengths: str  # lengths of the inputs and of the result, as the inside of an array
    buffer_count: int  # inputs and the result
    starts: str  # arguments of the call for one configuration


def render_native(source: Source) -> dict[str, str]:
    """Module and code."""
    texts = [c_function(function, source.program.parameters) for function in source.program]
    loops = [_loop(function, text, source.robot.n) for function, text in zip(source.program, texts, strict=True)]
    inverse = solvable(source.program)
    all_texts = [*texts, c_inverse(inverse, source).function] if inverse else texts
    counts = {text.name: text.constant_count for text in all_texts}
    module = python_context(source) | {"constant_counts": counts, "library": LIBRARY}
    if inverse is None:
        module["inverse"] = None
    else:
        module["inverse_in_one_call"] = not inverse.given and not counts["inverse_kinematics"]
        module["nearest_is_compiled"] = True
    code = c_context(source) | {"loops": list(zip(texts, loops, strict=True))}
    if inverse:
        code["inverse_loop"] = _inverse_loop(inverse, all_texts[-1])
        code["nearest"] = _nearest_loop(inverse, all_texts[-1])
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


@dataclass(frozen=True, slots=True)
class InverseLoop:
    """NumPy's inner loop of inverse kinematics, whose results are joint variables and what the branches are."""

    inputs: tuple[Input, ...]  # all inputs, the constants included
    row_call: str  # inputs of a call for one row
    loads: tuple[Input, ...]  # the inputs that are read
    cores: int  # place of the bytes between the entries of the results, among all steps
    constants_place: int  # place of the constants
    constants_core: int  # place of the bytes between them
    result_place: int  # place of the joint variables
    status_place: int  # place of what the branches are
    lengths: str  # bytes of the inputs and of the results, as the inside of an array
    buffer_count: int  # inputs and results
    starts: str  # inputs of the call for one pose


@dataclass(frozen=True, slots=True)
class NearestLoop:
    """NumPy's inner loop of the nearest solution, with the strings and numbers that its template takes."""

    inputs: tuple[Input, ...]
    count: int
    buffer_count: int
    lanes: str
    is_block: str
    loads: tuple[str, ...]
    row_call: str
    starts: str
    lengths: str


def _gather(width: int, place: int, entry: int, block: str, lane: int) -> str:
    """Loads entries of an argument into a block, from a lane on."""
    start = f"at[{place}] + {entry} * cores[{place}]"
    return f"gather({width}, {start}, steps[{place}], cores[{place}], rows, {block} + {lane} * width, width);"


def _nearest_loop(inverse: Inverse | InverseSearch, text: CFunction) -> NearestLoop:
    n, constants = inverse.joints, text.constant_count
    widths = {POSE: POSE_ENTRIES, NEAR: n} | ({"k": constants} if constants else {})
    inputs = tuple(Input(name, width, i, i) for i, (name, width) in enumerate(widths.items()))
    loads = [_gather(n, 1, 0, "nearby", 0)]
    for place, name in enumerate((POSE, NEAR)):
        loads += [_gather(widths[name], place, 0, f"{name}_block", 0)] if name in text.used else []
    if GIVEN in text.used:
        loads += [_gather(1, 1, joint, f"{GIVEN}_block", k) for k, joint in enumerate(inverse.given)]
    return NearestLoop(
        inputs=inputs,
        count=len(inputs),
        buffer_count=len(inputs) + 1,
        lanes="1" if isinstance(inverse, InverseSearch) else f"{text.name}_lanes",
        is_block="steps[2] == 0" if constants else "1",
        loads=tuple(loads),
        row_call=", ".join(f"{name}_row" for name in widths),
        starts=", ".join(f"inputs[{i}]" for i in range(len(inputs) + 1)),
        lengths=", ".join(str(8 * width) for width in (*widths.values(), n)),
    )


def _inverse_loop(inverse: Inverse | InverseSearch, text: CFunction) -> InverseLoop:
    function = inverse.function
    widths = [*function.widths.values()]
    widths += [text.constant_count] if text.constant_count else []
    count, size = len(widths), inverse.branches * inverse.joints
    names = [*function.widths, *(["k"] if text.constant_count else [])]
    inputs = tuple(Input(name, widths[i], i, count + 2 + i) for i, name in enumerate(names))
    return InverseLoop(
        inputs=inputs,
        row_call=", ".join(f"{name}_row" for name in names),
        loads=tuple(entry for entry in inputs if entry.name in text.used),
        cores=2 * count + 2,
        constants_place=count - 1,
        constants_core=2 * count + 1,
        result_place=count,
        status_place=count + 1,
        lengths=", ".join(str(length) for length in [*(8 * width for width in widths), 8 * size, inverse.branches]),
        buffer_count=count + 2,
        starts=", ".join(f"inputs[{i}]" for i in range(count)),
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
