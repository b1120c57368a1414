"""What the parts of one handout share: the robot, its closed forms, the options, and what prints them."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from itertools import chain, groupby

import sympy

from derive.errors import DeriveError
from derive.handouts.layout.lines import Equation, equated, equation_lines, fits, matrix, pack
from derive.handouts.layout.quantity import POLICY, LaidOut, Layouter, Namer, SheetPolicy
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.pieces import EMPTY, Box, bracketed, italic, joined, script, upright
from derive.handouts.notation.printer import Cell, DataPrinter, LatexPrinter, PlainPrinter
from derive.handouts.notation.symbols import Symbols
from derive.handouts.sheet.document import Block, Entry, Paragraph, Rows, SheetFormula
from derive.handouts.sheet.dynamics import DynamicsLayout
from derive.handouts.sheet.language import Text
from derive.handouts.sheet.latex_writer import macro
from derive.model.entries import Entries, ModelEntries
from derive.robot import tree
from derive.robot.description import Convention
from derive.robot.options.handout import Derivation, HandoutOptions
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses


class Context:
    """One robot on its way to a handout."""

    def __init__(
        self,
        entries: ModelEntries,  # its closed forms, entry by entry
        options: HandoutOptions,  # what the handout shows
        text: Text,  # translates messages
        poses: RobotPoses | None = None,  # where its frames are, for figures; None where nothing is drawn
        policy: SheetPolicy = POLICY,  # how much is printed
        whole: "Context | None" = None,  # of the serial arm that leads to an end of a tree: the tree
        end: str = "",  # and the name of that end
        places: tuple[int, ...] = (),  # and the joints of the tree that the arm has, from 0
    ) -> None:
        self.entries, self.options, self.text = entries, options, text
        self.poses, self.policy = poses, policy
        robot = self.robot = entries.robot
        self.whole, self.end, self.places = whole or self, end, places or tuple(range(robot.n))
        self.is_standard = robot.convention is Convention.STANDARD  # in which joint i moves about z of frame i-1
        self.has_closed_dynamics = robot.has_dynamics and robot.n <= policy.closed_form_joints
        self.steps = options.derivation is Derivation.STEPS  # whether intermediate steps are shown
        notation = Notation.of(robot, options.notation, comma=text.comma)
        self.notation: Notation = whole.notation if whole else replace(notation, degrees=robot.units.degrees)
        self.symbols = Symbols(self.notation, self.whole.robot.n, end)  # names of entries
        self.printer = LatexPrinter(self.notation)  # prints expressions
        self.layouter = Layouter(self.printer, policy, self.symbols.term, text("terms"))  # lays out quantities
        self.data = DataPrinter(robot, self.notation)  # prints cells of the robot file
        self.dynamics = DynamicsLayout(entries, self.layouter, self.symbols)  # lays out the dynamics

    @cached_property
    def ends(self) -> "tuple[Context, ...]":
        """What the parts about one end effector are made from: of a tree with several ends one for each of these."""
        found = []
        for name in (end.name for end in self.robot.ends if end.name):
            arm, places = self.entries.model.arm(name)
            given = self.options, self.text, self.poses and poses_of(arm.robot), self.policy
            found.append(Context(ModelEntries(arm), *given, self, name, places))
        return tuple(found) or (self,)

    def name(self, label: str) -> Box:
        """How the frame of a row of a tree is written: by its number, or by the name of a row without motion."""
        whole = self.whole.robot
        robot = whole if self.end in {"", *(end.name for end in whole.ends)} else self.robot  # the arm of a loop
        return italic(str(number)) if (number := tree.labels(robot).index(label)) <= robot.n else upright(label)

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """Of the rows of a tree on the way to the end effector, that of frame 0 empty; none of a chain."""
        is_tree = bool(self.end) or self.robot.is_tree
        return ("", *tree.rows_to(self.robot, tree.ends(self.robot)[0].after)) if is_tree else ()

    @cached_property
    def path(self) -> tuple[Box, ...]:
        """How the frames from frame 0 to the end effector are written."""
        return tuple(map(self.name, self.labels)) or tuple(italic(str(i)) for i in range(self.robot.n + 1))

    def between(self, i: int, j: int) -> Entries:
        """The frame at one place of the path, 4x4, in that at another one."""
        entries, labels = self.entries, self.labels
        return entries.between(labels[i], labels[j]) if labels else entries.transform(i, j)

    @property
    def J(self) -> Entries:
        """The geometric Jacobian, a column for each variable: zeros where it does not move an end of a tree."""
        own, columns = self.entries.J, {place: k for k, place in enumerate(self.places, 1)}
        if not self.end or self.robot.coupled:
            return own
        return Entries(
            (6, self.whole.robot.n),
            lambda i, j: own.terms(i, columns[j - 1]) if j - 1 in columns else 0,
            lambda i, j: own.entry(i, columns[j - 1]) if j - 1 in columns else sympy.S.Zero,
        )

    def function(self, name: str) -> str:
        """A generated function of the end effector."""
        return f"{name}_{self.end}" if self.end else name

    def paragraph(self, message: str, **values: object) -> Paragraph:
        """A message in the reader's language."""
        return Paragraph(self.text(message, **values))

    def announced(self, message: str, lines: Sequence[str], **values: object) -> list[Block]:
        """A message and the lines that it announces; nothing where there are none."""
        return [self.paragraph(message, **values), Rows(tuple(lines))] if lines else []

    def answer(self, message: str, **values: object) -> Paragraph:
        """The same, of what an exercise asks for."""
        return Paragraph(self.text(message, **values), is_answer=True)


