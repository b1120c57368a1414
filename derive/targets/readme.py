"""The README page of a generated folder: what is in it and how to use it."""

from dataclasses import replace
from functools import partial

from derive.errors import Location
from derive.programs.program import ARGUMENTS, GIVEN, POSE, Program, cost_text, joint_lines
from derive.robot.expression import to_text
from derive.robot.names import free_symbols, robot_symbols
from derive.robot.parser import parse_expression
from derive.robot.reading.size_limits import FORMULA_LIMITS
from derive.robot.robot import Robot
from derive.robot.rounding import DIGITS, is_given_in_decimals, number_text
from derive.robot.units import in_symbol_units
from derive.targets import templating
from derive.targets.escape import markdown_text
from derive.targets.target import Source, Target, package_name, shape_text

# What each file is; files that are not listed here appear without a word.
FILES = {
    "model_numpy.py": "the functions for one configuration or any batch; imports NumPy alone",
    "model_casadi.py": "the same functions as `casadi.Function` objects",
    "model_casadi.c": "CasADi's own C export of them",
    "model_casadi.h": "its header",
    "model.h": "the same functions in C99: what each takes and gives",
    "model.c": "their code, without allocation or globals",
    "model_native.py": "the same functions as those of `model_numpy.py`, compiled",
    "model_native.c": "NumPy's loops around `model.c`; compiled by `derive build`",
    "model.mjs": "the same functions as a JavaScript module, one configuration a call",
    "sheet.tex": "the equations, for `pdflatex sheet.tex`",
    "MANIFEST.json": "hash of the robot file, version of the tool, operation counts, hashes of the files",
    "__init__.py": "makes the folder an importable package",
    "+": "the same functions for MATLAB and Octave, a file each; a configuration is a column",  # the package's folder
}
# Limits that a formula of ours keeps: exact products of the user's numbers may have many digits.
OWN_FORMULA = replace(FORMULA_LIMITS, digits=FORMULA_LIMITS.text_length, number_bits=4 * FORMULA_LIMITS.text_length)


def render(source: Source) -> dict[str, str]:
    """The page."""
    robot, program = source.robot, source.program
    free, numbers, write = free_symbols(robot), dict(robot.parameters), partial(number_text, decimals=True, digits=None)
    baked = [(name, numbers[name]) for name in robot_symbols(robot) if name in numbers and name not in free]
    base = program["base_parameters"].columns if "base_parameters" in program else ()
    written = {column.name: _formulas(column.formula, robot) for column in base}
    inverse = program.inverse or program.search
    shown = {"q", "h", *(name for function in program for name in function.widths)}
    shown |= {*("qd", "qdd", "tau")} if robot.has_dynamics else set()
    context = {
        "units": robot.units,
        "title": markdown_text(robot.title),
        "name": robot.name,
        "package": package_name(robot),
        "digest": robot.digest,
        "version": source.version,
        "convention": robot.convention.value,
        "n": robot.dof,
        "joints": [
            f"`{line}` {markdown_text(joint.name)}".rstrip()
            for line, joint in zip(joint_lines(robot), robot.variables, strict=True)
        ],
        "files": [(n, FILES.get("+" if n.startswith("+") else n, "")) for n in source.files if n != "README.md"],
        "has_numpy": "model_numpy.py" in source.files,
        "has_casadi": "model_casadi.py" in source.files,
        "matlab": next((name[1:-1] for name in source.files if name.startswith("+")), ""),
        "functions": _functions(program),
        "inverse": inverse.summary if inverse is not None else "",
        "given": ", ".join(robot.joints[i].variable for i in inverse.given) if inverse is not None else "",
        "search": program.search,
        "without_inverse": program.without_inverse,
        "solved_ends": [each.end for each in program.of_ends],
        "arguments": [(name, text) for name, text in ARGUMENTS.items() if name in shown],
        # symbols whose number is part of the code: it in SI units and in those of the robot file
        "numbers": [(n, to_text(x, write), to_text(in_symbol_units(robot, n, x), write)) for n, x in baked],
        "base": [(name, rounded) for name, (rounded, _) in written.items()],  # which the grammar keeps free of markup
        "digits": DIGITS if any(rounded != exact for rounded, exact in written.values()) else None,
        "free": free,
        "example": ", ".join(["0.1"] * robot.dof),
        "column": "; ".join(["0.1"] * robot.dof),
        "struct": ", ".join(f"'{name}', 1.0" for name in free),
        "example_parameters": ", ".join(f'"{name}": 1.0' for name in free),
    }
    return {"README.md": templating.render("readme/README.md.jinja", **context)}


def _functions(program: Program) -> list[dict[str, str]]:
    shown = [(function, function.arguments, function.shape) for function in program]
    own = program.inverse or program.search
    for solved in (*([own] if own else []), *(each.inverse for each in program.of_ends)):
        arguments = (POSE, GIVEN) if solved.given else (POSE,)
        shown.append((solved.function, arguments, (solved.branches, solved.joints)))
    return [
        {
            "call": f"{function.name}({', '.join(arguments)})",
            "shape": shape_text(shape),
            "summary": function.interface.summary,
            "cost": "by numbers"
            if program.search and function is program.search.function
            else cost_text(function.operations),
        }
        for function, arguments, shape in shown
    ]


def _formulas(formula: str, robot: Robot) -> tuple[str, str]:
    """A formula with its numbers in few digits, and with all of them."""
    if not formula:
        return "", ""
    tree = parse_expression(formula, Location("formula"), limits=OWN_FORMULA)
    write = partial(number_text, decimals=is_given_in_decimals(robot))
    return to_text(tree, write), to_text(tree, partial(write, digits=None))


TARGET = Target("readme", "a page about the folder, its functions and their cost", ("README.md",), render)
