"""The passive joints of closed loops in a program: their positions, slopes and accelerations from the variables."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from derive.inverse.closed.unknowns import turned
from derive.inverse.closed.walk import GraphWalk
from derive.programs.tape.derivative import derivative
from derive.programs.tape.field import ClosingField, ClosingWalk
from derive.programs.tape.graph import Graph
from derive.programs.tape.scalars import QD, Passive, Q, TapeDomain
from derive.programs.tape.value import Value
from derive.robot.expression import Expression
from derive.robot.robot import Robot


def passive_joints(robot: Robot, graph: Graph) -> Passive:
    """The passive joints, loop by loop: cosines and sines, or lengths, of their variables, G, and dG/dt qd."""
    found, bare = Passive(), replace(robot, links=(), gravity=None)
    if not robot.loops:
        return found
    from derive.inverse.loops.linkage import linkage, twists  # the inverse kinematics, which few programs need

    variables = [variable.variable for variable in robot.variables]
    for one in linkage(robot):
        domain, numbers = TapeDomain(robot, graph, passive=found), dict[int, tuple[Value, ...]]()
        # The three angles of a ball joint have singular poses where the ball itself has none.
        kind = GraphWalk if one.circuit.places.count(-1) > 1 else ClosingWalk
        _, leaf = one.walk(domain, ClosingField(domain), partial(domain.argument, Q), kind)
        for place, shift, own in zip(one.circuit.places, one.graph.shifts, leaf.joints, strict=True):
            if place in one.passive:
                constant = domain.cosine_sine(shift) if len(own) == 2 else domain.constant(shift)
                numbers[place] = turned(own, constant, -1) if isinstance(constant, tuple) else (own[0] - constant,)
        found = replace(found, numbers={**found.numbers, **numbers})
        domain = TapeDomain(robot, graph, passive=found)
        columns, _ = twists(bare, one, domain)
        determinant, numerators = one.determinant(columns), one.first(robot, columns, domain)
        slopes: dict[Expression, Value] = {name: numerator / determinant for name, numerator in numerators}
        found = replace(found, slopes={**found.slopes, **slopes})
        domain, biases = TapeDomain(robot, graph, passive=found), dict[int, Value]()
        for p in one.passive:
            names, own = zip(*robot.joints[p].follows, strict=True)
            moved = derivative([found.slopes[slope] for slope in own], rates(robot, found, domain))
            shares = (domain.variable(QD, variables.index(name)) for name in names)
            biases[p] = sum((a * b for a, b in zip(moved, shares, strict=True)), domain.number(0))
        found = replace(found, biases={**found.biases, **biases})
    return found


def rates(robot: Robot, passive: Passive, domain: TapeDomain) -> dict[Value, Value]:
    """The rates of the variables, and of the numbers of passive joints, with which values change in time."""
    found = {domain.variable(Q, k): domain.variable(QD, k) for k in range(robot.dof)}
    for place, numbers in passive.numbers.items():
        rate = domain.argument(QD, place)
        if len(numbers) == 1:
            found[numbers[0]] = rate
        else:
            cosine, sine = numbers
            found |= {cosine: -sine * rate, sine: cosine * rate}
    return found
