"""``model_native.py``: the C functions of a robot as NumPy generalised ufuncs, compiled when the folder is built."""

from dataclasses import dataclass
from math import prod
from typing import Any

from derive.programs.program import GIVEN, NEAR, POSE, POSE_ENTRIES, Function, Inverse, InverseSearch
from derive.targets.c import c_context, solvable
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


def render_native(source: Source) -> dict[str, str]:
    """Module and code."""
    code, inverse = c_context(source), solvable(source)
    texts = code["functions"]
    loops = [_loop(function, text, source.robot.dof) for function, text in zip(source.program, texts, strict=True)]
    solver = [code["inverse"]["function"]] if inverse else []
    counts = {text["name"]: text["constant_count"] for text in [*texts, *solver]}
    module = python_context(source) | {"constant_counts": counts, "library": LIBRARY}
    if inverse is None:
        module["inverse"] = None
    else:
        module["inverse_in_one_call"] = not inverse.given and not counts["inverse_kinematics"]
        module["nearest_is_compiled"] = True
    code["loops"] = list(zip(texts, loops, strict=True))
    if inverse:
        code["inverse_loop"] = _inverse_loop(inverse, *solver)
        code["nearest"] = _nearest_loop(inverse, *solver)
    return {MODULE: render(f"native/{MODULE}.jinja", **module), CODE: render(f"native/{CODE}.jinja", **code)}


_WHAT = "the C functions as NumPy generalised ufuncs; needs a C compiler"
_COMPILED = {LIBRARY: (CODE, "model.c", "model.h")}
TARGET = Target("native", _WHAT, (MODULE, CODE), render_native, default=False, requires=("c",), compiled=_COMPILED)


def _gather(width: int, place: int, entry: int, block: str, lane: int) -> str:
    """Loads entries of an argument into a block, from a lane on."""
    start = f"at[{place}] + {entry} * cores[{place}]"
    return f"gather({width}, {start}, steps[{place}], cores[{place}], rows, {block} + {lane} * width, width);"


def _nearest_loop(inverse: Inverse | InverseSearch, text: dict[str, Any]) -> dict[str, object]:
    n, constants = inverse.joints, text["constant_count"]
    widths = {POSE: POSE_ENTRIES, NEAR: n} | ({"k": constants} if constants else {})
    inputs = tuple(Input(name, width, i, i) for i, (name, width) in enumerate(widths.items()))
    loads = [_gather(n, 1, 0, "nearby", 0)]
    for place, name in enumerate((POSE, NEAR)):
        loads += [_gather(widths[name], place, 0, f"{name}_block", 0)] if name in text["used"] else []
    if GIVEN in text["used"]:
        loads += [_gather(1, 1, joint, f"{GIVEN}_block", k) for k, joint in enumerate(inverse.given)]
    return {
        "inputs": inputs,
        "count": len(inputs),
        "buffer_count": len(inputs) + 1,
        "lanes": "1" if isinstance(inverse, InverseSearch) else f"{text['name']}_lanes",
        "is_block": "steps[2] == 0" if constants else "1",
        "loads": tuple(loads),
        "lengths": ", ".join(str(8 * width) for width in (*widths.values(), n)),
    }


def _inverse_loop(inverse: Inverse | InverseSearch, text: dict[str, Any]) -> dict[str, object]:
    widths = dict(inverse.function.widths) | ({"k": text["constant_count"]} if text["constant_count"] else {})
    count, size = len(widths), inverse.branches * inverse.joints
    inputs = tuple(Input(name, width, i, count + 2 + i) for i, (name, width) in enumerate(widths.items()))
    return {
        "inputs": inputs,  # all inputs, the constants included
        "loads": tuple(entry for entry in inputs if entry.name in text["used"]),  # the inputs that are read
        "cores": 2 * count + 2,  # place of the bytes between the entries of the results, among all steps
        "constants_place": count - 1,  # place of the constants
        "constants_core": 2 * count + 1,  # place of the bytes between them
        "result_place": count,  # place of the joint variables
        "status_place": count + 1,  # place of what the branches are
        "lengths": ", ".join(map(str, (*(8 * width for width in widths.values()), 8 * size, inverse.branches))),
        "buffer_count": count + 2,
    }


def _loop(function: Function, text: dict[str, Any], joints: int) -> dict[str, object]:
    widths = {name: function.width(name, joints) for name in function.arguments}
    widths |= {"k": text["constant_count"]} if text["constant_count"] else {}
    count = len(widths)
    inputs = (Input(name, width, i, count + 1 + i) for i, (name, width) in enumerate(widths.items()))
    return {
        "inputs": tuple(widths),  # names of the inputs, the constants from the parameters included
        "loads": tuple(entry for entry in inputs if entry.name in text["used"]),
        "constants_place": count - 1,  # place of the constants
        "constants_core": 2 * count,  # place of the bytes between them
        "result_place": count,  # place of the result
        "result_core": 2 * count + 1,  # place of the bytes between its entries, one for each axis
        "axes": len(function.shape),  # axes of the result
        "dimensions": ", ".join(map(str, function.shape or (1,))),
        # lengths of the inputs and of the result, as the inside of an array
        "lengths": ", ".join(map(str, (*widths.values(), prod(function.shape)))),
        "buffer_count": count + 1,  # inputs and the result
        "starts": ", ".join(f"starts[{i}]" for i in range(count + 1)),  # arguments of the call for one configuration
    }
