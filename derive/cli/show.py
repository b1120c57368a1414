"""``derive show``: quantities of a robot as text, LaTeX, Python or JSON."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from derive.cli.terminal import add_shared, digit_count, print_columns, print_json
from derive.errors import QuantityError, near_miss, quoted
from derive.robot.rounding import DIGITS, number_text

if TYPE_CHECKING:
    from derive.model.model import Model
    from derive.robot.robot import Robot

DESCRIPTION = """\
Print symbolic quantities of a robot in textbook notation.

Indices count from 1; further indices pick an entry: 'B[1,2]', 'T[][1,4]'. A matrix is printed as a grid where it
fits, else entry by entry. Without QUANTITY, the quantities that the robot has are listed. Names of books are
understood too: M, 'mass matrix', T06, 'det(J)', coriolis. In Python they are attributes of derive.Model: model.M.

'inverse' prints the inverse kinematics as textbooks derive it, for the task of the file or of --task.
With --at it prints numbers; symbols without a number stay.

  derive show scara-perugia T 'A[2]' J B 'christoffel[1,1,2]' C g tau
  derive show planar-2r-perugia inverse --task x,y
  derive show puma560-corke T J --at '0, 45, 0, 0, 90, 0'
  derive show scara-perugia Cqd --at '0, pi/4, 0.1, 0, a1=0.4' --rates '1, 0, 0, 0'
"""
FORMATS = ("text", "latex", "python", "json")
EXACT_FORMATS = ("python", "json")
FLOAT_DIGITS = 17  # digits of a number beside a symbol in these formats, at a point: they tell any two floats apart

WIDTH = 120  # widest grid; fixed, so that a page of documentation shows what a user gets
COMMENTS = {"text": "#", "latex": "%", "python": "#"}  # how a remark begins in each form
Printer = Callable[[Any], Any]  # writes one expression: its text, or a number for JSON


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, its quantities and the form of the output."""
    add = parser.add_argument
    add_shared(parser, "robot")
    add("quantities", metavar="QUANTITY", nargs="*", help="such as T, 'A[2]', B (default: list them)")
    add_shared(parser, "format", choices=FORMATS, default="text", help=f"{', '.join(FORMATS)} (default text)")
    add_shared(parser, "json", help="the same as --format json")
    grouped = "how expressions are grouped: compact, by-geometry, expanded, or options as in a robot file, such as "
    add_shared(parser, "style", help=grouped + "'compact, gravity: body' (default: as the robot file says)")
    sums = "which sums of angles are contracted (default: as the file says)"
    add("--contraction", choices=("aligned", "opposed"), help=sums)
    short = "abbreviate Christoffel symbols or constants, with their definitions (B, C, N, Bdot, g, tau)"
    add("--abbreviate", choices=("christoffel", "coefficients"), help=short)
    add_shared(parser, "task", help="task of inverse kinematics and singularities: pose, position, or rows (x,y,phi)")
    add("--given", metavar="JOINTS", help="joints whose values are known to the inverse kinematics, such as q3")
    point = "joint values in the order of the table and in the units of the robot file, and name=value of anything else"
    add_shared(parser, "at", help=point)
    add("--rates", metavar="V1,V2,...", help="joint velocities, in the units of the robot file per second")
    add("--accelerations", metavar="V1,V2,...", help="joint accelerations, likewise")
    add = parser.add_mutually_exclusive_group().add_argument
    add("--digits", type=digit_count, metavar="N", help=f"significant digits of numbers in text and LaTeX ({DIGITS})")
    add("--exact", action="store_true", help="exact fractions and roots (default for Python and JSON without --at)")


