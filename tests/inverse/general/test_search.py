"""Arms that no order of one-joint equations solves."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.closed.solve import solve
from derive.inverse.closed.walk import GraphWalk
from derive.inverse.general.candidates import finished
from derive.inverse.general.choice import find_general
from derive.inverse.general.search import GeneralSolution, _distinct, free_loop, scaled
from derive.inverse.numeric.chain import POSE, NumericChain
from tests.inverse.arms import PUBLISHED, random_arm
from tests.inverse.truth import AllSolutions, Chain

CASES = {case.name: case for case in PUBLISHED}


@cache
def solution_of(name) -> tuple[NumericChain, GeneralSolution]:
    """An arm's numbers and its eliminations."""
    case = CASES[name] if name in CASES else random_arm(name.split()[0], int(name.split()[1]))
    chain = NumericChain.of(case.robot(choice=False), case.values)
    found = find_general(chain, case.given)
    assert found
    return chain, GeneralSolution(case.given, POSE, found)


def configurations(chain, count, seed=0):
    """Random configurations, slides within the reach."""
    span = np.where(chain.revolute, math.pi, 0.5 * chain.reach)
    return np.random.default_rng(seed).uniform(-span, span, (count, chain.n))


def distance(chain, a, b):
    """Of configurations, full turns aside."""
    apart = np.abs(a - b)
    return np.where(chain.revolute, np.minimum(apart, 2 * math.pi - apart), apart).max(axis=-1)


ARMS = [
    "jaco",
    pytest.param("manseur-doty", marks=pytest.mark.sweep),
    pytest.param("crx-10ia", marks=pytest.mark.sweep),
    pytest.param("5R1P-general 0", marks=pytest.mark.sweep),
    pytest.param("4R2P-general 1", marks=pytest.mark.sweep),
    pytest.param("6R-wrist-middle 0", marks=pytest.mark.sweep),
    pytest.param("panda", marks=pytest.mark.sweep),
]


@pytest.mark.parametrize("name", ARMS)
def test_every_configuration_is_among_the_solutions_of_its_pose(name):
    chain, general = solution_of(name)
    q = configurations(chain, 60)
    poses = chain.pose_and_jacobian(q)[0]
    found = general.solve(chain, poses, q[:, list(general.given)] if general.given else None)
    exists = np.isfinite(found[..., 0])
    assert (np.where(exists, distance(chain, found, q[:, None]), 9.0).min(axis=1) < 1e-6).all()
    error = np.abs(chain.pose_and_jacobian(np.nan_to_num(found))[0] - poses[:, None]).max(axis=(2, 3))
    assert error[exists].max() < 1e-10 * max(1.0, chain.reach)
    assert not np.isnan(found[exists]).any()


def test_joints_that_are_given_keep_their_numbers_beyond_a_turn_too():
    chain = NumericChain.of(CASES["jaco"].robot(choice=False), {})
    table = np.full((1, 2, chain.n), 4.0)
    assert (_distinct(table, chain, (2,))[0, 0] == [4.0 - 2 * math.pi] * 2 + [4.0] + [4.0 - 2 * math.pi] * 3).all()


def test_no_solution_is_lost_where_an_elimination_is_so_inexact_that_its_candidates_are_only_near(monkeypatch):
    chain, general = solution_of("jaco")
    poses = chain.pose_and_jacobian(configurations(chain, 20, seed=4))[0]
    wanted = general.solve(chain, poses)

    def inexact(problem, found, pose):
        values = finished(problem, found, pose)
        if problem.elimination != general.eliminations[0]:
            return values
        two = [i for i, place in enumerate(values.place) if (values.place[:i] == place).sum() < 2]
        return replace(values, place=values.place[two], joints=values.joints[two] + 1e-3)

    monkeypatch.setattr("derive.inverse.general.search.finished", inexact)
    found = general.solve(chain, poses)
    assert np.array_equal(np.isfinite(found[..., 0]).sum(axis=1), np.isfinite(wanted[..., 0]).sum(axis=1))


@pytest.mark.sweep
def test_sixteen_real_solutions_are_found_at_the_pose_of_manseur_and_doty():
    chain, general = solution_of("manseur-doty")
    q = configurations(chain, 400, seed=1)
    numbers = np.isfinite(general.solve(chain, chain.pose_and_jacobian(q)[0])[..., 0]).sum(axis=1)
    assert (numbers % 2 == 0).all()
    assert numbers.max() >= 12


