"""Which places an arm reaches, by the square roots of its inverse kinematics: the exact boundary of its workspace.

An equation A cos + B sin = C has a real solution where C^2 <= A^2 + B^2. Where the pose stands on one side of that
alone, it says how far the wrist (or the end effector) may be from a point, an axis or a plane: a planar arm reaches
what lies between |a1 - a2| and a1 + a2 from its base. Joints are supposed to have no limits.

Sources: Siciliano et al., Robotics, section 2.12 (inverse kinematics of arms and wrists); Craig, Introduction to
Robotics, section 4.2 (existence of solutions).
"""

import random
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import mpmath
import numpy as np
import sympy

from derive.inverse.closed.nodes import NodeKind
from derive.inverse.closed.solve import Freedom
from derive.inverse.numeric.chain import Array
from derive.inverse.words.elementary import Numbers, PrintedLine, array_value, is_negative, with_lines
from derive.inverse.words.solutions import InverseKinematics, inverse_kinematics, parameter_numbers
from derive.lecture.point import DIGITS, value_of, written
from derive.lecture.sympy_conversion import Expr
from derive.robot.options.inverse import POSE, InverseOptions, Task
from derive.robot.options.style import Style
from derive.robot.robot import Robot

# Arms of up to so many joints are asked for a position, and not for a pose that they reach in one orientation only.
LARGEST_FREE = 3
# Positions in space, then in a plane.
_POSITIONS: tuple[Task, ...] = (("x", "y", "z"), ("x", "y"), ("x", "z"), ("y", "z"))


@dataclass(frozen=True)
class Bound:
    """Between which values a quantity of the pose has to be, for one unknown to be real."""

    unknown: Expr  # the joint variable, or sum of them, that is real there
    quantity: Expr  # the quantity, a polynomial of the pose
    least: Expr | None  # its least value; None where there is none
    most: Expr | None  # its largest value; None where there is none
    radii: tuple[Expr | None, Expr | None] | None  # square roots of both, where the quantity is a sum of squares

    @property
    def has_symbols(self) -> bool:
        """Whether its ends hold parameters, and not numbers alone."""
        return any(end.free_symbols for end in (self.least, self.most) if end is not None)

    @property
    def coordinates(self) -> int:
        """Of how many coordinates the quantity is made."""
        return len(self.quantity.free_symbols) if self.radii is None else len(sympy.Add.make_args(self.quantity))


@dataclass(frozen=True, eq=False)
class Reach:
    """The workspace of an arm without joint limits, as far as formulas say it."""

    inverse: InverseKinematics  # the inverse kinematics that it is read off: of the position, for arms of few joints
    bounds: tuple[Bound, ...]  # what has to hold, all of it
    names: tuple[PrintedLine, ...]  # what the bounds are about: ``wx = px - d6*r13``, distances with their signs
    others: tuple[Expr, ...]  # unknowns whose conditions depend on the orientation, or on other joints
    is_flat: bool  # whether the end effector stays in a plane

    @property
    def is_whole(self) -> bool:
        """Whether the bounds are all that has to hold."""
        return self.inverse.is_explicit and not self.others

    def numbers(self, bound: Bound) -> tuple[Expr | None, Expr | None] | None:
        """Both ends of a bound in numbers (of radii, where it has any); None where the file has none of a parameter."""
        ends = bound.radii or (bound.least, bound.most)
        known = {sympy.Symbol(name) for name, _ in self.inverse.robot.parameters}
        if any(end is not None and not end.free_symbols <= known for end in ends):
            return None
        with mpmath.workdps(DIGITS):
            values = parameter_numbers(self.inverse.robot, random.Random(12))
            return tuple(None if end is None else written(value_of(end, dict(values))) for end in ends)  # type: ignore[return-value]

    def margins(self, poses: Array, values: Mapping[str, float]) -> list[tuple[Array, ...]]:
        """By signs of distances how far poses are within each bound, (k,): squares of lengths, positive inside."""
        known: Numbers = {sympy.Symbol(name): np.float64(value) for name, value in values.items()}
        known |= {self.inverse.pose[i, j]: poses[:, i, j] for i, j in product(range(3), range(4))}
        signs = list(dict.fromkeys(sign for line in self.names for sign in line.signs))
        found = []
        for choice in product((1.0, -1.0), repeat=len(signs)):
            own = with_lines({**known, **dict(zip(signs, map(np.float64, choice), strict=True))}, self.names)
            with np.errstate(invalid="ignore"):
                ends = ((b.quantity, *end) for b in self.bounds for end in ((b.least, 1.0), (b.most, -1.0)))
                gaps = ((array_value(x, own) - array_value(end, own), sign) for x, end, sign in ends if end is not None)
                sides = [sign * gap for gap, sign in gaps]
            found.append(tuple(np.broadcast_to(side, len(poses)) for side in sides))
        return found


