"""``model.h`` and ``model.c``: the functions of a robot in C99, one configuration or a batch, from the same tapes.

A function has three parts: work on parameters alone, the angles, and everything else. Sines and cosines stand between
the last two: they are taken of all angles at once, which is what lets a compiler vectorise them across configurations.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite, prod

from derive.programs.program import ARGUMENTS, GIVEN, NEAR, POSE, Function, Inverse, joint_lines
from derive.programs.tape.tape import PARAMETER, Layer, Op, Output, Tape
from derive.robot.robot import Robot
from derive.targets.escape import c_comment, c_prefix
from derive.targets.kernel import TRIGONOMETRIC, C, Piece, case_context, input_name, temporary_names, write_statements
from derive.targets.target import Source, Target, joint_limits, shape_text
from derive.targets.templating import render

HEADER, CODE = "model.h", "model.c"

_ARRAYS = ("q", "qd", "qdd", "tau", POSE, GIVEN, NEAR, "sines", "cosines", "k", "params")
"""In the order in which they are read and declared; ``k`` holds the constants from the parameters."""

_LANES = ((128, 32), (256, 16))
"""Lanes of a block by the most entries that its result may have; larger ones have 8."""


@dataclass(frozen=True, slots=True)
class Read:
    """An entry of an array that a part uses.

    Attributes:
        name: Its name in the part.
        array: One of ``q``, ``qd``, ``qdd``, ``tau``, ``T``, ``given``, ``sines``, ``cosines``, ``k`` and ``params``.
        index: Its place, from 0.
    """

    name: str
    array: str
    index: int


@dataclass(frozen=True, slots=True)
class Part:
    """A piece of straight-line code.

    Attributes:
        reads: What it takes.
        body: Statements.
        results: Values.
    """

    reads: tuple[Read, ...]
    body: tuple[str, ...]
    results: tuple[str, ...]

    @property
    def arrays(self) -> tuple[str, ...]:
        """The arrays that it reads, in the order of their declaration."""
        used = {read.array for read in self.reads}
        return tuple(array for array in _ARRAYS if array in used)


@dataclass(frozen=True, slots=True)
class StaticFunction:
    """A part as a function of the file: its statements, and how it is declared and called.

    Attributes:
        declaration: Its parameters.
        one: The arguments of its call for one configuration.
        lane: The arguments of its call for one lane of a block.
        varying: The arguments of its call for a lane where the constants differ from lane to lane.
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
        angle_count: Angles whose sine or cosine is taken.
        has_sines: Whether a sine is taken of any.
        has_cosines: Whether a cosine is.
        constant_count: Constants that come from the parameters.
        constants: From the parameters to the constants.
        angles: From the arguments to the angles.
        lane: From the arguments and sines to the result, for one configuration of a block.
        declaration: Parameters of the public function.
        batch_declaration: Parameters of the public function of a batch.
        prototype: Parameters of the public function in the header.
        batch_prototype: Parameters of the public function of a batch in the header.
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
    angle_count: int
    has_sines: bool
    has_cosines: bool
    constant_count: int
    constants: StaticFunction
    angles: StaticFunction
    lane: StaticFunction
    declaration: str
    batch_declaration: str
    prototype: str
    batch_prototype: str
    block_declaration: str
    block_call: str
    documentation: tuple[str, ...]


def render_c(source: Source) -> dict[str, str]:
    """Header and code.

    Args:
        source: The robot and its program.

    Returns:
        Their texts by file name.
    """
    context = c_context(source)
    return {HEADER: render("c/model.h.jinja", **context), CODE: render("c/model.c.jinja", **context)}


TARGET = Target(
    name="c",
    summary="C99 without allocation or globals, one configuration or a batch",
    files=(HEADER, CODE),
    render=render_c,
)


