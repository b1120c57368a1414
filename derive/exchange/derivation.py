"""How a table becomes that of the other convention, step by step, as text; as LaTeX the handout has it."""

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Any

from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import TextPrinter, loses_digits
from derive.handouts.parts.conversion import FEW_FACTORS
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.mechanics.convention import Conversion, has_equal_poses
from derive.model.model import Model
from derive.robot.description import IDENTITY, Convention
from derive.robot.robot import Robot
from derive.robot.writer import cell_text

WIDTH = 120  # widest grid


def derivation_text(conversion: Conversion) -> str:
    """The derivation as text: factors, both products, what moves, the rows of both tables, and the equal product."""
    import sympy

    source, result = conversion.source, Robot.of(conversion.result)
    notation = Notation.of(source)
    write = TextPrinter(source, notation).doprint
    names = (source.convention.value, result.convention.value)
    ends = (source.base != IDENTITY or result.base != IDENTITY, source.tool != IDENTITY or result.tool != IDENTITY)
    n, power = source.n, "" if source.convention is Convention.MODIFIED else "^-1"
    moved = f"T'_base = T_base X_0{power}; T'_tool = X_{n}{'' if power else '^-1'} T_tool"
    lines = [
        "Z_i = Rot(z, theta_i) Trans(z, d_i) moves, X_i = Trans(x, a_i) Rot(x, alpha_i) = Rot(x, alpha_i) Trans(x, a_i)"
        " is constant.",
        f"{names[0]}: T = {_product(source, '', ends)}",
        f"{names[1]}: T = {_product(result, chr(39), ends)}",
        f"The factors are the same, the brackets are not: {moved}.",
        "",
        *_factors(conversion),
    ]
    models, matrices = [(Model(source), ""), (Model(result), "'")], {}
    for model, prime in models:
        convention = model.robot.convention.value
        for i in range(1, n + 1):
            matrices[f"A{prime}_{i} = {_bracket(model.robot, i)}, row {i} of the {convention} table"] = model.A(i)
    for name, frame, other in (("base", source.base, result.base), ("tool", source.tool, result.tool)):
        if frame != other:
            matrices[f"T'_{name}"] = sympy.Matrix([[expression_to_sympy(cell) for cell in row] for row in other])
    for name, matrix in matrices.items():
        lines += ["", *_grid(name, matrix, write)]
    entries = chain.from_iterable([*matrices.values(), models[0][0].T if n <= FEW_FACTORS else ()])
    if notation.digits and loses_digits(entries, decimals=notation.decimals, digits=notation.digits):
        lines += ["", f"Matrices are printed with {notation.digits} significant digits of each number."]
    lines += ["", *_links(conversion)]
    if n > FEW_FACTORS:
        lines.append(f"{n} rows are not multiplied out here; the product is that of the same factors.")
    else:
        both = [_around([f"A{prime}_{i}" for i in range(1, n + 1)], prime, ends) for prime in ("", "'")]
        lines += _grid(f"T = {both[0]} = {both[1]}", models[0][0].T, write)
        same = "equal" if has_equal_poses(conversion) else "DIFFERENT"
        lines.append(f"Both products multiplied out are {same}, entry by entry, in exact arithmetic.")
    return "\n".join(lines) + "\n"


def _bracket(robot: Robot, i: int) -> str:
    return f"Z_{i} X_{i}" if robot.convention is Convention.STANDARD else f"X_{i - 1} Z_{i}"


def _product(robot: Robot, prime: str, ends: tuple[bool, bool]) -> str:
    rows = [f"({_bracket(robot, i)})" for i in range(1, robot.n + 1)]
    return _around(rows if robot.n <= FEW_FACTORS else [*rows[:2], "...", rows[-1]], prime, ends)


def _around(rows: Sequence[str], prime: str, ends: tuple[bool, bool]) -> str:
    """Base, factors of the rows and tool; base and tool where one of the tables has them."""
    return " ".join([*([f"T{prime}_base"] if ends[0] else []), *rows, *([f"T{prime}_tool"] if ends[1] else [])])


def _factors(conversion: Conversion) -> Iterator[str]:
    """The constant factors, and the row of each table that holds them."""
    n = conversion.source.n
    source, result = conversion.source.convention.value, conversion.result.convention.value
    rows = [("factor", "a", "alpha", *(f"{name} table" for name in (source, result)))]
    for i, factor in enumerate(conversion.factors):
        homes = {"standard": f"row {i}" if i else "base", "modified": f"row {i + 1}" if i < n else "tool"}
        rows.append((f"X_{i}", cell_text(factor.a), cell_text(factor.alpha), homes[source], homes[result]))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    yield from ("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)


def _links(conversion: Conversion) -> Iterator[str]:
    source, result = conversion.source, conversion.result
    if changed := [i for i in range(len(source.links)) if source.links[i].com != result.links[i].com]:
        through = "X_i r" if source.convention is Convention.STANDARD else "X_i^-1 r"
        yield f"Frame i stands elsewhere; the centre of mass r is seen at {through}, the tensor in its axes:"
        for i in changed:
            ours, theirs = (", ".join(map(cell_text, links[i].com)) for links in (source.links, result.links))
            yield f"  link {i + 1}: [{ours}] is [{theirs}] in the {result.convention.value} frame {i + 1}"
        yield ""
    yield from (f"{note}." for note in conversion.notes)


def _grid(name: str, matrix: Any, write: Any) -> list[str]:
    """A matrix as a grid, or by its entries where that is too wide."""
    rows: Sequence[Sequence[str]] = [[write(entry) for entry in row] for row in matrix.tolist()]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    if 2 + sum(widths) + 2 * (len(widths) - 1) <= WIDTH:
        return [f"{name} =", *(f"  {'  '.join(map(str.rjust, row, widths))}" for row in rows)]
    entries = [(i, j, cell) for i, row in enumerate(rows, 1) for j, cell in enumerate(row, 1) if i < 4]
    return [f"{name} = (row,column: entry)", *(f"  {i},{j}: {cell}" for i, j, cell in entries)]
