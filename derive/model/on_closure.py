"""Formulas of robots with closed loops where these are closed: what names of passive joints are, and what is free."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from fractions import Fraction
from functools import cache, cached_property, partial

import numpy as np
import sympy

from derive.algebra.domain import PolynomialDomain, polynomial_expression
from derive.inverse.loops.linkage import gaps, linkage, positions, reach
from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy
from derive.model.closure import find_closure
from derive.model.kinematic_model import KinematicModel
from derive.robot.coupling import derivatives
from derive.robot.description import Joining
from derive.robot.expression import Expression, Name, add, multiply, names, number, substitute
from derive.robot.names import acceleration_name, robot_symbols, velocity_name
from derive.robot.robot import Robot


class OnClosure:
    """The closed configurations of one robot, in the branch of its file."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self._loops = robot, find_closure(KinematicModel(robot)).loops
        self.angles = {joint.variable for joint in robot.passive if joint.is_revolute}
        self.free = (*(each.variable for each in robot.variables), *robot_symbols(robot))
        self.reach = partial(reach, robot)  # of a point, further than which no slide goes [m]
        self._derivative = cache(self._find_derivative)

    def closes(self, point: Mapping[str, Fraction]) -> bool:
        """Whether the branch can be assembled with these numbers of variables and symbols."""
        q = [np.array([float(point[each.variable])]) for each in self.robot.variables]
        _, exists = positions(self.robot, linkage(self.robot), q, {name: float(x) for name, x in point.items()})
        return bool(exists[0])

    def meaning(self, name: str) -> Expression | None:
        """What a name of passive joints is in the branch of the file; None where it is free."""
        return self._positions.get(name) or self._derivative(name)

    @cached_property
    def _positions(self) -> Mapping[str, Expression]:
        """The lines that lead to the passive joints; other unknowns have names in brackets, which no user's has."""
        passive, found = {joint.variable for joint in self.robot.passive}, dict[str, Expression]()
        for k, one in enumerate(self._loops):
            lines = [(str(line.symbol), expression_from_sympy(line.value)) for line in one.solution.lines]
            own = {name: Name(f"({k} {name})") for name, _ in lines if name not in passive}
            found |= {own.get(name, Name(name)).name: substitute(value, own) for name, value in lines}
        return found

    def solved(self, name: str) -> Expression:
        """The position of a passive joint in one formula, in those that are solved before it and free names."""
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
            for gap in gaps(self.robot, loop, domain) if loop.by is not Joining.PRISMATIC else ():
                equation = polynomial_expression(gap, domain)
                for name, value in found:
                    equation = substitute(equation, {name: value})
                whole = sympy.expand(sympy.numer(sympy.together(expression_to_sympy(equation))))
                parts = (
                    (x, factor, sympy.expand(whole - factor * x)) for x in known if (factor := whole.coeff(x)) != 0
                )
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