def run(arguments: argparse.Namespace) -> None:
    """Derive the quantities and print them."""
    from derive.api.robots import load

    form = arguments.format = "json" if arguments.json else arguments.format
    if arguments.digits and form in EXACT_FORMATS:
        raise QuantityError(f"--digits with --format {form}", allowed="text and latex; Python and JSON have all digits")
    robot = _asked(load(arguments.robot, remarks_on_bodies=False), arguments)
    with_numbers = any((arguments.at, arguments.rates, arguments.accelerations))
    if not (arguments.quantities or with_numbers):
        _list(robot, form)
        return
    from derive.model.model import Model
    from derive.model.quantities import DESCRIBED

    model = Model(robot, style=arguments.style, contraction=arguments.contraction)
    shown = _derived(model, arguments, with_numbers=with_numbers)
    digits = None if arguments.exact else arguments.digits or DIGITS
    if with_numbers:
        remark, shown = _put_in(model, shown, arguments)
    values = [part for name, v in shown if name not in DESCRIBED for part in getattr(v, "expressions", (v,))]
    printer, loses = _printer(robot, form, digits, values, numbers=with_numbers)
    written = [(name, _written(robot, form, name, value, digits, printer)) for name, value in shown]
    if form == "json":
        print_json({"robot": robot.name, "quantities": dict(written), "remarks": robot.remarks_as_dicts})
        return
    if with_numbers:
        print(f"{COMMENTS[form]} {remark}")
    if loses and form in ("text", "latex"):
        print(f"{COMMENTS[form]} numbers are rounded to {digits} significant digits; --exact prints all of them")
    print("\n\n".join("\n".join(lines) for _, lines in written))
    if robot.passive:
        from derive.handouts.parts.closure import loop_remarks

        for line in loop_remarks(model, shown, arguments.robot):
            print(f"{COMMENTS[form]} {line}")


def _derived(model: Model, arguments: argparse.Namespace, *, with_numbers: bool) -> list[tuple[str, Any]]:
    """The quantities with their names; for dynamics, also which links are physically inconsistent."""
    from derive.api.robots import tell
    from derive.model.quantities import DESCRIBED
    from derive.model.quantity_names import by_ends, parse

    shown: list[tuple[str, Any]] = []
    names = dict[str, None]()
    for name in _wanted(model, arguments):
        if name not in DESCRIBED and (close := near_miss(name, DESCRIBED)):
            raise QuantityError(f"quantity {quoted(name)}", remedy=close)
        names |= dict.fromkeys([name] if name in DESCRIBED else by_ends(model, name))
    for name in names:
        if name in DESCRIBED:
            if with_numbers or arguments.abbreviate is not None:
                option = "--abbreviate" if arguments.abbreviate else "--at"
                raise QuantityError(f"{option} with {name}", remedy=f"ask for {name} without {option}")
            if name in ("aspects", "decoupling") and arguments.format in ("latex", "python"):
                raise QuantityError(f"--format {arguments.format} with {name}", allowed="allowed: text and json")
            shown.append((name, model.quantity(name)))
            continue
        quantity = parse(model, name)[0]
        if quantity.dynamic:
            tell(remark for remark in model.robot.remarks if remark.is_of_bodies)
        if quantity.name == "singularities" and not with_numbers:
            shown.append((name, model.singularities))
        elif arguments.abbreviate is None:
            shown.append((name, model.quantity(name)))
        else:
            value, definitions = model.abbreviated(name, by=arguments.abbreviate)
            shown += [(name, value), *((str(symbol), meaning) for symbol, meaning in definitions.items())]
    return shown


def _asked(robot: Robot, arguments: argparse.Namespace) -> Robot:
    """The robot with the task and the given joints of the command line."""
    from derive.robot.options.inverse import chosen_given, chosen_task

    options = robot.inverse
    variables = [joint.variable for joint in robot.variables]
    if arguments.given is not None:
        words = [word.strip() for word in arguments.given.split(",")]
        options = replace(options, given=chosen_given(list(filter(None, words)), variables), location=None)
    if arguments.task is not None:
        words = [word.strip() for word in arguments.task.split(",")]
        free = len(variables) - len(options.given or ())
        options = replace(options, task=chosen_task(list(filter(None, words)), free), location=None)
    return robot if options == robot.inverse else replace(robot, inverse=options)


