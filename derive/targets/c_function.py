"""A generated function in C: the texts that the templates put around its statements.

A function has three parts: work on parameters alone, the angles, and everything else. Sines and cosines stand between
the last two: they are taken of all angles at once, which is what lets a compiler vectorise them across configurations.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

from derive.programs.program import ARGUMENTS, DAMPING, GIVEN, NEAR, POSE, WIDTHS, Function
from derive.programs.tape.tape import PARAMETER, Layer, Op, Output, Tape
from derive.targets.kernel import TRIGONOMETRIC, C, CodePiece, input_name, temporary_names, write_statements
from derive.targets.target import shape_text

# In the order in which they are read and declared; ``k`` holds the constants from the parameters.
_ARRAYS = (*ARGUMENTS, POSE, GIVEN, NEAR, DAMPING, "sines", "cosines", "k", "params")
_LANES = ((128, 32), (256, 16))  # lanes of a block by the most entries that its result may have; larger ones have 8


@dataclass(frozen=True, slots=True)
class Read:
    """An entry of an array that a part uses."""

    name: str  # its name in the part
    # One of ``q``, ``qd``, ``qdd``, ``tau``, ``h``, ``T``, ``given``, ``sines``, ``cosines``, ``k`` and ``params``.
    array: str
    index: int  # its place, from 0


@dataclass(frozen=True, slots=True)
class CodePart:
    """A piece of straight-line code."""

    reads: tuple[Read, ...]  # what it takes
    body: tuple[str, ...]  # statements
    results: tuple[str, ...]  # values

    @property
    def arrays(self) -> tuple[str, ...]:
        """The arrays that it reads, in the order of their declaration."""
        used = {read.array for read in self.reads}
        return tuple(array for array in _ARRAYS if array in used)


def c_function(function: Function, parameters: Sequence[str], more_constants: int = 0) -> dict[str, Any]:
    """The texts of a function of a program in C."""
    constants, angles, body = _three_parts(function.tape, parameters)
    read = {*angles.arrays, *body.arrays}
    used = tuple(argument for argument in function.arguments if argument in read)
    hoisted = ["k"] if constants.results or more_constants else []
    inputs = [*function.arguments, *hoisted]
    size = prod(function.shape)
    lanes = f"{function.name}_lanes"
    return {
        "name": function.name,  # without the robot's
        "arguments": function.arguments,  # arguments from the user
        "used": used,  # those that have a say in the result
        "widths": WIDTHS,  # lengths of those that have not one entry per joint
        "unused": tuple(argument for argument in function.arguments if argument not in used),
        "size": size,  # entries of the result
        "lanes": next((count for most, count in _LANES if size <= most), 8),  # configurations in a block
        "angle_count": len(angles.results),  # angles whose sine or cosine is taken
        "has_sines": "sines" in read,
        "has_cosines": "cosines" in read,
        "constant_count": len(constants.results) + more_constants,  # constants that come from the parameters
        "constants": _static_function(constants, "k", "", step=False),  # from the parameters to the constants
        "angles": _static_function(angles, "angles", lanes),  # from the arguments to the angles
        "lane": _static_function(body, "result", lanes),  # from the arguments and sines to the result
        "declaration": pointers(inputs, "result", "restrict "),  # parameters of the public function
        "batch_declaration": f"size_t count, {pointers(inputs, 'result', 'restrict ')}",  # of that of a batch
        "prototype": pointers(inputs, "result"),  # both in the header
        "batch_prototype": f"size_t count, {pointers(inputs, 'result')}",
        "block_declaration": pointers([*used, *hoisted], "result", "restrict "),  # of the function of one block
        "block_call": ", ".join([*(f"{argument}_block" for argument in used), *hoisted, "result_block"]),
        "documentation": _documentation(function, len(constants.results)),  # lines of its comment
    }


def pointers(inputs: Iterable[str], output: str, qualifier: str = "") -> str:
    """Parameters of a function that reads some arrays and fills another."""
    return ", ".join([*(f"const double *{qualifier}{name}" for name in inputs), f"double *{qualifier}{output}"])


def _static_function(part: CodePart, output: str, lanes: str, *, step: bool = True) -> dict[str, object]:
    """A part whose entries lie ``lanes`` apart, or one after the other without a ``step``."""
    further = [read.array for read in part.reads if read.index]
    steps: list[str] = []
    if step and (len(part.results) > 1 or any(array != "k" for array in further)):
        steps.append("lanes")
    if step and "k" in further:
        steps.append("k_lanes")

    def _entry(array: str, index: int) -> str:  # ``qd[2 * lanes]``: entry 2 of this lane
        distance = "k_lanes" if array == "k" else "lanes"
        if not step or index == 0:
            return f"{array}[{index}]"
        return f"{array}[{distance}]" if index == 1 else f"{array}[{index} * {distance}]"

    reads = [f"const double {read.name} = {_entry(read.array, read.index)};" for read in part.reads]
    moved = [f"{name} + i" for name in (*part.arrays, output)]
    still = ["k" if name == "k + i" else name for name in moved]  # constants are the same in all lanes
    return {
        "declaration": ", ".join([pointers(part.arrays, output, "restrict "), *(f"const size_t {s}" for s in steps)]),
        "one": ", ".join([*part.arrays, output, *("1" for _ in steps)]),
        "lane": ", ".join([*still, *(lanes if s == "lanes" else "1" for s in steps)]),
        "varying": ", ".join([*moved, *(lanes for _ in steps)]),
        "body": (*reads, *part.body),
        "results": tuple(f"{_entry(output, i)} = {text};" for i, text in enumerate(part.results)),
    }


def _documentation(function: Function, constant_count: int) -> tuple[str, ...]:
    """The lines of a function's comment in the header."""
    wording = function.interface
    layout = ", row by row" if len(function.shape) > 1 else ""
    constants = f"@param[in]  k       {constant_count} constants from {function.name}_constants()."
    return (
        wording.summary,
        "",
        *(
            f"@param[in]  {name}       {ARGUMENTS[name]}, "
            + (f"{WIDTHS[name]} entries." if name in WIDTHS else "one entry per joint.")
            for name in function.arguments
            if name in ARGUMENTS
        ),
        *([constants] if constant_count else []),
        f"@param[out] result  {wording.symbol}, {shape_text(function.shape)}{layout}: {wording.result}.",
        "",
        *function.notes,
    )


