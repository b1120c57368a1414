"""Inverse kinematics in C: all branches at a pose, a batch of poses, and the nearest solution within the limits."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf, isfinite

from derive.programs.program import NEAR, POSE, Around, Inverse, InverseSearch
from derive.robot.options.solution_policy import POLICY
from derive.robot.robot import Robot
from derive.targets.c_function import CFunction, c_function, pointers
from derive.targets.c_search import CSearch, c_search
from derive.targets.escape import c_comment
from derive.targets.target import Source, joint_limits


@dataclass(frozen=True, slots=True)
class Load:
    """An argument that a batch loads into lanes."""

    name: str  # its name
    width: int  # number of its entries
    is_optional: bool  # whether it may be NULL, which stands for zeros


@dataclass(frozen=True, slots=True)
class CInverse:
    """Inverse kinematics."""

    function: CFunction  # the texts of its program; its constants are followed by those of the step
    step: CFunction | None  # those of its Newton step
    step_constants: str  # where the step's constants are, behind a comma; nothing where it has none
    constants_declaration: str  # declares all constants, behind a comma, for those that call the step and nothing else
    constants_argument: str  # hands them on
    branches: int  # number of branches
    size: int  # joint variables of all branches
    closed: str  # error of the pose of a branch in doubt up to which it is a solution
    around: Around | None  # where further solutions are looked for
    loads: tuple[Load, ...]  # the arguments that are read
    declaration: str  # parameters of the public function
    batch_declaration: str  # of that of a batch
    nearest_declaration: str  # of that of the nearest solution
    prototype: str  # parameters of the first in the header
    batch_prototype: str  # of the second
    nearest_prototype: str  # of the third
    lower: str  # lower limits of the joints, as the inside of an array
    upper: str  # upper limits
    revolute: str  # which joints turn, 1 or 0
    turning: str  # which of them are not given
    given: tuple[dict[str, str], ...]  # numbers of the given joints, from 1, and their places
    given_array: str  # declares the variables of the given joints, if there are any
    given_lines: tuple[str, ...]  # statements that take them from a configuration
    nearest_call: str  # arguments of the call of the first function in the third
    start_call: str  # arguments of a call with the free joints elsewhere
    alone_declaration: str  # parameters of what looks for further solutions: the inputs
    alone_call: str  # arguments of a call of it
    beside_call: str  # arguments of a call at a pose beside
    row_call: str  # inputs of a call for one row of a batch
    documentation: tuple[str, ...]  # lines of the comment of the first
    search: CSearch | None  # what the solver takes of the arm, where there is no program


def c_inverse(inverse: Inverse | InverseSearch, source: Source) -> CInverse:
    """Inverse kinematics in C."""
    robot, parameters = source.robot, source.program.parameters
    step = c_function(inverse.step, parameters) if isinstance(inverse, Inverse) else None
    further = step.constant_count if step else 0
    function = c_function(inverse.function, parameters, further)
    hoisted = ["k"] if function.constant_count else []
    names = list(inverse.function.widths)
    inputs = [*names, *hoisted]
    limits = [pair or (-inf, inf) for pair in joint_limits(robot)]
    joints, nearest = list(enumerate(robot.joints)), [POSE, NEAR, *hoisted]
    rows = [f"{name} + {inverse.function.widths[name]} * row" for name in names if name != NEAR]
    rows.append(f"{NEAR} ? {NEAR} + {inverse.joints} * row : NULL")

    def _declared(names: Iterable[str], qualifier: str, *, status: bool = True) -> str:
        return pointers(names, "q", qualifier) + (f", int *{qualifier}status" if status else "")

    return CInverse(
        function=function,
        step=step,
        step_constants=f", k + {function.constant_count - further}" if further else "",
        constants_declaration=", const double *restrict k" if further else "",
        constants_argument=", k" if further else "",
        branches=inverse.branches,
        size=inverse.branches * inverse.joints,
        closed=repr(inverse.closed) if isinstance(inverse, Inverse) else "",
        around=inverse.around if isinstance(inverse, Inverse) else None,
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
        turning=", ".join(str(int(i not in inverse.given and joint.is_revolute)) for i, joint in joints),
        given=tuple({"name": str(k + 1), "place": str(joint)} for k, joint in enumerate(inverse.given)),
        given_array=f", given[{len(inverse.given)}]" if inverse.given else "",
        given_lines=tuple(f"given[{k}] = near[{joint}];" for k, joint in enumerate(inverse.given)),
        nearest_call=", ".join([*inputs, "solutions", "status"]),
        start_call=", ".join([*("start" if name == NEAR else name for name in inputs), "values"]),
        alone_declaration=pointers(inputs, "q", "restrict "),
        alone_call=", ".join("start" if name == NEAR else name for name in [*inputs, "q"]),
        beside_call=", ".join([*("moved" if name == POSE else name for name in inputs), "values"]),
        row_call=", ".join([*rows, *hoisted]),
        documentation=_inverse_documentation(inverse, robot, function.constant_count),
        search=c_search(inverse, robot) if isinstance(inverse, InverseSearch) else None,
    )


def _bound(value: float) -> str:
    return repr(value) if isfinite(value) else "-INFINITY" if value < 0 else "INFINITY"


def _inverse_documentation(inverse: Inverse | InverseSearch, robot: Robot, constant_count: int) -> tuple[str, ...]:
    """The lines of the comment in the header."""
    interface, names = inverse.function.interface, [robot.joints[i].variable for i in inverse.given]
    far = POLICY.texts["far"]
    constants = f"@param[in]  k       {constant_count} constants from inverse_kinematics_constants()."
    near = (
        "where joints are that are free at a pose, a configuration; NULL for zeros. If the others",
        "have no solution with them there, they are elsewhere.",
    )
    if isinstance(inverse, InverseSearch):
        near = ("not looked at: at poses with infinitely many solutions some are returned;", "it may be NULL.")
    return (
        interface.summary,
        "",
        inverse.summary,
        f"T must be a pose: its rotation is not checked. Where an entry is not finite, or beyond {far}, none exists.",
        "",
        "@param[in]  T       pose of the end effector in the world frame, 4 x 4, row by row.",
        *([f"@param[in]  given   variables of {', '.join(map(c_comment, names))}."] if names else []),
        f"@param[in]  near    {near[0]}",
        f"                    {near[1]}",
        *([constants] if constant_count else []),
        f"@param[out] q       joint variables, {inverse.branches} x {inverse.joints}: {interface.result}.",
        f"@param[out] status  what each branch is, {inverse.branches}; may be NULL.",
        "@return the number of solutions.",
        "",
        *((*map(c_comment, inverse.order), *inverse.function.notes) if isinstance(inverse, Inverse) else ()),
    )
