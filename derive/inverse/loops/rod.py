"""The one unknown joint of a loop that a rod closes, by |p_A - p_B|^2 = L^2.

Seen from before that joint one end of the rod is where the variables put it, p. The other end moves with the joint and
is a vector linear in its cosine and sine, or in its length. The square of the distance is A cos + B sin + C of an angle
and a quadratic in a length: two solutions, real where the rod is long and short enough.
"""

from dataclasses import replace

from derive.inverse.closed.graph import Node, SolutionGraph
from derive.inverse.closed.nodes import NodeEquation, NodeFormula, NodeKind, Provenance
from derive.inverse.closed.unknowns import InverseDomain, baked, shifted, with_numbers
from derive.mechanics.chain import build_chain
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.robot.expression import ZERO
from derive.robot.robot import Robot


def rod_graph(arm: Robot, is_zero: tuple[bool, ...]) -> SolutionGraph | None:
    """The solutions of the first joint of an arm whose first link is the rod; None where it does not move the rod.

    Later joints are given, and of the pose the position, of which ``is_zero`` says what vanishes.
    """
    plain, shifts = shifted(with_numbers(arm, {k: cell for k, cell in baked(arm).items() if cell == ZERO}))
    domain, (first, *others) = InverseDomain(plain), plain.joints
    end = forward_kinematics(build_chain(replace(plain, joints=(replace(first, a=ZERO), *others)), domain)).position
    place = (domain.ring.zero if zero else domain.ring.generator(f"T[{i},4]") for i, zero in enumerate(is_zero, 1))
    square = sum(((p - x) ** 2 for p, x in zip(place, end, strict=True)), -(domain.constant(first.a) ** 2))
    unknown = domain.unknown(0)
    terms = domain.ring.coefficients(square, [domain.ring.index[name] for name in unknown.generators])
    if not any(map(any, terms)):
        return None
    kind, given = NodeKind.TYPE_2 if unknown.is_angle else NodeKind.QUADRATIC, tuple(range(1, plain.n))
    formula = NodeFormula(kind, (NodeEquation(terms, 2, Provenance(1, 1, "rod")),))
    nodes = [Node(k - 1, (domain.unknown(k),), (NodeFormula(NodeKind.GIVEN),)) for k in given]
    nodes.append(Node(len(given), (unknown,), (formula,), tuple(range(len(given))), formula.branches))
    scale = domain.square_reach
    return SolutionGraph(
        plain, domain, (), given, (), scale, tuple(nodes), shifts, count=2, complete=True, everywhere=True
    )
