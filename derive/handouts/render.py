"""The handout of a robot as files in memory, LaTeX, PDF and web page, the sheet of a folder, and single formulas."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import partial
from typing import TYPE_CHECKING

from derive.errors import QuantityError, TargetError, listed, near_miss, quoted
from derive.handouts.assemble import context_of, document, sections_of
from derive.handouts.exercise import exercise, solutions
from derive.handouts.figure.writers import latex_drawing
from derive.handouts.layout.flow import breakable, matrix_equation, whole_equations
from derive.handouts.layout.quantity import Item, LaidOut, Namer
from derive.handouts.notation.pieces import Box, italic, script
from derive.handouts.notation.symbols import Group, bold
from derive.handouts.parts.inverse_words import formulas
from derive.handouts.pdf import compile_latex
from derive.handouts.sheet import document as sheet
from derive.handouts.sheet.budget import within
from derive.handouts.sheet.context import Context, component_namer, entry_namer, formula, unlisted
from derive.handouts.sheet.document import Document, Section
from derive.handouts.sheet.language import Text
from derive.handouts.sheet.latex_writer import latex, latex_words, macro, omitted_words
from derive.model.entries import expanded_terms, of_matrix
from derive.model.quantities import REGISTRY, Quantity
from derive.model.quantity_names import parse, pick
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.options.handout import PARTS, HandoutOptions
from derive.robot.robot import Robot
from derive.version import __version__

if TYPE_CHECKING:
    from derive.handouts.page.viewer import Viewer


Format = StrEnum("Format", {"TEX": "tex", "PDF": "pdf", "HTML": "html"})  # by the endings of their files


@dataclass(frozen=True, slots=True)
class Handout:
    """A finished handout."""

    files: dict[str, bytes] = field(default_factory=dict)  # contents by file name
    pages: dict[str, int] = field(default_factory=dict)  # pages of each PDF by file name
    parts: tuple[str, ...] = ()  # the parts that it has
    shortened: bool = False  # whether anything was left out on paper to keep to its number of pages


# What stands in a handout beside the parts of its robot: a part after all others, and the arm of the web page, which
# moves in another way than by the sliders alone.
Addition = tuple[Callable[[Context], Section], "Callable[[Context], Viewer]"]


def sheet_names(robot: Robot, *, exercise_sheets: bool) -> tuple[str, ...]:
    """Names of a handout's files, without their endings."""
    return (f"{robot.name}-exercise", f"{robot.name}-solutions") if exercise_sheets else (robot.name,)


def handout_files(
    robot: Robot,
    options: HandoutOptions,
    formats: Collection[Format],
    *,
    exercise_sheets: bool = False,
    progress: Callable[[str, str], None] | None = None,
    addition: Addition | None = None,
) -> Handout:
    """The files of a handout, in memory."""
    tell = progress or (lambda robot, stage: None)
    tell(robot.name, "formulas")
    context = context_of(robot, options)
    whole = document(context)
    if addition is not None:
        whole = replace(whole, sections=(*whole.sections, addition[0](context)))
    paper = within(whole, options.pages, context.text)
    makers: list[Callable[[Document], Document]] = [lambda sheet: sheet]
    if exercise_sheets:
        makers = [lambda sheet: exercise(sheet, context.text), lambda sheet: solutions(sheet, context.text)]
    files: dict[str, bytes] = {}
    pages: dict[str, int] = {}
    shortened = paper is not whole
    for name, made_from in zip(sheet_names(robot, exercise_sheets=exercise_sheets), makers, strict=True):
        tex = latex(made_from(paper), context.text) if {Format.TEX, Format.PDF}.intersection(formats) else ""
        printed: dict[str, bytes] = {}
        if Format.PDF in formats:
            tell(robot.name, "pdflatex")
            compiled, spare = compile_latex(tex, name), 0
            while name == robot.name and compiled.pages > options.pages > spare + 1:  # the estimate was too low
                spare += 1
                tex = latex(within(whole, options.pages, context.text, spare), context.text)
                compiled = compile_latex(tex, name)
            shortened |= spare > 0
            printed[f"{name}.pdf"], pages[f"{name}.pdf"] = compiled.pdf, compiled.pages
        if Format.TEX in formats:
            files[f"{name}.tex"] = tex.encode()
        files.update(printed)
        if Format.HTML in formats:
            tell(robot.name, "web page")
            from derive.handouts.page.writer import page

            figure = addition[1](context) if addition else _arm(context)
            files[f"{name}.html"] = page(made_from(whole), context.text, figure, is_marked=True).encode()
    return Handout(files, pages, tuple(section.part for section in whole.sections), shortened)


