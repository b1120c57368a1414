"""The values of the parameters: those of the file in the frames of the links, and the base parameters.

Standard and base parameters as text in the robot's own symbols, for generated files.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from derive.algebra.domain import PolynomialDomain, polynomial_expression
from derive.errors import ExpressionError
from derive.mechanics.chain import Body, Chain, Domain, build_chain
from derive.mechanics.joint_motion import axis
from derive.mechanics.regrouping import regroup
from derive.mechanics.vectors import S, Symmetric, Vector, scale, steiner
from derive.model.identification.base_parameters import BaseSet, absorbed_rotors
from derive.model.identification.column_relations import Coefficient
from derive.robot.description import Link, Motor
from derive.robot.expression import ZERO, Expression, add, multiply, power, to_text
from derive.robot.inertial_parameters import LINK_PARTS, Parameter
from derive.robot.robot import Robot


def standard_values(robot: Robot, parameters: Sequence[Parameter], domain: Domain[S]) -> list[S]:
    """The parameters as the file gives them, each link's in its DH frame, about the frame's origin."""
    bodies = [_body(link, domain) for link in robot.links]
    return [
        body_part(bodies[p.joint - 1], p.part) if p.of_link else joint_part(robot.links[p.joint - 1], p.part, domain)
        for p in parameters
    ]


def base_values(robot: Robot, base: BaseSet, domain: Domain[S], coefficient: Callable[[Coefficient], S]) -> list[S]:
    """The base parameters: what the general rule groups, and what the relations of the set add.

    Args:
        robot: The robot.
        base: Its base parameters.
        domain: The scalars.
        coefficient: A coefficient of a relation as a scalar.
    """
    values = grouped_values(robot, base, domain)
    for relation in base.relations:
        for parameter, factor in relation.terms:
            values[parameter] = values[parameter] + coefficient(factor) * values[relation.parameter]
    return [values[parameter] for parameter in base.parameters]


def grouped_values(robot: Robot, base: BaseSet, domain: Domain[S]) -> dict[Parameter, S]:
    """The parameters in joint frames after the general rule, those that the relations replace among them."""
    chain = _grouped_chain(robot, domain)
    every = [*base.parameters, *(relation.parameter for relation in base.relations)]
    values: dict[Parameter, S] = {}
    for p in every:
        link = robot.links[p.joint - 1]
        values[p] = body_part(chain.bodies[p.joint - 1], p.part) if p.of_link else joint_part(link, p.part, domain)
    for i, (ratio, inertia) in _absorbed(robot, domain).items():
        values[Parameter(i, "Ia")] = values[Parameter(i, "Ia")] + (ratio * ratio - ratio) * inertia
    return values


def _grouped_chain(robot: Robot, domain: Domain[S]) -> Chain[S]:
    """The arm without spinning rotors: links and the masses of rotors, and what absorbed rotors add to them."""
    still = replace(robot, links=tuple(_without_spin(link) for link in robot.links))
    chain = build_chain(still, domain)
    bodies = list(chain.bodies)
    z = chain.zero
    for i, (ratio, inertia) in _absorbed(robot, domain).items():
        bodies[i - 1] = bodies[i - 1] + _spinning(chain, (z, z, chain.one), ratio * inertia)
        if i > 1:
            bodies[i - 2] = bodies[i - 2] + _spinning(chain, axis(chain.joints[i - 1]), inertia - ratio * inertia)
    return regroup(replace(chain, bodies=tuple(bodies)))


def _absorbed(robot: Robot, domain: Domain[S]) -> Mapping[int, tuple[S, S]]:
    """By joint, ratio (counted along +z) and inertia of the rotors that links and armatures take over."""
    found: dict[int, tuple[S, S]] = {}
    for i in absorbed_rotors(robot):
        motor = robot.links[i - 1].motor or Motor()
        ratio, inertia = domain.constant(motor.ratio), domain.constant(motor.inertia)
        found[i] = (ratio if robot.joints[i - 1].sign > 0 else -ratio, inertia)
    return found


def _spinning(chain: Chain[S], u: Vector[S], inertia: S) -> Body[S]:
    """A body that resists turning about ``u`` alone: inertia u u^T."""
    z = chain.zero
    v = scale(inertia, u)
    tensor = Symmetric(v[0] * u[0], v[1] * u[1], v[2] * u[2], v[0] * u[1], v[0] * u[2], v[1] * u[2])
    return Body(z, (z, z, z), tensor)


def _without_spin(link: Link) -> Link:
    return link if link.motor is None else replace(link, motor=replace(link.motor, inertia=ZERO))


def _body(link: Link, domain: Domain[S]) -> Body[S]:
    constant = domain.constant
    mass = constant(link.mass)
    r = (constant(link.com[0]), constant(link.com[1]), constant(link.com[2]))
    tensor = Symmetric(*(constant(getattr(link.inertia, part)) for part in ("xx", "yy", "zz", "xy", "xz", "yz")))
    return Body(mass, scale(mass, r), tensor + steiner(mass, r))


def body_part(body: Body[S], part: str) -> S:
    """One of a body's ten parameters."""
    if part == "m":
        return body.mass
    if part in LINK_PARTS[1:4]:
        return body.first_moment["xyz".index(part[1])]
    value: S = getattr(body.inertia, part[1:])
    return value


def joint_part(link: Link, part: str, domain: Domain[S]) -> S:
    """Rotor, armature or friction."""
    motor = link.motor or Motor()
    cells = {"mm": motor.mass, "Im": motor.inertia, "Ia": link.armature, "b": link.viscous, "f": link.coulomb}
    return domain.constant(cells[part])


MAX_TEXT = 1000
"""Longest formula, in characters, that is written."""


class ParameterFormulas:
    """Formulas of a robot's parameters; empty where a cell is outside of what polynomials can hold.

    Args:
        robot: The robot.
        base: Its base parameters.
    """

    def __init__(self, robot: Robot, base: BaseSet) -> None:
        self._robot = robot
        self._base = base
        try:
            self._domain: PolynomialDomain | None = PolynomialDomain(robot, rates=False)
        except (ExpressionError, ZeroDivisionError):
            self._domain = None

    def standard(self, parameters: Sequence[Parameter]) -> list[str]:
        """What the file gives: ``m1*com1``."""
        domain = self._domain
        if domain is None:
            return [""] * len(parameters)
        values = standard_values(self._robot, parameters, domain)
        return [_text(polynomial_expression(value, domain)) for value in values]

    def base(self) -> list[str]:
        """What is grouped: ``Izz1 + a1**2*m2``."""
        domain = self._domain
        if domain is None:
            return [""] * len(self._base.parameters)
        values = grouped_values(self._robot, self._base, domain)
        sums = {p: [polynomial_expression(values[p], domain)] for p in self._base.parameters}
        for relation in self._base.relations:
            moved = polynomial_expression(values[relation.parameter], domain)
            for parameter, factor in relation.terms:
                sums[parameter].append(multiply(self._coefficient(factor), moved))
        return [_text(add(*terms)) for terms in sums.values()]

    def _coefficient(self, factor: Coefficient) -> Expression:
        assert self._base.domain is not None, "relations come with their ring"
        parts = (factor.numerator, factor.denominator)
        numerator, denominator = (polynomial_expression(p, self._base.domain) for p in parts)
        return multiply(numerator, power(denominator, -1))


def _text(formula: Expression) -> str:
    text = to_text(formula)
    return text if len(text) <= MAX_TEXT else ""
