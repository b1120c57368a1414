"""The nodes of an arm: each follows from those before it, and angles that are left are sums of those found."""

from __future__ import annotations

from collections import Counter

import pytest

from derive.inverse.closed.formulas import GraphDerivation
from derive.inverse.closed.nodes import NodeKind
from derive.robot.robot import Robot


@pytest.mark.parametrize("name", ["planar-3r", "puma560-corke"])
def test_each_joint_follows_from_those_before_it_and_sums_are_those_of_their_joints(name: str) -> None:
    robot = Robot.load(name)
    graph = GraphDerivation(robot, robot.inverse.task).graph()
    assert graph is not None
    assert [graph.joint_node(k).unknown.joints for k in range(robot.n)] == [(k,) for k in range(robot.n)]
    sums = [node for node in graph.nodes if node.kind is NodeKind.SUM]
    assert sums
    for node in graph.nodes:
        assert all(need < node.index for need in node.needs)
    for node in sums:
        total: Counter[int] = Counter()
        for part, sign in node.formulas[0].parts:
            total.update({joint: sign * own for joint, own in zip(part.joints, part.signs, strict=True)})
        wanted = dict(zip(node.unknown.joints, node.unknown.signs, strict=True))
        assert {joint: count for joint, count in total.items() if count} == wanted
