"""Straight-line code from a tape: statements in order, values used once written where they are used."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.programs.tape.tape import LEAVES, PARAMETER, Layer, Node, Op, Source, Tape
from derive.targets.printer import Piece, Printer, print_operation

_INLINE_WIDTH = 52
"""Longest value, in characters, that is written inside another one; longer ones get a name."""

_TRIGONOMETRIC = {Op.SINE: "s", Op.COSINE: "c"}


@dataclass(frozen=True, slots=True)
class Kernel:
    """The text of one function.

    Attributes:
        parameters: Indices of the run-time parameters that it needs.
        hoisted: Statements on run-time parameters alone.
        constants: Names of the values that the body takes from there.
        arguments: Arguments that the body reads.
        body: Statements on the arguments.
        results: The outputs.
    """

    parameters: tuple[int, ...]
    hoisted: tuple[str, ...]
    constants: tuple[str, ...]
    constant_values: tuple[str, ...]
    arguments: tuple[str, ...]
    body: tuple[str, ...]
    results: tuple[str, ...]


def input_name(source: Source, parameters: Sequence[str]) -> str:
    """``q1``, ``qd1``, ... and ``p_name``: users' names have a namespace of their own."""
    return f"p_{parameters[source.index]}" if source.kind == PARAMETER else f"{source.kind}{source.index + 1}"


def write_kernel(tape: Tape, printer: Printer, parameters: Sequence[str]) -> Kernel:
    """The statements of a tape.

    Args:
        tape: The program.
        printer: The language.
        parameters: Names of the run-time parameters.
    """
    writer = _Writer(tape, printer, parameters)
    hoisted = writer.statements(Layer.HOISTED)
    values = tape.hoisted_results
    constant_values = tuple(writer.pieces[i].text for i in values)
    names = tuple(writer.constant_name(i, k) for k, i in enumerate(values))
    for i, name in zip(values, names, strict=True):
        writer.pieces[i] = Piece(name)
    body = writer.statements(Layer.BODY)
    kinds = {node.source.kind for node in tape.nodes if node.source is not None}
    return Kernel(
        parameters=tape.parameters,
        hoisted=hoisted,
        constants=names,
        constant_values=constant_values,
        arguments=tuple(kind for kind in ("q", "qd", "qdd", "tau") if kind in kinds),
        body=body,
        results=tuple(writer.result(o.node, o.negative) for o in tape.outputs),
    )


class _Writer:
    def __init__(self, tape: Tape, printer: Printer, parameters: Sequence[str]) -> None:
        self.tape = tape
        self.printer = printer
        self.parameters = parameters
        self.pieces: dict[int, Piece] = {}
        self.crossing = set(tape.hoisted_results)
        self.count = 0
        for i, node in enumerate(tape.nodes):
            if node.op is Op.CONSTANT:
                self.pieces[i] = printer.number(node.value)
            elif node.source is not None:
                self.pieces[i] = Piece(input_name(node.source, parameters))

    def statements(self, layer: Layer) -> tuple[str, ...]:
        """Statements of one layer; values used once stay pieces."""
        lines: list[str] = []
        for i, node in enumerate(self.tape.nodes):
            if node.layer is layer and node.op not in LEAVES:
                piece = print_operation(self.printer, node.op, [self.pieces[k] for k in node.operands])
                if not self._stays_inside(i, node, piece):
                    name = self._name(node)
                    lines.append(self.printer.assign(name, piece))
                    piece = Piece(name)
                self.pieces[i] = piece
        return tuple(lines)

    def result(self, index: int, negative: bool) -> str:
        """An output."""
        node = self.tape.nodes[index]
        if negative and node.op is Op.CONSTANT:
            return self.printer.number(-node.value).text  # type: ignore[operator]
        piece = self.pieces[index]
        return self.printer.negate(piece).text if negative else piece.text

    def constant_name(self, index: int, place: int) -> str:
        """Bare parameters keep their name."""
        node = self.tape.nodes[index]
        return self.pieces[index].text if node.op in LEAVES else f"k{place + 1}"

    def _stays_inside(self, index: int, node: Node, piece: Piece) -> bool:
        if node.op in _TRIGONOMETRIC or index in self.crossing:
            return False
        return self.tape.use_counts[index] == 1 and len(piece.text) <= _INLINE_WIDTH

    def _name(self, node: Node) -> str:
        """``s2`` and ``c2`` for the sine and cosine of q2, else the next free ``t``."""
        if node.op in _TRIGONOMETRIC:
            source = self.tape.nodes[node.operands[0]].source
            if source is not None and source.kind == "q":
                return f"{_TRIGONOMETRIC[node.op]}{source.index + 1}"
        self.count += 1
        return f"t{self.count}"


def rows_of(values: Sequence[str], columns: int) -> tuple[tuple[str, ...], ...]:
    """Outputs in rows, for printing."""
    return tuple(tuple(values[i : i + columns]) for i in range(0, len(values), columns))
