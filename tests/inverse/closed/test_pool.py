"""The pool of equations, unknowns, conditions, and graphs of solutions."""

from __future__ import annotations

from functools import cache

import pytest

from derive.algebra.residues import Residue
from derive.handouts.notation.derivation import derivation_lines
from derive.handouts.notation.notation import Notation
from derive.inverse.closed.evidence import Change, Evidence
from derive.inverse.closed.graph import Node, SolutionGraph
from derive.inverse.closed.nodes import NodeEquation, NodeFormula, NodeKind, Provenance
from derive.inverse.closed.pool import ENTRIES, HIGHER, Cut, Links, Pool, dimension, frame_atoms, identity_atoms
from derive.inverse.closed.pose import entry_conditions
from derive.inverse.closed.search import Search
from derive.inverse.closed.solve import counted, solve
from derive.inverse.closed.unknowns import InverseDomain, State, shifted
from derive.inverse.words.solutions import inverse_kinematics
from derive.mechanics.vectors import Frame, dot, hat, matmul, multiply, transpose
from derive.model.model import Model
from derive.robot.robot import Robot
from tests.inverse.arms import arm_of

ARM = arm_of(
    "modified",
    "R 30 0.1 0.2 0; P 90 0.3 0 90; R -90 0 0.4 0; R 0 0.5 0.6 0",
    "tool: [[1, 0, 0, 0.1], [0, 1, 0, 0.2], [0, 0, 1, 0], [0, 0, 0, 1]]",
)
WHOLE = frozenset((i, j) for i in (1, 2, 3) for j in (1, 2, 3, 4))


DOMAIN = InverseDomain(shifted(ARM)[0])
LINKS = Links(DOMAIN.robot, DOMAIN, DOMAIN.joint_turn)


@cache
def evidence(*, special: bool = False) -> Evidence:
    return Evidence(DOMAIN, list(LINKS.cuts()), WHOLE, deep=True, special=special)


@pytest.mark.parametrize("special", [False, True])
def test_both_sides_of_every_equation_agree_where_the_arm_is(special: bool) -> None:
    found = evidence(special=special)
    for k, (cut, entry) in enumerate(found.equations):
        constant = found.effects[Change(0, 2)].coefficients[k]
        at_the_pose = (constant[:, 0] + constant[:, 1] + constant[:, 3]) % found.prime
        assert not at_the_pose.any(), (cut, entry)


def test_invariants_are_those_of_the_frame_however_it_was_composed() -> None:
    found = evidence()
    prime = found.prime
    pose = found.pose
    again = frame_atoms(Frame(pose.rotation, pose.position), Residue(prime, [[0]]), deep=True)
    for entry in (*ENTRIES, *HIGHER):
        assert not (pose.entry(entry) - again.entry(entry)).values.any(), entry
    turned = multiply(transpose(pose.rotation), pose.position)
    assert not (dot(turned, turned) - pose.square).values.any()
    moment = matmul(hat(pose.position, Residue(prime, [[0]])), pose.rotation)
    assert not (moment[0][1] - pose.entry("m[1,2]")).values.any()


def test_cuts_stand_at_both_ends_of_every_offset_and_entries_have_their_dimension() -> None:
    cuts = list(LINKS.cuts())
    assert Cut(0, 2, outer_right=True) in cuts
    assert not any(cut.outer_left for cut in cuts if cut.first == 0)
    assert [dimension(entry) for entry in ("R[1,1]", "p[1]", "u[2]", "p.p", "m[1,1]", "k[1,1]")] == [0, 1, 1, 2, 1, 2]
    inside, _ = Pool(LINKS, identity_atoms(LINKS, deep=False)).sides(Cut(2, 3))
    assert inside.entry("p[3]") == DOMAIN.constant(DOMAIN.robot.joints[2].d)


def test_an_equation_depends_on_what_occurs_in_it_alone() -> None:
    found = evidence()
    search = Search(found)
    slide = found.effects[Change(-1, 1)]
    rotations = [k for k, (_, entry) in enumerate(found.equations) if entry[0] == "R"]
    assert not slide.depends[rotations].any()
    way = search.way()
    assert way is not None
    assert {step.group for step in way} == {-1, 0, 1}


