r"""One part of a handout, or one quantity, for ``\input`` into a teacher's own notes."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from derive.errors import QuantityError, TargetError, listed, near_miss, quoted
from derive.handouts.assemble import context_of, section_of
from derive.handouts.context import Context
from derive.handouts.document import Figure, Section, Table, blocks_of, rows_of
from derive.handouts.formula import entry_namer, formula
from derive.handouts.latex_writer import fragment
from derive.handouts.layout.quantity import Item, LaidOut
from derive.handouts.notation.pieces import Box, italic, script
from derive.handouts.notation.symbols import Group, bold
from derive.model.entries import expanded_terms, of_matrix
from derive.model.quantities import REGISTRY, parse
from derive.robot.robot import Robot
from derive.robot.style import PARTS, HandoutOptions

_WIDEST = 10
"""Columns that amsmath's matrices have unless told otherwise."""

_MATRIX = re.compile(r"\\begin\{bmatrix\}(.*?)\\end\{bmatrix\}", re.DOTALL)

_WORDS = {
    "detJ": "\\det\\mathbf{J}",
    "rpy": "\\boldsymbol{\\phi}_{\\mathrm{RPY}}",
    "euler_zyz": "\\boldsymbol{\\phi}_{\\mathrm{ZYZ}}",
}
"""Quantities whose names are no symbols."""

_FUNCTIONS = {
    "T": "forward_kinematics",
    "A": "link_transforms",
    "J": "jacobian",
    "B": "inertia_matrix",
    "C": "coriolis_matrix",
    "N": "coriolis_matrix",
    "christoffel": "coriolis_matrix",
    "g": "gravity_vector",
    "tau": "inverse_dynamics",
}


def fragment_text(robot: Robot, options: HandoutOptions, name: str) -> str:
    """LaTeX of a part or a quantity, without a document around it.

    Args:
        robot: The robot.
        options: What the handout shows; language and notation count here too.
        name: A part such as ``inertia`` or a quantity such as ``B``, ``A[1]`` or ``T[0,2]``.

    Returns:
        The text, headed by a comment that names the packages it needs.

    Raises:
        QuantityError: Neither a part nor a quantity, or one that this robot does not have.
    """
    context = context_of(robot, options)
    section = section_of(context, name) if name in PARTS else _quantity(context, name)
    if section is None:
        raise QuantityError(f"{robot.name} has no part {quoted(name)}", allowed="its file gives no links")
    blocks = list(blocks_of(section))
    packages = {
        "amsmath": True,
        "booktabs": any(isinstance(block, Table) for block in blocks),
        "longtable": any(isinstance(block, Table) and block.long for block in blocks),
        "tikz": any(isinstance(block, Figure) for block in blocks),
        "pdflscape": any(rows.landscape for block in blocks for rows in rows_of(block)),
    }
    needed = "".join(f"\\usepackage{{{package}}}" for package, is_needed in packages.items() if is_needed)
    shown = f"% {name} of {robot.name}: written by derive {context.version}; needs {needed}\n"
    body = fragment(section, context.text)
    columns = max((row.count("&") + 1 for matrix in _MATRIX.findall(body) for row in matrix.split("\\\\")), default=0)
    if columns > _WIDEST:
        shown += f"% and \\setcounter{{MaxMatrixCols}}{{{columns}}}\n"
    return shown + body