def _arm(context: Context) -> Viewer | None:
    """The arm to move where it can be drawn."""
    from derive.handouts.figure.projection import plane_normal
    from derive.handouts.figure.scene import arm_scene
    from derive.handouts.page.viewer import FUNCTIONS, FUNCTIONS_OF_TREES, dragging, symbol_values, viewer

    if context.poses is None:
        return None
    assumed = {name: value for name, value, _ in context.poses.assumed}
    robot = context.robot
    dragged = dragging(robot, symbol_values(robot, (), assumed))
    asked = robot if dragged is None else replace(robot, inverse=dragged.task)
    names = FUNCTIONS_OF_TREES if robot.is_tree else FUNCTIONS
    program = build_program(asked, Effort.QUICK, names=names, inverse=dragged is not None)
    normal = plane_normal([arm_scene(robot, context.poses.frames(context.poses.zero))])
    return viewer(robot, program, assumed, context.text, notation=context.notation, dragged=dragged, normal=normal)


def generated_sheet(robot: Robot) -> dict[str, str]:
    """The sheet of a generated folder, as the robot file asks for it."""
    context = context_of(robot)
    return {"sheet.tex": latex(within(document(context), robot.handout.pages, context.text), context.text)}


# -- one part or one quantity, for ``\input`` into notes, whatever their class, letters and columns
#
# A line of the sheet has a known width; a fragment does not know where it will stand. It brings a few definitions in a
# group of its own, by which TeX breaks equations, chooses between a matrix and its entries, and makes a table or a
# figure smaller, all by the ``\linewidth`` that it finds.

_WIDTH = re.compile(r"[0-9]+(\.[0-9]+)?(pt|mm|cm|in|em)")
_INDEX = re.compile(r"(?<![A-Za-z\\])i(?![A-Za-z])")  # the index in a symbol of the registry
_COMMAND = re.compile(r"\\[A-Za-z]+|[{}_^]")  # what takes no room in print
_LETTER = 8.0  # a bold letter [pt]


def fragment_text(robot: Robot, options: HandoutOptions, name: str, width: str = "") -> str:
    """LaTeX of a part or a quantity, without a document around it."""
    if width and _WIDTH.fullmatch(width) is None:
        allowed = "allowed: a number with pt, mm, cm, in or em, such as 84mm"
        raise QuantityError(f"width {quoted(width)}", allowed=allowed)
    name, context = " ".join(name.split()), context_of(robot, options)
    sections = tuple(sections_of(context, [name])) if name in PARTS else (_quantity(context, name),)
    if not sections:
        why = "it has no closed loops" if name == "closure" else "its file gives no links"
        raise QuantityError(f"{robot.name} has no part {quoted(name)}", allowed=why)
    section = replace(sections[0], blocks=tuple(block for own in sections for block in own.blocks))
    return fragment(section, context.text, name=name, robot=robot.name, width=width)


def _quantity(context: Context, name: str) -> sheet.Section:
    """A section that holds one quantity, as the handout prints it where it does."""
    try:
        row, indices, entry = parse(context.entries.model, name)
    except QuantityError as error:  # what is no quantity may be meant for a part
        word = re.split(r"[\[\s]", name.strip(), maxsplit=1)[0]
        part = near_miss(word, PARTS)
        if error.remedy and not part:
            raise
        allowed = f"parts: {listed(PARTS)}; quantities: {listed(REGISTRY)}"
        found = f"no part and no quantity {quoted(name)}"
        raise TargetError(found, allowed=allowed, remedy=part or near_miss(word, REGISTRY)) from None
    if row.dynamic and not context.robot.has_dynamics:
        raise QuantityError(f"{name} of {context.robot.name}", allowed="its file gives no links", remedy="add links:")
    if row.name == "inverse" and entry is None:
        if not (blocks := tuple(formulas(context))):
            found = f"formulas for {name} of {context.robot.name}"
            raise QuantityError(found, allowed="allowed: arms that have a closed form")
        return sheet.Section("", "", blocks)
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
    return sheet.Section("", "", (formula(context, laid_out, row.function),))


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