def _wanted(model: Model, arguments: argparse.Namespace) -> list[str]:
    """Names of the quantities; a task or given joints are refused where none of them depends on these."""
    from derive.model.quantities import DESCRIBED
    from derive.model.quantity_names import parse

    option = "--task" if arguments.task is not None else "--given" if arguments.given is not None else ""
    serve = ("inverse", "singularities") if arguments.task is not None else ("inverse",)
    names = [name for name in arguments.quantities if option and name not in DESCRIBED]
    if names and len(names) == len(arguments.quantities) and all(parse(model, n)[0].name not in serve for n in names):
        allowed = f"allowed: with {', '.join(serve)}, workspace and aspects"
        raise QuantityError(f"{option} with {names[0]}", allowed=allowed)
    if arguments.quantities:
        return list(arguments.quantities)
    # what is printed at a point unless quantities are named
    has_dynamics = model.robot.has_dynamics
    asked = {"T": True, "J": True, "B": has_dynamics, "g": has_dynamics}
    asked |= {"Cqd": has_dynamics and arguments.rates, "tau": has_dynamics and arguments.accelerations}
    return [name for name, is_asked in asked.items() if is_asked]


def _written(robot: Robot, form: str, name: str, value: Any, digits: int | None, printer: Printer) -> Any:
    """A quantity as lines; for JSON a matrix by rows, a scalar as text, everything else by its parts."""
    if not hasattr(value, "free_symbols"):  # no expression and no matrix; inverse kinematics takes long to import
        from derive.handouts.notation import derivation
        from derive.handouts.notation.notation import Notation
        from derive.handouts.notation.printer import TextPrinter
        from derive.handouts.parts.closure import closure_lines, closure_parts
        from derive.inverse.words.reach import Reach
        from derive.inverse.words.solutions import InverseKinematics
        from derive.model.closure import Closure
        from derive.model.decoupling import Decoupling
        from derive.model.singularities.aspects import Aspects
        from derive.model.singularities.singularities import Singularities

        notation, as_json = replace(Notation.of(robot), digits=digits), form == "json"
        match value:
            case InverseKinematics() if as_json:
                return derivation.derivation_parts(value)
            case InverseKinematics():
                heading = [f"{COMMENTS[form]} {name}"] if "[" in name else []  # of which end of a tree it is
                return [*heading, *derivation.derivation_lines(value, form, notation)]
            case Closure():
                return closure_parts(value) if as_json else closure_lines(value, form, notation)
            case Reach():
                return (
                    derivation.workspace_parts(value) if as_json else derivation.workspace_lines(value, form, notation)
                )
            case Aspects() if as_json:
                return derivation.aspects_parts(value)
            case Aspects():
                return derivation.aspects_text(value, TextPrinter(robot, notation).doprint, digits)
            case Decoupling():
                return value.parts(printer) if as_json else value.lines(printer)
            case Singularities() if as_json:
                return derivation.singularities_parts(value, printer)
            case Singularities():
                return derivation.singularities_lines(value, name, form, printer)
    if form != "json":
        return _lines(form, name, value, printer)
    return printer(value) if (rows := _entries(value, printer)) is None else rows


def _put_in(
    model: Model, shown: list[tuple[str, Any]], arguments: argparse.Namespace
) -> tuple[str, list[tuple[str, Any]]]:
    """The point in words, and the quantities there."""
    from derive.lecture.point import at_point
    from derive.robot.cells import typed_point
    from derive.robot.expression import to_text

    point = typed_point(model.robot, arguments.at, arguments.rates, arguments.accelerations)
    given = dict(model.robot.parameters)
    write = partial(number_text, decimals=True, digits=None)
    words = ", ".join(f"{name} = {to_text(value, write)}" for name, value in point.items() if given.get(name) != value)
    point = model.closure.completed(point) if model.robot.passive else point
    digits = FLOAT_DIGITS if arguments.format in EXACT_FORMATS else None
    put_in = partial(at_point, values=point, exact=arguments.exact, digits=digits)
    values = [(name, value.at(point) if hasattr(value, "at") else put_in(value, name=name)) for name, value in shown]
    return f"at {words or 'the numbers of the file'} (SI units, rad)", values