@pytest.mark.sweep
def test_all_real_solutions_agree_with_those_found_by_continuation():
    case = CASES["jaco"]
    chain, general = solution_of("jaco")
    q = configurations(chain, 4, seed=2)
    found = general.solve(chain, chain.pose_and_jacobian(q)[0])
    truth = AllSolutions(Chain(case.arm))
    for mine, true in zip(found, truth.real(q)[0], strict=True):
        mine = mine[np.isfinite(mine[:, 0])]
        assert len(mine) == len(true)
        assert all(distance(chain, mine, one).min() < 1e-6 for one in true)


def test_an_unreachable_pose_has_no_solution():
    chain, general = solution_of("jaco")
    pose = chain.pose_and_jacobian(configurations(chain, 2))[0]
    pose[:, :3, 3] += 3 * chain.reach
    assert not np.isfinite(general.solve(chain, pose)).any()


def test_double_roots_are_kept():
    chain, general = solution_of("jaco")
    q = configurations(chain, 40, seed=3)
    # on the way to a singular configuration two solutions merge; the last one of the way is within 1e-7 of it
    unit = np.where(chain.revolute, 1.0, chain.reach)

    def determinant(x):
        slope = chain.pose_and_jacobian(x)[1].reshape(*x.shape[:-1], chain.n, 12) * unit[:, None]
        return np.linalg.svd(slope)[1][..., -1]

    ends = []
    for one in q:
        steps = one + np.linspace(-1, 1, 201)[:, None] * np.eye(6)[2]
        place = determinant(steps).argmin()
        if 0 < place < 200:
            ends.append(steps[place])
    ends = np.array(ends)
    assert len(ends) >= 10
    found = general.solve(chain, chain.pose_and_jacobian(ends)[0])
    exists = np.isfinite(found[..., 0])
    assert (np.where(exists, distance(chain, found, ends[:, None]), 9.0).min(axis=1) < 1e-4).all()


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["jaco", "xarm6", "crx-10ia"])
def test_poses_of_eighth_turns_keep_their_regular_solutions_and_have_some_at_singular_ones(name):
    chain, general = solution_of(name)
    q = np.random.default_rng(3).integers(-4, 5, (200, chain.n)) * math.pi / 4
    poses, slope = chain.pose_and_jacobian(q)
    regular = np.linalg.svd(slope.reshape(200, chain.n, 12))[1][:, -1] > 1e-2 * chain.reach
    found = general.solve(chain, poses)
    exists = np.isfinite(found[..., 0])
    assert exists.any(axis=1).all()
    near = np.where(exists, distance(chain, found, q[:, None]), 9.0).min(axis=1) < 1e-5
    assert near[regular].all()


def test_units_of_length_make_no_difference():
    chain, general = solution_of("jaco")
    poses = chain.pose_and_jacobian(configurations(chain, 5))[0]
    millimetres = NumericChain(
        chain.revolute, chain.sign, scaled(chain.fixed, 1e-3), scaled(chain.tool, 1e-3), chain.limits
    )
    for one, other in zip(general.solve(millimetres, scaled(poses, 1e-3)), general.solve(chain, poses), strict=True):
        one, other = one[np.isfinite(one[:, 0])], other[np.isfinite(other[:, 0])]
        assert len(one) == len(other)
        assert all(distance(chain, other, each).min() < 1e-7 for each in one)


def test_the_free_loop_has_the_given_joints_in_its_gaps():
    case = CASES["panda"]
    chain = NumericChain.of(case.robot(choice=False))
    q = configurations(chain, 3)
    loop, free = free_loop(chain, case.given, q[:, list(case.given)])
    assert loop.n == 6
    assert list(free) == [i for i in range(7) if i not in case.given]


def test_a_general_node_runs_in_the_graph_of_its_arm():
    case = CASES["manseur-doty"]
    robot = case.robot(choice=False)
    graph = solve(robot)
    assert [node.kind for node in graph.nodes] == [NodeKind.GENERAL]
    assert (graph.count, graph.complete) == (16, True)
    chain = NumericChain.of(robot)
    q = configurations(chain, 10)
    poses = chain.pose_and_jacobian(q)[0]
    run = GraphWalk(graph, FloatField({}), [[poses[:, i, j] for j in range(4)] for i in range(3)])
    found = [(np.stack(run.angles(leaf), axis=-1), leaf.exists) for leaf in run.leaves()]
    assert len(found) == 16
    apart = [np.where(exists, distance(chain, own, q), 9.0) for own, exists in found]
    assert (np.min(apart, axis=0) < 1e-6).all()
