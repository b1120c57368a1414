"""``model_numpy.py``: the functions of a robot for one configuration or any batch, importing NumPy alone."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from derive.programs.program import ARGUMENTS, FELT, WIDTHS, Function, Inverse, InverseSearch
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.targets.escape import python_docstring, python_string
from derive.targets.kernel import LINE_WIDTH, PYTHON, entry_names, rows_of, wrapped, write_kernel
from derive.targets.target import Source, Target, case_context, heading, joint_bounds, joint_limits
from derive.targets.templating import render

if TYPE_CHECKING:
    from derive.inverse.general.closure import Closure
    from derive.inverse.general.elimination import Elimination

FILE = "model_numpy.py"

_WRENCH_OPTIONS = ("*", "wrench=None", 'wrench_frame="world"')
_SHORT = 100  # longest constant that stands on one line


def render_numpy(source: Source) -> dict[str, str]:
    """The module ``model_numpy.py``."""
    program, parameters = source.program, source.program.parameters
    own = [(each, _inverse(each.inverse, each.arm, parameters)) for each in program.of_ends]
    tapes = [function.tape for each in program.of_ends for function in (each.inverse.function, each.inverse.step)]
    context = python_context(source) | case_context([*program.all_tapes, *tapes])
    arms = [
        {"end": each.end, "dof": each.arm.n, "places": _tuple(list(map(str, each.places))), "inverse": inverse}
        for each, inverse in own
    ]
    return {FILE: render("numpy/model_numpy.py.jinja", **context | {"arms": arms})}


TARGET = Target("numpy", "functions of one configuration or a batch, importing NumPy alone", (FILE,), render_numpy)


def python_context(source: Source) -> dict[str, object]:
    """What the templates of all modules in Python ask for."""
    robot, program = source.robot, source.program
    tables: dict[str, Sequence[str]] = {name: list(map(repr, most)) for name, most in joint_bounds(robot).items()}
    if "regressor" in program:
        tables["STANDARD_PARAMETERS"] = [python_string(column.name) for column in program["regressor"].columns]
    if "base_parameters" in program:
        base = program["base_parameters"].columns
        tables["BASE_PARAMETERS"] = [python_string(column.name) for column in base]
        tables["BASE_FORMULAS"] = [python_string(column.formula) for column in base]
    ends = [python_string(end.name) for end in robot.ends if end.name]
    tables |= {"ENDS": ends} if ends else {}
    constants: dict[str, Sequence[str]] = {
        "JOINT_NAMES": [python_string(joint.label) for joint in robot.variables],
        "JOINT_TYPES": [python_string(joint.type.value) for joint in robot.variables],
        "LIMITS": [repr(limits) for limits in joint_limits(robot)],
        "PARAMETERS": [python_string(name) for name in program.parameters],
        **tables,
    }
    of_ends = {each.interface.any_end: ", ".join(each.arguments) for each in program if each.interface.end}
    passive = {name: width for function in program for name, width in function.widths.items()}
    felt = {name: both for name, both in FELT.items() if all(each in program for each in both) and not passive}
    return heading(source, python_docstring) | {
        "constants": [  # tuples at the top of the module, on one line where that is enough
            {"name": name, "inside": _tuple(values), "lines": wrapped(values)}
            | {"short": len(name) + len(_tuple(values)) <= _SHORT}
            for name, values in constants.items()
        ],
        "tables": tuple(tables),
        "widths": [
            *({**WIDTHS, **passive}).items(),
            ("wrench", WIDTHS["h"]),
        ],  # entries of arguments that have not one per joint
        "has_parameters": bool(program.parameters),
        "has_dynamics": robot.has_dynamics,
        **case_context(program.all_tapes),
        "inverse": _inverse(program.inverse or program.search, robot, program.parameters),
        "suffix": "",  # of the names of what inverse kinematics has for each end of a tree
        "arms": [],  # inverse kinematics of the ends
        "inverse_in_one_call": False,
        "nearest_is_compiled": False,
        "functions": [_python_function(f, program.parameters, robot.dof, felt.get(f.name, ())) for f in program],
        "has_felt": bool(felt),
        "wrench": ARGUMENTS["h"],  # what a wrench is, in words
        "functions_of_ends": [{"name": name, "arguments": arguments} for name, arguments in of_ends.items()],
        "ends": [end.name for end in robot.ends],
    }


def _python_function(
    function: Function,
    parameters: Sequence[str],
    joints: int,
    felt: Sequence[str] = (),
    listed: Sequence[str] = (),  # the module's parameters where the robot is a part of another one
) -> dict[str, object]:
    """The texts of one function of a robot with so many joints, and with an optional wrench where that is ``felt``."""
    kernel = write_kernel(function.tape, PYTHON, parameters)
    length = function.shape[-1] if function.shape else 1
    unpack = [_unpacking(entry_names(function, kind, joints), kind) for kind in kernel.arguments]
    unpack += [_unpacking(kernel.constants, "k")] if kernel.constants else []
    return {
        "name": function.name,
        "arguments": ", ".join(function.arguments),
        "signature": ", ".join((*function.arguments, "params=None", "out=None", *(_WRENCH_OPTIONS if felt else ()))),
        "felt": felt,  # the functions of its torques, in the axes of the world and of the end effector
        "kernel_arguments": ", ".join(("functions", "k", *function.arguments)),  # ``functions, k, q, qd``
        "arguments_tuple": _tuple(function.arguments),  # the names of its arguments, as the inside of a tuple
        "argument_names": _tuple([f'"{name}"' for name in function.arguments]),
        "core": _core([function.width(name, joints) for name in function.arguments], function.shape),
        "shape": str(function.shape),  # as a Python tuple
        "is_scalar": not function.shape,  # whether the result is one number
        "parameter_places": wrapped([str((listed or parameters).index(parameters[i])) for i in kernel.parameters]),
        "unpack_parameters": _unpacking([f"p_{parameters[i]}" for i in kernel.parameters], "p"),
        "hoisted": kernel.hoisted,  # statements on parameters alone
        "hoisted_results": wrapped(kernel.constant_values),  # the values that the body takes from there
        "hoisted_calls": kernel.hoisted_calls,  # whether sines and the like occur in them
        "unpack": tuple(unpack),  # statements that name the entries of the arguments
        "body": kernel.body,
        "results": tuple(row for columns in rows_of(kernel.results, length) for row in wrapped(columns)),
        "calls": kernel.calls,  # whether sines and the like occur in the statements or results
        "wording": function.interface,  # what its docstring says: summary, symbol and result
        "described": function.described,  # arguments
        "batch": ", ".join(("...", *map(str, function.shape))),  # the shape of its result for a batch
        "notes": function.notes,  # how it is computed
        "operations": str(function.operations.as_dict()).replace("'", '"'),  # counts as a Python dictionary
    }


def _inverse(inverse: Inverse | InverseSearch | None, robot: Robot, listed: Sequence[str]) -> dict[str, object] | None:
    """Inverse kinematics by formulas or by a search, if there is any, in a module with these parameters."""
    if inverse is None:
        return None
    names = [robot.joints[i].label for i in inverse.given]
    search, parameters = inverse if isinstance(inverse, InverseSearch) else None, free_symbols(robot)
    texts = partial(_python_function, parameters=parameters, joints=robot.n, listed=listed)
    return {
        "kernel": texts(inverse.function),  # the texts of its program
        "step": texts(inverse.step) if isinstance(inverse, Inverse) else None,
        "count": inverse.summary,  # how many solutions there are
        "branches": inverse.branches,
        "core": _core(["4,4", *[len(names)] * bool(names)], (inverse.branches, robot.dof)),
        "closed": repr(inverse.closed) if isinstance(inverse, Inverse) else "",
        "around": inverse.around if isinstance(inverse, Inverse) else None,  # where further solutions are looked for
        "given_names": _tuple([python_string(name) for name in names]) if names else "",
        "given_joints": _tuple([str(i) for i in inverse.given]) if names else "",
        "given_words": ", ".join(map(python_docstring, names)),
        "given_count": len(names),
        "order": tuple(map(python_docstring, inverse.order)) if isinstance(inverse, Inverse) else (),
        "is_search": search is not None,  # whether the kernel gives the arm's frames alone, and numbers are searched
        "entries": repr(search.entries) if search else "",  # the entries of T that are wanted, as a tuple
        "eliminations": tuple(map(_elimination, search.eliminations)) if search else (),
        "solutions": search.count if search else 0,  # the number of complex solutions, 0 where it is not known
        "signs": repr([float(joint.sign) for joint in robot.joints]),  # factors of the joint variables
    }


def _elimination(elimination: Elimination) -> str:
    """A call that makes it anew in the module."""

    def _closure(way: Closure) -> str:
        return f"_Closure({way.joints}, {way.dropped}, {way.direction}, {way.eliminated})"

    forms = ((_closure(each.closure), each.equations, each.constant, each.linear) for each in elimination.reductions)
    ways = [f"_Reduction({', '.join(map(str, form))})" for form in forms]
    rest = (elimination.hidden, elimination.multiplied, elimination.rows, _closure(elimination.finish))
    arguments = (f"({_tuple(ways)})", *map(str, rest), str(elimination.start), str(elimination.straight))
    return f"_Elimination({', '.join(arguments)})"


def _unpacking(names: Sequence[str], source: str) -> str:
    """A statement that names the entries of a tuple or array, broken as a formatter would."""
    if len(lines := textwrap.wrap(", ".join(names) + ",", LINE_WIDTH)) == 1:
        return f"{lines[0][:-1]} = {source}" if len(names) > 1 else f"({lines[0]}) = {source}"
    return "\n".join(["(", *(f"        {line}" for line in lines), f"    ) = {source}"])


def _core(widths: Sequence[int | str], shape: Sequence[int]) -> str:
    """The signature of a generalised ufunc: ``(6),(6)->(6,6)``."""
    return f"{','.join(f'({width})' for width in widths)}->({','.join(map(str, shape))})"


def _tuple(texts: Sequence[str]) -> str:
    """What stands in the parentheses of a tuple."""
    return f"{texts[0]}," if len(texts) == 1 else ", ".join(texts)
