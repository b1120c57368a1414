"""What is generated for one robot: its functions, each with its interface and a tape."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import prod
from typing import TYPE_CHECKING

from derive.programs.tape.tape import Operations, Tape
from derive.robot.robot import Robot

if TYPE_CHECKING:
    from derive.inverse.general.elimination import Elimination

# The arguments that a function may take, in words; each has one entry per joint but for `WIDTHS`.
ARGUMENTS: Mapping[str, str] = {
    "q": "joint variables [rad, m]",
    "qd": "joint velocities [rad/s, m/s]",
    "qdd": "joint accelerations [rad/s^2, m/s^2]",
    "tau": "joint torques and forces [N m, N]",
    "h": "force [N] and moment [N m] of the environment on the end effector, about its origin",
    "q_p": "variables of passive joints where the loops close, of passive_positions near there [rad, m]",
}
WIDTHS: Mapping[str, int] = {"h": 6}  # entries of arguments that have not one per joint
# The functions of a wrench, in the axes of the world and of the end effector, that others take into account: theirs is
# taken off the result, or added to ``tau``.
FELT: Mapping[str, tuple[str, str]] = {
    "inverse_dynamics": ("wrench_torques", "wrench_torques_end"),
    "forward_dynamics": ("wrench_torques", "wrench_torques_end"),
    "inverse_dynamics_dq": ("wrench_torques_dq", "wrench_torques_end_dq"),
}
POSE, GIVEN, NEAR, DAMPING = "T", "given", "near", "damping"
"""The arguments of inverse kinematics: the pose of the end effector, the variables of joints that are given, and where
joints are that no equation determines; and of its Newton step, by how much that is shortened."""

POSE_ENTRIES = 16  # of a pose, a 4x4 matrix row by row


@dataclass(frozen=True, slots=True)
class Interface:
    """What a generated function is, whatever the robot."""

    name: str  # for instance ``inverse_dynamics``
    arguments: tuple[str, ...]  # its arguments, in order, of `ARGUMENTS`; empty for what depends on parameters alone
    # Of the result for one configuration; ``n`` is the number of joints, ``p`` that of the columns, ``m`` that of the
    # rows of the task; nothing for a scalar.
    shape: tuple[int | str, ...]
    symbol: str  # how the notes write the result
    summary: str  # one line
    result: str  # what the entries of the result are, with their units
    end: str = ""  # the end of a tree that it is of; empty for none

    @property
    def any_end(self) -> str:
        """Its name without that of its end."""
        return self.name.removesuffix(f"_{self.end}") if self.end else self.name

    def at(self, end: str) -> Interface:
        """The same for an end of a tree."""
        summary, result = (text.replace("the end effector", f"end {end}") for text in (self.summary, self.result))
        summary = summary if summary != self.summary else f"{summary.removesuffix('.')}, end {end}."
        return replace(self, name=f"{self.name}_{end}", summary=summary, result=result, end=end)


@dataclass(frozen=True, slots=True)
class Column:
    """What the entries of a result at one place along its last axis belong to."""

    name: str  # short and plain
    formula: str = ""  # what it is in the robot's symbols, in the cell grammar; empty where there is none


@dataclass(frozen=True, slots=True)
class Function:
    """One generated function of one robot."""

    interface: Interface  # what it takes and gives
    shape: tuple[int, ...]  # shape of the result for one configuration
    tape: Tape  # the program; outputs in row-major order of ``shape``
    formulation: str  # what the tape was traced through, in words
    # What the entries along the last axis of the result belong to, where that has names.
    columns: tuple[Column, ...] = ()
    # Lengths of further arguments than those of `ARGUMENTS`, which inverse kinematics has.
    widths: Mapping[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        assert prod(self.shape) == len(self.tape.outputs), (self.name, self.shape, len(self.tape.outputs))

    @property
    def name(self) -> str:
        """For instance ``inverse_dynamics``."""
        return self.interface.name

    @property
    def arguments(self) -> tuple[str, ...]:
        """Its arguments, in order."""
        return self.interface.arguments

    def width(self, argument: str, joints: int) -> int:
        """How many entries an argument has."""
        return self.widths.get(argument, WIDTHS.get(argument, joints))

    @property
    def operations(self) -> Operations:
        """Operations per evaluation."""
        return self.tape.operations

    @property
    def described(self) -> tuple[tuple[str, str, int], ...]:
        """Its arguments in words, each with the number of its entries, 0 where it has one per joint."""
        widths = {**WIDTHS, **self.widths}
        return tuple((name, ARGUMENTS[name], widths.get(name, 0)) for name in self.arguments if name in ARGUMENTS)

    @property
    def notes(self) -> tuple[str, ...]:
        """Formulation and cost, for a docstring."""
        lines = [f"{self.formulation[0].upper()}{self.formulation[1:]}: {cost_text(self.operations)}."]
        if self.tape.hoisted_operations.total:
            lines.append(f"Once per set of parameters: {cost_text(self.tape.hoisted_operations)}.")
        return tuple(lines)


@dataclass(frozen=True, slots=True)
class Around:
    """Where solutions that are alone are looked for where others are free (`derive.inverse.closed.branches`)."""

    # Rows of motions A, one after the other, by which poses T are brought beside, A T; lengths in the unit.
    motions: tuple[tuple[float, ...], ...]
    # What is added to the joints of branches, in half turns and units, where poses beside lead nowhere.
    starts: tuple[tuple[float, ...], ...]
    # What is added to a solution that comes back to itself if it is alone, in radians and units.
    nudge: tuple[float, ...]
    # Whether there are fewer joints than the task has dimensions, so that poses beside are out of reach.
    is_short: bool

    @property
    def texts(self) -> dict[str, tuple[str, ...]]:
        """Their rows as generated code has them, with commas; `nudge` is one row."""
        rows = {"motions": self.motions, "starts": self.starts, "nudge": (self.nudge,)}
        return {name: tuple(", ".join(map(str, row)) for row in own) for name, own in rows.items()}


@dataclass(frozen=True, slots=True)
class Inverse:
    """Inverse kinematics of one robot."""

    # Its tape takes a pose and the given joints; its outputs are the joint variables, branch by branch, and then the
    # code of each branch: its `derive.inverse.numeric.newton.Status`, and more where it is to be checked
    # (`derive.programs.inverse`).
    function: Function
    # Its tape takes a configuration, a pose and a damping; its outputs are a configuration that is nearer to the
    # pose, how far the first one is from it, and the unit of length (`derive.programs.inverse`).
    step: Function
    branches: int  # how many there are
    joints: int  # number of joints
    given: tuple[int, ...]  # indices of the joints that are arguments
    summary: str  # how many solutions there are, in words
    closed: float  # error of the pose, lengths relative to the reach, up to which a branch in doubt is a solution
    around: Around  # where further solutions are looked for
    postures: tuple[str, ...] = ()  # words for the branches, in their order; empty where none hold

    @property
    def order(self) -> tuple[str, ...]:
        """The branches by name, in their order, as lines of a docstring; none where there are no words for them."""
        head = "Branches, in this order; `derive show ROBOT inverse --format json` has their signs:"
        return (head, *(f"{k}. {words}" for k, words in enumerate(self.postures, 1))) if self.postures else ()


@dataclass(frozen=True, slots=True)
class InverseSearch:
    """Inverse kinematics of a robot without formulas: what the code that finds its solutions needs of the arm."""

    # Its tape gives the constant frames between the joints, from parameters alone; its widths are those of the
    # arguments of inverse kinematics.
    function: Function
    branches: int  # how many rows the result has
    joints: int  # number of joints
    given: tuple[int, ...]  # indices of the joints that are arguments
    entries: tuple[tuple[int, int], ...]  # the entries of T that are wanted, row and column from 0
    # How joints are found as eigenvalues, the best way first; none for damped Newton from many starts.
    eliminations: tuple[Elimination, ...]
    count: int  # the number of complex solutions of a generic pose; 0 where it is not known
    summary: str  # how many solutions there are and how they are found, in words
    reason: str  # why there are no formulas
    motions: tuple[tuple[float, ...], ...]  # by which singular poses are brought beside, as `Around` has them


@dataclass(frozen=True, slots=True)
class EndInverse:
    """Inverse kinematics of an end of a tree that stands: that of the serial arm which leads there."""

    end: str  # name of the end
    arm: Robot  # the arm
    places: tuple[int, ...]  # its joints in the tree
    inverse: Inverse  # the names of its functions are those of the end


@dataclass(frozen=True, slots=True)
class Program:
    """All functions of a robot."""

    functions: tuple[Function, ...]  # in the order in which they are printed
    parameters: tuple[str, ...]  # names of the run-time parameters, in the order of the parameter vector
    inverse: Inverse | None = None  # inverse kinematics, of a robot for which there is a closed form
    without_inverse: str = ""  # why there is none; empty where there is one, or where nobody asked for it
    search: InverseSearch | None = None  # what finds the solutions of a robot that has no closed form
    of_ends: tuple[EndInverse, ...] = ()  # inverse kinematics of the ends of a tree, of those that have a closed form

    def __getitem__(self, name: str) -> Function:
        return {function.name: function for function in self.functions}[name]

    def __contains__(self, name: object) -> bool:
        return any(function.name == name for function in self.functions)

    def __iter__(self) -> Iterator[Function]:
        return iter(self.functions)

    @property
    def operations(self) -> dict[str, dict[str, int]]:
        """Counts for the manifest, by function."""
        return {function.name: function.operations.as_dict() for function in self.all_functions}

    @property
    def all_functions(self) -> tuple[Function, ...]:
        """The functions and inverse kinematics."""
        solved = [self.inverse] if self.inverse else [each.inverse for each in self.of_ends]
        return (*self.functions, *(inverse.function for inverse in solved))

    @property
    def all_tapes(self) -> tuple[Tape, ...]:
        """The tapes of the functions, and of what these call."""
        tapes = tuple(function.tape for function in self.functions)
        return (*tapes, self.inverse.function.tape, self.inverse.step.tape) if self.inverse else tapes

    @property
    def hoisted_operations(self) -> dict[str, dict[str, int]]:
        """Counts of the work on run-time parameters alone, by function."""
        return {function.name: function.tape.hoisted_operations.as_dict() for function in self.all_functions}


def cost_text(operations: Operations) -> str:
    """Operation counts as they are printed."""
    return ", ".join([f"{count} {name}" for name, count in operations.as_dict().items() if count]) or "no operations"


def joint_lines(robot: Robot, escape: Callable[[str], str] | None = None) -> tuple[str, ...]:
    """The joints of a robot as lines of documentation; ``escape`` makes comments of names, None leaves them out."""
    return tuple(
        f"{i + 1}: {joint.variable}, {joint.type.value} [{'rad' if joint.is_revolute else 'm'}]"
        + (f", {escape(joint.name)}" if escape and joint.name else "")
        for i, joint in enumerate(robot.variables)
    )
