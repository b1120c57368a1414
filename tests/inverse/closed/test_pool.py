"""The pool of equations, unknowns, conditions, and graphs of solutions."""

from __future__ import annotations

import numpy as np
import pytest

from derive.algebra.residues import Residue
from derive.handouts.notation.derivation import derivation_lines
from derive.handouts.notation.notation import Notation
from derive.inverse.closed.evidence import Change, Evidence
from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import Node, SolutionGraph
from derive.inverse.closed.nodes import NodeEquation, NodeFormula, NodeKind, Provenance
from derive.inverse.closed.pool import ENTRIES, HIGHER, Cut, Links, Pool, dimension, frame_atoms, identity_atoms
from derive.inverse.closed.pose import entry_conditions
from derive.inverse.closed.search import Search
from derive.inverse.closed.solve import counted, solve
from derive.inverse.closed.unknowns import InverseDomain, State, shifted
from derive.inverse.closed.walk import GraphWalk
from derive.inverse.words.solutions import inverse_kinematics
from derive.mechanics.vectors import Frame, dot, hat, matmul, multiply, transpose
from derive.model.model import Model
from derive.robot.robot import Robot

ARM = """
name: arm
convention: modified
joints:
  - {type: revolute, a: 0.1, alpha: pi/6, d: 0.2}
  - {type: prismatic, a: 0.3, alpha: pi/2, theta: pi/2}
  - {type: revolute, alpha: -pi/2, d: 0.4}
  - {type: revolute, a: 0.5, d: 0.6}
tool: [[1, 0, 0, 0.1], [0, 1, 0, 0.2], [0, 0, 1, 0], [0, 0, 0, 1]]
"""

WHOLE = frozenset((i, j) for i in (1, 2, 3) for j in (1, 2, 3, 4))


def evidence(*, special: bool = False) -> Evidence:
    robot, _ = shifted(Robot.from_text(ARM))
    domain = InverseDomain(robot)
    links = Links(robot, domain, domain.joint_turn)
    return Evidence(domain, list(links.cuts()), WHOLE, deep=True, special=special)


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
    robot, _ = shifted(Robot.from_text(ARM))
    domain = InverseDomain(robot)
    links = Links(robot, domain, domain.joint_turn)
    cuts = list(links.cuts())
    assert Cut(0, 2, outer_right=True) in cuts
    assert not any(cut.outer_left for cut in cuts if cut.first == 0)
    assert [dimension(entry) for entry in ("R[1,1]", "p[1]", "u[2]", "p.p", "m[1,1]", "k[1,1]")] == [0, 1, 1, 2, 1, 2]
    inside, _ = Pool(links, identity_atoms(links, deep=False)).sides(Cut(2, 3))
    assert inside.entry("p[3]") == domain.constant(robot.joints[2].d)


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


DOMAIN = InverseDomain(Robot.load("planar-3r"))
NOTHING = State(((0b0001, 0b0010, 0b0100, 0b1000),), frozenset())


def known(state: State) -> set[tuple[int, ...]]:
    return {u.joints for u in DOMAIN.unknowns() if all(DOMAIN.is_known(name, state) for name in u.generators)}


def test_of_sums_that_are_known_their_differences_are_known_and_between_parts_are_all_sums() -> None:
    whole = NOTHING.joined(0, 0b0001, 0b1000)
    assert known(NOTHING) == set()
    assert known(whole) == {(0, 1, 2)}
    assert known(whole.joined(0, 0b1001, 0b0100)) == {(0, 1), (2,), (0, 1, 2)}
    assert [u.joints for u in DOMAIN.between(0, (0b1001, 0b0010))] == [(0,), (1, 2)]


def test_an_equation_is_written_in_one_unknown_and_what_is_known() -> None:
    whole = NOTHING.joined(0, 0b0001, 0b1000)
    first, rest = DOMAIN.unknown(0), DOMAIN.unknown(1, 2)
    cosine, sine = map(DOMAIN.ring.generator, rest.generators)
    written = DOMAIN.rewritten(cosine * cosine + sine, whole, first)
    used = {name for name, degree in zip(DOMAIN.ring.names, written.degrees(), strict=True) if degree}
    assert used == {*first.generators, *DOMAIN.unknown(0, 1, 2).generators}
    (c, s), (e, f) = (map(DOMAIN.ring.generator, u.generators) for u in (first, DOMAIN.unknown(0, 1, 2)))
    assert written == (e * c + f * s) * (e * c + f * s) + f * c - e * s


