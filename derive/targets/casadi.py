"""``model_casadi.py``: the functions of a robot as ``casadi.Function`` objects, and CasADi's own export to C."""

from typing import Any

from derive.algebra.constants import to_float
from derive.interrupts import TemporaryFolder
from derive.programs.program import NEAR, Function, Inverse
from derive.programs.tape.tape import ALL_NAMES, PARAMETER, Op, evaluate
from derive.robot.options.solution_policy import POLICY
from derive.targets.escape import c_comment, python_docstring
from derive.targets.numpy import python_context
from derive.targets.target import Source, Target, heading
from derive.targets.templating import render

FILE, CODE, HEADER = "model_casadi.py", "model_casadi.c", "model_casadi.h"
# What CasADi calls functions.
NAMES = ALL_NAMES | {Op.LESS: "lt", Op.SELECT: "if_else", Op.MAXIMUM: "fmax", Op.MINIMUM: "fmin", Op.ABSOLUTE: "fabs"}


def render_casadi(source: Source) -> dict[str, str]:
    """The module ``model_casadi.py``."""
    search = source.program.search
    reason = python_docstring(f"{search.reason}, which is no expression") if search else ""
    context = python_context(source) | {"columns": 4 * source.robot.dof, "without_inverse": reason}
    if search:
        context["inverse"] = None
    return {FILE: render("casadi/model_casadi.py.jinja", **context)}


_WHAT = "casadi.Function objects with named inputs and outputs, for MPC and CasADi's own C export"
TARGET = Target("casadi", _WHAT, (FILE,), render_casadi)


def render_casadi_c(source: Source) -> dict[str, str]:
    """Code and header, behind a heading of ours; like CasADi's text, they depend on its version."""
    import casadi

    parameters = source.program.parameters
    generator = casadi.CodeGenerator(CODE, {"with_header": True})
    for function in source.program:
        generator.add(casadi_function(function, source.robot.dof, len(parameters)))
    inverse = source.program.inverse
    for branch in casadi_inverse(inverse, len(parameters)) if inverse else ():
        generator.add(branch)
    top = render(
        "casadi-c/heading.c.jinja",
        **heading(source, c_comment),
        parameters=parameters,
        has_inverse=inverse is not None,
        given=", ".join(source.robot.joints[i].variable for i in inverse.given) if inverse else "",
        order=tuple(map(c_comment, inverse.order)) if inverse else (),
        casadi_version=casadi.CasadiMeta.version(),
    )
    with TemporaryFolder() as folder:
        generator.generate(f"{folder.path}/")
        return {name: top + (folder.path / name).read_text(encoding="utf-8") for name in (CODE, HEADER)}


_EXPORT = "CasADi's own C export of its functions"
C_TARGET = Target("casadi-c", _EXPORT, (CODE, HEADER), render_casadi_c, default=False)


def casadi_function(function: Function, joints: int, parameters: int) -> Any:
    """A tape as a ``casadi.Function`` on SX."""
    import casadi

    names, inputs, results = _evaluated(function, joints, parameters)
    output = casadi.densify(casadi.vertcat(*results))  # an entry that is zero is an entry
    if len(function.shape) > 1:  # a matrix, or matrices side by side; CasADi's run down the columns
        rows, columns = function.shape[-2:]
        blocks = casadi.vertsplit(output, rows * columns)
        output = casadi.horzcat(*[casadi.reshape(block, columns, rows).T for block in blocks])
    return casadi.Function(function.name, inputs, [output], names, [function.interface.symbol])


def casadi_inverse(inverse: Inverse, parameters: int) -> list[Any]:
    """Inverse kinematics as ``casadi.Function`` objects on SX."""
    import casadi

    names, inputs, values = _evaluated(inverse.function, inverse.joints, parameters)
    step_names, step_inputs, results = _evaluated(inverse.step, inverse.joints, parameters)
    step = casadi.Function("step", step_inputs, [casadi.vertcat(*results)], step_names, ["ahead"])
    pose, params = inputs[0], inputs[len(inputs) - bool(parameters) :]
    found, n = [], inverse.joints
    for branch in range(inverse.branches):
        q, code = casadi.vertcat(*values[branch * n : branch * n + n]), values[inverse.branches * n + branch]
        ahead, mended = step(q, pose, POLICY.damping, *params), q
        for _ in range(2):  # as `_checked` of model_casadi.py
            later = step(ahead[:n], pose, POLICY.damping, *params)
            better = later[n] < ahead[n]
            mended, ahead = casadi.if_else(better, ahead[:n], mended), casadi.if_else(better, later, ahead)
        kind = casadi.if_else((ahead[n] <= POLICY.closed) * (code < 8), casadi.fmod(code, 4), 0)
        status = casadi.if_else(casadi.norm_1(pose[:12]) <= POLICY.far, casadi.if_else(code < 4, code, kind), 0)
        q = casadi.if_else(status > 0, casadi.if_else(code < 4, q, mended), casadi.DM.nan(n, 1))
        found.append(casadi.Function(f"inverse_kinematics_{branch + 1}", inputs, [q, status], names, ["q", "status"]))
    return found


def _evaluated(function: Function, joints: int, parameters: int) -> tuple[list[str], list[Any], list[Any]]:
    """Names and symbols of a function's inputs, and its results."""
    import casadi

    names = [*(name for name in function.arguments if name != NEAR), *(["params"] if parameters else [])]
    inputs = [casadi.SX.sym(name, parameters if name == "params" else function.width(name, joints)) for name in names]
    kinds = [PARAMETER if name == "params" else name for name in names]
    entries = dict(zip(kinds, map(casadi.vertsplit, inputs), strict=True))
    entries[NEAR] = [casadi.SX(0)] * joints  # where joints are free, they are zero
    arithmetic = {name: getattr(casadi, NAMES[op]) for op, name in ALL_NAMES.items()}
    arithmetic["number"] = lambda value: casadi.SX(to_float(value))
    return names, inputs, evaluate(function.tape, entries, arithmetic)
