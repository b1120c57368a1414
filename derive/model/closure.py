"""How the passive joints of closed loops follow the variables: formulas of their positions and of their derivatives."""

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property, partial, reduce
from itertools import chain, combinations_with_replacement
from typing import Any

import mpmath
import numpy as np
import sympy
from sympy.simplify.fu import TR10i

from derive.algebra.domain import PolynomialDomain, polynomial_expression
from derive.algebra.ring import Polynomial
from derive.errors import QuantityError, listed
from derive.inverse.loops.closing import Closing, gaps, openings, reach, twists
from derive.inverse.loops.linkage import SolvedLoop, assembled, linkage, positions, slopes
from derive.inverse.words.elementary import PrintedLine, reduced, with_lines
from derive.inverse.words.solutions import InverseKinematics, Solution
from derive.lecture.point import DIGITS, KEPT, value_of
from derive.lecture.sympy_conversion import Expr, Matrix, expression_from_sympy, expression_to_sympy
from derive.model.kinematic_model import KinematicModel
from derive.robot.description import Joining, Loop, derivatives
from derive.robot.expression import Call, Expression, Name, Number, Power, add, multiply, names, number, substitute
from derive.robot.names import acceleration_name, robot_symbols, velocity_name
from derive.robot.robot import Robot

_LONG = 60  # operations of det J_p; a longer one of loops together is printed as the determinant of its entries


@dataclass(frozen=True)
class JoinedLoops:
    """Loops that are solved together, and the derivatives of their passive joints."""

    loops: tuple[Loop, ...]
    zeros: tuple[Expr, ...]  # factors of det J_p that move, or itself: no derivative has a value where one is zero
    names: tuple[str, ...]  # of the derivatives, G_q3_q1, and of the second ones, H_q3_q1_q1
    slope: Callable[[str], Expr]  # one by its name, a second one in the first: all of many variables take minutes

    @property
    def words(self) -> str:
        """Which rows are joined."""
        return "; ".join(f"{listed(loop.join)} are joined ({loop.by.value})" for loop in self.loops)


@dataclass(frozen=True, kw_only=True)
class LoopClosure(JoinedLoops):
    """One loop: its unknown joints are a serial arm whose pose the variables determine."""

    known: tuple[PrintedLine, ...]  # entries of its pose that the solution uses, in variables and parameters
    inverse: InverseKinematics  # of the arm, every branch
    solution: Solution  # the branch of the file, with what is known before it

    @property
    def surfaces(self) -> list[Expr]:
        """Of a point that three rods hold, what vanishes on two planes and a sphere; of other loops nothing."""
        if len(self.loops) == 1:
            return []
        x, own = sympy.Matrix([joint.variable for joint in self.inverse.robot.joints]), [y.symbol for y in self.known]
        given = self.inverse.pose[:3, :].applyfunc(lambda s: s if s in own else sympy.S.Zero)
        planes = [given[:, k].dot(x) + given[k, 3] for k in (0, 1)]
        return [*planes, x.dot(x) + 2 * given[:, 2].dot(x) + given[2, 3]]


@dataclass(frozen=True, kw_only=True)
class IteratedClosure(JoinedLoops):
    """Loops that are solved numerically."""

    passive: tuple[str, ...]  # the variables of their passive joints
    equations: tuple[Expr, ...]  # as many, zero where they close


