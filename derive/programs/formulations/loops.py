"""The passive joints of closed loops in a program: their positions, slopes and accelerations from the variables."""

from __future__ import annotations

from dataclasses import replace

from derive.inverse.closed.unknowns import turned
from derive.inverse.closed.walk import GraphWalk
from derive.inverse.loops.linkage import SolvedLoop, linkage, twists
from derive.programs.tape.derivative import derivative
from derive.programs.tape.field import ClosingField, ClosingWalk
from derive.programs.tape.graph import Graph
from derive.programs.tape.scalars import QD, Passive, Q, TapeDomain
from derive.programs.tape.value import Value
from derive.robot.coupling import coupling
from derive.robot.expression import Expression
from derive.robot.robot import Robot


def passive_joints(robot: Robot, graph: Graph) -> Passive:
    """The passive joints, loop by loop."""
    found, bare, matrix = Passive(), replace(robot, links=(), gravity=None), coupling(robot)
    for one in linkage(robot):
        domain = TapeDomain(robot, graph, passive=found)
        found = replace(found, numbers={**found.numbers, **_positions(one, domain)})
        domain = TapeDomain(robot, graph, passive=found)
        columns, _ = twists(bare, one, domain)
        others, determinant = [m for m in columns if m not in one.passive], one.determinant(columns)
        slopes: dict[Expression, Value] = {}
        for k, variable in enumerate(robot.variables):
            shares = [(m, domain.constant(matrix[m][k])) for m in others]
            right = [sum((columns[m][row] * share for m, share in shares), domain.number(0)) for row in one.rows]
            for p, numerator in zip(one.passive, one.numerators(columns, right), strict=True):
                if (name := dict(robot.joints[p].follows).get(variable.variable)) is not None:
                    slopes[name] = numerator / determinant
        found = replace(found, slopes={**found.slopes, **slopes})
        biases = _biases(robot, one, found, TapeDomain(robot, graph, passive=found))
        found = replace(found, biases={**found.biases, **biases})
    return found


def _positions(one: SolvedLoop, domain: TapeDomain) -> dict[int, tuple[Value, ...]]:
    """Cosine and sine, or length, of the variables of the passive joints of a loop."""
    # The three angles of a ball joint have singular poses where the ball itself has none.
    kind = GraphWalk if one.circuit.places.count(-1) > 1 else ClosingWalk
    run = one.walk(domain, ClosingField(domain), lambda place: domain.argument(Q, place), kind)
    numbers: dict[int, tuple[Value, ...]] = {}
    for place, shift, own in zip(one.circuit.places, one.graph.shifts, one.branch(run).joints, strict=True):
        if place in one.passive:
            constant = domain.cosine_sine(shift) if len(own) == 2 else domain.constant(shift)
            numbers[place] = turned(own, constant, -1) if isinstance(constant, tuple) else (own[0] - constant,)
    return numbers


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


def _biases(robot: Robot, one: SolvedLoop, passive: Passive, domain: TapeDomain) -> dict[int, Value]:
    """dG/dt qd: what the passive joints of a loop accelerate while the variables do not."""
    names = [variable.variable for variable in robot.variables]
    found: dict[int, Value] = {}
    for p in one.passive:
        follows = robot.joints[p].follows
        moved = derivative([passive.slopes[slope] for _, slope in follows], rates(robot, passive, domain))
        shares = (domain.variable(QD, names.index(name)) for name, _ in follows)
        found[p] = sum((a * b for a, b in zip(moved, shares, strict=True)), domain.number(0))
    return found