ARMS = {  # rows of revolute (R) and prismatic (P) joints, and what a pose must fulfil
    "{R, d: d1}, {P, alpha: -pi/2}, {P}": "r33 = 0, r31 = 0, r32 = -1, px*c1 = -py*s1",
    "{P, alpha: pi/2}, {P, alpha: pi/2, theta: pi/2}, {P}": "r13 = 1, r23 = 0, r33 = 0, r31 = 1, r32 = 0",
    "{R, d: d1, alpha: -pi/2}, {R, a: a2}, {R, a: a3}, {R, a: a4, alpha: -pi/2}, {R, d: d5}": "r23*c1 = r13*s1",
    "{R, alpha: -pi/2}, {R, alpha: pi/2}, {R, d: d6}": "px = d6*r13, py = d6*r23, pz = d6*r33",
}


@pytest.mark.parametrize("rows", ARMS)
def test_conditions_are_those_of_textbooks_with_their_signs(rows: str) -> None:
    joints = rows.replace("{R", "{type: revolute").replace("{P", "{type: prismatic")
    robot = Robot.from_text(f"name: arm\nconvention: standard\njoints: [{joints}]\n")
    lines = derivation_lines(Model(robot).inverse, "text", Notation.of(robot))
    assert lines[1] == f"a pose can be reached only if {ARMS[rows]}"


def test_an_angle_tells_the_orientation_of_a_planar_arm() -> None:
    """So the last link is taken off first, as textbooks do, and the elbow follows from the law of cosines."""
    robot = Robot.load("planar-3r")
    lines = derivation_lines(inverse_kinematics(robot, robot.style, ("x", "y", "phi")), "text", Notation.of(robot))
    assert "   wx = px - a3*r11" in lines
    assert "   D = (wx**2 + wy**2 - a1**2 - a2**2)/(2*a1*a2)" in lines


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


def test_nodes_have_a_value_for_each_branch_and_joints_are_found_where_they_are_solved_for() -> None:
    graph = planar_graph()
    assert graph.axes == ((0,), (0,))
    assert graph.choices == (0,)
    assert graph.leaves == graph.slots == 2
    assert [node.unknown.joints for node in graph.nodes] == [(1,), (0,)]
    assert graph.places == ((0, 3), (1, 3))


def pose_at(q: np.ndarray, a1: float, a2: float) -> list[list[np.ndarray]]:
    x = a1 * np.cos(q[0]) + a2 * np.cos(q[0] + q[1])
    y = a1 * np.sin(q[0]) + a2 * np.sin(q[0] + q[1])
    c, s, zero = np.cos(q[0] + q[1]), np.sin(q[0] + q[1]), np.zeros_like(x)
    return [[c, -s, zero, x], [s, c, zero, y], [zero, zero, zero + 1, zero]]


def test_every_configuration_is_among_the_solutions_of_its_pose_and_all_lead_there() -> None:
    q = np.random.default_rng(3).uniform(-3, 3, (2, 200))
    pose = pose_at(q, 0.7, 0.4)
    run = GraphWalk(planar_graph(), FloatField({"a1": 0.7, "a2": 0.4}), pose)
    found = []
    for leaf in run.leaves():
        assert np.all(leaf.exists)
        angles = np.stack(run.angles(leaf))
        again = pose_at(angles, 0.7, 0.4)
        assert np.allclose(again[0][3], pose[0][3], atol=1e-12)
        assert np.allclose(again[1][3], pose[1][3], atol=1e-12)
        found.append(np.abs(np.exp(1j * angles) - np.exp(1j * q)).max(axis=0))
    assert len(found) == planar_graph().leaves == 2
    assert np.min(found, axis=0).max() < 1e-7


@pytest.mark.parametrize(("x", "branches"), [(1.1, 1), (1.1 + 1e-15, 1), (1.2, 0), (0.25, 0), (1.0, 2)])
def test_on_the_boundary_there_is_one_branch_and_beyond_it_none(x: float, branches: int) -> None:
    zero, one = np.zeros(1), np.ones(1)
    pose = [[one, zero, zero, np.array([x])], [zero, one, zero, zero], [zero, zero, one, zero]]
    run = GraphWalk(planar_graph(), FloatField({"a1": 0.7, "a2": 0.4}), pose)
    leaves = list(run.leaves())
    assert sum(int(np.all(leaf.exists)) for leaf in leaves) == branches
    assert all(np.isfinite(run.angles(leaf)).all() for leaf in leaves)


def test_where_a_folded_arm_can_turn_freely_the_joint_is_said_to_be_free() -> None:
    zero, one = np.zeros(1), np.ones(1)
    pose = [[one if i == j else zero for j in range(4)] for i in range(3)]
    run = GraphWalk(planar_graph(), FloatField({"a1": 0.5, "a2": 0.5}), pose, near=[np.array([0.3]), zero])
    leaf = next(run.leaves())
    assert np.all(leaf.exists)
    assert np.all(leaf.free[0])
    assert not np.any(leaf.free[1])
    assert np.allclose(run.angles(leaf), [[0.3], [np.pi]], atol=1e-7)