@dataclass(frozen=True)
class Closure:
    """The closed loops of a robot, in the order in which they are solved."""

    robot: Robot
    loops: tuple[LoopClosure | IteratedClosure, ...]

    @property
    def G(self) -> Matrix:
        """First derivatives of the passive joints, a row each: qd_p = G qd, G = -J_p^-1 J_a, a column a variable."""
        return self._matrix([(q.variable,) for q in self.robot.variables])

    @property
    def H(self) -> Matrix:
        """Second ones, in the first by name, ``G_q3_q1``; a column for each pair of variables: q1 q1, q1 q2, q2 q2."""
        return self._matrix(list(combinations_with_replacement([q.variable for q in self.robot.variables], 2)))

    def _matrix(self, columns: Sequence[tuple[str, ...]]) -> Matrix:
        known = {name: one.slope for one in self.loops for name in one.names}
        named, size = derivatives(self.robot).items(), len(columns[0]) + 1
        entries = {by: known[name.name](name.name) for by, name in named if len(by) == size}
        rows = [joint.variable for joint in self.robot.passive]
        return sympy.ImmutableMatrix([[entries.get((row, *column), 0) for column in columns] for row in rows])

    @property
    def expressions(self) -> tuple[Expr, ...]:
        """Everything that is printed of it."""
        solved = [one for one in self.loops if isinstance(one, LoopClosure)]
        own = [e for one in self.loops for e in one.zeros]
        own += [e for one in self.loops if isinstance(one, IteratedClosure) for e in one.equations]
        own += [line.value for one in solved for line in one.known]
        return (*own, *(e for one in solved for e in one.inverse.expressions))

    def at(self, point: Mapping[str, Expression]) -> Matrix:
        """The positions of the passive joints at a point, a column [rad or m]; names where it lacks numbers."""
        full, names = self.completed(point), [joint.variable for joint in self.robot.passive]
        return sympy.ImmutableMatrix([expression_to_sympy(full.get(name, Name(name))) for name in names])

    def completed(self, point: Mapping[str, Expression], digits: int = KEPT) -> dict[str, Expression]:
        """A point with the positions of passive joints and their derivatives, where it has all numbers for them."""
        full, wanted = dict(point), {joint.variable: joint for joint in self.robot.passive}
        with mpmath.workdps(DIGITS):
            known = {sympy.Symbol(k): value_of(expression_to_sympy(e), {}) for k, e in point.items()}
            for one in self.loops:
                if isinstance(one, IteratedClosure):
                    known |= (roots := self._roots(one, known))
                    lines = {symbol: symbol for symbol in roots}
                else:
                    lines = {line.symbol: line.value for line in one.solution.lines}
                for symbol, formula in {**lines, **{sympy.Symbol(k): one.slope(k) for k in one.names}}.items():
                    try:
                        known[symbol] = value = value_of(formula, dict(known))
                    except (ArithmeticError, ValueError):
                        raise self._open(one) from None
                    name = str(symbol)
                    if not isinstance(value, sympy.Basic) and name in {*wanted, *one.names}:
                        if name in wanted and wanted[name].is_revolute:
                            value = mpmath.atan2(mpmath.sin(value), mpmath.cos(value))
                        full[name] = number(Fraction(mpmath.nstr(value, digits)))
        return full

    def _open(self, one: JoinedLoops) -> QuantityError:
        found = f"the loop of {self.robot.name} that joins {listed(one.loops[0].join)}, at this point"
        return QuantityError(f"{found}: it is open, or singular")

    def _roots(self, one: IteratedClosure, known: Mapping[Any, Any]) -> dict[Any, Any]:
        """The passive joints of loops that are solved numerically, with all digits; none where a number lacks."""
        names = [*(joint.variable for joint in self.robot.variables), *robot_symbols(self.robot)]
        try:
            numbers = {name: float(known[sympy.Symbol(name)]) for name in names}
        except (KeyError, TypeError):
            return {}
        q = [np.array([numbers[joint.variable]]) for joint in self.robot.variables]
        full, exists = positions(self.robot, linkage(self.robot), q, numbers)
        if not exists[0]:
            raise self._open(one)
        near = {joint.variable: x[0] for joint, x in zip(self.robot.joints, full, strict=True)}
        symbols = [sympy.Symbol(name) for name in one.passive]

        def _values(*roots: Any) -> list[Any]:
            return [value_of(e, {**known, **dict(zip(symbols, roots, strict=True))}) for e in one.equations]

        found = mpmath.findroot(_values, [mpmath.mpf(near[name]) for name in one.passive])
        return dict(zip(symbols, found, strict=True))


