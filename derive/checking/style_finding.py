"""The style of a book from some of its formulas: which options write most of them as they are printed.

Every printed formula is cut into parts that are written independently of each other, an equation of motion into what
multiplies accelerations and velocities, gravity and friction. A part depends on few options (`Style`). From each named
set the options are changed, one or two at a time, as long as more formulas come out in the printed form.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache, cached_property
from itertools import combinations, product

from derive.algebra.angles import contracted_groups
from derive.checking.formulas.findings import Finding, Outcome, Role
from derive.errors import Location
from derive.handouts.notation.printer import TextPrinter
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import compare, form_of, scalar_quantity
from derive.model.model import Model
from derive.model.quantity_names import parse
from derive.robot import expression as tree
from derive.robot.expression import Call, Expression, Sum, add, children, names, substitute
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.options.style import NAMED_STYLES, STYLE_OPTIONS, Contraction, Grouping, Rates, Style
from derive.robot.robot import Robot

_BODIES = ("products", "factors", "brackets")
_GRAVITY = ("products", "factors", "g")

# The options that decide how a dynamic quantity is written; kinematic ones depend on what they contain.
OPTIONS_OF: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("B", "B_link"), ("inertia", *_BODIES)),
    "kinetic": ("inertia", *_BODIES, "kinetic"),
    "potential": ("potential", *_GRAVITY),
    "christoffel": ("christoffel", *_BODIES),
    **dict.fromkeys(("C", "N", "Bdot"), ("christoffel", *_BODIES, "coriolis")),
    "B_qdd": ("inertia", *_BODIES, "accelerations", "torques"),
    "Cqd": ("christoffel", *_BODIES, "velocities", "torques"),
    "g": ("gravity", *_GRAVITY),
}
# What the terms of an equation of motion are, and the quantity that they are.
_TORQUE_PARTS = {"accelerations": "B_qdd", "velocities": "Cqd", "gravity": "g", "friction": "friction"}


@dataclass(frozen=True, slots=True)
class Example:
    """A formula as a book prints it."""

    robot: Robot  # whose formula it is
    quantity: str  # the scalar that it is printed for, such as ``tau[1]``
    formula: Expression  # what is printed, in the robot's own names
    text: str = ""  # as it is printed
    location: Location = field(default_factory=lambda: Location("<example>"))  # where it stands


@dataclass(frozen=True, slots=True)
class ExampleVerdict:
    """What the style that was found makes of one printed formula.

    Attributes:
        quantity: What it is printed for, such as ``tau[1]``.
        outcome: ``same form``, ``equal`` where it is written otherwise, or ``wrong``.
        printed: The formula as printed.
        written: The derived formula in the style that was found.
        reason: Why it is not as printed: the options that would write it so, or that none do; empty where it is.
        place: File, line and column of the formula.
    """

    quantity: str
    outcome: str
    printed: str
    written: str
    reason: str
    place: str

    @property
    def reproduced(self) -> bool:
        """Whether it comes out as printed."""
        return self.outcome == Outcome.SAME_FORM.value


def printed_examples(findings: Iterable[Finding]) -> list[Example]:
    """The formulas that can be written in more than one way: those that contain a sum."""
    found = []
    for finding in findings:
        question, telling = finding.question, finding.role in (Role.PRINTED, Role.CORRECTION) and not finding.erratum
        known = finding.unknown is None and "^" not in finding.quantity  # no transpose, no inverse
        if telling and known and question is not None and _has_sum(question.printed):
            printed = substitute(question.printed, question.definitions)
            found.append(Example(question.robot, finding.entry, printed, finding.text, finding.location))
    return found


class StyleEvidence:
    """Examples and what is known of them: in which options' values each part comes out as printed."""

    def __init__(self, examples: Iterable[Example]) -> None:
        self.examples = tuple(examples)
        self._robots: dict[Robot, _StyledRobot] = {}
        self._parts: list[tuple[_ExamplePart, ...]] = []
        for example in self.examples:
            known = self._robots.setdefault(example.robot, _StyledRobot(example.robot))
            self._parts.append(tuple(_parts(known, example)))

    def best_style(self, without: int | None = None) -> Style:
        """The style in which most examples come out as printed."""
        known = [parts for i, parts in enumerate(self._parts) if i != without]
        found = [_improved(start, known) for start in NAMED_STYLES.values()]
        return max(found, key=lambda style: (*_score(style, known), -len(style.options())))

    def fits(self, i: int, style: Style) -> bool:
        """Whether a style writes an example as it is printed."""
        return all(part.fits(style) for part in self._parts[i])

    def reproduced(self, style: Style) -> int:
        """How many examples come out as printed."""
        return _score(style, self._parts)[0]

    def verdicts(self, style: Style) -> Iterator[ExampleVerdict]:
        """What a style makes of each example, in their order."""
        for example, parts in zip(self.examples, self._parts, strict=True):
            written = scalar_quantity(self._robots[example.robot].model(style), example.quantity)
            outcome, reason = Outcome.SAME_FORM, ""
            if different := [part for part in parts if not part.fits(style)]:
                outcome, reason = Outcome.EQUAL, "; ".join(_reason(part, style) for part in different)
                if not compare(example.robot, expression_from_sympy(written), example.formula).equal:
                    outcome, reason = Outcome.WRONG, "it is not equal to the derived formula"
            text, place = TextPrinter(example.robot).doprint(written), str(example.location)
            yield ExampleVerdict(example.quantity, outcome.value, example.text, text, reason, place)


