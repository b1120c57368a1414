"""What is told in words, as lines of text, LaTeX and Python: inverse kinematics, workspace, singularities, aspects."""

import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import sympy

from derive.errors import listed
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import PlainPrinter
from derive.handouts.notation.solution_printer import SignLatexPrinter, SignPrinter, pose_names, with_names
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.words.derivation import Origin, OriginForm, PrintedEquation, PrintedStep
from derive.inverse.words.elementary import PrintedLine
from derive.inverse.words.reach import Bound, Reach
from derive.inverse.words.solutions import InverseKinematics
from derive.model.singularities.aspects import Aspects
from derive.model.singularities.singularities import Singularities, statement
from derive.robot.description import IDENTITY
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

Print = Callable[[Any], str]

_POSE = 6  # coordinates of a pose: arms of fewer joints reach it under conditions only
LONGEST_PAIR = 12  # operations of two arcs half a turn apart that are both written


def derivation_lines(found: InverseKinematics, form: str, notation: Notation) -> list[str]:
    """The derivation as lines."""
    notation = with_names(notation, found)
    if form == "latex":  # the formulas as rows of an ``aligned`` environment
        tex = SignLatexPrinter(notation, found).latex
        rows = [_equation(condition, tex).replace("=", "&=", 1) for condition in found.conditions]
        rows += [formula(line, tex, " &= ", " \\text{ or } ", " + \\pi") for line in found.definitions]
        for step in found.steps:
            if not step.lines:
                rows += [_equation(equation, tex).replace("=", "&=", 1) for equation in step.equations]
            rows += [formula(line, tex, " &= ", " \\text{ or } ", " + \\pi") for line in step.lines]
        if not rows:
            return [f"% {headline(found)}", *(f"% {step.unknown}: {reason(found, step)}" for step in found.steps)]
        return ["\\begin{aligned}", *(f"  {row} \\\\" for row in rows), "\\end{aligned}"]
    if form != "python":
        return derivation_text(found, SignPrinter(found.robot, notation, pose_names(found)).doprint)
    # Python, and as comments what has no formula: joints that are given, roots of quartics, eigenvalues.
    write, texts = PlainPrinter().doprint, iter(derivation_python(found))
    lines = [next(texts) for _ in found.definitions]
    for step in found.steps:
        if not step.lines:
            lines.append(f"# {write(step.unknown)}: {reason(found, step)}")
            lines += [f"#   {_equation(equation, write)}" for equation in step.equations]
        lines += [next(texts) for _ in step.lines]
    return lines or [f"# {headline(found)}"]


def derivation_parts(found: InverseKinematics) -> dict[str, Any]:
    """What there is to know of the derivation, as text that Python reads, for JSON."""
    write = PlainPrinter().doprint
    steps = [
        {
            "unknown": write(step.unknown),
            "type": step.kind.value,
            "from": reason(found, step),
            "equations": [{"left": write(e.left), "right": write(e.right)} for e in step.equations],
            "formulas": {write(line.symbol): write(line.value) for line in step.lines},
            "branches": step.branches,
            "real_if": None if step.exists is sympy.true else write(step.exists),
            "free_where_zero": list(map(write, step.free)),
        }
        for step in found.steps
    ]
    return {
        "pose": [[write(entry) for entry in row] for row in found.pose.tolist()],
        "count": found.count,
        "complete": found.complete,
        "everywhere": found.everywhere,
        "why_not": found.graph.why_not,
        "conditions": [{"left": write(c.left), "right": write(c.right)} for c in found.conditions],
        "definitions": {write(line.symbol): write(line.value) for line in found.definitions},
        "sums": {write(name): write(total) for total, name in found.sums.items()},
        "steps": steps,
        "solutions": [{"name": s.name, "signs": {str(k): v for k, v in s.signs.items()}} for s in found.solutions],
    }


def derivation_text(found: InverseKinematics, write: Print) -> list[str]:
    """The derivation as plain text."""
    lines = [headline(found)]
    if found.conditions:
        lines.append(f"a pose can be reached only if {', '.join(_equation(c, write) for c in found.conditions)}")
    if found.definitions:
        within = "pose within the arm, without base, tool and offsets at both ends"
        lines += ["", f"{'the line along both planes' if found.is_point else within}:"]
        lines += [f"   {formula(line, write)}" for line in found.definitions]
    totals = {name: f" = {write(total)}" for total, name in found.sums.items()}
    for number, step in enumerate(found.steps, 1):
        lines += ["", f"{number}. {write(step.unknown)}{totals.get(step.unknown, '')}: {reason(found, step)}"]
        others = (e for e in step.equations if PrintedLine(e.left, e.right) not in step.lines)
        lines += [f"     {_equation(e, write)}" for e in others]
        lines += [f"   {formula(line, write)}" for line in step.lines]
        if step.kind is NodeKind.CONIC:
            lines.append(f"   of the fourth degree in tan({write(step.unknown)}/2): at most {step.branches} values")
        if step.exists is not sympy.true:
            real = step.exists  # a relation such as Abs(D) <= 1
            lines.append(f"   real for {write(real.lhs)} {real.rel_op} {write(real.rhs)}")
        where = f"if {' and '.join(f'{write(e)} = 0' for e in step.fails)}"
        if step.fails and step.instead:
            shown = " and ".join(_equation(equation, write) for equation in step.instead[0])
            lines.append(f"   {where}, solved by {shown} instead, {_sources(found.robot, step.instead[0])}")
        elif step.fails:
            # of three rods the line may go across, and its points are elsewhere on it
            lines.append(f"   {'not determined so' if found.is_point else 'arbitrary'} {where}")
    return lines


