"""What is generated for one robot: its functions, each with a tape."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import prod

from derive.programs.tape.tape import Operations, Output, Tape


@dataclass(frozen=True, slots=True)
class Column:
    """What the entries of a result at one place along its last axis belong to.

    Attributes:
        name: Short and plain.
        formula: What it is in the robot's symbols, in the cell grammar; empty where there is none.
    """

    name: str
    formula: str = ""


@dataclass(frozen=True, slots=True)
class Function:
    """One generated function.

    Attributes:
        name: For instance ``inverse_dynamics``.
        arguments: Its arguments, each with one entry per joint, in order: ``q``, ``qd``, ``qdd`` or ``tau``;
            empty for what depends on parameters alone.
        shape: Shape of the result for one configuration.
        tape: The program; outputs in row-major order of ``shape``.
        formulation: What the tape was traced through, in words.
        columns: What the entries along the last axis of the result belong to, where that has names.
    """

    name: str
    arguments: tuple[str, ...]
    shape: tuple[int, ...]
    tape: Tape
    formulation: str
    columns: tuple[Column, ...] = ()

    def __post_init__(self) -> None:
        """Check that the tape fills the shape."""
        assert prod(self.shape) == len(self.tape.outputs), (self.name, self.shape, len(self.tape.outputs))

    @property
    def outputs(self) -> tuple[Output, ...]:
        """The results, row by row."""
        return self.tape.outputs

    @property
    def operations(self) -> Operations:
        """Operations per evaluation."""
        return self.tape.operations

    @property
    def hoisted_operations(self) -> Operations:
        """Operations on run-time parameters alone, done once per call."""
        return self.tape.hoisted_operations


@dataclass(frozen=True, slots=True)
class Program:
    """All functions of a robot.

    Attributes:
        functions: In the order in which they are printed.
        parameters: Names of the run-time parameters, in the order of the parameter vector.
    """

    functions: tuple[Function, ...]
    parameters: tuple[str, ...]

    def __getitem__(self, name: str) -> Function:
        """The function of that name."""
        for function in self.functions:
            if function.name == name:
                return function
        raise KeyError(name)

    def __contains__(self, name: object) -> bool:
        """Whether there is a function of that name."""
        return any(function.name == name for function in self.functions)

    def __iter__(self) -> Iterator[Function]:
        """The functions in order."""
        return iter(self.functions)