def _improved(style: Style, known: Sequence[tuple[_ExamplePart, ...]]) -> Style:
    """Options changed as some part asks for it, as long as that makes more parts and examples come out as printed."""
    best = _score(style, known)
    while True:
        # steepest ascent: of all changes that some part asks for, the one after which most examples fit
        different = [part for parts in known for part in parts if not part.fits(style)]
        moves = {move for part in different for move in part.remedies(style)}
        # in a fixed order, so that of equally good moves the same is made everywhere
        trials = [(_score(move, known), -len(move.options()), str(move), move) for move in moves]
        score, _, _, improved = max(trials, key=lambda trial: trial[:3], default=(best, 0, "", style))
        if score <= best:
            return style
        best, style = score, improved


def _score(style: Style, known: Iterable[tuple[_ExamplePart, ...]]) -> tuple[int, int]:
    """How many examples, and how many parts of them, come out as printed."""
    fits = [[part.fits(style) for part in parts] for parts in known]
    return sum(map(all, fits)), sum(map(sum, fits))


class _StyledRobot:
    """A robot written in many styles; what does not depend on the style is derived once."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.model, self.form = robot, cache(self._model), cache(self._form)
        self._exact: dict[Contraction, Model] = {}

    @cached_property
    def lengths(self) -> frozenset[str]:
        """Symbols of the table and prismatic variables, all that is no angle in a kinematic formula."""
        angles = {joint.variable for joint in self.robot.movers if joint.is_revolute}
        cells = [cell for joint in self.robot.joints for cell in (joint.a, joint.d)]
        cells += [cell for link in self.robot.links for cell in link.com]
        cells += [row[3] for matrix in (self.robot.base, self.robot.tool) for row in matrix]
        return frozenset(name for cell in cells for name in names(cell)) - angles

    def _model(self, style: Style) -> Model:
        exact = self._exact.get(style.contraction) or Model(self.robot, style)
        return self._exact.setdefault(style.contraction, exact).with_style(style)

    def _form(self, quantity: str, style: Style) -> object:
        return form_of(expression_from_sympy(scalar_quantity(self.model(style), quantity)))


class _ExamplePart:
    """A part of an example that is written independently of the others."""

    def __init__(
        self, title: str, printed: Expression, robot: _StyledRobot, quantity: str, options: tuple[str, ...]
    ) -> None:
        self.title, self.options = title, options
        self._form, self._robot, self._quantity = form_of(printed), robot, quantity
        self._fits: dict[tuple[StrEnum, ...], bool] = {}

    def fits(self, style: Style) -> bool:
        """Whether it comes out as printed."""
        key = tuple(getattr(style, name) for name in self.options)
        if key not in self._fits:
            alone = _effective(Style().changed(dict(zip(self.options, key, strict=True))), self.options)
            self._fits[key] = self._robot.form(self._quantity, alone) == self._form
        return self._fits[key]

    def remedies(self, style: Style) -> list[Style]:
        """The styles with the fewest changes, one or two, in which it comes out as printed."""
        for count in (1, 2):
            chosen = (
                style.changed(dict(zip(some, values, strict=True)))
                for some in combinations(self.options, count)
                for values in product(*(STYLE_OPTIONS[name] for name in some))
            )
            if found := [trial for trial in chosen if self.fits(trial)]:
                return found
        return []


def _effective(style: Style, options: tuple[str, ...]) -> Style:
    """A style without options that others leave without effect, so that equal forms are written once."""
    for rates, grouping in (("accelerations", "inertia"), ("velocities", "christoffel")):
        if rates in options and "torques" in options:
            chosen = getattr(style, grouping) if style.torques is Grouping.USUAL else style.torques
            if getattr(style, rates) in (Rates.TERM, Rates.GEOMETRY):
                style, chosen = style.changed({name: getattr(Style(), name) for name in _BODIES}), Grouping.USUAL
            style = style.changed({"torques": Grouping.USUAL, grouping: chosen})
    return style


def _parts(known: _StyledRobot, example: Example) -> Iterator[_ExamplePart]:
    quantity, indices, entry = parse(known.model(Style()), example.quantity)
    # whether axes that are parallel but opposed could be contracted
    aligned, opposed = (contracted_groups(example.robot, which) for which in (Contraction.ALIGNED, Contraction.OPPOSED))
    contraction = ("contraction",) if opposed != aligned else ()
    if quantity.name == "tau":
        printed = _by_rates(example.robot, example.formula)
        for title, name in _TORQUE_PARTS.items():
            whole = f"{name}[{(entry or indices)[0]}]"
            yield _ExamplePart(title, printed[title], known, whole, (*OPTIONS_OF.get(name, ()), *contraction))
        return
    is_kinematic = not quantity.dynamic or quantity.name.startswith("J")
    kinematic = ("positions" if known.lengths & set(names(example.formula)) else "rotations", "short")
    options = OPTIONS_OF.get(quantity.name, kinematic if is_kinematic else ())
    yield _ExamplePart("", example.formula, known, example.quantity, (*options, *contraction))


def _by_rates(robot: Robot, formula: Expression) -> dict[str, Expression]:
    """An equation of motion term by term: accelerations, velocities, gravity, friction."""
    variables = [joint.variable for joint in robot.movers]
    accelerations, velocities = set(map(acceleration_name, variables)), set(map(velocity_name, variables))
    frictional = {name for link in robot.links for cell in (link.viscous, *link.dry) for name in names(cell)}
    found: dict[str, list[Expression]] = {title: [] for title in _TORQUE_PARTS}
    for term in (tree.multiply(tree.number(factor), term) for factor, term in tree.linear_terms(formula)):
        used = set(names(term))
        moving = "friction" if used & frictional else "velocities"
        found["accelerations" if used & accelerations else moving if used & velocities else "gravity"].append(term)
    return {title: add(*terms) for title, terms in found.items()}


def _reason(part: _ExamplePart, style: Style) -> str:
    """Which options would write a part as printed."""
    subject = f"the terms of {part.title}: " if part.title else ""
    if not (remedies := part.remedies(style)):
        return f"{subject}grouped as no options do"
    remedy = min(remedies, key=lambda trial: (len(trial.options()), str(trial)))
    values = {name: getattr(remedy, name) for name in STYLE_OPTIONS}
    changes = ", ".join(f"{name}: {value}" for name, value in values.items() if value is not getattr(style, name))
    return f"{subject}as printed with {changes}, which fewer of the other formulas have"


def _has_sum(e: Expression) -> bool:
    return not isinstance(e, Call) and (isinstance(e, Sum) or any(map(_has_sum, children(e))))
