"""Straight-line code from a tape, for every language: how operations are written, and which values get a line.

A value that is used once is written where it is used, unless it is long; any other gets a name in a line of its own.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count

from derive.algebra.constants import Constant, to_float
from derive.programs.program import ARGUMENTS, DAMPING, GIVEN, NEAR, POSE, Function
from derive.programs.tape.tape import ALL_NAMES, LEAVES, PARAMETER, InputSource, Layer, Op, Output, Tape

CASE, SUM, PRODUCT, ATOM = 0, 1, 2, 3  # how tightly the outermost operation of a text binds
TRIGONOMETRIC = {Op.SINE: "s", Op.COSINE: "c"}  # letters of the names that sines and cosines get
_INLINE_WIDTH = 52  # longest value, in characters, that is written inside another one
LINE_WIDTH = 104  # longest line of a list of values or names
_C_NAMES = {Op.ARCTANGENT: "arctangent", Op.ABSOLUTE: "fabs"}
_MATLAB_NAMES = {Op.ROOT: "root", Op.MAXIMUM: "max", Op.MINIMUM: "min", Op.ABSOLUTE: "abs"}


@dataclass(frozen=True, slots=True)
class CodePiece:
    """Text of a value, and how tightly its outermost operation binds."""

    text: str
    binding: int = ATOM

    def inside(self, binding: int) -> str:
        """The text as an operand."""
        return f"({self.text})" if self.binding < binding else self.text


@dataclass(frozen=True, slots=True)
class Language:
    """How a language writes the operations of a tape: infix, in the tape's order, whatever the language may reorder."""

    assignment: str  # the statement that names a value, with ``{name}`` and ``{value}`` in it
    double_minus: bool = False  # whether ``--2`` is 2; where it is a mistake, a negative number is no atom
    has_choice: bool = False  # whether it has ``case ? a : b``, and a comparison is a number; else functions do both
    times: str = "*"  # how it multiplies
    over: str = "/"  # how it divides
    names: Mapping[Op, str] = field(default_factory=lambda: ALL_NAMES)  # what it calls functions

    def number(self, value: Constant | None) -> CodePiece:
        """An exact constant."""
        assert value is not None
        text = repr(to_float(value))
        return CodePiece(text, SUM if text.startswith("-") and not self.double_minus else ATOM)

    def operation(self, op: Op, operands: Sequence[CodePiece]) -> CodePiece:
        """One operation."""
        a, b = operands[0], operands[-1]
        match op:
            case Op.ADD | Op.SUBTRACT:
                return CodePiece(f"{a.inside(SUM)} {'+' if op is Op.ADD else '-'} {b.inside(PRODUCT)}", SUM)
            case Op.MULTIPLY | Op.DIVIDE:
                sign = self.times if op is Op.MULTIPLY else self.over
                return CodePiece(f"{a.inside(PRODUCT)}{sign}{b.inside(ATOM)}", PRODUCT)
            case Op.NEGATE:
                return CodePiece(f"-{a.inside(PRODUCT)}", SUM)
            case Op.LESS if self.has_choice:
                return CodePiece(f"{a.inside(SUM)} < {b.inside(SUM)}", CASE)
            case Op.SELECT if self.has_choice:
                case, chosen, other = operands
                test = case.inside(SUM) if case.binding == CASE else f"{case.inside(SUM)} > 0.0"
                return CodePiece(f"{test} ? {chosen.inside(SUM)} : {other.inside(SUM)}", CASE)
            case _:
                return CodePiece(f"{self.names[op]}({', '.join(operand.text for operand in operands)})")

    def output(self, tape: Tape, output: Output, pieces: Mapping[int, CodePiece]) -> str:
        """A result, with its sign."""
        node = tape.nodes[output.node]
        if output.negative and node.op is Op.CONSTANT and node.value is not None:
            return self.number(-node.value).text
        piece = pieces[output.node]
        return self.operation(Op.NEGATE, [piece]).text if output.negative else piece.text


PYTHON = Language("{name} = {value}", double_minus=True)  # Python: floats, arrays and CasADi expressions alike
JAVASCRIPT = Language("const {name} = {value};")  # numbers, with ``sin``, ``cos``, ``sign`` and the like of ``Math``
# MATLAB and Octave: rows of numbers, one for each configuration; ``less``, ``select`` and a real ``root`` are ours.
OCTAVE = Language("{name} = {value};", times=".*", over="./", names=ALL_NAMES | _MATLAB_NAMES)
# C: doubles, with ``sin``, ``cos``, ``sqrt`` and ``fabs`` of <math.h> and a ``sign`` and the like of our own.
C = Language("const double {name} = {value};", has_choice=True, names=ALL_NAMES | _C_NAMES)


def input_name(source: InputSource, parameters: Sequence[str]) -> str:
    """The variable that holds an input."""
    if source.kind == POSE:
        return f"T{source.index // 4 + 1}{source.index % 4 + 1}"
    return f"p_{parameters[source.index]}" if source.kind == PARAMETER else f"{source.kind}{source.index + 1}"


