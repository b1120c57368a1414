"""A target, the files that it writes and the function that renders them, and what it is rendered from: a source."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from math import isfinite

from derive.algebra.constants import exact_number, to_float
from derive.programs.program import Program, joint_lines
from derive.programs.tape.tape import ALL_NAMES, BRANCHING_NAMES, FUNCTION_NAMES, Tape
from derive.robot.evaluate import evaluate
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Source:
    """One robot, ready to be printed."""

    robot: Robot
    program: Program  # its functions as tapes
    version: str  # version of the tool, stated in every output
    files: tuple[str, ...] = ()  # names of all files of this build, for the page that lists them


@dataclass(frozen=True, slots=True)
class Target:
    """One kind of output."""

    name: str  # what the user says to choose it
    summary: str  # one line for help texts
    files: tuple[str, ...]  # names of the files that it writes
    render: Callable[[Source], dict[str, str]]  # makes their contents, by file name; a pure function
    needs_program: bool = True  # else it is rendered while the program is searched for
    default: bool = True  # whether a build writes it when no target is named
    requires: tuple[str, ...] = ()  # names of the targets whose files it needs
    # For each library that a build compiles, the files that it depends on; the first is given to the compiler.
    compiled: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    package: Callable[[Robot], str] | None = None  # name of the folder that it writes besides, by the robot

    def names(self, robot: Robot) -> tuple[str, ...]:
        """What it writes for a robot, as the page of the folder lists it."""
        return (*self.files, f"{self.package(robot)}/") if self.package else self.files


def heading(source: Source, comment: Callable[[str], str]) -> dict[str, object]:
    """What the comment at the top of a file asks for; ``comment`` makes users' text harmless there."""
    robot = source.robot
    return {
        "title": comment(robot.title or robot.name),
        "name": comment(robot.name),
        "version": comment(source.version),
        "digest": robot.digest,
        "convention": robot.convention.value,
        "dof": robot.dof,
        "joints": joint_lines(robot, comment),
    }


def case_context(tapes: Iterable[Tape]) -> dict[str, object]:
    """What templates ask for about the functions that a file provides for its kernels."""
    has_cases = any(node.op in BRANCHING_NAMES for tape in tapes for node in tape.nodes)
    return {"has_cases": has_cases, "operators": ", ".join((ALL_NAMES if has_cases else FUNCTION_NAMES).values())}


def package_name(robot: Robot) -> str:
    """Name of a robot's folder, importable by Python."""
    return name if (name := robot.name.replace("-", "_")).isidentifier() else f"robot_{name}"


def shape_text(shape: tuple[int, ...]) -> str:
    """A shape in comments and tables."""
    return " x ".join(map(str, shape)) or "scalar"


def joint_limits(robot: Robot) -> tuple[tuple[float, float] | None, ...]:
    """Lower and upper limit of each joint [rad or m]; None where there is none or it has no number."""
    numbers = dict(robot.parameters)
    limits: list[tuple[float, float] | None] = []
    for joint in robot.variables:
        bounds = [exact_number(bound, numbers) for bound in joint.limits or ()]
        known = [to_float(bound) for bound in bounds if bound is not None]
        limits.append((known[0], known[1]) if len(known) == 2 else None)
    return tuple(limits)


def bound_text(value: float, infinity: str) -> str:
    """A bound in a language that has a word for infinity."""
    return repr(value) if isfinite(value) else f"-{infinity}" if value < 0 else infinity


def joint_bounds(robot: Robot) -> dict[str, tuple[float | None, ...]]:
    """Largest speeds [rad/s or m/s] and torques [N m or N] of joints by their constant, where some joint has one."""
    found = {}
    for key in ("speed", "torque"):
        if any(cells := [getattr(joint, key) for joint in robot.variables]):
            found[f"{key.upper()}_LIMITS"] = tuple(None if cell is None else evaluate(cell, {}) for cell in cells)
    return found