def find_closure(model: KinematicModel) -> Closure:
    """The loops of a robot in the notation of a model."""
    robot, domain, loops, found = model.robot, model.domain, linkage(model.robot), list[LoopClosure | IteratedClosure]()
    variables = {sympy.Symbol(joint.variable) for joint in robot.movers}
    for k, one in enumerate(loops):
        moving = slopes(robot, one, domain)
        both = {**moving.first, **moving.second}
        quotient = cache(partial(_quotient, domain, both, moving.determinant))
        # A factor that all have in common is one of the rows that were chosen, not of the loop.
        common = reduce(lambda p, q: p.gcd(q), (p.raw for p in moving.first.values()), moving.determinant.raw)
        factors = sympy.Mul.make_args(_contracted(domain, domain.ring.wrap(moving.determinant.raw / common)))
        zeros = tuple(f.as_base_exp()[0] for f in factors if not variables.isdisjoint(f.free_symbols))
        if len(one.loops) > 1 and sum(map(sympy.count_ops, zeros)) > _LONG:
            columns, _ = twists(robot, one, domain)
            entries = [[_contracted(domain, columns[p][row]) for p in one.passive] for row in one.rows]
            zeros = (sympy.Determinant(sympy.ImmutableMatrix(entries)),)
        joined = JoinedLoops(one.loops, zeros, tuple(both), quotient)
        rods = [loop.length for loop in one.loops if loop.by is Joining.DISTANCE]
        own = PolynomialDomain(robot, [*rods, *(Power(length, -1) for length in rods)], rates=False)
        if not isinstance(one, SolvedLoop):
            rows, _ = openings(robot, one, own)
            # Of a rod L^2 - |p_A - p_B|^2, twice the row of its velocity.
            scales = [2 if one.loops[row // 6].by is Joining.DISTANCE else 1 for row in one.rows]
            scaled = zip(scales, one.rows, strict=True)
            equations = tuple(_contracted(own, rows[row] * scale) for scale, row in scaled)
            passive = tuple(robot.joints[p].variable for p in one.passive)
            found.append(IteratedClosure(**vars(joined), passive=passive, equations=equations))
            continue
        inverse = InverseKinematics(one.graph, one.circuit.arm, model.style)
        used = sympy.Tuple(*inverse.expressions).free_symbols
        is_point = len(one.loops) > 1
        ring = (exact := own if is_point else domain).ring
        pose = zip(inverse.pose[:3, :], chain(*one.circuit.pose(exact).rows(ring.zero, ring.one)), strict=False)
        values = {symbol: entry for symbol, entry in pose if symbol in used}
        if is_point:
            known = tuple(PrintedLine(symbol, _contracted(own, entry)) for symbol, entry in values.items())
        else:
            known = tuple(PrintedLine(symbol, TR10i(model.form.kinematic(e))) for symbol, e in values.items())
        solution = _branch(robot, loops[: k + 1], inverse, known)
        inverse.conditions = ()  # a loop that closes meets them
        found.append(LoopClosure(**vars(joined), known=known, inverse=inverse, solution=solution))
    return Closure(robot, tuple(found))


def _branch(
    robot: Robot, loops: tuple[Closing, ...], inverse: InverseKinematics, known: tuple[PrintedLine, ...]
) -> Solution:
    """Which of the printed solutions is the branch of the file: the one whose numbers are those of its graph."""
    values, _, full, _ = assembled(robot, loops)
    names = [sympy.Symbol(joint.variable) for joint in robot.joints]
    unknown = {names[k]: full[k] for k in loops[-1].passive}
    others = {name: x for name, x in zip(names, full, strict=True) if name not in unknown}

    def _gap(solution: Solution) -> Any:
        own = {sympy.Symbol(name): np.float64(x) for name, x in values.items()} | others
        own = with_lines(own, solution.lines)
        gaps = [np.exp(1j * own[name]) - np.exp(1j * x) for name, x in unknown.items()]
        return np.nan_to_num(np.abs(gaps), nan=2.0).sum()

    return min((replace(each, lines=(*known, *each.lines)) for each in inverse.solutions), key=_gap)


def _contracted(domain: PolynomialDomain, p: Polynomial) -> Expr:
    """A polynomial with the angles of several branches added and subtracted: ``sin(q1 + q2 - q3)``."""
    return TR10i(sympy.expand(expression_to_sympy(polynomial_expression(p, domain))))


def _quotient(domain: PolynomialDomain, numerators: Mapping[str, Polynomial], below: Polynomial, name: str) -> Expr:
    """A derivative without common factors, as a sum or as one fraction, whichever is shorter."""
    top, bottom = (_contracted(domain, p) for p in reduced(numerators[name], below))
    size = bottom.as_coeff_Mul()[0]
    top, bottom = sympy.expand(top / size), bottom / size
    turns = sorted(top.atoms(sympy.sin, sympy.cos), key=str)
    return min(sympy.expand(top / bottom), sympy.collect(top, turns, sympy.factor) / bottom, key=sympy.count_ops)


# -- formulas of robots with closed loops where these are closed: what names of passive joints are, and what is free


class OnClosure:
    """The closed configurations of one robot, in the branch of its file."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self._closure = robot, find_closure(KinematicModel(robot))
        self._loops = self._closure.loops
        self.angles = {joint.variable for joint in robot.passive if joint.is_revolute}
        self.free = (*(each.variable for each in robot.variables), *robot_symbols(robot))
        self.reach = partial(reach, robot)  # of a point, further than which no slide goes [m]
        self._derivative = cache(self._find_derivative)

    def closes(self, point: Mapping[str, Fraction]) -> bool:
        """Whether the branch can be assembled with these numbers of variables and symbols."""
        q = [np.array([float(point[each.variable])]) for each in self.robot.variables]
        _, exists = positions(self.robot, linkage(self.robot), q, {name: float(x) for name, x in point.items()})
        return bool(exists[0])

    def roots(self, point: Mapping[str, Fraction]) -> dict[str, Fraction]:
        """The positions that have no formulas, where the branch can be assembled."""
        wanted = [name for one in self._loops if isinstance(one, IteratedClosure) for name in one.passive]
        full = self._closure.completed({name: number(x) for name, x in point.items()}, DIGITS) if wanted else {}
        numbers = {name: full[name] for name in wanted}
        return {name: cell.value for name, cell in numbers.items() if isinstance(cell, Number)}

    def meaning(self, name: str) -> Expression | None:
        """What a name of passive joints is in the branch of the file; None where it is free."""
        return self._positions.get(name) or self._derivative(name)

    @cached_property
    def _positions(self) -> Mapping[str, Expression]:
        """The lines that lead to the passive joints; other unknowns have names in brackets, which no user's has."""
        passive, found = {joint.variable for joint in self.robot.passive}, dict[str, Expression]()
        for k, one in enumerate(self._loops):
            if isinstance(one, IteratedClosure):
                continue
            lines = [(str(line.symbol), expression_from_sympy(line.value)) for line in one.solution.lines]
            own = {name: Name(f"({k} {name})") for name, _ in lines if name not in passive}
            found |= {own.get(name, Name(name)).name: substitute(value, own) for name, value in lines}
        return found

    def solved(self, name: str) -> Expression:
        """The position of a passive joint in one formula, in those that are solved before it and free names."""
        if name not in self._positions:
            raise QuantityError(f"a formula of {name}: its loops are solved numerically", remedy="compare G instead")
        e = self._positions[name]
        while inner := {name: self._positions[name] for name in names(e) if name.startswith("(")}:
            e = substitute(e, inner)
        return e

    def _find_derivative(self, name: str) -> Expression | None:
        """What G, H, a velocity or an acceleration of passive joints is in other names; None of the rest."""
        slopes = (one.slope(name) for one in self._loops if name in one.names)
        return self._rates.get(name) or next(map(expression_from_sympy, slopes), None)

    @cached_property
    def _rates(self) -> Mapping[str, Expression]:
        """qd_p = G qd, and qdd_p = G qdd + qd^T H qd."""
        terms = defaultdict[str, list[Expression]](list)
        for (joint, *by), name in derivatives(self.robot).items():
            moved, velocities = velocity_name(joint), [Name(velocity_name(variable)) for variable in by]
            twice = number(len({*by}))  # a pair of different variables stands for both orders
            if len(by) == 1:
                terms[moved].append(multiply(name, *velocities))
                terms[velocity_name(moved)].append(multiply(name, Name(acceleration_name(by[0]))))
            else:
                terms[velocity_name(moved)].append(multiply(twice, name, *velocities))
        return {name: add(*parts) for name, parts in terms.items()}

    @cached_property
    def _lengths(self) -> tuple[tuple[str, Expression], ...]:
        """What closures, linear in lengths and slides, say of one each, in the order in which they are put in.

        The other names are free then, so that what is zero is so in every configuration of every branch.
        """
        domain, found = PolynomialDomain(self.robot, rates=False), list[tuple[str, Expression]]()
        slides = (each.variable for each in self.robot.passive if not each.is_revolute)
        known = list(map(sympy.Symbol, (*slides, *robot_symbols(self.robot))))
        for loop in self.robot.loops:
            ways = gaps(self.robot, loop, domain) if loop.by is not Joining.PRISMATIC else ()
            if loop.by is Joining.DISTANCE:  # a rod is as long as the way between its ends
                square, ways = polynomial_expression(sum((x * x for x in ways), domain.ring.zero), domain), ()
                for name, value in found:
                    square = substitute(square, {name: value})
                if isinstance(loop.length, Name) and loop.length.name not in {*names(square), *dict(found)}:
                    found.append((loop.length.name, Call("sqrt", (square,))))
            for gap in ways:
                equation = polynomial_expression(gap, domain)
                for name, value in found:
                    equation = substitute(equation, {name: value})
                whole = sympy.expand(sympy.numer(sympy.together(expression_to_sympy(equation))))
                parts = ((x, slope, sympy.expand(whole - slope * x)) for x in known if (slope := whole.coeff(x)) != 0)
                linear = [(x, factor, rest) for x, factor, rest in parts if not (factor.has(x) or rest.has(x))]
                if linear:
                    x, below, rest = min(linear, key=lambda part: sympy.count_ops(part[1]))
                    found.append((str(x), expression_from_sympy(-rest / below)))
        return tuple(found)

    def reduced(self, e: Expression) -> Expression:
        """A formula of free names alone, which in closed configurations has the same value."""
        while defined := {name: value for name in names(e) if (value := self._derivative(name)) is not None}:
            e = substitute(e, defined)
        for name, value in self._lengths:
            e = substitute(e, {name: value})
        return e