def entry_names(function: Function, argument: str, joints: int) -> list[str]:
    """The variables that hold the entries of an argument."""
    return [input_name(InputSource(argument, i), ()) for i in range(function.width(argument, joints))]


def write_statements(
    tape: Tape,
    language: Language,
    nodes: Iterable[int],
    pieces: dict[int, CodePiece],
    free_names: Iterator[str] | None = None,
    names: Mapping[int, str] | None = None,
) -> tuple[str, ...]:
    """Statements that compute some values of a tape; by default they are called ``t1``, ``t2``, ..."""
    named, free = names or {}, free_names or (f"t{k}" for k in count(1))
    lines = []
    for i in nodes:
        node = tape.nodes[i]
        piece = language.operation(node.op, [pieces[k] for k in node.operands])
        if i in named or tape.use_counts[i] != 1 or len(piece.text) > _INLINE_WIDTH:
            name = named.get(i) or next(free)
            lines.append(language.assignment.format(name=name, value=piece.text))
            piece = CodePiece(name)
        pieces[i] = piece
    return tuple(lines)


@dataclass(frozen=True, slots=True)
class Kernel:
    """The text of one function in Python or JavaScript."""

    parameters: tuple[int, ...]  # indices of the run-time parameters that it needs
    hoisted: tuple[str, ...]  # statements on run-time parameters alone
    constants: tuple[str, ...]  # names of the values that the body takes from there
    constant_values: tuple[str, ...]  # what they are
    arguments: tuple[str, ...]  # arguments that the body reads
    body: tuple[str, ...]  # statements on the arguments
    results: tuple[str, ...]  # the outputs
    hoisted_calls: bool  # whether sines, roots or the like occur in the hoisted part
    calls: bool  # whether they occur in the body


def write_kernel(tape: Tape, language: Language, parameters: Sequence[str]) -> Kernel:
    """A tape in two parts: work on run-time parameters alone, and everything else."""
    # Texts of constants and inputs, and the values with a name: s2 and c2 are the sine and cosine of q2.
    pieces: dict[int, CodePiece] = {}
    names = dict.fromkeys(tape.hoisted_results, "")
    for i, node in enumerate(tape.nodes):
        if node.op is Op.CONSTANT:
            pieces[i] = language.number(node.value)
        elif node.source is not None:
            pieces[i] = CodePiece(input_name(node.source, parameters))
        elif node.op in TRIGONOMETRIC:
            angle = tape.nodes[node.operands[0]].source
            names[i] = f"{TRIGONOMETRIC[node.op]}{angle.index + 1}" if angle and angle.kind == "q" else ""
    computed = [(i, node.layer) for i, node in enumerate(tape.nodes) if node.op not in LEAVES]
    layers = {layer: [i for i, own in computed if own is layer] for layer in (Layer.HOISTED, Layer.BODY)}
    free_names = (f"t{k}" for k in count(1))  # ``t1``, ``t2``, ...
    hoisted = write_statements(tape, language, layers[Layer.HOISTED], pieces, free_names, names)
    crossing = tape.hoisted_results
    values = tuple(pieces[i].text for i in crossing)
    for place, i in enumerate(crossing):
        if tape.nodes[i].op not in LEAVES:  # a bare parameter keeps its name
            pieces[i] = CodePiece(f"k{place + 1}")
    body = write_statements(tape, language, layers[Layer.BODY], pieces, free_names, names)
    kinds = {node.source.kind for node in tape.nodes if node.source is not None}
    return Kernel(
        parameters=tape.parameters,
        hoisted=hoisted,
        constants=tuple(pieces[i].text for i in crossing),
        constant_values=values,
        arguments=tuple(kind for kind in (*ARGUMENTS, POSE, GIVEN, NEAR, DAMPING) if kind in kinds),
        body=body,
        results=tuple(language.output(tape, output, pieces) for output in tape.outputs),
        hoisted_calls=any(tape.nodes[i].op in ALL_NAMES for i in layers[Layer.HOISTED]),
        calls=any(tape.nodes[i].op in ALL_NAMES for i in layers[Layer.BODY]),
    )


def rows_of(values: Sequence[str], columns: int) -> tuple[tuple[str, ...], ...]:
    """Values in rows, for printing."""
    return tuple(tuple(values[i : i + columns]) for i in range(0, len(values), columns))


def wrapped(values: Sequence[str], going_on: str = "") -> tuple[str, ...]:
    """Values with a comma after each, in lines; with a mark of lines that go on, no comma ends the last."""
    lines: list[str] = []
    line = ""
    for place, value in enumerate(values, 1):
        text = value if going_on and place == len(values) else f"{value}, "
        if line and len(line) + len(text) > LINE_WIDTH:
            lines.append(line.rstrip() + going_on)
            line = ""
        line += text
    return (*lines, line.rstrip()) if line else tuple(lines)
