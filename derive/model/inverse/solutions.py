"""Inverse kinematics as a quantity of a model: how textbooks derive it, every branch, and the proof."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import mpmath
import sympy

from derive.lecture.sympy_conversion import Expr, Matrix, expression_to_sympy
from derive.model.inverse.derivation import Derivation, PrintedEquation, Step
from derive.model.inverse.elementary import Line, Sign
from derive.model.inverse.graph import SolutionGraph
from derive.model.inverse.nodes import Kind
from derive.model.point import DIGITS, value_of
from derive.robot.names import number_of, robot_symbols
from derive.robot.robot import Robot
from derive.robot.style import Style

Numbers = dict[Expr, Any]
"""Numbers of mpmath by symbol."""

POSES = 3
"""Random reachable poses at which the solutions are put into T."""

CLOSE = mpmath.mpf(10) ** -25
"""Below it two numbers of fifty digits are equal: a double root costs half of the digits."""


@dataclass(frozen=True)
class Solution:
    """One branch.

    Attributes:
        name: ``shoulder right, elbow up``; signs where the arm has no such words.
        signs: The choices that lead to it.
        lines: The formulas with these choices, in order.
        joints: The joint variables, in what the lines name.
    """

    name: str
    signs: Mapping[Sign, int]
    lines: tuple[Line, ...]
    joints: Mapping[Expr, Expr]

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
        """The joint variables in numbers, with the working precision of mpmath.

        Args:
            values: Numbers of the pose, of the parameters, and of joints that are given.

        Returns:
            Numbers of all lines; None where the branch does not exist.
        """
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
    """Where an unknown is not determined: it is free then, and what follows only depends on the sum with it.

    Attributes:
        unknown: The joint variable, or a sum of them.
        conditions: Expressions that vanish together there.
    """

    unknown: Expr
    conditions: tuple[Expr, ...]


@dataclass(frozen=True)
class Verification:
    """What putting the solutions into T showed.

    Attributes:
        poses: Random reachable poses that were tried, with fifty digits.
        branches: Real branches at them that reproduced T.
        spurious: Real branches that did not: the task asks for them to be dropped.
        found: Whether the configuration that each pose was made of is among the solutions.
        worst: The largest difference of an entry.
    """

    poses: int
    branches: int
    spurious: int
    found: bool
    worst: float


class InverseKinematics:
    """How the joint variables of an arm follow from its pose, every branch.

    Args:
        graph: The graph of its elementary equations.
        robot: The robot.
        style: How sums are grouped.
        T: The pose as a function of the joint variables, 4x4.
        frames: The joint frames in the world, 4x4 each, from the base to the last one.

    Attributes:
        graph: The graph of its elementary equations.
        robot: The robot.
        T: The pose as a function of the joint variables, 4x4.
    """

    def __init__(
        self, graph: SolutionGraph, robot: Robot, style: Style, T: Matrix, frames: Sequence[Matrix] = ()
    ) -> None:
        self.graph, self.robot, self.T, self._frames = graph, robot, T, tuple(frames)
        self._derivation = Derivation(graph, robot, style)

    def __repr__(self) -> str:
        return f"<InverseKinematics of {self.robot.name}, {self.count} solutions>"

    @property
    def pose(self) -> Matrix:
        """The pose that is given, 4x4, in its symbols: ``r11``, ..., ``px``, ``py``, ``pz``."""
        rows = [[self._derivation.pose[i, j] for j in (1, 2, 3, 4)] for i in (1, 2, 3)]
        return sympy.ImmutableMatrix([*rows, [0, 0, 0, 1]])

    @property
    def definitions(self) -> tuple[Line, ...]:
        """Names for what base, tool and the offsets at both ends of the arm make of the pose: the wrist centre."""
        return self._derivation.definitions

    @property
    def steps(self) -> tuple[Step, ...]:
        """How each unknown is found, in order."""
        return self._derivation.steps

    @property
    def sums(self) -> Mapping[Expr, Expr]:
        """Names of sums of joint variables: ``q2 + q3`` -> ``q23``."""
        return self._derivation.sums

    @property
    def count(self) -> int:
        """The number of solutions of a generic reachable pose, over the complex numbers: no pose has more."""
        return self.graph.count

    @property
    def complete(self) -> bool:
        """Whether it is certain that no solution is missing."""
        return self.graph.complete

    @property
    def conditions(self) -> tuple[PrintedEquation, ...]:
        """What holds at reachable poses of an arm with fewer than six joints."""
        return self._derivation.conditions

    @property
    def degenerate(self) -> tuple[Degenerate, ...]:
        """Where an unknown is free."""
        return tuple(Degenerate(step.unknown, step.free) for step in self.steps if step.free)

    @property
    def is_explicit(self) -> bool:
        """Whether every step is a formula; a quartic or an eigenvalue problem is none."""
        return self.graph.is_closed and all(step.lines or step.kind is Kind.GIVEN for step in self.steps)

    @cached_property
    def solutions(self) -> tuple[Solution, ...]:
        """Every branch in closed form, named; empty where the arm has none, see `is_explicit`."""
        if not self.is_explicit:
            return ()
        unnamed = tuple(self._branches())
        names = self._names(unnamed)
        return tuple(
            Solution(name, branch.signs, branch.lines, branch.joints)
            for name, branch in zip(names, unnamed, strict=True)
        )

    def _branches(self) -> Iterator[Solution]:
        lines = (*self.definitions, *(line for step in self.steps for line in step.lines))
        signs = tuple(dict.fromkeys(sign for line in lines for sign in line.signs))
        variables = [sympy.Symbol(joint.variable) for joint in self.robot.joints]
        for choice in product((1, -1), repeat=len(signs)):
            chosen = dict(zip(signs, choice, strict=True))
            put_in = {sign: sympy.Integer(e) for sign, e in chosen.items()}
            own = tuple(Line(line.symbol, line.value.xreplace(put_in).xreplace(self.sums)) for line in lines)
            values = {line.symbol: line.value for line in own}
            joints = {q: values[q] for q in variables if q in values}
            yield Solution(", ".join(f"{s}={e:+d}" for s, e in chosen.items()), chosen, own, joints)

    # -- in numbers

    @cached_property
    def verified(self) -> Verification:
        """Every solution put into T, with fifty digits, at random reachable poses."""
        found, branches, spurious, worst = True, 0, 0, mpmath.mpf(0)
        with mpmath.workdps(DIGITS):
            for values, q in self._samples(POSES):
                hit = False
                for solution in self.solutions:
                    numbers = solution.numbers(values)
                    if numbers is None:
                        continue
                    error = self._error(values, numbers)
                    branches, spurious = branches + (error < CLOSE), spurious + (error >= CLOSE)
                    worst = max(worst, error) if error < CLOSE else worst
                    hit = hit or self._same(q, numbers)
                found = found and hit
        return Verification(POSES, branches, spurious, found, float(worst))

    def _samples(self, poses: int) -> Iterator[tuple[Numbers, Numbers]]:
        """Numbers of parameters and of a reachable pose, and the configuration that it is made of."""
        rng = random.Random(12)
        given = number_of(self.robot)
        for _ in range(poses):
            values: Numbers = {}
            for name in robot_symbols(self.robot):
                number = expression_to_sympy(given[name]) if name in given else sympy.Rational(rng.randint(20, 90), 97)
                values[sympy.Symbol(name)] = value_of(number, {})
            q = {
                sympy.Symbol(joint.variable): mpmath.mpf(rng.randint(-300, 300) if joint.is_revolute else 40) / 101
                for joint in self.robot.joints
            }
            known = {**values, **q}
            for (i, j), symbol in self._derivation.pose.items():
                values[symbol] = value_of(self.T[i - 1, j - 1], known)
            for joint in self.graph.given:
                symbol = sympy.Symbol(self.robot.joints[joint].variable)
                values[symbol] = q[symbol]
            yield values, q

    def _error(self, values: Numbers, numbers: Numbers) -> Any:
        """The largest difference between the pose of a solution and the one that was asked for."""
        known = {**{s: v for s, v in values.items()}, **{s: v for s, v in numbers.items() if s.is_Symbol}}
        places = self._derivation.pose.items()
        return max(abs(value_of(self.T[i - 1, j - 1], known) - values[symbol]) for (i, j), symbol in places)

    def _same(self, q: Numbers, numbers: Numbers) -> bool:
        """Whether two configurations are the same but for full turns."""
        for joint in self.robot.joints:
            symbol = sympy.Symbol(joint.variable)
            gap = q[symbol] - numbers.get(symbol, q[symbol])
            if (abs(2 * mpmath.sin(gap / 2)) if joint.is_revolute else abs(gap)) > CLOSE:
                return False
        return True

    def _names(self, branches: Sequence[Solution]) -> list[str]:
        """Words for the branches where they hold at every sample, else their signs."""
        return [branch.name for branch in branches]
