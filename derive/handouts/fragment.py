r"""One part of a handout, or one quantity, for ``\input`` into a teacher's own notes."""

from __future__ import annotations

import re
from functools import partial

from derive.errors import QuantityError, TargetError, listed, near_miss, quoted
from derive.handouts.assemble import context_of, section_of
from derive.handouts.fragment_writer import fragment
from derive.handouts.layout.quantity import Item, LaidOut, Namer
from derive.handouts.notation.pieces import Box, italic, script
from derive.handouts.notation.symbols import Group, bold
from derive.handouts.parts.inverse_formulas import formulas
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Section
from derive.handouts.sheet.formula import component_namer, entry_namer, formula
from derive.model.entries import expanded_terms, of_matrix
from derive.model.quantities import REGISTRY, Quantity
from derive.model.quantity_names import parse, pick
from derive.robot.options.handout import PARTS, HandoutOptions
from derive.robot.robot import Robot

_WIDTH = re.compile(r"[0-9]+(\.[0-9]+)?(pt|mm|cm|in|em)")

_INDEX = re.compile(r"(?<![A-Za-z\\])i(?![A-Za-z])")  # the index in a symbol of the registry
_COMMAND = re.compile(r"\\[A-Za-z]+|[{}_^]")  # what takes no room in print
_LETTER = 8.0  # a bold letter [pt]


def fragment_text(robot: Robot, options: HandoutOptions, name: str, width: str = "") -> str:
    """LaTeX of a part or a quantity, without a document around it."""
    if width and _WIDTH.fullmatch(width) is None:
        raise QuantityError(
            f"width {quoted(width)}", allowed="allowed: a number with pt, mm, cm, in or em, such as 84mm"
        )
    name, context = " ".join(name.split()), context_of(robot, options)
    section = section_of(context, name) if name in PARTS else _quantity(context, name)
    if section is None:
        raise QuantityError(f"{robot.name} has no part {quoted(name)}", allowed="its file gives no links")
    return fragment(section, context.text, name=name, robot=robot.name, version=context.version, width=width)


def _asked(context: Context, name: str) -> tuple[Quantity, tuple[int, ...], tuple[int, ...] | None]:
    """What a name asks for, in the words of `derive.model.quantity_names`; what is none may be meant for a part."""
    try:
        return parse(context.entries.model, name)
    except QuantityError as error:
        word = re.split(r"[\[\s]", name.strip(), maxsplit=1)[0]
        part = near_miss(word, PARTS)
        if error.remedy and not part:
            raise
        raise TargetError(
            f"no part and no quantity {quoted(name)}",
            allowed=f"parts: {listed(PARTS)}; quantities: {listed(REGISTRY)}",
            remedy=part or near_miss(word, REGISTRY),
        ) from None


def _quantity(context: Context, name: str) -> Section:
    """A section that holds one quantity, as the handout prints it where it does."""
    row, indices, entry = _asked(context, name)
    if row.dynamic and not context.robot.has_dynamics:
        raise QuantityError(f"{name} of {context.robot.name}", allowed="its file gives no links", remedy="add links:")
    if row.name == "inverse" and entry is None:
        blocks = tuple(formulas(context))
        if not blocks:
            raise QuantityError(
                f"formulas for {name} of {context.robot.name}", allowed="allowed: arms that have a closed form"
            )
        return Section("", "", blocks)
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
            laid_out = _by_value(context, row, indices, entry)
    return Section("", "", (formula(context, laid_out, row.function),))


def _by_value(context: Context, row: Quantity, indices: tuple[int, ...], entry: tuple[int, ...] | None) -> LaidOut:
    """Any other quantity, or an entry: by the value that the model has for it."""
    whole, name = row.value(context.entries.model, *indices), row.name
    value = whole if entry is None else pick(whole, entry, row.call)
    symbol, namer = _called(context, name, indices)
    if namer is None and hasattr(value, "shape") and value.shape[1] == 1:
        namer = component_namer(symbol)
    namer = namer or entry_namer(symbol, "," if context.robot.n > 9 else "")
    if hasattr(value, "shape"):
        limit = context.policy.grouped_terms if REGISTRY[name].dynamic else 0
        return context.layouter.lay_out(symbol, namer, of_matrix(value), limit=limit)
    if entry is not None and len(entry) == 2:  # a row and a column, as in T[0,2][1,4]
        symbol = namer(*entry)
    elif entry is not None:  # the row of a vector
        symbol = script(Box(f"({symbol.tex})", symbol.width + 10.0), italic(str(entry[0])))
    item = Item(symbol, max(1, expanded_terms(value)), lambda: value)
    return context.layouter.entries([item], limit=context.policy.grouped_terms)


def _called(context: Context, name: str, indices: tuple[int, ...]) -> tuple[Box, Namer | None]:
    """What a quantity is called, and its entries; None where these are the symbol in brackets with indices."""
    symbols = context.symbols
    match name, indices:
        case "A", (i,):
            symbol = symbols.frame("A", i, i - 1)
        case "T", (i, j):
            symbol = symbols.frame("T", j, i)
        case "T", (i,):
            symbol = script(bold("T"), italic(str(i)))
        case (("T" | "J" | "C" | "N"), ()):
            return bold(name), partial(symbols.entry, "t" if name == "T" else name)
        case "B", ():
            return context.dynamics.inertia_symbol, context.dynamics.inertia_entry
        case "g", ():
            return bold("g"), lambda row, _: symbols.component("g", row)
        case "tau", ():
            return Box("\\boldsymbol{\\tau}", 8.0), lambda row, _: symbols.torque(row)
        case "christoffel", (i, j, k):
            symbol = symbols.christoffel(i, j, k)
        case _:  # the symbol of the registry, with its index and the letter of the inertia matrix
            text = REGISTRY[name].symbol.replace("\\mathbf{B}", f"\\mathbf{{{symbols.inertia_letter}}}")
            if indices:
                text = _INDEX.sub(f"{{{','.join(map(str, indices))}}}", text.replace("i,\\ldots", "i"))
            symbol = Box(text, _LETTER * len(_COMMAND.sub("", text)))
    return symbol, None
