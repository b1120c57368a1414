"""A graph of solutions written by hand: the planar arm of two links."""

from __future__ import annotations

from derive.inverse.closed.graph import Node, SolutionGraph
from derive.inverse.closed.nodes import NodeEquation, NodeFormula, NodeKind, Provenance
from derive.inverse.closed.unknowns import InverseDomain, shifted
from derive.robot.robot import Robot

PLANAR = """
name: planar
convention: standard
joints:
  - {type: revolute, a: a1}
  - {type: revolute, a: a2}
"""


def planar_graph() -> SolutionGraph:
    """theta_2 by the law of cosines, then theta_1 from x and y."""
    robot, shifts = shifted(Robot.from_text(PLANAR))
    domain = InverseDomain(robot)
    x, y, a1, a2 = map(domain.ring.generator, ("T[1,4]", "T[2,4]", "a1", "a2"))
    (one,), (two,) = ((domain.unknown(k),) for k in (0, 1))
    c2, s2 = map(domain.ring.generator, two.generators)
    square = x * x + y * y - a1 * a1 - a2 * a2
    law = NodeEquation({(1, 0): 2 * (a1 * a2), (0, 0): -square}, 2, Provenance(1, 2, "p.p"))
    first = NodeEquation({(1, 0): a1 + a2 * c2, (0, 1): -(a2 * s2), (0, 0): -x}, 1, Provenance(1, 2, "p[1]"))
    second = NodeEquation({(1, 0): a2 * s2, (0, 1): a1 + a2 * c2, (0, 0): -y}, 1, Provenance(1, 2, "p[2]"))
    nodes = (
        Node(0, (two,), (NodeFormula(NodeKind.TYPE_2, (law,)),), (), 2),
        Node(1, (one,), (NodeFormula(NodeKind.TYPE_3, (first, second)),), (0,), 1),
    )
    reach = a1 * a1 + a2 * a2 + x * x + y * y
    return SolutionGraph(robot, domain, ("x", "y"), (), (), reach, nodes, shifts, (), 2, True, True)


def test_a_node_has_a_value_for_each_branch_of_what_it_needs() -> None:
    graph = planar_graph()
    assert graph.axes == ((0,), (0,))
    assert graph.choices == (0,)
    assert graph.leaves == graph.slots == 2


def test_joints_are_found_where_their_variables_are_solved_for() -> None:
    graph = planar_graph()
    assert [graph.joint_node(k).index for k in (0, 1)] == [1, 0]
    assert graph.places == ((0, 3), (1, 3))
