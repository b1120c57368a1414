"""The singularities of an arm as text, LaTeX, Python and JSON, and the aspects between them as text and JSON."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from derive.errors import listed
from derive.handouts.notation.printer import PlainPrinter
from derive.model.singularities.aspects import Aspects
from derive.model.singularities.singularities import Singularities, statement
from derive.robot.names import robot_symbols

_MANY = 16  # solutions that are listed one by one
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
    condition = f"det({found.square}) = 0" if found.square else f"the rank of J is less than {found.rank or 'usual'}"
    families = [
        [{"zero": write(c.expression), "values": list(map(write, c.values)), "certain": c.is_certain} for c in family]
        for family in found.families
    ]
    return {
        "determinant": write(found.determinant) if found.blocks else None,
        "condition": condition,
        "task": list(found.task),
        "rank": found.rank,
        "families": families,
        "complete": found.complete,
        "unless": list(map(write, found.unless)),
        "text": list(statement(found, write)),
    }


def aspects_text(found: Aspects, write: Callable[[Any], str], digits: int | None = None) -> list[str]:
    """The aspects as plain text; joint variables on a path with so many significant digits, None for all."""
    if found.why_not:
        return [f"aspects cannot be computed: {found.why_not}"]
    joints = [joint.variable for joint in found.inverse.robot.joints]
    task = f" of the task {', '.join(found.task)}" if found.task else ""
    what = f"sets of configurations that no singularity{task} divides"
    if found.count is None:
        group = next(group for group in found.groups if group.parts is None)
        named = listed(joints[k] for k in group.joints)
        lines = [f"aspects ({what}) are not counted: det J depends on {named} together"]
    else:
        told = "by the signs of" if found.factors else "by the sign of det J"
        aspects = f"{found.count} aspect{'s' if found.count > 1 else ''}"
        lines = [f"{aspects}, if no joint has limits: {what}; they differ {told}"]
    for number, factor in enumerate(found.factors, 1):
        posture = f" ({factor.posture.value})" if factor.posture else ""
        lines.append(f"   {number}. {write(factor.expression)}{posture}")
    pairs = zip(found.inverse.solutions, found.signs, strict=bool(found.signs))
    signed = [(solution.name, signs) for solution, signs in pairs if signs is not None]
    listed_signs = [f"   {' '.join('+' if sign > 0 else '-' for sign in signs)}  {name}" for name, signs in signed]
    if 1 < len(listed_signs) <= _MANY and len(listed_signs) == len(found.signs):
        lines += ["signs of these in each solution:" if len(found.factors) > 1 else "its sign in each solution:"]
        lines += listed_signs
    lines += _crossing(found, joints, digits)
    known = {name for name, _ in found.inverse.robot.parameters}
    geometry = replace(found.inverse.robot, links=(), gravity=None)
    if assumed := [name for name in robot_symbols(geometry) if name not in known and name in found.values]:
        numbers = ", ".join(f"{name} = {found.values[name]:.4g}" for name in assumed)
        lines.append(f"looked at with {numbers}, for which the file has no numbers")
    return lines


def _crossing(found: Aspects, joints: list[str], digits: int | None) -> list[str]:
    """Whether the arm changes posture within an aspect."""
    poses = len(found.solutions)
    if found.crossing is not None:
        width = max(8, *map(len, joints))
        places = found.crossing.path.tolist()
        columns = [[f"{value:.{digits}g}" if digits else repr(value) for value in place] for place in places]
        aligned = ([cell.rjust(max(8, *map(len, cells))) for cell in cells] for cells in columns)
        least = f"{100 * found.crossing.clearance:.2g} % of its largest value"
        return [
            "cuspidal: it changes posture without meeting a singularity. On the way from one solution of a pose to",
            f"another one, along straight lines from column to column, det J is never less than {least}:",
            *(f"   {name:<{width}}  {'  '.join(row)}" for name, *row in zip(joints, *aligned, strict=True)),
        ]
    if found.shared:
        return [
            f"at {found.shared} of {poses} random poses two solutions have the same signs; no path between them that",
            "avoids singularities was found, which does not prove that none exists",
        ]
    where = f"at {poses} random poses every solution lies in an aspect of its own"
    return [f"{where}: between these the arm changes posture through singularities only"]


def aspects_parts(found: Aspects) -> dict[str, Any]:
    """What there is to know of the aspects, for JSON."""
    write = PlainPrinter().doprint
    crossing = found.crossing
    signs = found.signs or (None,) * len(found.inverse.solutions)
    return {
        "count": found.count,
        "why_not": found.why_not,
        "task": list(found.task),
        "factors": [write(factor.expression) for factor in found.factors],
        "poses": len(found.solutions),
        "poses_with_shared_signs": found.shared,
        "cuspidal": found.is_cuspidal,
        "path": None if crossing is None else crossing.path.tolist(),
        "solutions": [
            {"name": solution.name, "signs": None if own is None else list(own)}
            for solution, own in zip(found.inverse.solutions, signs, strict=True)
        ],
    }