def _quantity(context: Context, name: str) -> Section:
    """A section that holds one quantity, as the handout prints it where it does."""
    word = re.split(r"[\[\s]", name.strip(), maxsplit=1)[0]
    if word not in REGISTRY:  # what is meant may be a part or a quantity
        raise TargetError(
            f"no part and no quantity {quoted(name)}",
            allowed=f"parts: {listed(PARTS)}; quantities: {listed(REGISTRY)}",
            remedy=near_miss(word, (*PARTS, *REGISTRY)),
        )
    row, indices, entry = parse(context.entries.model, name)
    if row.dynamic and not context.robot.has_dynamics:
        raise QuantityError(f"{name} of {context.robot.name}", allowed="its file gives no links", remedy="add links:")
    dynamics, entries, lay_out = context.dynamics, context.entries, context.layouter.lay_out
    match row.name if entry is None and not indices else "":
        case "T":
            laid_out = lay_out(bold("T"), partial(context.symbols.entry, "t"), entries.T)
        case "J":
            laid_out = lay_out(bold("J"), partial(context.symbols.entry, "J"), entries.J, group=Group.J)
        case "kinetic" if dynamics.is_compact(entries.B):
            laid_out = dynamics.closed("kinetic")
        case "B" | "C" | "N" | "g" | "tau" | "potential":
            laid_out = dynamics.closed(row.name)
        case _:  # no part prints it as a whole
            laid_out = _by_value(context, name, row.name, indices)
    return Section("", "", (formula(context, laid_out, _FUNCTIONS.get(row.name, "")),))


@dataclass(frozen=True, slots=True)
class _Name:
    """What a quantity is called; its entries are in brackets with indices."""

    symbol: Box
    entry: Callable[[int, int], Box]


def _by_value(context: Context, text: str, name: str, indices: tuple[int, ...]) -> LaidOut:
    """Any other quantity, or an entry: by the value that the model has for it."""
    value = context.entries.model.quantity(text)
    called = _called(context, name, indices)
    if hasattr(value, "shape"):
        limit = context.policy.grouped_terms if REGISTRY[name].dynamic else 0
        return context.layouter.lay_out(called.symbol, called.entry, of_matrix(value), limit=limit)
    symbol = called.symbol
    numbers = re.findall(r"\d+", text.partition("[")[2])[len(indices) :]
    if len(numbers) == 2:  # a row and a column, as in T[0,2][1,4]
        symbol = called.entry(int(numbers[0]), int(numbers[1]))
    elif numbers:  # the row of a vector
        symbol = script(Box(f"({symbol.tex})", symbol.width + 10.0), italic(str(int(numbers[0]))))
    item = Item(symbol, max(1, expanded_terms(value)), lambda: value)
    return context.layouter.entries([item], limit=context.policy.grouped_terms)


def _called(context: Context, name: str, indices: tuple[int, ...]) -> _Name:
    symbols = context.symbols
    match name, indices:
        case "A", (i,):
            symbol = symbols.frame("A", i, i - 1)
        case "T", (i, j):
            symbol = symbols.frame("T", j, i)
        case (("T" | "J" | "C" | "N"), ()):
            return _Name(bold(name), partial(symbols.entry, "t" if name == "T" else name))
        case "B", ():
            return _Name(context.dynamics.inertia_symbol, context.dynamics.inertia_entry)
        case "g", ():
            return _Name(bold("g"), lambda row, _: symbols.component("g", row))
        case "tau", ():
            return _Name(Box("\\boldsymbol{\\tau}", 8.0), lambda row, _: symbols.torque(row))
        case "christoffel", (i, j, k):
            symbol = symbols.christoffel(i, j, k)
        case _:
            symbol = _by_name(name, indices, symbols.inertia_letter)
    return _Name(symbol, entry_namer(symbol, "," if context.robot.n > 9 else ""))


def _by_name(name: str, indices: tuple[int, ...], inertia: str) -> Box:
    r"""``Jv_com[2]`` is \mathbf{J}_{\mathrm{v,com},2}; ``Bdot`` has its dot."""
    if name == "Bdot":
        return Box(f"\\dot{{\\mathbf{{{inertia}}}}}", 10.0)
    if name in _WORDS:
        return Box(_WORDS[name], 30.0)
    if len(name) > 1 and "_" not in name:
        return Box(f"\\mathrm{{{name}}}", 6.0 * len(name))
    rest = name[1:].strip("_").replace("_", ",")
    labels = ",".join([*([f"\\mathrm{{{rest}}}"] if rest else []), *map(str, indices)])
    nucleus = bold(inertia if name.startswith("B") else name[0])
    return script(nucleus, Box(labels, 6.0 * (len(rest) + 3 * len(indices)))) if labels else nucleus