def test_leaves_are_counted_and_constant_entries_found() -> None:
    robot = Robot.load("scara-perugia")
    graph = solve(robot)
    assert counted(graph, graph.domain, {}).count == 2
    assert [str(e.coefficient().raw) for e in graph.conditions] == ["T[1,3]", "T[2,3]", "T[3,3] + 1"]
    links = Links(graph.robot, graph.domain, graph.domain.joint_turn)
    arm = Evidence(graph.domain, list(links.cuts()), WHOLE)
    assert len(entry_conditions(graph, arm, {})) == 7


PARALLEL = InverseDomain(Robot.load("planar-3r"))
NOTHING = State(((0b0001, 0b0010, 0b0100, 0b1000),), frozenset())


def known(state: State) -> set[tuple[int, ...]]:
    return {u.joints for u in PARALLEL.unknowns() if all(PARALLEL.is_known(name, state) for name in u.generators)}


def test_of_sums_that_are_known_their_differences_are_known_and_between_parts_are_all_sums() -> None:
    whole = NOTHING.joined(0, 0b0001, 0b1000)
    assert known(NOTHING) == set()
    assert known(whole) == {(0, 1, 2)}
    assert known(whole.joined(0, 0b1001, 0b0100)) == {(0, 1), (2,), (0, 1, 2)}
    assert [u.joints for u in PARALLEL.between(0, (0b1001, 0b0010))] == [(0,), (1, 2)]


def test_an_equation_is_written_in_one_unknown_and_what_is_known() -> None:
    whole = NOTHING.joined(0, 0b0001, 0b1000)
    first, rest = PARALLEL.unknown(0), PARALLEL.unknown(1, 2)
    cosine, sine = map(PARALLEL.ring.generator, rest.generators)
    written = PARALLEL.rewritten(cosine * cosine + sine, whole, first)
    used = {name for name, degree in zip(PARALLEL.ring.names, written.degrees(), strict=True) if degree}
    assert used == {*first.generators, *PARALLEL.unknown(0, 1, 2).generators}
    (c, s), (e, f) = (map(PARALLEL.ring.generator, u.generators) for u in (first, PARALLEL.unknown(0, 1, 2)))
    assert written == (e * c + f * s) * (e * c + f * s) + f * c - e * s


ARMS = {  # rows of revolute (R) and prismatic (P) joints, and what a pose must fulfil
    "R 0 d1 0 0; P 0 0 0 -90; P 0 0 0 0": "r33 = 0, r31 = 0, r32 = -1, px*c1 = -py*s1",
    "P 0 0 0 90; P 90 0 0 90; P 0 0 0 0": "r13 = 1, r23 = 0, r33 = 0, r31 = 1, r32 = 0",
    "R 0 d1 0 -90; R 0 0 a2 0; R 0 0 a3 0; R 0 0 a4 -90; R 0 d5 0 0": "r23*c1 = r13*s1",
    "R 0 0 0 -90; R 0 0 0 90; R 0 d6 0 0": "px = d6*r13, py = d6*r23, pz = d6*r33",
}


@pytest.mark.parametrize("rows", ARMS)
def test_conditions_are_those_of_textbooks_with_their_signs(rows: str) -> None:
    robot = arm_of("standard", rows)
    lines = derivation_lines(Model(robot).inverse, "text", Notation.of(robot))
    assert lines[1] == f"a pose can be reached only if {ARMS[rows]}"


def test_an_angle_tells_the_orientation_of_a_planar_arm() -> None:
    """So the last link is taken off first, as textbooks do, and the elbow follows from the law of cosines."""
    robot = Robot.load("planar-3r")
    lines = derivation_lines(inverse_kinematics(robot, robot.style, ("x", "y", "phi")), "text", Notation.of(robot))
    assert "   wx = px - a3*r11" in lines
    assert "   D = (wx**2 + wy**2 - a1**2 - a2**2)/(2*a1*a2)" in lines


PLANAR = arm_of("standard", "R 0 0 a1 0; R 0 0 a2 0")


def planar_graph() -> SolutionGraph:
    """theta_2 by the law of cosines, then theta_1 from x and y."""
    robot, shifts = shifted(PLANAR)
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


def test_nodes_have_a_value_for_each_branch_and_joints_are_found_where_they_are_solved_for() -> None:
    graph = planar_graph()
    assert graph.axes == ((0,), (0,))
    assert graph.choices == (0,)
    assert graph.leaves == graph.slots == 2
    assert [node.unknown.joints for node in graph.nodes] == [(1,), (0,)]
    assert graph.places == ((0, 3), (1, 3))
