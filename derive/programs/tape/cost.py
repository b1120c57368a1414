"""What a program costs, in each of the forms in which one is held: a graph, or polynomials that share variables.

`derive.programs.tape.tape.OPERATION_COST` says what an operation costs; a tape counts its operations itself
(`derive.programs.tape.tape.Operations`). Additions and multiplications are the unit.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from derive.programs.tape.build import reachable
from derive.programs.tape.graph import UNITS, Graph, Ref
from derive.programs.tape.tape import OPERATION_COST, Layer


@dataclass(frozen=True, order=True, slots=True)
class Cost:
    """The cost of a program that stands in a graph; programs are compared by their body, then by their hoisted work."""

    body: int  # of what is computed in every evaluation
    hoisted: int  # of what is computed once per set of run-time parameters
    nodes: int = field(compare=False)  # how many nodes were looked at to find this


def program_cost(graph: Graph, outputs: Sequence[Ref]) -> Cost:
    """The cost of some outputs, what they share counted once."""
    nodes = reachable(graph, outputs)
    costs = dict.fromkeys(Layer, 0)
    for i in nodes:
        costs[graph.layer[i]] += OPERATION_COST[graph.op[i]]
    return Cost(costs[Layer.BODY], costs[Layer.HOISTED], len(nodes))


def term_cost(monomial: tuple[int, ...], coefficient: Ref) -> int:
    """Multiplications of a coefficient and a product of variables."""
    return len(monomial) - (coefficient in UNITS) if monomial else 0


def polynomial_cost(polynomial: Mapping[tuple[int, ...], Ref]) -> int:
    """Multiplications and additions of a sum of products."""
    cost = len(polynomial) - 1
    for monomial, coefficient in polynomial.items():
        if monomial:
            cost += len(monomial) - (coefficient in UNITS)
    return cost if cost > 0 else 0
