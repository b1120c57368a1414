"""The singularities of an arm as text, LaTeX and Python, and as JSON."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from derive.model.singularities.singularities import Singularities, statement

Write = Callable[[Any], Any]


def singularities_lines(found: Singularities, name: str, form: str, write: Write) -> list[str]:
    """The singularities in words, in LaTeX, or as a Python assignment under comments."""
    if form == "latex":
        return found.latex_lines(write)
    first, *lines = [*([f"{name} = {write(found.determinant)}"] if found.blocks else []), *statement(found, write)]
    if form == "text":
        return [first if found.blocks else f"{name}: {first}", *(f"  {line}" for line in lines)]
    zeros = ", ".join(f"[{', '.join(write(c.expression) for c in family)}]" for family in found.families)
    if not found.blocks:
        lines, first = [first, "families, all of one are zero together:", *lines], f"{name} = [{zeros}]"
    return [*(f"# {line}" for line in lines), first]


def singularities_parts(found: Singularities, write: Write) -> dict[str, Any]:
    """The same for JSON."""
    families = [
        [{"zero": write(c.expression), "values": list(map(write, c.values)), "certain": c.is_certain} for c in family]
        for family in found.families
    ]
    return {
        "determinant": write(found.determinant) if found.blocks else None,
        "condition": f"det({found.square}) = 0"
        if found.square
        else f"the rank of J is less than {found.rank or 'usual'}",
        "task": list(found.task),
        "rank": found.rank,
        "families": families,
        "complete": found.complete,
        "unless": list(map(write, found.unless)),
        "text": list(statement(found, write)),
    }