def derivation_python(found: InverseKinematics) -> list[str]:
    """The formulas as assignments; the signs are ``epsilon_1``, ..., each 1 or -1."""
    write = PlainPrinter().doprint
    lines, parts = [], dict[Any, Any]()
    for line in found.named_lines:
        symbol, value = line.symbol, line.value.xreplace(parts)
        if symbol.is_Function:  # the sine or cosine of what comes next
            parts[symbol] = sympy.Symbol(f"{symbol.func.__name__}_{symbol.args[0]}")
            symbol = parts[symbol]
        else:
            parts = {}
        lines.append(f"{write(symbol)} = {write(value)}{''.join(f'  # {sign}: 1 or -1' for sign in line.signs)}")
    return lines


def headline(found: InverseKinematics) -> str:
    """How many solutions there are, in words."""
    if not found.graph.is_closed:
        return f"no closed form: {found.graph.why_not}"
    if not found.complete:
        return f"at most {found.graph.leaves} solutions"
    count = f"{found.count} solution{'s' if found.count != 1 else ''}"
    count += " (complete)" if found.everywhere else " for almost every reachable pose; special poses may have more"
    leaves = found.graph.leaves
    return count if leaves == found.count else f"{count}; of {leaves} choices of signs some do not reach the pose"


def reason(found: InverseKinematics, step: PrintedStep) -> str:
    """Where the equations of a step come from, in words."""
    if step.kind is not NodeKind.GENERAL:
        known = {NodeKind.GIVEN: "given", NodeKind.SUM: "from the angles already found"}
        return known.get(step.kind) or _sources(found.robot, step.equations)
    formula = next(node.formulas[0] for node in found.graph.nodes if node.kind is NodeKind.GENERAL).payload
    hidden, others, eliminated = formula.joints
    (joint,) = step.joints
    if joint in eliminated:
        return "from linear equations, given the joints found before"
    if joint in others:
        return "from the eigenvector"
    variables = [row.variable for row in found.robot.joints]
    between, without = (", ".join(variables[k] for k in sorted(joints)) for joints in ((hidden, *others), eliminated))
    size = formula.solution.eliminations[0].eigenvalues
    return f"from the eigenvalues of a {size}x{size} matrix: equations in {between} alone, without {without}"


def _sources(robot: Robot, equations: Iterable[PrintedEquation]) -> str:
    by_matrix: dict[str, list[str]] = {}
    origins = [origin for equation in equations for origin in equation.origins]
    for matrix, entry in (_place(robot, origin) for origin in origins):
        by_matrix.setdefault(matrix, []).append(entry)
    phrases = []
    for matrix, named in by_matrix.items():
        entries = tuple(dict.fromkeys(named))
        if len(entries) > 1 and all(re.fullmatch(r"entry \([\d,]+\)", entry) for entry in entries):
            entries = ("entries " + " and ".join(entry.removeprefix("entry ") for entry in entries),)
        phrases.append(f"{' and '.join(entries)} {matrix}")
    eliminated = any(len(equation.origins) > 1 for equation in equations)
    return "; ".join([*phrases, *(["another unknown eliminated"] if eliminated else [])])


def _place(robot: Robot, origin: Origin) -> tuple[str, str]:
    """The matrix that an equation is of, and what of its entries."""
    places = [f"({','.join(map(str, entry))})" for entry in origin.entries]
    product = product_text(robot, origin)
    axes = f"axes {origin.first} and {origin.last}"
    match origin.form:
        case OriginForm.ENTRY:
            return f"of {product}", f"entry {places[0]}"
        case OriginForm.SQUARES:
            return f"of {product}, squared and added", f"entries {', '.join(places[:-1])} and {places[-1]}"
        case OriginForm.COMPONENT:
            letter, axis = "xyz"[origin.entries[0][0] - 1], origin.last if origin.inverse else origin.first
            if origin.first == origin.last:
                return f"of what joint {axis} adds to the position, along its axes", f"component {letter}"
            return f"of the vector between {axes}, along those of joint {axis}", f"component {letter}"
        case OriginForm.DISTANCE:
            return f"between {axes}", "squared distance"
        case OriginForm.ROD:
            if origin.last > origin.first:
                return "between the ends of the rods", "squared distances"
            return "between the ends of the rod", "squared distance"
        case OriginForm.DIRECTIONS:
            return f"of the rotation between {axes}", f"entry {places[0]}"
        case OriginForm.MOMENT:
            return f"of {product}", f"entry {places[0]} of the moments (Raghavan and Roth)"


