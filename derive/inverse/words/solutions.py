"""Inverse kinematics as a quantity of a model: how textbooks derive it, every branch, and the proof."""

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import chain, combinations, product
from typing import Any

import mpmath
import numpy as np
import sympy

from derive.errors import QuantityError, listed
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.graph import SolutionGraph
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.closed.solve import solve
from derive.inverse.words.derivation import PrintedDerivation
from derive.inverse.words.elementary import Numbers, PrintedLine, Sign, with_lines
from derive.inverse.words.postures import postures
from derive.lecture.point import DIGITS, value_of, written
from derive.lecture.sympy_conversion import Expr, Matrix, aligned_latex, expression_to_sympy
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.robot.expression import Expression
from derive.robot.names import robot_symbols
from derive.robot.options.inverse import Task
from derive.robot.options.style import Style
from derive.robot.robot import Robot

POSES = 3  # random reachable poses at which the solutions are put into T
_KEPT = 32  # arms that are kept for those who ask for them again: sheets in three languages say the same of one
CLOSE = mpmath.mpf(10) ** -25  # below it two numbers of fifty digits are equal: a double root costs half of the digits


def parameter_numbers(robot: Robot, rng: random.Random) -> Numbers:
    """Numbers of all parameters: those of the robot file, random ones for the others, with the precision of mpmath."""
    known: Numbers = {}
    for name, expression in robot.parameters:
        known[sympy.Symbol(name)] = value_of(expression_to_sympy(expression), dict(known))
    for name in robot_symbols(robot):
        known.setdefault(sympy.Symbol(name), mpmath.mpf(rng.randint(20, 90)) / 97)
    return known


class DigitsDomain(FloatDomain):
    """Cells of a robot and joint positions as numbers of mpmath, with its working precision."""

    functions = (mpmath.cos, mpmath.sin, mpmath.mpf)

    def __init__(self, robot: Robot, q: Sequence[Any], values: Numbers) -> None:
        super().__init__(robot, q, {})
        self._known = dict(values)

    def number(self, value: int | Fraction) -> Any:
        """A rational."""
        return self.functions[2](value.numerator) / value.denominator

    def constant(self, expression: Expression) -> Any:
        """The value of a cell."""
        return self.functions[2](value_of(expression_to_sympy(expression), self._known))

    def cosine_sine(self, angle: Expression) -> Any:
        """Cosine and sine of a constant angle."""
        value, number = expression_to_sympy(angle), self.functions[2]
        return tuple(number(value_of(function(value), self._known)) for function in (sympy.cos, sympy.sin))


class ArrayDomain(DigitsDomain):
    """The same at many configurations, as arrays of floats."""

    functions = (np.cos, np.sin, float)


@dataclass(frozen=True)
class Solution:
    """One branch."""

    name: str  # ``shoulder right, elbow up``; ``#3`` where words do not tell the third one from others
    signs: Mapping[Sign, int]  # the choices that lead to it
    lines: tuple[PrintedLine, ...]  # the formulas with these choices, in order
    joints: Mapping[Expr, Expr]  # the joint variables, in what the lines name

    @cached_property
    def explicit(self) -> dict[Expr, Expr]:
        """The joint variables in pose and parameters alone; long where the arm is."""
        known: dict[Expr, Expr] = {}
        for line in self.lines:
            value = line.value.xreplace(known)
            known[line.symbol] = value
            if line.symbol.is_Symbol and line.symbol in self.joints:
                known[sympy.cos(line.symbol)], known[sympy.sin(line.symbol)] = sympy.cos(value), sympy.sin(value)
        return {symbol: value.xreplace(known) for symbol, value in self.joints.items()}

    def numbers(self, values: Mapping[Expr, Any]) -> Numbers | None:
        """The numbers of all lines, with the working precision of mpmath; None where the branch does not exist."""
        known: Numbers = dict(values)
        found: Numbers = {}
        for line in self.lines:
            try:
                found[line.symbol] = known[line.symbol] = value_of(line.value, known)
            except (ArithmeticError, ValueError):
                return None
        return found


