"""The workspace of an arm in formulas, as lines of text, of LaTeX, of Python, and as JSON."""

from dataclasses import replace
from typing import Any

import sympy

from derive.handouts.notation.derivation import Print, formula
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.solution_printer import SignLatexPrinter, SignPrinter, pose_names, with_names
from derive.handouts.notation.text import PlainPrinter
from derive.inverse.words.reach import Bound, Reach

_POSE = 6  # coordinates of a pose: arms of fewer joints reach it under conditions only


def workspace_lines(reach: Reach, form: str, notation: Notation) -> list[str]:
    """The workspace as lines."""
    found = reach.inverse
    if notation.digits is not None:
        reach = replace(reach, bounds=tuple(map(_in_decimals, reach.bounds)))
    notation = with_names(notation, found)
    if form == "latex":
        write = SignLatexPrinter(notation, found).latex
        rows = [formula(line, write, " &= ") for line in reach.names]
        rows += [comparison(bound, write, " \\le ") for bound in reach.bounds]
        return ["\\begin{aligned}", *(f"  {row} \\\\" for row in rows), "\\end{aligned}"]
    if form == "python":
        write = PlainPrinter().doprint
        lines = [f"{write(line.symbol)} = {write(line.value)}" for line in reach.names]
        inside = " and ".join(comparison(bound, write, " <= ") for bound in reach.bounds)
        return [*lines, f"reached = {inside or True}"]
    return workspace_text(reach, SignPrinter(found.robot, notation, pose_names(found)).doprint)


def workspace_text(reach: Reach, write: Print) -> list[str]:
    """The workspace as plain text."""
    found = reach.inverse
    count = f"{found.count} solution{'s' if found.count != 1 else ''}"
    variables = " and ".join(map(write, reach.others))
    if not reach.bounds:
        if reach.is_whole:
            if found.conditions or found.robot.n < _POSE:
                return ["no bound: every joint is real where the conditions on the pose hold, if no joint has limits"]
            return ["every pose is reachable if no joint has limits"]
        how = f"up to {count}" if found.count else "no closed form"
        why = f"{variables} real under conditions on more than the position" if variables else "no square root alone"
        return [f"no bound on the position alone ({how}; {why})", "the boundary: derive plot --workspace"]
    lines = ["reachable region, if no joint has limits:"]
    for bound in reach.bounds:
        numbers = reach.numbers(bound)
        size = ""
        if numbers is not None and bound.has_symbols:
            size = f" ({' to '.join(f'{float(x):.4g}' for x in numbers if x is not None)} m)"
        lines.append(
            f"   {comparison(bound, write, ' <= ')}{size}: {shape(reach, bound)}, {write(bound.unknown)} is real"
        )
    if reach.names:
        lines += ["where", *(f"   {formula(line, write)}" for line in reach.names)]
    if reach.is_whole:
        signs = any(line.signs for line in reach.names)
        lines.append(f"{'up to ' * signs}{count} inside")
    else:
        lines.append(f"and where {variables or 'all joints'} can be real, which depends on more than the position")
    return lines


def workspace_parts(reach: Reach) -> dict[str, Any]:
    """What there is to know of a workspace, as text that Python reads, for JSON."""
    write = PlainPrinter().doprint
    bounds = [
        {
            "unknown": write(bound.unknown),
            "quantity": write(bound.quantity),
            "least": None if bound.least is None else write(bound.least),
            "most": None if bound.most is None else write(bound.most),
            "shape": shape(reach, bound),
        }
        for bound in reach.bounds
    ]
    names = {write(line.symbol): write(line.value) for line in reach.names}
    return {"bounds": bounds, "names": names, "whole": reach.is_whole, "count": reach.inverse.count}


def _in_decimals(bound: Bound) -> Bound:
    """A bound whose ends are decimals where they hold numbers alone, with more digits than are printed."""

    def _decimal(e: Any) -> Any:
        return sympy.Rational(str(sympy.N(e, 30))) if e is not None and e.is_number and not e.is_Rational else e

    radii = None if bound.radii is None else (_decimal(bound.radii[0]), _decimal(bound.radii[1]))
    return replace(bound, least=_decimal(bound.least), most=_decimal(bound.most), radii=radii)


def comparison(bound: Bound, write: Print, at_most: str) -> str:
    """``abs(a1 - a2) <= sqrt(x**2 + y**2) <= a1 + a2``."""
    least, most = bound.radii or (bound.least, bound.most)
    middle = bound.quantity if bound.radii is None else sympy.sqrt(bound.quantity)
    return at_most.join(write(e) for e in (least, middle, most) if e is not None)


def shape(reach: Reach, bound: Bound) -> str:
    """What a bound leaves, in words: ``between two spheres``."""
    if bound.radii is None:
        return "on one side of a surface" if None in (bound.least, bound.most) else "between two surfaces"
    around = {line.symbol for line in reach.names if line.signs}
    if bound.quantity.free_symbols & around:
        surfaces = "torus", "tori"
    else:
        flat = "circle" if reach.is_flat else "cylinder"
        surfaces = {1: ("plane", "planes"), 2: (flat, f"{flat}s")}.get(bound.coordinates, ("sphere", "spheres"))
    if bound.least is not None and bound.most is not None:
        return f"between two {surfaces[1]}"
    return f"{'inside' if bound.least is None else 'outside'} of a {surfaces[0]}"
