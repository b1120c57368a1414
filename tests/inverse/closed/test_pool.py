"""The pool of equations: both sides of every cut agree, and invariants transform as they should."""

from __future__ import annotations

import pytest

from derive.algebra.residues import Residue
from derive.inverse.closed.completeness import counted
from derive.inverse.closed.conditions import entry_conditions
from derive.inverse.closed.evidence import Change, Evidence
from derive.inverse.closed.pool import ENTRIES, HIGHER, Cut, Links, Pool, dimension, frame_atoms, identity_atoms
from derive.inverse.closed.search import Search
from derive.inverse.closed.solve import solve
from derive.inverse.closed.unknowns import InverseDomain, shifted
from derive.mechanics.vectors import Frame, dot, hat, matmul, multiply, transpose
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