def _printer(robot: Robot, form: str, digits: int | None, values: list[Any], *, numbers: bool) -> tuple[Printer, bool]:
    """What writes the entries, and whether digits are lost by it."""
    from derive.handouts.notation.notation import Notation
    from derive.handouts.notation.printer import LatexPrinter, PlainPrinter, TextPrinter, loses_digits

    notation = Notation.of(robot)
    notation = replace(notation, digits=digits, decimals=notation.decimals or numbers)
    loses = digits is not None and loses_digits(values, decimals=notation.decimals, digits=digits)
    if form == "latex":
        return LatexPrinter(notation).latex, loses
    symbolic = TextPrinter(robot, None if digits is None else notation) if form == "text" else PlainPrinter()
    if robot.passive and form == "text":  # quotients of which the divisor is a product
        from derive.handouts.notation.solution_printer import SignPrinter

        symbolic = SignPrinter(robot, notation, frozenset())
    if not numbers or digits is None:
        return symbolic.doprint, loses
    writers: dict[str, Callable[[float], Any]] = {"text": f"{{:.{digits}g}}".format, "python": repr, "json": float}
    return lambda value: writers[form](float(value)) if value.is_number else symbolic.doprint(value), loses


def _list(robot: Robot, form: str) -> None:
    """The quantities that a robot has, each with its indices and what it is."""
    from derive.model.quantities import DESCRIBED, REGISTRY

    known = [row for row in REGISTRY.values() if row.is_of(robot)]
    rows = {row.call: (row.symbol, row.shape_of(robot), row.unit, row.summary) for row in known}
    decouples = robot.has_dynamics and robot.dof > 1
    described = [name for name in DESCRIBED if (decouples if name == "decoupling" else not robot.is_tree)]
    rows |= {name: ("", "", "", DESCRIBED[name]) for name in described}
    if form == "json":
        found = {n: dict(zip(("symbol", "shape", "unit", "summary"), row, strict=True)) for n, row in rows.items()}
        print_json({"robot": robot.name, "quantities": found})
    else:
        shapes = {name: shape or ("text" if name in DESCRIBED else "scalar") for name, (_, shape, _, _) in rows.items()}
        cells = [(name, shapes[name], unit, text) for name, (_, _, unit, text) in rows.items()]
        print_columns(cells, ("quantity", "shape", "unit", "what it is"))


def _entries(value: Any, printer: Printer) -> list[list[str]] | None:
    """The entries of a matrix as text, by rows; None for a scalar."""
    if not hasattr(value, "tolist"):
        return None
    rows = (row if isinstance(row, list) else [row] for row in value.tolist())
    return [[printer(entry) for entry in row] for row in rows]


def _lines(form: str, name: str, value: Any, printer: Printer) -> list[str]:
    """A quantity as text, as LaTeX for mathematics mode, or as an assignment in Python."""
    rows = _entries(value, printer)
    target = re.sub(r"\W+", "_", name).strip("_") if form == "python" else name
    if rows is None:
        return [printer(value)] if form == "latex" else [f"{target} = {printer(value)}"]
    if form == "latex":
        from derive.handouts.layout.lines import matrix_rows

        body = [f"  {row}" for row in matrix_rows(rows)]  # an array: amsmath's matrices have at most ten columns
        body[-1] += r" \\"
        return [rf"\left[\begin{{array}}{{{'c' * len(rows[0])}}}", *body, r"\end{array}\right]"]
    if form == "python":
        return [f"{target} = [", *(f"    [{', '.join(row)}]," for row in rows), "]"]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    if 2 + sum(widths) + 2 * (len(widths) - 1) <= WIDTH:
        return [f"{name} =", *(f"  {'  '.join(map(str.rjust, row, widths))}" for row in rows)]
    found = [(i, j, cell) for i, row in enumerate(rows, 1) for j, cell in enumerate(row, 1) if cell != "0"]
    lines = [f"{name} = ({len(rows)} x {len(widths)}, row,column: entry)"]
    lines += [f"  {i},{j}: {cell}" for i, j, cell in found]
    return lines if len(found) == len(rows) * len(widths) else [*lines, "  all other entries: 0"]
