"""A solution graph as the lines of a textbook: each step with its equation, whence it comes, and the formulas.

The pose is written by its entries, ``r11`` to ``r33`` and ``px``, ``py``, ``pz``; where base, tool or offsets of the
first and last joint stand between it and the arm, the pose within the arm gets names of its own first: of a wrist with
``d6`` the wrist centre, ``wx = px - d6*r13``.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction

import sympy

from derive.algebra.angles import decompose
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind as Generator
from derive.algebra.ring import Polynomial
from derive.inverse.closed.graph import Node, SolutionGraph
from derive.inverse.closed.nodes import NodeEquation, NodeFormula, NodeKind, Provenance, Unknown
from derive.inverse.closed.pose import is_plain
from derive.inverse.closed.unknowns import POSE_NAMES
from derive.inverse.words.elementary import Linear, PrintedLine, Scribe, Solved, is_negative, minus_signs, usual
from derive.lecture.form import LectureForm
from derive.lecture.sympy_conversion import Expr
from derive.robot.description import Convention
from derive.robot.expression import ZERO, Expression, Name, Number, add, multiply, substitute
from derive.robot.names import joint_label, robot_symbols
from derive.robot.options.style import Contraction, Style
from derive.robot.robot import Robot

# The last matrix of a product, and the rows of its fourth column that are meant; None where there is no such product.
Seen = tuple[int, tuple[int, ...]] | None


class OriginForm(StrEnum):
    """What is made of the entries."""

    ENTRY = "entry"  # one entry of the product
    SQUARES = "squares"  # several entries, squared and added
    COMPONENT = "component"  # a component of the vector between two axes, in the frame of one of them
    DISTANCE = "distance"  # the squared distance between points of two axes
    ROD = "rod"  # the squared distance between the ends of a rod
    DIRECTIONS = "directions"  # the rotation between two axes
    MOMENT = "moment"  # of p x R, or p.p R - 2 p (R^T p)^T: Raghavan and Roth, J. Mech. Des. 115(3), 1993


@dataclass(frozen=True)
class Origin:
    """Where an equation comes from."""

    form: OriginForm  # what is made of the entries
    first: int  # first matrix of the product A_first ... A_last, or the first of two axes, from 1
    last: int  # the last one; one less than the first where nothing is left of it
    entries: tuple[tuple[int, ...], ...]  # rows and columns, from 1; of a component its number alone
    inverse: bool = False  # whether of the inverse product; of a component, whether in the frame of the last axis
    has_base: bool = False  # whether the product begins with the base
    has_tool: bool = False  # whether it ends with the tool


def origin(robot: Robot, source: Provenance, *, to_end: bool, from_base: bool = False) -> Origin:
    """The origin of an equation."""
    name, places = source.entry, tuple(map(int, re.findall(r"\d", source.entry)))
    in_world = from_base and source.first == 1
    # What is constant between the rows is no part of a matrix of the table: then no entry of a product is named.
    has_table = not robot.is_tree
    match name[0]:
        case "R":
            found, (row, column) = Origin(OriginForm.DIRECTIONS, source.first, source.last, (places,)), places
            if robot.convention is Convention.MODIFIED and not in_world:
                row = _turned(robot.joints[source.first - 1].alpha, row)
            elif robot.convention is Convention.STANDARD and not (to_end and source.last == robot.n):
                column = _turned(robot.joints[source.last - 1].alpha, column)
            if row and column and has_table:
                found = replace(found, form=OriginForm.ENTRY, entries=((row, column),))
        case "r":
            found = Origin(OriginForm.ROD, source.first, source.last, ((1, 4), (2, 4), (3, 4)))
        case "m" | "k":
            found = Origin(OriginForm.MOMENT, source.first, source.last, (places,))
        case kind:
            form = OriginForm.COMPONENT if places else OriginForm.DISTANCE
            found = Origin(form, source.first, source.last, (places,), inverse=kind != "p")
            asked = robot, source, places, in_world
            seen = _position(*asked, to_end) if kind == "p" else _back(*asked)
            if seen is not None and all(seen[1]) and has_table:
                form = OriginForm.ENTRY if places else OriginForm.SQUARES
                found = replace(found, form=form, last=seen[0], entries=tuple((row, 4) for row in seen[1]))
    return replace(found, has_base=in_world, has_tool=to_end and source.last == robot.n)


def _position(robot: Robot, source: Provenance, places: tuple[int, ...], in_world: bool, to_end: bool) -> Seen:
    """The position at which M ends, seen from where it begins."""
    first, standard = source.first, robot.convention is Convention.STANDARD
    last = _end(robot, source, to_end, along=places == (3,))
    start, squares = robot.joints[first - 1], source.entry == "p.p"
    exact = last is not None
    if squares and not in_world:
        exact &= start.d == ZERO or not (start.is_revolute and (source.outer_left or first == 1))
    rows = places or ((1, 2, 3) if squares else (1, 2))
    if not standard and not in_world:
        exact &= start.a == ZERO or (not squares and source.entry != "p.xy")
        rows = tuple(_turned(start.alpha, row) for row in rows)
    return (last, rows) if exact and last is not None else None


def _end(robot: Robot, source: Provenance, to_end: bool, *, along: bool) -> int | None:
    """The last matrix of the shortest product that ends where M does, carried on to where nothing more is added."""
    joints, last = robot.joints, source.last
    joint = joints[last - 1]
    is_open = source.outer_right or (last == robot.n and not to_end)
    if to_end and last == robot.n:
        return last
    if robot.convention is Convention.STANDARD:
        if joint.is_revolute and (is_open or joint.d == ZERO):
            last -= 1
        elif joint.a != ZERO and not (along and source.first == last):  # a adds nothing along the axis of its joint
            return None
    elif joint.is_revolute and is_open and joint.d != ZERO:
        return None
    while last < robot.n and joints[last].is_revolute and joints[last].a == joints[last].d == ZERO:
        last += 1
    return last


def _back(robot: Robot, source: Provenance, places: tuple[int, ...], in_world: bool) -> Seen:
    """The position at which M begins, seen from where it ends."""
    first, last, standard = source.first, source.last, robot.convention is Convention.STANDARD
    begin, end = robot.joints[first - 1], robot.joints[last - 1]
    exact = in_world or not begin.is_revolute or begin.d == ZERO or not (source.outer_left or first == 1)
    rows = places or (1, 2)
    if standard:
        exact &= end.a == ZERO or bool(places)
        rows = tuple(_turned(end.alpha, row) for row in rows)
    else:
        exact &= begin.a == ZERO or in_world
    return (last, rows) if exact else None


def _turned(angle: Expression, index: int) -> int:
    """The number of an axis after a turn about x, 0 where it is none of the axes."""
    exact = decompose(angle)
    quarters = exact.pi_multiple * 2
    if index == 1:
        return 1
    if exact.terms or quarters.denominator != 1:
        return 0
    return index if quarters % 2 == 0 else 5 - index


# Entries of the upper three rows of a pose.
PLACES = tuple((row, column) for row in (1, 2, 3) for column in (1, 2, 3, 4))
_SYMBOLS = {Generator.VARIABLE, Generator.RATE, Generator.ACCELERATION, Generator.PARAMETER, Generator.PI}
_PLACE = re.compile(r"W\[(\d),(\d)\]")


def pose_names(robot: Robot) -> dict[tuple[int, int], str]:
    """What the entries of the pose are called: ``r11``, ..., ``px``, ``py``, ``pz``."""
    taken = {*robot_symbols(robot), *(joint.variable for joint in robot.joints)}
    for rotation, position in (("r", "p"), ("R", "P"), ("R_", "P_"), ("rot_", "pos_")):
        found = {(i, j): f"{position}{'xyz'[i - 1]}" if j == 4 else f"{rotation}{i}{j}" for i, j in PLACES}
        if taken.isdisjoint(found.values()):
            return found
    return {(i, j): f"pose_{i}{j}_{len(max(taken, key=len))}" for i, j in PLACES}


@dataclass(frozen=True)
class PrintedEquation:
    """The equation that a step solves."""

    left: Expr  # what holds the unknown
    right: Expr  # what is known
    origins: tuple[Origin, ...]  # where it comes from: two places where an unknown was eliminated from two equations


@dataclass(frozen=True)
class PrintedStep:
    """How one unknown is found."""

    unknown: Expr  # a joint variable, or a sum of them
    kind: NodeKind  # the elementary type
    equations: tuple[PrintedEquation, ...]  # what is solved
    lines: tuple[PrintedLine, ...]  # the formulas, the unknown last; none where there is no formula
    branches: int  # how many values it has for given ones before
    exists: Expr  # when it has any; SymPy's true where always
    fails: tuple[Expr, ...]  # what vanishes where these equations do not determine it; empty where they always do
    instead: tuple[tuple[PrintedEquation, ...], ...]  # other equations for those poses; none where it is free there
    free: tuple[Expr, ...]  # what vanishes where no equation determines it; empty where that never happens
    joints: tuple[int, ...]  # the joints of the unknown, from 0


class PrintedDerivation:
    """The lines of one graph: one step for each unknown, after the names of entries of the pose within the arm.

    `pose` has the symbols of its entries by row and column, `sums` the names of sums of joint variables that are found
    before these, ``q2 + q3`` -> ``q23``, and `conditions` what vanishes at every reachable pose.
    """

    def __init__(self, graph: SolutionGraph, robot: Robot, style: Style) -> None:
        self._graph, self._robot = graph, robot
        names = pose_names(robot)
        self.pose = {place: sympy.Symbol(name) for place, name in names.items()}
        variables = [joint.variable for joint in robot.joints]
        taken = {*robot_symbols(robot), *variables, *names.values(), "c", "s"}
        self._scribe = Scribe(self._write, taken, lambda p: not self._is_geometry(p))
        # what the pose within the arm has that no entry of the pose is, but for its sign
        within = {
            name: self._scribe.name((f"w{'xyz'[int(at[1]) - 1]}" if at[2] == "4" else f"w{at[1]}{at[2]}",))
            for name, p in graph.definitions
            if (at := _PLACE.fullmatch(name)) and not is_plain(p)
        }
        zero = dict(zip(variables, graph.shifts, strict=True))  # sums of angles have the sums of their shifts
        constants = (substitute(g.expression, zero) for g in graph.domain.generators if g.kind not in _SYMBOLS)
        extra = [*map(Name, (*names.values(), *within.values())), *graph.shifts, *constants]
        self._domain = PolynomialDomain(robot, extra, contraction=Contraction.OPPOSED, rates=False)
        self._form = LectureForm(self._domain, style=style)
        # What the generators of the graph's ring are, but those that are defined by others.
        shifted = {j.variable: add(Name(j.variable), s) for j, s in zip(robot.joints, graph.shifts, strict=True)}
        self._images = {f"T[{i},{j}]": self._domain.ring.generator(name) for (i, j), name in names.items()}
        for g in graph.domain.generators:
            if g.name not in POSE_NAMES:
                self._images[g.name] = self._domain.constant(substitute(g.expression, shifted))
        self._pose_names = {*names.values(), *within.values()}
        for name, p in graph.definitions:
            image = self._composed(p)
            if name in within:
                self._scribe.lines.append(PrintedLine(sympy.Symbol(within[name]), self._write(image)))
                image = self._domain.ring.generator(within[name])
            self._images[name] = image
        self.definitions = tuple(self._scribe.lines)
        self.sums = dict(self._named_sums())
        self.steps = tuple(step for node in graph.nodes for step in self._steps(node))
        self.conditions = tuple(self._condition(equation) for equation in graph.conditions)

    def _write(self, p: Polynomial) -> Expr:
        return self._form.kinematic(p)

    def written(self, p: Polynomial) -> Expr:
        """A polynomial of the graph as it is printed."""
        return self._write(self._composed(p))

    def _composed(self, p: Polynomial) -> Polynomial:
        ring = self._domain.ring
        images = (self._images.get(name, ring.zero).raw for name in self._graph.domain.ring.names)
        return ring.wrap(p.raw.compose(*images, ctx=ring.context))

    def _named_sums(self) -> Iterator[tuple[Expr, Expr]]:
        """``q23`` for q2 + q3; a letter where angles are subtracted or have no labels."""
        for unknown in (unknown for node in self._graph.nodes for unknown in node.unknowns):
            if len(unknown.joints) > 1:
                variables = [self._robot.joints[j].variable for j in unknown.joints]
                stem, labels = variables[0].removesuffix(joint_label(variables[0])), self._label(unknown)
                added = min(unknown.signs) > 0 and all(joint_label(v) and v.startswith(stem) for v in variables)
                letters = ((f"{stem}{labels}",) if added else ()) + ("alpha", "phi", "psi")
                yield self._symbol(unknown), sympy.Symbol(self._scribe.name(letters, labels))

    def _steps(self, node: Node) -> Iterator[PrintedStep]:
        formula = node.formulas[0]
        for unknown in node.unknowns:
            symbol = self._named(unknown)
            first = len(self._scribe.lines)
            solved: Solved | None = None
            equations: tuple[PrintedEquation, ...] = ()
            if formula.kind is NodeKind.SUM:
                solved = Solved(sympy.Add(*(sign * self._named(part) for part, sign in formula.parts)))
            elif formula.equations and unknown is node.unknown:
                printed = [self._equation(unknown, equation) for equation in formula.equations]
                printed.sort(key=lambda pair: [origin.entries for origin in pair[0].origins])
                equations = tuple(equation for equation, _ in printed)
                label, values = self._label(unknown), [own for _, own in printed]
                match formula.kind:
                    case NodeKind.TYPE_2:
                        solved = self._scribe.one_equation(label, values[0])
                    case NodeKind.TYPE_3:
                        solved = Solved(self._scribe.two_equations(symbol, label, values[0], values[1]))
                    case NodeKind.TYPE_1 | NodeKind.QUADRATIC:
                        solved = self._scribe.length(label, values[0])
            if solved is not None:
                self._scribe.lines.append(PrintedLine(symbol, solved.value))
                self._scribe.sums.update({total: name for total, name in self.sums.items() if name == symbol})
            lines = tuple(self._scribe.lines[first:])
            fails, free = self._free(node.formulas[:1]), self._free(node.formulas)
            others = node.formulas[1:] if fails and len(self._lost(formula)) == 1 else ()
            instead = tuple(tuple(self._equation(unknown, e)[0] for e in other.equations) for other in others)
            own = symbol, formula.kind, equations, lines, node.branches, (solved.exists if solved else sympy.true)
            yield PrintedStep(*own, fails, instead, free, unknown.joints)

    def _free(self, formulas: Sequence[NodeFormula]) -> tuple[Expr, ...]:
        """What vanishes where no formula determines its unknown; nothing where one always does."""
        found: dict[Expr, None] = {}
        for formula in formulas:
            ways = [[self._composed(p) for p in way] for way in self._lost(formula)]
            if not all(ways) or any(p and self._is_geometry(p) for way in ways for p in way):
                return ()
            written = [{self._positive(p): None for p in way if p} for way in ways]
            found.update(next((way for way in written if way.keys() <= found.keys()), written[0]))
        angles = [(e.func, e.args) for e in found]
        if any(func is sympy.sin and (sympy.cos, arguments) in angles for func, arguments in angles):
            return ()
        return tuple(sorted(found, key=lambda e: (e.count_ops(), str(e))))

    def _lost(self, formula: NodeFormula) -> list[tuple[Polynomial, ...]]:
        """The polynomials at whose common zeros a formula does not determine its unknown, in several ways to say it.

        Where of two equations one is the other turned by a right angle, these are the coefficients of one, or what
        stands on the right of both, which then vanish too.
        """
        if formula.kind is NodeKind.TYPE_2:  # 0 = C is no equation for the unknown only where C vanishes, too
            return [tuple(p for p in formula.equations[0].linear if p)]
        if formula.kind is not NodeKind.TYPE_3:
            return [formula.degenerate]
        (a, b, c), (d, e, g) = (equation.linear for equation in formula.equations)
        if not b or not a or not ((e == a and d == -b) or (e == -a and d == b)):
            return [formula.degenerate]
        if (a * a + b * b).is_constant:
            return [()]
        of_pose = [any(self._has_pose(self._composed(p).degrees()) for p in way) for way in ((a, b), (c, g))]
        return [(a, b), (c, g)] if of_pose == [True, False] else [(c, g), (a, b)]

    def _is_geometry(self, p: Polynomial) -> bool:
        """Whether a polynomial is one of the parameters alone, which an arm is supposed not to have zero."""
        moving = (Generator.SINE, Generator.COSINE, Generator.VARIABLE)
        degrees = p.degrees()
        moves = any(degree and g.kind in moving for g, degree in zip(self._domain.generators, degrees, strict=True))
        return not moves and not self._has_pose(degrees)

    def _symbol(self, unknown: Unknown) -> Expr:
        variables = (sympy.Symbol(self._robot.joints[j].variable) for j in unknown.joints)
        return sympy.Add(*(sign * q for sign, q in zip(unknown.signs, variables, strict=True)))

    def _named(self, unknown: Unknown) -> Expr:
        symbol = self._symbol(unknown)
        return self.sums.get(symbol, symbol)

    def _label(self, unknown: Unknown) -> str:
        return "".join(joint_label(self._robot.joints[j].variable) for j in unknown.joints)

    def _sum(self, unknown: Unknown, cells: Sequence[Expression]) -> Expression:
        """The cells of the joints of an unknown, added with their signs."""
        signed = zip(unknown.joints, unknown.signs, strict=True)
        return add(*(multiply(Number(Fraction(sign)), cells[j]) for j, sign in signed))

    def _equation(self, unknown: Unknown, equation: NodeEquation) -> tuple[PrintedEquation, Linear]:
        """An equation in the variable itself, and its coefficients: of A cos + B sin = C, or of r^2, r and 1."""
        shift, symbol = self._sum(unknown, self._graph.shifts), self._symbol(unknown)  # more than the variables
        if not unknown.is_angle:
            square, slope, rest = (self._composed(equation.coefficient(k)) for k in (2, 1, 0))
            by = self._domain.constant(shift)
            slope, rest = slope + 2 * by * square, rest + by * slope + by * by * square
            left = sympy.Add(self._write(square) * symbol**2, self._write(slope) * symbol)
            return PrintedEquation(left, self._write(-rest), self._origins(equation.source)), (square, slope, rest)
        named = self._named(unknown)
        is_letter = named != symbol and not str(named).endswith(self._label(unknown))
        cosine, sine = (f(named if is_letter else symbol) for f in (sympy.cos, sympy.sin))
        ring = self._domain.ring
        c, s = (ring.one, ring.zero) if shift == ZERO else self._domain.cosine_sine(shift)
        if max((sum(exponents) for exponents in equation.terms), default=0) > 1:
            # turned back by the shift
            of = self._write(c) * cosine - self._write(s) * sine, self._write(s) * cosine + self._write(c) * sine
            terms = ((self._write(self._composed(p)), i, j) for (i, j), p in sorted(equation.terms.items()))
            left = sympy.Add(*(p * of[0] ** i * of[1] ** j for p, i, j in terms))
            return PrintedEquation(left, sympy.S.Zero, self._origins(equation.source)), (ring.zero,) * 3
        a, b, known = map(self._composed, equation.linear)
        a, b = a * c + b * s, b * c - a * s
        size = self._scale(known, a, b) * (-1 if self._is_turned(a, b, known) else 1)
        a, b, known = (p * (1 / size) for p in (a, b, known))
        # As any other sum is written, a1*c1 + a2*c12, or with the one cosine and sine.
        c, s = self._domain.cosine_sine(self._sum(unknown, [Name(joint.variable) for joint in self._robot.joints]))
        whole, apart = self._write(a * c + b * s), sympy.Add(self._write(a) * cosine, self._write(b) * sine)
        left = whole if 3 * whole.count_ops() <= 2 * apart.count_ops() and not is_letter else apart
        return PrintedEquation(left, self._write(known), self._origins(equation.source)), (a, b, known)

    def _scale(self, *sides: Polynomial) -> Fraction:
        """What an equation is divided by, so that squares, else entries of the pose stand in it without a number."""
        posed = [term for p in sides for term in p.terms() if self._has_pose(term[0])]
        return usual(posed or next(p for p in sides if p).terms())

    def _is_turned(self, a: Polynomial, b: Polynomial, known: Polynomial) -> bool:
        """Whether an equation reads better with all signs changed: one term on its left, or the pose's, positive."""
        single = a if not b else b if not a else None
        if single is not None and len(single) == 1:
            return is_negative(self._write(single))
        signs = [coefficient for exponents, coefficient in known.terms() if self._has_pose(exponents)]
        balance = sum(1 if coefficient > 0 else -1 for coefficient in signs)
        if balance:
            return balance < 0
        plain, turned = (sum(minus_signs(self._write(e * p)) for p in (a, b, known)) for e in (1, -1))
        return bool(plain > turned)

    def _positive(self, p: Polynomial) -> Expr:
        """What is zero where a polynomial is: most coefficients are 1, most terms positive, no constant factor."""
        value = self._write(p * (1 / self._scale(p)))
        value = value.as_independent(*value.free_symbols, as_Add=False)[1]  # without sqrt(3) or cos(pi/18)
        return -value if is_negative(value) else value

    def _has_pose(self, exponents: tuple[int, ...]) -> bool:
        generators = zip(self._domain.generators, exponents, strict=True)
        return any(exponent and g.name in self._pose_names for g, exponent in generators)

    def _origins(self, source: Provenance) -> tuple[Origin, ...]:
        sources = (source, source.also) if source.also else (source,)
        graph = self._graph
        return tuple(origin(self._robot, each, to_end=graph.to_end, from_base=graph.from_base) for each in sources)

    def _condition(self, equation: NodeEquation) -> PrintedEquation:
        """``r33 = -1``, ``r12 = r21``: what holds nothing of the pose stands on the right, or one of two terms."""
        whole = self._positive(self._composed(equation.coefficient(*(0,) * len(next(iter(equation.terms))))))
        posed = {symbol.name for symbol in (*self.pose.values(), *(line.symbol for line in self.definitions))}
        terms = sorted(whole.args if whole.is_Add else (whole,), key=str)
        held = [term for term in terms if not posed.isdisjoint(symbol.name for symbol in term.free_symbols)]
        if len(held) == len(terms) == 2:
            held = [min(held, key=lambda term: len(term.free_symbols))]
        left = sympy.Add(*held)
        right = left - whole
        if is_negative(left):
            left, right = -left, -right
        return PrintedEquation(left, right, self._origins(equation.source))
