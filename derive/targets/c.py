"""``model.h`` and ``model.c``: the functions of a robot in C99, one configuration or a batch, from the same tapes.

A function has three parts: work on parameters alone, the angles, and everything else. Sines and cosines stand between
the last two: they are taken of all angles at once, which is what lets a compiler vectorise them across configurations.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, prod
from typing import TYPE_CHECKING, Any

from derive.programs.program import ARGUMENTS, DAMPING, GIVEN, NEAR, POSE, WIDTHS, Function, Inverse, InverseSearch
from derive.programs.tape.tape import PARAMETER, Layer, Op, Output, Tape
from derive.robot.robot import Robot
from derive.targets.escape import c_comment, c_prefix
from derive.targets.kernel import TRIGONOMETRIC, C, CodePiece, input_name, write_statements
from derive.targets.target import Source, Target, bound_text, case_context, heading, joint_limits, shape_text
from derive.targets.templating import render

if TYPE_CHECKING:
    from derive.inverse.general.closure import Closure
    from derive.inverse.general.elimination import Elimination

# In the order in which they are read and declared; ``k`` holds the constants from the parameters.
_ARRAYS = (*ARGUMENTS, POSE, GIVEN, NEAR, DAMPING, "sines", "cosines", "k", "params")
_LANES = ((128, 32), (256, 16))  # lanes of a block by the most entries that its result may have; larger ones have 8
HEADER, CODE = "model.h", "model.c"
_LEAST = 4  # length of the sides of square matrices, at least: compilers warn of loops that never run on shorter ones


@dataclass(frozen=True, slots=True)
class Read:
    """An entry of an array that a part uses."""

    name: str  # its name in the part
    array: str  # one of `_ARRAYS`
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
        return tuple(array for array in _ARRAYS if any(read.array == array for read in self.reads))


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
        "widths": {**WIDTHS, **function.widths},  # lengths of those that have not one entry per joint
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
        "prototype": pointers(inputs, "result"),  # the same in the header
        "block_declaration": pointers([*used, *hoisted], "result", "restrict "),  # of the function of one block
        "block_call": ", ".join([*(f"{argument}_block" for argument in used), *hoisted, "result_block"]),
        "wording": function.interface,  # what its comment says: summary, symbol and result
        "described": function.described,  # arguments
        "shape": shape_text(function.shape) + ", row by row" * (len(function.shape) > 1),
        "notes": function.notes,  # how it is computed
    }


def pointers(inputs: Iterable[str], output: str, qualifier: str = "") -> str:
    """Parameters of a function that reads some arrays and fills another."""
    return ", ".join([*(f"const double *{qualifier}{name}" for name in inputs), f"double *{qualifier}{output}"])


def _static_function(part: CodePart, output: str, lanes: str, *, step: bool = True) -> dict[str, object]:
    """A part whose entries lie ``lanes`` apart, or one after the other without a ``step``."""
    further = [read.array for read in part.reads if read.index]
    steps: list[str] = []
    steps += ["lanes"] if step and (len(part.results) > 1 or any(array != "k" for array in further)) else []
    steps += ["k_lanes"] if step and "k" in further else []

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
            sines[i] = Read(f"{TRIGONOMETRIC[node.op]}{name}", "sines" if node.op is Op.SINE else "cosines", place)
    return (
        _part(tape, parameters, [Output(i, False) for i in constants], {}),
        _part(tape, parameters, [Output(i, False) for i in angles], constants),
        _part(tape, parameters, tape.outputs, {**constants, **sines}),
    )


def _part(tape: Tape, parameters: Sequence[str], outputs: Sequence[Output], given: Mapping[int, Read]) -> CodePart:
    """Code for some outputs, in which ``given`` values need not be computed."""
    needed = {output.node for output in outputs}
    for i in reversed(range(len(tape.nodes))):  # operands stand before what is made of them
        if i in needed and i not in given:
            needed.update(tape.nodes[i].operands)
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
    body = write_statements(tape, C, operations, pieces)
    reads.sort(key=lambda read: (_ARRAYS.index(read.array), read.index))
    return CodePart(tuple(reads), body, tuple(C.output(tape, output, pieces) for output in outputs))


def render_c(source: Source) -> dict[str, str]:
    """Header and code."""
    context = c_context(source)
    return {HEADER: render("c/model.h.jinja", **context), CODE: render("c/model.c.jinja", **context)}


TARGET = Target("c", "C99 without allocation or globals, one configuration or a batch", (HEADER, CODE), render_c)


def c_context(source: Source) -> dict[str, Any]:
    """What the templates of C ask for."""
    program, prefix = source.program, c_prefix(source.robot.name)
    functions = [c_function(function, program.parameters) for function in program]
    solved = solvable(source)
    inverse = c_inverse(solved, source) if solved else None
    texts = [*functions, inverse["function"]] if inverse else functions
    return heading(source, c_comment) | {
        "parameters": [{"name": name, "place": str(i)} for i, name in enumerate(program.parameters)],
        "parameter_count": len(program.parameters),
        "prefix": prefix,
        "guard": f"DERIVE_{prefix.upper()}MODEL_H",
        "functions": functions,
        "inverse": inverse,
        "has_angles": any(function["angle_count"] for function in texts),
        **case_context(program.all_tapes),
        "has_sign": any(node.op is Op.SIGN for tape in program.all_tapes for node in tape.nodes),
        "has_batches": any(function["arguments"] for function in texts),
    }


def solvable(source: Source) -> Inverse | InverseSearch | None:
    """Inverse kinematics that C has: by a program, or by eigenvalues."""
    search = source.program.search
    return source.program.inverse or (search if search and search.eliminations else None)


def c_inverse(inverse: Inverse | InverseSearch, source: Source) -> dict[str, Any]:
    """Inverse kinematics in C."""
    robot, parameters = source.robot, source.program.parameters
    step = c_function(inverse.step, parameters) if isinstance(inverse, Inverse) else None
    further = step["constant_count"] if step else 0
    function = c_function(inverse.function, parameters, further)
    inputs = [*inverse.function.widths, *(hoisted := ["k"] if function["constant_count"] else [])]
    limits = [pair or (-inf, inf) for pair in joint_limits(robot)]
    joints, nearest = list(enumerate(robot.joints)), [POSE, NEAR, *hoisted]
    rows = [f"{name} + {width} * row" for name, width in inverse.function.widths.items() if name != NEAR]
    rows.append(f"{NEAR} ? {NEAR} + {inverse.joints} * row : NULL")

    def _declared(names: Iterable[str], qualifier: str, *, status: bool = True) -> str:
        return pointers(names, "q", qualifier) + (f", int *{qualifier}status" if status else "")

    return {
        "function": function,  # the texts of its program; its constants are followed by those of the step
        "step": step,  # those of its Newton step
        "step_constants": f", k + {function['constant_count'] - further}" if further else "",
        "branches": inverse.branches,
        "size": inverse.branches * inverse.joints,  # joint variables of all branches
        "closed": repr(inverse.closed) if isinstance(inverse, Inverse) else "",
        "around": inverse.around if isinstance(inverse, Inverse) else None,  # where further solutions are looked for
        "loads": [  # the arguments that a batch loads into lanes; an optional one may be NULL, which stands for zeros
            {"name": name, "width": inverse.function.widths[name], "is_optional": name == NEAR}
            for name in function["used"]
        ],
        "declaration": _declared(inputs, "restrict "),  # parameters of the public function
        "nearest_declaration": _declared(nearest, "restrict ", status=False),  # of that of the nearest solution
        "prototype": _declared(inputs, ""),  # parameters of the first in the header
        "nearest_prototype": _declared(nearest, "", status=False),
        # limits of the joints, each list as the inside of an array
        "lower": ", ".join(bound_text(pair[0], "INFINITY") for pair in limits),
        "upper": ", ".join(bound_text(pair[1], "INFINITY") for pair in limits),
        "revolute": ", ".join(str(int(joint.is_revolute)) for joint in robot.joints),  # which joints turn, 1 or 0
        "turning": ", ".join(str(int(i not in inverse.given and joint.is_revolute)) for i, joint in joints),
        "given": tuple({"name": str(k + 1), "place": str(joint)} for k, joint in enumerate(inverse.given)),
        "given_array": f", given[{len(inverse.given)}]" if inverse.given else "",
        "nearest_call": ", ".join([*inputs, "solutions", "status"]),
        "start_call": ", ".join([*("start" if name == NEAR else name for name in inputs), "values"]),
        "alone_declaration": pointers(inputs, "q", "restrict "),
        "alone_call": ", ".join("start" if name == NEAR else name for name in [*inputs, "q"]),
        "beside_call": ", ".join([*("moved" if name == POSE else name for name in inputs), "values"]),
        "row_call": ", ".join([*rows, *hoisted]),  # inputs of a call for one row of a batch
        "count": inverse.summary,  # how many solutions there are
        "given_words": ", ".join(c_comment(robot.joints[i].variable) for i in inverse.given),
        "joints": inverse.joints,
        "order": tuple(map(c_comment, inverse.order)) if isinstance(inverse, Inverse) else (),
        "search": c_search(inverse, robot) if isinstance(inverse, InverseSearch) else None,
    }


def c_search(search: InverseSearch, robot: Robot) -> dict[str, Any]:
    """Numbers and initialisers for the templates below ``c/search``."""
    free = [joint for joint in range(robot.n) if joint not in search.given]
    size = max(each.eigenvalues for each in search.eliminations)
    return {
        "eliminations": tuple(map(_initialiser, search.eliminations)),  # each as the inside of an array
        "is_position": all(column == 3 for _, column in search.entries),  # whether the position alone is wanted
        "free": _listed(free),  # indices of the joints that are solved for, as the inside of an array
        "free_count": len(free),
        "given_joints": _listed(search.given or (-1,)),
        "given_count": len(search.given),
        "entry_rows": _listed(row for row, _ in search.entries),  # rows of the entries of T that are wanted
        "entry_columns": _listed(column for _, column in search.entries),
        "entry_count": len(search.entries),
        "signs": _listed(float(joint.sign) for joint in robot.joints),  # factors of the joint variables
        # Most ways around the loop of an elimination, and most equations of one.
        "ways": max(len(each.reductions) for each in search.eliminations),
        "rows": max(sum(way.equations for way in each.reductions) for each in search.eliminations),
        "columns": max(_LEAST, *(max(sum(each.rows), _products(each)) for each in search.eliminations)),
        "size": max(_LEAST, size),
        "most": max(search.branches, 8 * size),  # solutions that are kept
        "motions": tuple(map(_listed, search.motions)),
    }


def _products(elimination: Elimination) -> int:
    """How many products of the joints beside the hidden one there are."""
    way = elimination.finish
    met = {(way.dropped + way.direction * place) % way.joints for place in range(way.eliminated + 1)}
    others = [joint for joint in range(way.joints) if joint not in met and joint != elimination.hidden]
    return prod((2 if joint in elimination.straight else 3) + (joint == elimination.multiplied) for joint in others)


def _initialiser(elimination: Elimination) -> str:
    multiplied = -1 if elimination.multiplied is None else elimination.multiplied
    straight = sum(1 << joint for joint in elimination.straight)
    ways = [_way(each.closure, each.equations, each.constant, each.linear) for each in elimination.reductions]
    head = f"{elimination.start}, {elimination.hidden}, {multiplied}, {{{_listed(elimination.rows)}}}"
    return f"{{{head}, {straight}, {len(ways)}, {{{', '.join(ways)}}}, {_way(elimination.finish)}}}"


def _way(way: Closure, *numbers: int) -> str:
    """A way around the loop, and how its equations split by degree."""
    return f"{{{_listed((way.dropped, way.direction, way.eliminated, *(numbers or (0, 0, 0))))}}}"


def _listed(values: Iterable[float]) -> str:
    return ", ".join(map(str, values))