@dataclass(frozen=True)
class Degenerate:
    """Where an unknown is not determined: it is free then, and what follows only depends on the sum with it."""

    unknown: Expr  # the joint variable, or a sum of them
    conditions: tuple[Expr, ...]  # expressions that vanish together there


@dataclass(frozen=True)
class Verification:
    """What putting the solutions into T showed."""

    poses: int  # random reachable poses that were tried, with fifty digits
    branches: int  # real branches at them that reproduced T
    spurious: int  # real branches that did not: the task asks for them to be dropped
    found: bool  # whether the configuration that each pose was made of is among the solutions
    worst: float  # the largest difference of an entry


class InverseKinematics:
    """How the joint variables of an arm follow from its pose, every branch.

    Task and given joints are ``asked`` for where they are not those of the file.
    """

    def __init__(self, graph: SolutionGraph, robot: Robot, style: Style, asked: tuple[Any, ...] = ()) -> None:
        self.graph, self.robot = graph, robot
        self._origin = (robot, style, *asked)
        self._variables = [sympy.Symbol(joint.variable) for joint in robot.joints]
        printed = PrintedDerivation(graph, robot, style)
        # The number of solutions of a generic reachable pose, over the complex numbers; whether it is certain that none
        # is missing, and that no pose has more isolated ones.
        self.count, self.complete, self.everywhere = graph.count, graph.complete, graph.everywhere
        # Names for what base, tool and the offsets at both ends make of the pose (the wrist centre), how each unknown
        # is found, in order, and names of sums of joint variables: q2 + q3 -> q23.
        self.definitions, self.steps, self.sums = printed.definitions, printed.steps, printed.sums
        # What holds at reachable poses of an arm with fewer than six joints, and what writes polynomials of the graph.
        self.conditions, self.written, self._pose = printed.conditions, printed.written, printed.pose

    def __reduce__(self) -> tuple[Any, ...]:
        """It is derived again, once in each process: FLINT's polynomials cannot be pickled."""
        return inverse_kinematics, self._origin

    def __repr__(self) -> str:
        return f"<InverseKinematics of {self.robot.name}, {self.count} solutions>"

    @property
    def shape(self) -> tuple[int, int]:
        """Joints and solutions: entry (i, k) is joint i of solution k."""
        return self.robot.n, len(self.solutions)

    def __getitem__(self, place: tuple[int, int]) -> Expr:
        """A joint variable of a solution, in pose and parameters alone."""
        joint, solution = place
        return self.solutions[solution].explicit[sympy.Symbol(self.robot.joints[joint].variable)]

    def _repr_latex_(self) -> str:
        sides = ((line.symbol, " \\text{ or } ".join(map(sympy.latex, line.alternatives))) for line in self.lines)
        return aligned_latex([f"{sympy.latex(symbol)} = {right}" for symbol, right in sides])

    @property
    def lines(self) -> tuple[PrintedLine, ...]:
        """All formulas in order."""
        return (*self.definitions, *(line for step in self.steps for line in step.lines))

    @cached_property
    def named_lines(self) -> tuple[PrintedLine, ...]:
        """The same with the names of sums of angles, ``cos(q23)``, from where these are found."""
        known: dict[Expr, Expr] = {q: q for q in (self._variables[k] for k in self.graph.given)}  # found, by sum
        totals = {name: total for total, name in self.sums.items()}
        found = []
        for line in self.lines:
            calls = [(call, _from_known(call.args[0], known)) for call in line.value.atoms(sympy.sin, sympy.cos)]
            put_in = {call: call.func(angle) for call, angle in calls if angle is not None}
            found.append(PrintedLine(line.symbol, line.value.xreplace(put_in)))
            if line.symbol in self._variables or line.symbol in totals:
                known[totals.get(line.symbol, line.symbol)] = line.symbol
        return tuple(found)

    @property
    def expressions(self) -> tuple[Expr, ...]:
        """Everything that is printed of it."""
        equations = (e for step in self.steps for equation in step.equations for e in (equation.left, equation.right))
        return (*equations, *(line.value for line in self.lines), *(e for step in self.steps for e in step.free))

    @property
    def pose(self) -> Matrix:
        """The pose that is given, 4x4, in its symbols: ``r11``, ..., ``px``, ``py``, ``pz``."""
        return sympy.ImmutableMatrix([*[[self._pose[i, j] for j in (1, 2, 3, 4)] for i in (1, 2, 3)], [0, 0, 0, 1]])

    @property
    def is_point(self) -> bool:
        """Whether it is a point that three rods hold, on the line along two planes."""
        return bool(self.definitions) and not self.graph.task

    @property
    def degenerate(self) -> tuple[Degenerate, ...]:
        """Where an unknown is free."""
        return tuple(Degenerate(step.unknown, step.free) for step in self.steps if step.free)

    @property
    def is_explicit(self) -> bool:
        """Whether every step is a formula; a quartic or an eigenvalue problem is none."""
        return self.graph.is_closed and all(step.lines or step.kind is NodeKind.GIVEN for step in self.steps)

    @cached_property
    def solutions(self) -> tuple[Solution, ...]:
        """Every branch in closed form, named, as generated code has them; empty where there is none (`is_explicit`)."""
        if not self.is_explicit:
            return ()
        signs, unnamed = tuple(dict.fromkeys(sign for line in self.lines for sign in line.signs)), list[Solution]()
        for choice in product((1, -1), repeat=len(signs)):
            chosen = dict(zip(signs, choice, strict=True))
            put_in = {sign: sympy.Integer(e) for sign, e in chosen.items()}
            own = tuple(PrintedLine(line.symbol, line.value.xreplace(put_in)) for line in self.named_lines)
            written_out = {line.symbol: line.value for line in own}
            joints = {q: written_out[q] for q in self._variables if q in written_out}
            unnamed.append(Solution("", chosen, own, joints))
        if len(unnamed) == 1:
            return tuple(unnamed)
        if self.is_point:  # no pose of an arm would say on which side its branches are
            return tuple(replace(branch, name=f"#{k}") for k, branch in enumerate(unnamed, 1))
        found = postures(self.robot, self.graph)
        q = dict(zip(self._variables, found.q, strict=True))
        values = self.values_at({sympy.Symbol(k): float(x) for k, x in found.parameters.items()}, q, ArrayDomain)
        # The joint variables of each branch at many poses, not a number where it is not real.
        arrays = []
        for known in (with_lines(values, branch.lines) for branch in unnamed):
            angles = (np.broadcast_to(np.asarray(known.get(symbol, own)), own.shape) for symbol, own in q.items())
            arrays.append(np.stack(list(angles)))
        ordered = sorted(zip(found.places(arrays), unnamed, strict=True), key=lambda pair: pair[0])
        return tuple(replace(branch, name=found.names[k] or f"#{k + 1}") for k, branch in ordered)

    def at(self, point: Mapping[str, Expression]) -> Matrix:
        """All configurations that reach the pose of one, to thirty digits: a row a joint, a column a solution.

        The point has numbers of the joint variables and of parameters by name; one without is a `QuantityError`.
        """
        with mpmath.workdps(DIGITS):
            known = {sympy.Symbol(name): value_of(expression_to_sympy(value), {}) for name, value in point.items()}
            symbols = [*map(sympy.Symbol, robot_symbols(replace(self.robot, links=(), gravity=None))), *self._variables]
            missing = [str(symbol) for symbol in symbols if symbol not in known]
            if missing:
                found = f"the inverse kinematics needs a number for {listed(missing)}"
                raise QuantityError(found, remedy="give numbers of all joints and parameters")
            values = self.values_at(known, known)
            columns = []
            if not self.is_explicit:
                # By the graph run over floats, or by Newton's method where there is none.
                goal = np.array([[float(values.get(x, x)) for x in row] for row in self.pose.tolist()])
                floats = {str(symbol): float(x) for symbol, x in known.items() if symbol not in self._variables}
                given = [float(known[self._variables[k]]) for k in self.graph.given]
                every = InverseSolver.of(self.robot, self.graph, floats).solve(goal, given).q
                columns += [[written(mpmath.mpf(float(x))) for x in q] for q in every[np.isfinite(every).all(axis=-1)]]
            for solution in self.solutions:
                numbers = solution.numbers(values)
                if numbers is not None and self.error(values, numbers) < CLOSE:
                    columns.append([written(numbers.get(q, known[q])) for q in self._variables])
        return sympy.ImmutableMatrix(len(columns), self.robot.n, list(chain.from_iterable(columns))).T

    @cached_property
    def verified(self) -> Verification:
        """Every solution put into T, with fifty digits, at random reachable poses."""
        found, branches, spurious, worst = True, 0, 0, mpmath.mpf(0)
        with mpmath.workdps(DIGITS):
            rng, joints = random.Random(12), list(zip(self.robot.joints, self._variables, strict=True))
            for _ in range(POSES):
                # Numbers of parameters and of a reachable pose, and the configuration that it is made of.
                values, q, hit = parameter_numbers(self.robot, rng), Numbers(), False
                for joint, symbol in joints:
                    q[symbol] = mpmath.mpf(rng.randint(-300, 300) if joint.is_revolute else rng.randint(20, 90)) / 101
                values = self.values_at(values, q)
                for solution in self.solutions:
                    numbers = solution.numbers(values)
                    if numbers is None:
                        continue
                    error = self.error(values, numbers)
                    branches, spurious = branches + (error < CLOSE), spurious + (error >= CLOSE)
                    worst = max(worst, error) if error < CLOSE else worst
                    gaps = ((joint, q[x] - numbers.get(x, q[x])) for joint, x in joints)
                    # the same but for full turns
                    apart = [abs(2 * mpmath.sin(gap / 2)) if joint.is_revolute else abs(gap) for joint, gap in gaps]
                    hit = hit or max(apart) <= CLOSE
                found = found and hit
        return Verification(POSES, branches, spurious, found, float(worst))

    def values_at(self, values: Numbers, q: Numbers, domain: type[DigitsDomain] = DigitsDomain) -> Numbers:
        """Numbers of parameters, of the pose at a configuration q, and of the joints that are given."""
        end = forward_kinematics(self._chain(values, q, domain)).rows(0, 1)
        found = {symbol: number for symbol, number in values.items() if symbol not in self._variables}
        found |= {symbol: end[i - 1][j - 1] for (i, j), symbol in self._pose.items()}
        return found | {self._variables[k]: q[self._variables[k]] for k in self.graph.given}

    def _chain(self, values: Numbers, q: Numbers, domain: type[DigitsDomain] = DigitsDomain) -> Chain[Any]:
        robot = replace(self.robot, links=(), gravity=None)
        return build_chain(robot, domain(robot, [q[symbol] for symbol in self._variables], values))

    def error(self, values: Numbers, numbers: Numbers) -> Any:
        """The largest difference of an entry of the pose of `Solution.numbers` from that of `values_at`."""
        reached = forward_kinematics(self._chain(values, {**values, **numbers})).rows(0, 1)
        return max(abs(reached[i][j] - values[self._pose[i + 1, j + 1]]) for i, j in self.graph.places)


def _from_known(angle: Expr, known: Mapping[Expr, Expr]) -> Expr | None:
    """A sum of joint variables in the names of what is found, up to three of them; None where nothing need be done."""
    if all(symbol in known for symbol in angle.free_symbols):
        return None
    for size in (1, 2, 3):
        for parts in combinations(known.items(), size):
            for signs in product((1, -1), repeat=size):
                if sympy.Add(*(e * total for e, (total, _) in zip(signs, parts, strict=True))) == angle:
                    return sympy.Add(*(e * name for e, (_, name) in zip(signs, parts, strict=True)))
    return None


@lru_cache(_KEPT)
def inverse_kinematics(
    robot: Robot, style: Style, task: Task | None = None, given: tuple[int, ...] | None = None
) -> InverseKinematics:
    """How the joint variables of an arm follow from its pose, derived once for all who ask."""
    asked = () if task is None and given is None else (task, given)
    return InverseKinematics(solve(robot, task, given), robot, style, asked)