def c_context(source: Source) -> dict[str, object]:
    """What the templates of C ask for.

    Args:
        source: The robot and its program.

    Returns:
        Values by name.
    """
    program, prefix = source.program, c_prefix(source.robot.name)
    functions = [c_function(function, program.parameters) for function in program]
    inverse = c_inverse(program.inverse, source) if program.inverse else None
    texts = [*functions, inverse.function] if inverse else functions
    return c_heading(source) | {
        "parameters": [{"name": name, "place": str(i)} for i, name in enumerate(program.parameters)],
        "parameter_count": len(program.parameters),
        "prefix": prefix,
        "guard": f"DERIVE_{prefix.upper()}MODEL_H",
        "functions": functions,
        "inverse": inverse,
        "has_angles": any(function.angle_count for function in texts),
        **case_context(function.tape for function in program.all_functions),
        "has_sign": any(node.op is Op.SIGN for function in program.all_functions for node in function.tape.nodes),
        "has_batches": any(function.arguments for function in texts),
    }


def c_heading(source: Source) -> dict[str, object]:
    """What the comment at the top of a file in C asks for.

    Args:
        source: The robot and its program.

    Returns:
        Values by name.
    """
    robot = source.robot
    return {
        "title": c_comment(robot.title or robot.name),
        "name": c_comment(robot.name),
        "version": c_comment(source.version),
        "digest": robot.digest,
        "convention": robot.convention.value,
        "dof": robot.n,
        "joints": [c_comment(line) for line in joint_lines(robot)],
    }


def c_function(function: Function, parameters: Sequence[str]) -> CFunction:
    """A function of a program in C.

    Args:
        function: The function as a tape.
        parameters: Names of the run-time parameters.

    Returns:
        Its texts.
    """
    constants, angles, body = _three_parts(function.tape, parameters)
    read = {*angles.arrays, *body.arrays}
    used = tuple(argument for argument in function.arguments if argument in read)
    hoisted = ["k"] if constants.results else []
    inputs = [*function.arguments, *hoisted]
    size = prod(function.shape)
    return CFunction(
        name=function.name,
        arguments=function.arguments,
        used=used,
        unused=tuple(argument for argument in function.arguments if argument not in used),
        size=size,
        lanes=next((lanes for most, lanes in _LANES if size <= most), 8),
        angle_count=len(angles.results),
        has_sines="sines" in read,
        has_cosines="cosines" in read,
        constant_count=len(constants.results),
        constants=_static_function(constants, "k", "", step=False),
        angles=_static_function(angles, "angles", f"{function.name}_lanes"),
        lane=_static_function(body, "result", f"{function.name}_lanes"),
        declaration=_pointers(inputs, "result", "restrict "),
        batch_declaration=f"size_t count, {_pointers(inputs, 'result', 'restrict ')}",
        prototype=_pointers(inputs, "result"),
        batch_prototype=f"size_t count, {_pointers(inputs, 'result')}",
        block_declaration=_pointers([*used, *hoisted], "result", "restrict "),
        block_call=", ".join([*(f"{argument}_block" for argument in used), *hoisted, "result_block"]),
        documentation=_documentation(function, len(constants.results)),
    )


@dataclass(frozen=True, slots=True)
class Load:
    """An argument that a batch loads into lanes.

    Attributes:
        name: Its name.
        width: Number of its entries.
        is_optional: Whether it may be NULL, which stands for zeros.
    """

    name: str
    width: int
    is_optional: bool