def poses_of(robot: Robot) -> RobotPoses | None:
    """Where the frames of a robot are; None where nothing can be drawn."""
    with suppress(DeriveError):
        return RobotPoses(robot)
    return None


# -- from closed forms to formulas of the handout, and the formulas of textbooks that hold for every robot


def formula(context: Context, laid_out: LaidOut, function: str = "", task: str = "") -> SheetFormula:
    """A laid-out quantity as a formula."""
    rows = [Rows(laid_out.lines)] if laid_out.lines else []
    rows += [Rows(laid_out.landscape, landscape=True)] if laid_out.landscape else []
    python = PlainPrinter().doprint
    return SheetFormula(
        rows=tuple(rows),
        named=laid_out.named,
        omitted=laid_out.omitted,
        note=unlisted(context.text, laid_out.symmetric, laid_out.has_zeros),
        function=function,
        entries=lambda: [Entry(name.tex, context.printer.latex(e), python(e)) for name, e in laid_out.values],
        task=task,
        blanks=laid_out.blanks,
    )


def unlisted(text: Text, symmetric: bool, has_zeros: bool) -> str:
    """What a reader must know of a matrix that is printed entry by entry."""
    _ = text
    if symmetric and has_zeros:
        return _("The matrix is symmetric; entries that are not listed are zero.")
    if symmetric:
        return _("The matrix is symmetric.")
    return _("Entries that are not listed are zero.") if has_zeros else ""


def entry_namer(symbol: Box, comma: str = "") -> Namer:
    """Names of the entries of a matrix that has no letter of its own: (A)_{12}."""
    return lambda row, column: script(bracketed(symbol), italic(f"{row}{comma}{column}"))


def component_namer(symbol: Box) -> Namer:
    """Names of the components of a vector: (z_1)_2."""
    return lambda row, _: script(bracketed(symbol), italic(str(row)))


def matrix_lines(symbol: Box, cells: Sequence[Sequence[Cell]], namer: Namer) -> list[str]:
    """A matrix of the robot's data: in brackets if it fits, else entry by entry."""
    box = equated(symbol, matrix([[joined(cell) for cell in row] for row in cells]))
    if fits(box, len(cells)):
        return [box.tex]
    places = ((i, j, cell) for i, row in enumerate(cells, 1) for j, cell in enumerate(row, 1))
    return equation_lines(Equation(namer(i, j), cell) for i, j, cell in places)


def side_by_side(items: Sequence[LaidOut]) -> LaidOut:
    """Small matrices that share lines, as one quantity."""
    values, blanks = (tuple(chain.from_iterable(getattr(item, key) for item in items)) for key in ("values", "blanks"))
    return LaidOut(tuple(pack(item.box for item in items)), values=values, blanks=blanks)


def in_rows(quantities: Iterable[LaidOut]) -> Iterator[LaidOut]:
    """Quantities in their order; small neighbours share lines."""
    for is_small, group in groupby(quantities, key=lambda laid_out: laid_out.box != EMPTY):
        neighbours = list(group)
        yield from [side_by_side(neighbours)] if is_small else neighbours


BodyItem = tuple[Box, Entries, int]  # what it is called, the quantity, the letter of its intermediate terms


def body_formulas(
    context: Context, items: Iterable[BodyItem], task: str = "", *, symmetric: bool = False
) -> Iterator[Block]:
    """Quantities of links and rotors in their order; small neighbours share lines. No generated function gives them."""
    small, body = context.layouter.small, context.dynamics.body
    quantities = (
        small(symbol, entry_namer(symbol), quantity)
        or replace(body(symbol, quantity, group, symmetric), box=EMPTY)  # which has lines of its own
        for symbol, quantity, group in items
    )
    for laid_out in in_rows(quantities):
        if laid_out.lines or not laid_out.omitted:
            yield replace(formula(context, laid_out, task=task), omitted=())
        if laid_out.omitted:
            yield context.answer("These entries are too long to print; multiplied out they have so many terms:")
            yield Rows(laid_out.omitted, is_answer=True)


def textbook(name: str, **values: object) -> Rows:
    """A formula as textbooks print it, such as c_ijk by the derivatives of B."""
    lines: list[str] = []
    for line in macro("textbook.tex.jinja", name, **values).splitlines():
        if line.startswith(" "):
            lines[-1] += f" {line.strip()}"
        elif line:
            lines.append(line)
    return Rows(tuple(lines))
