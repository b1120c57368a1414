"""``model_casadi.py``: the functions of a robot as ``casadi.Function`` objects, from the same tapes."""

from __future__ import annotations

from derive.emit.numpy_target import python_context
from derive.emit.source import Source
from derive.emit.target import Target
from derive.emit.templating import render

FILE = "model_casadi.py"


def render_casadi(source: Source) -> dict[str, str]:
    """The module's text."""
    context = python_context(source) | {"columns": 4 * source.robot.n}
    return {FILE: render("casadi/model_casadi.py.jinja", **context)}


TARGET = Target(
    name="casadi",
    summary="casadi.Function objects with named inputs and outputs, for MPC and CasADi's own C export",
    files=(FILE,),
    render=render_casadi,
)