@dataclass(frozen=True, slots=True)
class CInverse:
    """Inverse kinematics.

    Attributes:
        function: The texts of its program.
        branches: Number of branches.
        size: Joint variables of all branches.
        loads: The arguments that are read.
        declaration: Parameters of the public function.
        batch_declaration: Of that of a batch.
        nearest_declaration: Of that of the nearest solution.
        prototype: Parameters of the first in the header.
        batch_prototype: Of the second.
        nearest_prototype: Of the third.
        lower: Lower limits of the joints, as the inside of an array.
        upper: Upper limits.
        revolute: Which joints turn, 1 or 0.
        given: Numbers of the given joints, from 1, and their places.
        given_array: Declares the variables of the given joints, if there are any.
        given_lines: Statements that take them from a configuration.
        nearest_call: Arguments of the call of the first function in the third.
        start_call: Arguments of a call with the free joints elsewhere.
        row_call: Inputs of a call for one row of a batch.
        documentation: Lines of the comment of the first.
    """

    function: CFunction
    branches: int
    size: int
    loads: tuple[Load, ...]
    declaration: str
    batch_declaration: str
    nearest_declaration: str
    prototype: str
    batch_prototype: str
    nearest_prototype: str
    lower: str
    upper: str
    revolute: str
    given: tuple[dict[str, str], ...]
    given_array: str
    given_lines: tuple[str, ...]
    nearest_call: str
    start_call: str
    row_call: str
    documentation: tuple[str, ...]


def c_inverse(inverse: Inverse, source: Source) -> CInverse:
    """Inverse kinematics in C.

    Args:
        inverse: The program.
        source: The robot.

    Returns:
        Its texts.
    """
    function, robot = c_function(inverse.function, source.program.parameters), source.robot
    hoisted = ["k"] if function.constant_count else []
    inputs = [*function.arguments, *hoisted]
    limits = [pair or (-inf, inf) for pair in joint_limits(robot)]
    nearest = [POSE, NEAR, *hoisted]
    rows = [f"{name} + {inverse.function.widths[name]} * row" for name in function.arguments if name != NEAR]
    rows.append(f"{NEAR} ? {NEAR} + {inverse.joints} * row : NULL")

    def _declared(names: Iterable[str], qualifier: str, *, status: bool = True) -> str:
        return _pointers(names, "q", qualifier) + (f", int *{qualifier}status" if status else "")

    return CInverse(
        function=function,
        branches=inverse.branches,
        size=inverse.branches * inverse.joints,
        loads=tuple(Load(name, inverse.function.widths[name], name == NEAR) for name in function.used),
        declaration=_declared(inputs, "restrict "),
        batch_declaration=f"size_t count, {_declared(inputs, 'restrict ')}",
        nearest_declaration=_declared(nearest, "restrict ", status=False),
        prototype=_declared(inputs, ""),
        batch_prototype=f"size_t count, {_declared(inputs, '')}",
        nearest_prototype=_declared(nearest, "", status=False),
        lower=", ".join(_bound(pair[0]) for pair in limits),
        upper=", ".join(_bound(pair[1]) for pair in limits),
        revolute=", ".join(str(int(joint.is_revolute)) for joint in robot.joints),
        given=tuple({"name": str(k + 1), "place": str(joint)} for k, joint in enumerate(inverse.given)),
        given_array=f", given[{len(inverse.given)}]" if inverse.given else "",
        given_lines=tuple(f"given[{k}] = near[{joint}];" for k, joint in enumerate(inverse.given)),
        nearest_call=", ".join([*inputs, "solutions", "status"]),
        start_call=", ".join([*("start" if name == NEAR else name for name in inputs), "q", "status"]),
        row_call=", ".join([*rows, *hoisted]),
        documentation=_inverse_documentation(inverse, robot, function.constant_count),
    )


def _bound(value: float) -> str:
    return repr(value) if isfinite(value) else "-INFINITY" if value < 0 else "INFINITY"