def find_reach(robot: Robot, style: Style, own: InverseKinematics) -> Reach:
    """What an arm reaches."""
    if robot.n <= LARGEST_FREE and robot.inverse.task == POSE:
        task = next((task for task in _POSITIONS if len(task) == robot.n == Freedom(robot, task).rank), None)
        if task is not None:
            own = inverse_kinematics(replace(robot, inverse=InverseOptions(task)), style)
    return _Reading(own).reach()


class _Reading:
    """Reads the bounds off the equations of an inverse kinematics."""

    def __init__(self, found: InverseKinematics) -> None:
        self._found = found
        self._places = {found.pose[i, 3] for i in range(3)}
        self._places |= {line.symbol for line in found.definitions if str(line.symbol)[-1:] in ("x", "y", "z")}
        self._pose = set(found.pose.free_symbols) | {line.symbol for line in found.definitions}
        self._turned: list[tuple[Expr, dict[Expr, Expr], Expr, Expr]] = []
        self._names = list(found.definitions)
        self._values = parameter_numbers(found.robot, random.Random(12))

    def reach(self) -> Reach:
        bounds, others = [], []
        nodes = (node for node in self._found.graph.nodes for _ in node.unknowns)
        for node, step in zip(nodes, self._found.steps, strict=True):
            formula = node.formulas[0]
            if formula.kind in (NodeKind.CONIC, NodeKind.GENERAL):
                others.append(step.unknown)
            if formula.kind is NodeKind.QUADRATIC:
                a, b, c = (self._written(formula.equations[0].coefficient(k)) for k in (2, 1, 0))
                sides = (sympy.expand(b**2 - 4 * a * c), sympy.S.Zero)
            elif formula.kind is NodeKind.TYPE_2:
                a, b, right = (self._written(p) for p in formula.equations[0].linear)
                sides = (sympy.expand(a**2 + b**2), right)
            else:
                continue
            if sides[1] != 0 or formula.kind is NodeKind.QUADRATIC:
                bound = self._bound(step.unknown, *map(self._without_turns, sides))
                bounds += [] if bound is None else [bound]
                if bound is None and any(e.free_symbols & self._pose or e.has(sympy.sin, sympy.cos) for e in sides):
                    others.append(step.unknown)  # a condition on more than the geometry
            if formula.kind is NodeKind.TYPE_2 and len(node.unknown.joints) == 1:
                self._remember(node.unknown.joints[0], a, b, right, node.unknown.generators)
        # Distances along the turned arm, counted so that its offset is positive: (rho - a1)^2.
        for u, *_ in self._turned:
            parts = [term for bound in bounds for term in sympy.Add.make_args(bound.quantity) if term.has(u)]
            if parts and all(t.is_Pow and t.exp == 2 and self._number(t.base.subs(u, 0)) > 0 for t in parts):
                turned = {term: (u - term.base.subs(u, 0)) ** 2 for term in parts}
                bounds = [replace(bound, quantity=bound.quantity.xreplace(turned)) for bound in bounds]
        used = set[Expr]().union(*(bound.quantity.free_symbols for bound in bounds))
        for line in reversed(self._names):
            used |= line.value.free_symbols if line.symbol in used else set()
        names = tuple(line for line in self._names if line.symbol in used)
        is_flat = Freedom(self._found.robot, _POSITIONS[0]).rank == 2
        return Reach(self._found, tuple(bounds), names, tuple(others), is_flat)

    def _written(self, p: Any) -> Expr:
        return sympy.expand(self._found.written(p))

    def _remember(self, joint: int, a: Expr, b: Expr, right: Expr, generators: tuple[str, ...]) -> None:
        """From a c + b s = d for the first angle: u = b c - a s is the distance along the turned arm, +-sqrt(...)."""
        ring = self._found.graph.domain.ring
        c, s = (self._written(ring.generator(name)) for name in generators)
        variable = sympy.Symbol(self._found.robot.joints[joint].variable)
        turn = sympy.expand(a * c + b * s)
        cosine, sine = sympy.cos(variable), sympy.sin(variable)
        a, b = turn.coeff(cosine), turn.coeff(sine)
        first, second = (part.as_coeff_Mul() for part in (a, b))
        is_plain = {first[1], second[1]} <= self._places and first[1] != second[1] and abs(first[0]) == abs(second[0])
        if not is_plain or right.free_symbols & self._pose or right.has(sympy.sin, sympy.cos):
            return
        letters = {str(symbol) for symbol in (*self._pose, *self._values)}
        name = next(name for name in ("rho", "u", *(f"rho_{k}" for k in range(9))) if name not in letters)
        u = sympy.Symbol(name)
        # The choice that the solution makes at this joint.
        sign = next(line.signs[0] for line in self._found.lines if line.symbol == variable and line.signs)
        scale = abs(first[0])
        # (first, second) turned back by the angle: d/scale across the arm, u along it.
        put_in = {
            first[1]: (right / scale * cosine - u * sine) * scale / first[0],
            second[1]: (right / scale * sine + u * cosine) * scale / second[0],
        }
        square = sympy.expand(first[1] ** 2 + second[1] ** 2 - (right / scale) ** 2)
        self._turned.append((u, put_in, cosine, sine))
        self._names.append(PrintedLine(u, sign * sympy.sqrt(square)))
        self._places.add(u)
        self._pose.add(u)

    def _without_turns(self, e: Expr) -> Expr:
        """An expression of the pose turned back by the first angle, in distances along the turned arm."""
        for _, put_in, cosine, sine in self._turned:
            if not e.has(cosine, sine):
                continue
            c, s = sympy.symbols("c s", cls=sympy.Dummy)
            turned = sympy.expand(e.xreplace(put_in)).xreplace({cosine: c, sine: s})
            e = sympy.expand(sympy.rem(turned, c**2 + s**2 - 1, c).xreplace({c: cosine, s: sine}))
        return e

    def _bound(self, unknown: Expr, left: Expr, right: Expr) -> Bound | None:
        """right^2 <= left as a bound of one quantity; None where it depends on more than places, or on other joints."""
        more = self._pose - self._places | {sympy.Symbol(joint.variable) for joint in self._found.robot.joints}
        if any(e.has(sympy.sin, sympy.cos) or e.free_symbols & more for e in (left, right)):
            return None
        has_left, has_right = (bool(e.free_symbols & self._places) for e in (left, right))
        if has_right and not has_left:
            quantity, rest, scale = self._squares(right)
            least, most = self._ends(-rest, left / scale**2)
        elif has_left:
            quantity, rest, scale = self._squares(left if not has_right else sympy.expand(left - right**2))
            limit = (sympy.S.Zero if has_right else right**2 / scale) - rest
            least, most = (limit, None) if scale > 0 else (None, limit)
        else:
            return None
        if least is not None and self._number(least) <= 0 and self._is_sum_of_squares(quantity):
            least = None
        if least is None and most is None:
            return None
        radii = (self._root(least), self._root(most)) if self._is_sum_of_squares(quantity) else None
        return Bound(unknown, quantity, least, most, radii)

    def _squares(self, e: Expr) -> tuple[Expr, Expr, Expr]:
        """(quantity, rest, scale) of an expression scale*(quantity + rest); squares are completed."""
        # x^2 + b x = (x + b/2)^2 - b^2/4 for every coordinate with a plain square.
        places = sorted(self._places & e.free_symbols, key=str)
        p = sympy.Poly(e, *places)
        known = [c for c in (*[p.coeff_monomial(x**2) for x in places], *p.coeffs()) if c.is_number and c != 0]
        scale = known[0] if known else sympy.S.One
        p = sympy.Poly(sympy.expand(e / scale), *places)
        rest = p.coeff_monomial(1)
        terms, taken = [], set()
        for x in places:
            slope = p.coeff_monomial(x)
            if p.coeff_monomial(x**2) == 1 and all(m[places.index(x)] == 0 or sum(m) <= 2 for m in p.monoms()):
                terms.append((x + slope / 2) ** 2)
                rest -= slope**2 / 4
                taken |= {x, x**2}
        powers = ((sympy.Mul(*(x**k for x, k in zip(places, own, strict=True))), c) for own, c in p.terms())
        terms += [c * m for m, c in powers if m != 1 and m not in taken]
        return sympy.Add(*terms), sympy.expand(rest), scale

    def _is_sum_of_squares(self, quantity: Expr) -> bool:
        return all(term.is_Pow and term.exp == 2 for term in sympy.Add.make_args(quantity))

    def _ends(self, middle: Expr, square: Expr) -> tuple[Expr, Expr]:
        """middle -+ sqrt(square), as (x -+ sqrt(y))^2 + rest where 4 x^2 y is the square and that makes it shorter."""
        if not (middle.free_symbols | square.free_symbols):
            return middle - sympy.sqrt(square), middle + sympy.sqrt(square)
        factors = sympy.factor_list(square / 4)
        # middle -+ 2 x sqrt(y) = (x -+ sqrt(y))^2 + rest: of all square divisors x^2 the one with the shortest rest.
        ways: list[tuple[int, int, Expr, Expr, Expr]] = []
        for powers in product(*(range(power // 2 + 1) for _, power in factors[1])):
            x = sympy.Mul(*(base**k for (base, _), k in zip(factors[1], powers, strict=True)))
            y = sympy.expand(sympy.cancel(square / 4 / x**2))
            rest = sympy.expand(middle - x**2 - y)
            ways.append((len(sympy.Add.make_args(rest)) if rest != 0 else 0, len(ways), x, y, rest))
        size, _, x, y, rest = min(ways, key=lambda way: way[:2])
        if size >= len(sympy.Add.make_args(middle)):
            return middle - sympy.sqrt(square), middle + sympy.sqrt(square)
        w = self._root(y)
        x = x if self._number(x) > 0 else -x
        return (x - w) ** 2 + rest, (x + w) ** 2 + rest

    def _root(self, e: Expr | None) -> Expr | None:
        """The root of what is not negative; of a square without an amount where a number of the file says its sign."""
        if e is None:
            return None
        if e.is_Pow and e.exp == 2:
            known = {sympy.Symbol(name) for name, _ in self._found.robot.parameters}
            terms = sympy.Add.make_args(e.base)
            is_sure = e.base.free_symbols <= known or not any(is_negative(term) for term in terms)
            return (e.base if self._number(e.base) >= 0 else -e.base) if is_sure else sympy.Abs(e.base)
        return sympy.sqrt(e)

    def _number(self, e: Expr) -> float:
        """Its value, with random positive lengths for parameters without a number."""
        with mpmath.workdps(DIGITS):
            return float(value_of(e, dict(self._values)))