def product_text(robot: Robot, origin: Origin) -> str:
    """``A_1^-1 T A_6^-1``: what holds the joints first..last alone."""
    before = [f"A_{i}^-1" for i in range(origin.first - 1, 0, -1)]
    after = [f"A_{i}^-1" for i in range(robot.n, origin.last, -1)]
    base = [] if origin.has_base or robot.base == IDENTITY else ["base^-1"]
    tool = [] if origin.has_tool or robot.tool == IDENTITY else ["tool^-1"]
    text = " ".join((*before, *base, "T", *tool, *after))
    return (f"({text})^-1" if " " in text else "T^-1") if origin.inverse else text


def formula(line: PrintedLine, write: Print, equals: str = " = ", or_: str = " or ", half_turn: str = " + pi") -> str:
    """``theta2 = atan2(+-sqrt(1 - D**2), D)``; both values where a sign stands in it twice."""
    left = write(line.symbol)
    first, *others = map(write, line.alternatives)
    if not others:
        return f"{left}{equals}{first}"
    is_short = sum(value.count_ops() for value in line.alternatives) < LONGEST_PAIR
    return f"{left}{equals}{first}{or_}{others[0] if is_short else left + half_turn}"


def _equation(equation: PrintedEquation, write: Print) -> str:
    return f"{write(equation.left)} = {write(equation.right)}"


# -- the workspace


def workspace_lines(reach: Reach, form: str, notation: Notation) -> list[str]:
    """The workspace as lines."""
    found = reach.inverse
    if notation.digits is not None:
        bounds = []
        for bound in reach.bounds:
            radii = None if bound.radii is None else (_decimal(bound.radii[0]), _decimal(bound.radii[1]))
            bounds.append(replace(bound, least=_decimal(bound.least), most=_decimal(bound.most), radii=radii))
        reach = replace(reach, bounds=tuple(bounds))
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
    write = SignPrinter(found.robot, notation, pose_names(found)).doprint
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
        numbers = reach.numbers(bound) if bound.has_symbols else None
        size = f" ({' to '.join(f'{float(x):.4g}' for x in numbers if x is not None)} m)" if numbers else ""
        what = f"{shape(reach, bound)}, {write(bound.unknown)} is real"
        lines.append(f"   {comparison(bound, write, ' <= ')}{size}: {what}")
    lines += ["where", *(f"   {formula(line, write)}" for line in reach.names)] if reach.names else []
    if reach.is_whole:
        lines.append(f"{'up to ' * any(line.signs for line in reach.names)}{count} inside")
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


def _decimal(e: Any) -> Any:
    """The end of a bound as a decimal where it holds numbers alone, with more digits than are printed."""
    return sympy.Rational(str(sympy.N(e, 30))) if e is not None and e.is_number and not e.is_Rational else e


def comparison(bound: Bound, write: Print, at_most: str) -> str:
    """``abs(a1 - a2) <= sqrt(x**2 + y**2) <= a1 + a2``."""
    least, most = bound.radii or (bound.least, bound.most)
    middle = bound.quantity if bound.radii is None else sympy.sqrt(bound.quantity)
    return at_most.join(write(e) for e in (least, middle, most) if e is not None)


def shape(reach: Reach, bound: Bound) -> str:
    """What a bound leaves, in words: ``between two spheres``."""
    if bound.radii is None:
        return "on one side of a surface" if None in (bound.least, bound.most) else "between two surfaces"
    if bound.quantity.free_symbols & {line.symbol for line in reach.names if line.signs}:
        surfaces = "torus", "tori"
    else:
        flat = "circle" if reach.is_flat else "cylinder"
        surfaces = {1: ("plane", "planes"), 2: (flat, f"{flat}s")}.get(bound.coordinates, ("sphere", "spheres"))
    if bound.least is not None and bound.most is not None:
        return f"between two {surfaces[1]}"
    return f"{'inside' if bound.least is None else 'outside'} of a {surfaces[0]}"


# -- the singularities, and the aspects between them

_MANY = 16  # solutions that are listed one by one


def singularities_lines(found: Singularities, name: str, form: str, write: Print) -> list[str]:
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


def singularities_parts(found: Singularities, write: Print) -> dict[str, Any]:
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


def aspects_text(found: Aspects, write: Print, digits: int | None = None) -> list[str]:
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