def _three_parts(tape: Tape, parameters: Sequence[str]) -> tuple[CodePart, CodePart, CodePart]:
    """From parameters to constants, from arguments and constants to angles, and from all of these to the outputs."""
    joints = {i: n.source.index for i, n in enumerate(tape.nodes) if n.source is not None and n.source.kind == "q"}
    # What sines and cosines are taken of, except where that depends on a sine or cosine itself.
    late, found = set[int](), set[int]()
    for i, node in enumerate(tape.nodes):
        is_angle_taken = node.op in TRIGONOMETRIC
        if node.layer is Layer.BODY and (is_angle_taken or late.intersection(node.operands)):
            if is_angle_taken and not late.intersection(node.operands):
                found.add(node.operands[0])
            late.add(i)
    angles = sorted(found, key=lambda angle: (0, joints[angle]) if angle in joints else (1, angle))
    constants = {i: Read(f"k{place + 1}", "k", place) for place, i in enumerate(tape.hoisted_results)}
    sines: dict[int, Read] = {}
    for i, node in enumerate(tape.nodes):
        if node.layer is Layer.BODY and node.op in TRIGONOMETRIC and node.operands[0] in angles:
            angle = node.operands[0]
            place = angles.index(angle)
            name = joints[angle] + 1 if angle in joints else f"a{place + 1}"
            array = "sines" if node.op is Op.SINE else "cosines"
            sines[i] = Read(f"{TRIGONOMETRIC[node.op]}{name}", array, place)
    return (
        _part(tape, parameters, [Output(i, False) for i in constants], {}),
        _part(tape, parameters, [Output(i, False) for i in angles], constants),
        _part(tape, parameters, tape.outputs, {**constants, **sines}),
    )


def _part(tape: Tape, parameters: Sequence[str], outputs: Sequence[Output], given: Mapping[int, Read]) -> CodePart:
    """Code for some outputs, in which ``given`` values need not be computed."""
    needed = {output.node for output in outputs}
    stack = list(needed)
    while stack:
        i = stack.pop()
        fresh = set() if i in given else set(tape.nodes[i].operands) - needed
        needed |= fresh
        stack += fresh
    reads: list[Read] = []
    pieces: dict[int, CodePiece] = {}
    operations: list[int] = []
    for i in sorted(needed):
        node = tape.nodes[i]
        if i in given:
            reads.append(given[i])
        elif node.source is not None:
            array = "params" if node.source.kind == PARAMETER else node.source.kind
            reads.append(Read(input_name(node.source, parameters), array, node.source.index))
        elif node.op is Op.CONSTANT:
            pieces[i] = C.number(node.value)
            continue
        else:
            operations.append(i)
            continue
        pieces[i] = CodePiece(reads[-1].name)
    body = write_statements(tape, C, operations, pieces, temporary_names())
    reads.sort(key=lambda read: (_ARRAYS.index(read.array), read.index))
    return CodePart(tuple(reads), body, tuple(C.output(tape, output, pieces) for output in outputs))
