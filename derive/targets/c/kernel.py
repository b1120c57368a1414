"""Straight-line C from a tape, in three parts: work on parameters alone, the angles, and everything else.

Sines and cosines stand between the last two: they are taken of all angles at once, which is what lets a compiler
vectorise them across configurations.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from derive.programs.tape.tape import LEAVES, PARAMETER, Layer, Node, Op, Output, Tape
from derive.targets.kernel import input_name
from derive.targets.printer import CPrinter, Piece, print_operation

_INLINE_WIDTH = 52
"""Longest value, in characters, that is written inside another one; longer ones get a name."""

_TRIGONOMETRIC = {Op.SINE: "s", Op.COSINE: "c"}
_READING_ORDER = ("q", "qd", "qdd", "tau", "s", "c", "k", PARAMETER)


@dataclass(frozen=True, slots=True)
class Read:
    """An entry of an array that a part uses.

    Attributes:
        name: Its name in the part.
        array: ``q``, ``qd``, ..., ``s`` and ``c`` (sines, cosines), ``k`` (constants) or `PARAMETER`.
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


@dataclass(frozen=True, slots=True)
class CKernel:
    """The text of one function.

    Attributes:
        constants: From the parameters to the constants.
        angles: From the arguments and constants to the angles.
        body: From the arguments, constants, sines and cosines of the angles to the outputs.
    """

    constants: Part
    angles: Part
    body: Part


def write_c_kernel(tape: Tape, parameters: Sequence[str]) -> CKernel:
    """The parts of a tape.

    Args:
        tape: The program.
        parameters: Names of the run-time parameters.
    """
    return _Writer(tape, parameters).kernel()


class _Writer:
    def __init__(self, tape: Tape, parameters: Sequence[str]) -> None:
        self.tape = tape
        self.parameters = parameters
        self.printer = CPrinter()

    def kernel(self) -> CKernel:
        values = self.tape.hoisted_results
        angles = [Output(i, False) for i in self.angles]
        return CKernel(
            constants=self.part([Output(i, False) for i in values], {}),
            angles=self.part(angles, self.constants),
            body=self.part(self.tape.outputs, {**self.constants, **self.sines}),
        )

    @cached_property
    def angles(self) -> tuple[int, ...]:
        """What sines and cosines are taken of, except where that depends on a sine or cosine itself."""
        late: set[int] = set()
        angles: dict[int, None] = {}
        for i, node in enumerate(self.tape.nodes):
            if node.layer is not Layer.BODY:
                continue
            if late.intersection(node.operands):
                late.add(i)
            elif node.op in _TRIGONOMETRIC:
                late.add(i)
                angles[node.operands[0]] = None
        return tuple(sorted(angles, key=self._place_of_angle))

    def _place_of_angle(self, index: int) -> tuple[int, int]:
        """Variables of joints in their order, then all other angles."""
        source = self.tape.nodes[index].source
        return (0, source.index) if source is not None and source.kind == "q" else (1, index)

    @cached_property
    def constants(self) -> Mapping[int, Read]:
        """The values that come from the parameters, as they are read elsewhere."""
        return {i: Read(f"k{place + 1}", "k", place) for place, i in enumerate(self.tape.hoisted_results)}

    @cached_property
    def sines(self) -> Mapping[int, Read]:
        """The sines and cosines of the angles: ``s2`` and ``c2`` for those of q2."""
        names = self._angle_names()
        places = {angle: place for place, angle in enumerate(self.angles)}
        reads: dict[int, Read] = {}
        for i, node in enumerate(self.tape.nodes):
            if node.layer is Layer.BODY and node.op in _TRIGONOMETRIC and node.operands[0] in places:
                letter, angle = _TRIGONOMETRIC[node.op], node.operands[0]
                reads[i] = Read(f"{letter}{names[angle]}", letter, places[angle])
        return reads

    def _angle_names(self) -> dict[int, str]:
        """The joint's number, or a letter and the angle's for an angle that is not just a joint's variable."""
        names = {}
        for place, angle in enumerate(self.angles):
            source = self.tape.nodes[angle].source
            names[angle] = str(source.index + 1) if source is not None and source.kind == "q" else f"a{place + 1}"
        return names

    def part(self, outputs: Sequence[Output], given: Mapping[int, Read]) -> Part:
        """Code for some outputs, in which ``given`` values need not be computed."""
        needed = self._needed(outputs, given)
        pieces: dict[int, Piece] = {}
        reads: list[Read] = []
        lines: list[str] = []
        for i in needed:
            node = self.tape.nodes[i]
            read = given.get(i) or self._input(node)
            if read is not None:
                reads.append(read)
                pieces[i] = Piece(read.name)
            elif node.op is Op.CONSTANT:
                pieces[i] = self.printer.number(node.value)
            else:
                pieces[i] = self._operation(i, node, pieces, lines)
        reads.sort(key=lambda read: (_READING_ORDER.index(read.array), read.index))
        return Part(tuple(reads), tuple(lines), tuple(self._result(o, pieces) for o in outputs))

    def _needed(self, outputs: Iterable[Output], given: Mapping[int, Read]) -> list[int]:
        seen = {output.node for output in outputs}
        stack = list(seen)
        while stack:
            i = stack.pop()
            fresh = set() if i in given else set(self.tape.nodes[i].operands) - seen
            seen |= fresh
            stack += fresh
        return sorted(seen)

    def _input(self, node: Node) -> Read | None:
        source = node.source
        if source is None:
            return None
        return Read(input_name(source, self.parameters), source.kind, source.index)

    def _operation(self, index: int, node: Node, pieces: Mapping[int, Piece], lines: list[str]) -> Piece:
        """The operation where it is used, or the name that it gets in a line of its own."""
        piece = print_operation(self.printer, node.op, [pieces[k] for k in node.operands])
        inside = self.tape.use_counts[index] == 1 and len(piece.text) <= _INLINE_WIDTH
        if inside and node.op not in LEAVES:
            return piece
        name = f"t{len(lines) + 1}"
        lines.append(self.printer.assign(name, piece))
        return Piece(name)

    def _result(self, output: Output, pieces: Mapping[int, Piece]) -> str:
        node = self.tape.nodes[output.node]
        if output.negative and node.op is Op.CONSTANT:
            return self.printer.number(-node.value).text  # type: ignore[operator]
        piece = pieces[output.node]
        return self.printer.negate(piece).text if output.negative else piece.text