def _inverse_documentation(inverse: Inverse, robot: Robot, constant_count: int) -> tuple[str, ...]:
    """The lines of the comment in the header."""
    interface, names = inverse.function.interface, [robot.joints[i].variable for i in inverse.given]
    constants = f"@param[in]  k       {constant_count} constants from inverse_kinematics_constants()."
    return (
        interface.summary,
        "",
        inverse.summary,
        "T must be a pose: its rotation is not checked.",
        "",
        "@param[in]  T       pose of the end effector in the world frame, 4 x 4, row by row.",
        *([f"@param[in]  given   variables of {', '.join(map(c_comment, names))}."] if names else []),
        "@param[in]  near    where joints are that are free at a pose, a configuration; NULL for zeros. If the others",
        "                    have no solution with them there, they are elsewhere.",
        *([constants] if constant_count else []),
        f"@param[out] q       joint variables, {inverse.branches} x {inverse.joints}: {interface.result}.",
        f"@param[out] status  what each branch is, {inverse.branches}; may be NULL.",
        "@return the number of solutions.",
        "",
        *inverse.function.notes,
    )


def _pointers(inputs: Iterable[str], output: str, qualifier: str = "") -> str:
    """Parameters of a function that reads some arrays and fills another."""
    return ", ".join([*(f"const double *{qualifier}{name}" for name in inputs), f"double *{qualifier}{output}"])


def _static_function(part: Part, output: str, lanes: str, *, step: bool = True) -> StaticFunction:
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
    return StaticFunction(
        declaration=", ".join([_pointers(part.arrays, output, "restrict "), *(f"const size_t {s}" for s in steps)]),
        one=", ".join([*part.arrays, output, *("1" for _ in steps)]),
        lane=", ".join([*still, *(lanes if s == "lanes" else "1" for s in steps)]),
        varying=", ".join([*moved, *(lanes for _ in steps)]),
        body=(*reads, *part.body),
        results=tuple(f"{_entry(output, i)} = {text};" for i, text in enumerate(part.results)),
    )


def _documentation(function: Function, constant_count: int) -> tuple[str, ...]:
    """The lines of a function's comment in the header."""
    wording = function.interface
    layout = ", row by row" if len(function.shape) > 1 else ""
    constants = f"@param[in]  k       {constant_count} constants from {function.name}_constants()."
    return (
        wording.summary,
        "",
        *(
            f"@param[in]  {name}       {ARGUMENTS[name]}, one entry per joint."
            for name in function.arguments
            if name in ARGUMENTS
        ),
        *([constants] if constant_count else []),
        f"@param[out] result  {wording.symbol}, {shape_text(function.shape)}{layout}: {wording.result}.",
        "",
        *function.notes,
    )


def _three_parts(tape: Tape, parameters: Sequence[str]) -> tuple[Part, Part, Part]:
    """From parameters to constants, from arguments and constants to angles, and from all of these to the outputs."""
    joints = {i: n.source.index for i, n in enumerate(tape.nodes) if n.source is not None and n.source.kind == "q"}
    angles = sorted(_angles(tape), key=lambda angle: (0, joints[angle]) if angle in joints else (1, angle))
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


def _angles(tape: Tape) -> set[int]:
    """What sines and cosines are taken of, except where that depends on a sine or cosine itself."""
    late: set[int] = set()
    angles: set[int] = set()
    for i, node in enumerate(tape.nodes):
        if node.layer is Layer.BODY and late.intersection(node.operands):
            late.add(i)
        elif node.layer is Layer.BODY and node.op in TRIGONOMETRIC:
            late.add(i)
            angles.add(node.operands[0])
    return angles


def _part(tape: Tape, parameters: Sequence[str], outputs: Sequence[Output], given: Mapping[int, Read]) -> Part:
    """Code for some outputs, in which ``given`` values need not be computed."""
    needed = {output.node for output in outputs}
    stack = list(needed)
    while stack:
        i = stack.pop()
        fresh = set() if i in given else set(tape.nodes[i].operands) - needed
        needed |= fresh
        stack += fresh
    reads: list[Read] = []
    pieces: dict[int, Piece] = {}
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
        pieces[i] = Piece(reads[-1].name)
    body = write_statements(tape, C, operations, pieces, temporary_names())
    reads.sort(key=lambda read: (_ARRAYS.index(read.array), read.index))
    return Part(tuple(reads), body, tuple(C.output(tape, output, pieces) for output in outputs))
