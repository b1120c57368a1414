"""The values of the parameters, as scalars of any kind and as text in the robot's own symbols for generated files."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from derive.algebra.domain import PolynomialDomain, polynomial_expression
from derive.algebra.quotients import Quotient
from derive.errors import ExpressionError
from derive.mechanics.chain import Body, Domain, body_in, build_chain, central_inertia, constant_vector, fixed_bodies
from derive.mechanics.joint_motion import axis
from derive.mechanics.regrouping import regroup
from derive.mechanics.vectors import S, axial_tensor, scale, steiner
from derive.model.identification.base_parameters import BaseSet, absorbed_rotors
from derive.robot.description import Motor
from derive.robot.expression import ZERO, Expression, add, multiply, power, to_text
from derive.robot.inertial_parameters import LINK_PARTS, Parameter, coulomb_parts
from derive.robot.robot import Robot

MAX_TEXT = 1000  # longest formula, in characters, that is written


def parameters_of(body: Body[S]) -> list[S]:
    """A body's ten parameters in the order of `LINK_PARTS`."""
    i = body.inertia
    return [body.mass, *body.first_moment, i.xx, i.yy, i.zz, i.xy, i.xz, i.yz]


def standard_values(robot: Robot, parameters: Sequence[Parameter], domain: Domain[S]) -> list[S]:
    """The parameters as the file gives them, each link's in its DH frame, about the frame's origin."""
    bodies = []
    for link in robot.links:
        mass, r = domain.constant(link.mass), constant_vector(link.com, domain)
        bodies.append(Body(mass, scale(mass, r), central_inertia(link, domain) + steiner(mass, r)))
    for i, frame, link in fixed_bodies(robot, domain):
        if i >= 0:
            bodies[i] = bodies[i] + body_in(frame, link, domain)
    return [_value(p, robot, bodies, domain) for p in parameters]


def base_values(robot: Robot, base: BaseSet, domain: Domain[S], coefficient: Callable[[Quotient], S]) -> list[S]:
    """The base parameters: what the general rule groups, and what the relations of the set add."""
    values = grouped_values(robot, base, domain)
    for relation in base.relations:
        for parameter, factor in relation.terms:
            values[parameter] = values[parameter] + coefficient(factor) * values[relation.parameter]
    return [values[parameter] for parameter in base.parameters]


def grouped_values(robot: Robot, base: BaseSet, domain: Domain[S]) -> dict[Parameter, S]:
    """The parameters in joint frames after the general rule."""
    # links and the masses of rotors, without their spin; what absorbed rotors add to links and armatures
    still = [one if one.motor is None else replace(one, motor=replace(one.motor, inertia=ZERO)) for one in robot.links]
    chain = build_chain(replace(robot, links=tuple(still)), domain)
    bodies, z, armatures = list(chain.bodies), chain.zero, dict[Parameter, S]()
    for i in absorbed_rotors(robot):
        motor = robot.links[i - 1].motor or Motor()
        ratio, inertia = domain.constant(motor.ratio), domain.constant(motor.inertia)
        ratio = ratio if robot.joints[i - 1].sign > 0 else -ratio
        # (w.u + k qd)^2 split as `absorbed_rotors` says: armature, link i, link i-1.
        armatures[Parameter(i, "Ia")] = (ratio * ratio - ratio) * inertia
        turning = axial_tensor(ratio * inertia, (z, z, chain.one))
        bodies[i - 1] = bodies[i - 1] + Body(z, chain.null, turning)
        if (before := chain.joints[i - 1].parent) >= 0:
            turning = axial_tensor(inertia - ratio * inertia, axis(chain.joints[i - 1]))
            bodies[before] = bodies[before] + Body(z, chain.null, turning)
    grouped = regroup(replace(chain, bodies=tuple(bodies))).bodies
    everything = (*base.parameters, *(relation.parameter for relation in base.relations))
    values = {p: _value(p, robot, grouped, domain) for p in everything}
    for p, added in armatures.items():
        values[p] = values[p] + added
    return values


def _value(p: Parameter, robot: Robot, bodies: Sequence[Body[S]], domain: Domain[S]) -> S:
    """One of a body's ten parameters, or that of a rotor, armature or friction."""
    if p.of_link:
        return parameters_of(bodies[p.joint - 1])[LINK_PARTS.index(p.part)]
    link = robot.links[p.joint - 1]
    motor = link.motor or Motor()
    cells = {"mm": motor.mass, "Im": motor.inertia, "Ia": link.armature, "b": link.viscous}
    cells |= coulomb_parts(link)
    return domain.constant(cells[p.part])


def standard_formulas(robot: Robot, parameters: Sequence[Parameter]) -> list[str]:
    """What the file gives, ``m1*com1``; empty where a cell is outside of what polynomials can hold."""
    try:
        domain = PolynomialDomain(robot, rates=False)
    except (ExpressionError, ZeroDivisionError):
        return [""] * len(parameters)
    return [_text(polynomial_expression(value, domain)) for value in standard_values(robot, parameters, domain)]


def base_formulas(robot: Robot, base: BaseSet) -> list[str]:
    """What is grouped, ``Izz1 + a1**2*m2``, one formula for each base parameter; empty as those of the file."""
    try:
        domain = PolynomialDomain(robot, rates=False)
    except (ExpressionError, ZeroDivisionError):
        return [""] * len(base.parameters)
    values = grouped_values(robot, base, domain)
    sums = {p: [polynomial_expression(values[p], domain)] for p in base.parameters}
    for relation in base.relations:
        moved = polynomial_expression(values[relation.parameter], domain)
        for parameter, factor in relation.terms:
            numerator, denominator = base.fraction(factor)
            sums[parameter].append(multiply(multiply(numerator, power(denominator, -1)), moved))
    return [_text(add(*terms)) for terms in sums.values()]


def _text(formula: Expression) -> str:
    text = to_text(formula)
    return text if len(text) <= MAX_TEXT else ""