# -- as LaTeX

_WIDEST = 10  # columns that amsmath's matrices have unless told otherwise
_macro = partial(macro, "fragment.tex.jinja")


def fragment(section: sheet.Section, text: Text, *, name: str, robot: str, width: str = "") -> str:
    r"""A section in a group of its own."""
    blocks = list(sheet.blocks_of(section))
    is_drawn = any(isinstance(block, sheet.Figure) for block in blocks)
    written = "".join(_written(block, text) for block in section.blocks)
    matrices = re.findall(r"\\begin\{bmatrix\}(.*?)\\end\{bmatrix\}", written, re.DOTALL)
    columns = max((row.count("&") + 1 for matrix in matrices for row in matrix.split("\\\\")), default=0)
    heading = _macro(
        "heading",
        name=name,
        robot=robot,
        version=__version__,
        packages="".join(f"\\usepackage{{{package}}}" for package in ("amsmath", *(["graphicx"] if is_drawn else []))),
        columns=columns if columns > _WIDEST else 0,
        width=width,
        is_drawn=is_drawn,
        has_tables=any(isinstance(block, sheet.Table) for block in blocks),
    )
    return heading + written + _macro("ending")


def _words(text: str) -> str:
    """A text whose inline products may be broken behind a bracket."""
    return latex_words(text).replace(")\\,", ")\\,\\allowbreak ")


def _written(block: sheet.Block, text: Text) -> str:
    match block:
        case sheet.Paragraph(words):
            return _macro("paragraph", text=_words(words))
        case sheet.Rows(lines):
            return _rows(lines, text)
        case sheet.SheetFormula():
            return "".join(_formula(block, text))
        case sheet.Blank(_, task):
            return _macro("paragraph", text=_words(task))
        case sheet.Table(header, rows):
            head, *body = (" & ".join(map(_words, row)) for row in (header, *rows))
            pairs = (zip(header, row, strict=True) for row in rows)  # in words, for a line that the table does not fit
            items = ["; ".join(f"{_words(name)}: {_words(cell)}" for name, cell in row) for row in pairs]
            return _macro("table", header=head, rows=body, items=items)
        case sheet.Figure(drawing, caption):
            return _macro("figure", drawing=latex_drawing(drawing), caption=_words(caption))
        case sheet.Steps(title, blocks):
            return _macro("steps", title=_words(title)) + "".join(_written(inner, text) for inner in blocks)


def _formula(block: sheet.SheetFormula, _: Text) -> Iterator[str]:
    lines = [line for rows in block.rows for line in rows.lines]
    if block.named:
        yield _macro("paragraph", text=_words(_("With the abbreviations")))
        yield _rows(block.named, _)
        yield _macro("paragraph", text=_words(_("the entries are as follows.")))
    if lines:
        is_alone = len(whole_equations(lines)) == 1 and matrix_equation(lines[0]) is not None
        entries = [entry for entry in block.entries() if "\\begin" not in entry.latex] if is_alone else []
        yield _rows(lines, _, [f"{entry.name} = {entry.latex}" for entry in entries])
    if block.omitted:
        yield _macro("paragraph", text=_words(omitted_words(block, _)))
        yield _rows(block.omitted, _)
    if block.note:
        yield _macro("paragraph", text=_words(block.note))


def _rows(lines: Iterable[str], text: Text, named: Sequence[str] = ()) -> str:
    """Equations; ``named`` are the entries of a matrix that stands alone, in their own names."""
    items = []
    for equation in whole_equations(lines):
        if (matrix := matrix_equation(equation)) is not None:
            entries = tuple(breakable(entry) for entry in named or matrix.entries())
            cells = [cell for row in matrix.cells for cell in row]
            is_half = matrix.is_symmetric and len(entries) < len(cells) - cells.count("0")
            note = _words(unlisted(text, is_half, "0" in cells))
            items.append(_macro("matrix", whole=equation, entries=entries, note=note).rstrip())
        else:
            items.append(f"\\whole{{{equation}}}%" if "\\begin" in equation else f"\\eq{{{breakable(equation)}}}%")
    return _macro("rows", items=items)
