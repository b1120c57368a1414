"""General arms: closure, elimination and candidates, the search of all solutions, and their number."""

import math
import warnings
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.graph import GraphWalk
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.closed.solve import solve
from derive.inverse.general.candidates import candidates, finished
from derive.inverse.general.choice import count_solutions, eliminations, find_general
from derive.inverse.general.closure import Loop, closures, middle_part
from derive.inverse.general.elimination import EigenProblem
from derive.inverse.general.rigid_motion import BESIDE, beside, motion_by, pose_features
from derive.inverse.general.search import GeneralSolution, _distinct, free_loop, scaled
from derive.inverse.numeric.chain import POSE, POSITION, NumericChain
from tests.interpreters import printed_by
from tests.inverse.arms import PUBLISHED, arm_of, random_arm
from tests.inverse.truth import AllSolutions, Chain
from tests.random_robots import swept


def random_loop(types, seed=0):
    return Loop(tuple(t == "R" for t in types), tuple(random_frames(np.random.default_rng(seed), len(types) + 1)))


def pose_of(loop, q):
    """T at a configuration, (1, 4, 4)."""
    return loop.pose([motion_by(turns, x) for turns, x in zip(loop.revolute, q, strict=True)])[None]


def products(loop, joints, q):
    """The multilinear products of (1, c, s) or (1, d, d^2)."""
    result = np.ones(1)
    for joint in joints:
        x = q[joint]
        line = (1, np.cos(x), np.sin(x)) if loop.revolute[joint] else (1, x, x * x)
        result = np.multiply.outer(result, line).reshape(-1)
    return result


@pytest.mark.parametrize("types", ["RRRRRR", "RPRRRR", "PRRPRR", "RRRRR", "RRPR"])
def test_around_the_loop_both_ways_give_the_same_numbers(types):
    loop = random_loop(types)
    q = np.random.default_rng(3).uniform(-2, 2, loop.n)
    pose = pose_of(loop, q)
    ways = closures(loop)
    assert len(ways) >= loop.n
    for way in ways:
        left = way.eliminated_part(loop) @ products(loop, way.order[2:0:-1], q)
        right = way.unknown_part(loop, pose_features(pose)).reshape(15, -1) @ products(loop, way.unknowns, q)
        if way.aligned is None:
            left = left.reshape(15)
        np.testing.assert_allclose(left, right, atol=1e-10)


def test_a_loop_may_be_read_from_another_joint_and_locked_joints_become_part_of_its_gaps():
    loop = random_loop("RRRPRR")
    q = np.random.default_rng(4).uniform(-2, 2, 6)
    motions = [motion_by(turns, x) for turns, x in zip(loop.revolute, q, strict=True)]
    turned, constant = loop.rotated(2, loop.pose(motions)[None])
    np.testing.assert_allclose(turned.pose(motions[2:] + motions[:2]), constant, atol=1e-12)
    loop = random_loop("RRRRRRR")
    q = np.random.default_rng(5).uniform(-2, 2, 7)
    motions = [motion_by(True, x) for x in q]
    left = loop.locked([None, None, motions[2], None, None, None, motions[6]])
    assert left.n == 5
    np.testing.assert_allclose(left.pose([motions[k] for k in (0, 1, 3, 4, 5)]), loop.pose(motions), atol=1e-12)


def test_the_middle_of_three_joints_moves_what_the_last_one_carries():
    loop = random_loop("RRR")
    q = np.random.default_rng(6).uniform(-2, 2, 3)
    way = closures(random_loop("RRRRRR"))[-1].alone
    parts, near, far = middle_part(loop, way)
    carried = loop.carried(way.dropped)
    moved = near @ motion_by(True, -way.direction * q[1]) @ far
    seen = np.einsum("k,kj->j", (1, np.cos(q[1]), np.sin(q[1])), parts)
    np.testing.assert_allclose(seen, carried.action(moved) @ carried.start, atol=1e-12)


def random_frames(random, count):
    """Rigid motions, (count, 4, 4)."""
    frames = np.tile(np.eye(4), (count, 1, 1))
    for k in range(count):
        rotation = np.linalg.qr(random.normal(size=(3, 3)))[0]
        frames[k, :3, :3] = rotation * np.linalg.det(rotation)
        frames[k, :3, 3] = random.normal(size=3)
    return frames


def test_poses_beside_are_poses_at_a_small_distance_that_grows_with_the_unit():
    frames = random_frames(np.random.default_rng(5), 4)
    unit = np.array([1.0, 2.0, 10.0, 1e-3])
    for which in range(len(BESIDE)):
        moved = beside(frames, which, unit)
        turn = moved[:, :3, :3] @ frames[:, :3, :3].transpose(0, 2, 1)
        np.testing.assert_allclose(turn @ turn.transpose(0, 2, 1), np.broadcast_to(np.eye(3), (4, 3, 3)), atol=1e-15)
        shift = moved[:, :3, 3] - (turn @ frames[:, :3, 3:])[..., 0]
        np.testing.assert_allclose(shift / unit[:, None], np.broadcast_to(shift[0], (4, 3)), atol=1e-12)
        assert 1e-4 < np.abs(turn - np.eye(3)).max() < 0.1
        assert (moved[:, 3] == (0, 0, 0, 1)).all()


def apart(loop, joints, q):
    """Differences of joints from q, full turns aside; NaN where a joint is not known."""
    difference = joints - q
    return np.abs(np.where(loop.revolute, 2 * np.sin(difference / 2), difference))


@pytest.mark.parametrize("types", ["RRRRRR", "PRRPRR", "RRRRR"])
def test_a_configuration_is_among_the_candidates_of_its_pose_first_in_part_and_then_whole(types):
    loop = random_loop(types)
    q = np.random.default_rng(7).uniform(-2, 2, (3, loop.n))
    pose = np.concatenate([pose_of(loop, one) for one in q])
    elimination = min(eliminations(loop, pose[:1]), key=lambda each: each.eigenvalues)
    problem = EigenProblem.of(loop, elimination)
    found = candidates(problem, pose)
    known = list(elimination.unknowns)
    whole = finished(problem, found, pose)
    assert np.isnan(np.delete(found.joints, known, axis=1)).all()
    assert not found.doubtful.any()
    for place, one in enumerate(q):
        part = apart(loop, found.joints[found.place == place], one)[:, known]
        assert part.max(axis=1).min() < 1e-6
        assert apart(loop, whole.joints[whole.place == place], one).max(axis=1).min() < 1e-6


def test_the_joints_of_an_arm_whose_position_is_wanted_follow_from_linear_equations():
    loop = random_loop("RRR").with_tip
    q = np.array([0.4, -1.1, 0.8])
    pose = pose_of(random_loop("RRR"), q)
    elimination = min(eliminations(loop, pose), key=lambda each: each.eigenvalues)
    problem = EigenProblem.of(loop, elimination)
    whole = finished(problem, candidates(problem, pose), pose)
    assert apart(loop, whole.joints, np.append(q, 0.0)).max(axis=1).min() < 1e-6


CASES = {case.name: case for case in PUBLISHED}


@cache
def solution_of(name) -> tuple[NumericChain, GeneralSolution]:
    case = case_of(name)
    chain = NumericChain.of(case.robot(choice=False), case.values)
    found = find_general(chain, case.given)
    assert found
    return chain, GeneralSolution(case.given, POSE, found)


def configurations(chain, count, seed=0):
    span = np.where(chain.revolute, math.pi, 0.5 * chain.reach)
    return np.random.default_rng(seed).uniform(-span, span, (count, chain.n))


def distance(chain, a, b):
    apart = np.where(np.isfinite(a), np.abs(a - b), 9.0)
    return np.where(chain.revolute, np.minimum(apart, np.abs(2 * math.pi - apart)), apart).max(axis=-1)


ARMS = ["jaco", *swept("manseur-doty", "crx-10ia", "5R1P-general 0", "4R2P-general 1", "6R-wrist-middle 0", "panda")]


@pytest.mark.parametrize("name", ARMS)
def test_every_configuration_is_among_the_solutions_of_its_pose(name):
    chain, general = solution_of(name)
    q = configurations(chain, 400 if name == "manseur-doty" else 60)
    poses = chain.pose_and_jacobian(q)[0]
    found = general.solve(chain, poses, q[:, list(general.given)] if general.given else None)
    exists = np.isfinite(found[..., 0])
    assert (distance(chain, found, q[:, None]).min(axis=1) < 1e-6).all()
    error = np.abs(chain.pose_and_jacobian(np.nan_to_num(found))[0] - poses[:, None]).max(axis=(2, 3))
    assert error[exists].max() < 1e-10 * max(1.0, chain.reach)
    assert not np.isnan(found[exists]).any()
    if name == "manseur-doty":  # of sixteen at one pose, in pairs
        assert set(exists.sum(axis=1)) <= set(range(2, 17, 2))
        assert exists.sum(axis=1).max() >= 12


def test_joints_that_are_given_keep_their_numbers_and_stand_in_the_gaps_of_the_free_loop():
    chain = NumericChain.of(CASES["jaco"].robot(choice=False), {})
    table = np.full((1, 2, chain.n), 4.0)
    assert (_distinct(table, chain, (2,))[0, 0] == [4.0 - 2 * math.pi] * 2 + [4.0] + [4.0 - 2 * math.pi] * 3).all()
    case = CASES["panda"]
    chain = NumericChain.of(case.robot(choice=False))
    q = configurations(chain, 3)
    loop, free = free_loop(chain, case.given, q[:, list(case.given)])
    assert loop.n == 6
    assert list(free) == [i for i in range(7) if i not in case.given]


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


def assert_all(chain, general, q, truth):
    """All real solutions of poses are those found by continuation."""
    found = general.solve(chain, chain.pose_and_jacobian(q)[0])
    for mine, true in zip(found, truth.real(q)[0], strict=True):
        mine = mine[np.isfinite(mine[:, 0])]
        assert len(mine) == len(true)
        assert all(distance(chain, mine, one).min() < 1e-6 for one in true)


@pytest.mark.sweep
def test_all_real_solutions_agree_with_those_found_by_continuation():
    chain, general = solution_of("jaco")
    assert_all(chain, general, configurations(chain, 4, seed=2), AllSolutions(Chain(CASES["jaco"].arm)))


def test_an_unreachable_pose_has_no_solution():
    chain, general = solution_of("jaco")
    pose = chain.pose_and_jacobian(configurations(chain, 2))[0]
    pose[:, :3, 3] += 3 * chain.reach
    assert not np.isfinite(general.solve(chain, pose)).any()


def test_double_roots_are_kept():
    chain, general = solution_of("jaco")
    # on the way to a singular configuration two solutions merge; the last one of the way is within 1e-7 of it
    steps = configurations(chain, 40, seed=3)[:, None] + np.linspace(-1, 1, 201)[:, None] * np.eye(6)[2]
    unit = np.where(chain.revolute, 1.0, chain.reach)
    slopes = chain.pose_and_jacobian(steps)[1].reshape(*steps.shape, 12) * unit[:, None]
    place = np.linalg.svd(slopes)[1][..., -1].argmin(axis=1)
    inner = np.flatnonzero((place > 0) & (place < 200))
    ends = steps[inner, place[inner]]
    assert len(ends) >= 10
    found = general.solve(chain, chain.pose_and_jacobian(ends)[0])
    assert (distance(chain, found, ends[:, None]).min(axis=1) < 1e-4).all()


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["jaco", "xarm6", "crx-10ia"])
def test_poses_of_eighth_turns_keep_their_regular_solutions_and_have_some_at_singular_ones(name):
    chain, general = solution_of(name)
    q = np.random.default_rng(3).integers(-4, 5, (200, chain.n)) * math.pi / 4
    poses, slope = chain.pose_and_jacobian(q)
    regular = np.linalg.svd(slope.reshape(200, chain.n, 12))[1][:, -1] > 1e-2 * chain.reach
    found = general.solve(chain, poses)
    assert np.isfinite(found[..., 0]).any(axis=1).all()
    assert (distance(chain, found, q[:, None]).min(axis=1)[regular] < 1e-5).all()


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


@pytest.mark.parametrize("types", ["RRRRRR", "RRPRRR"])
def test_a_general_arm_has_sixteen_eigenvalues(types):
    loop = random_loop(types)
    pose = pose_of(loop, np.random.default_rng(1).uniform(-2, 2, 6))
    assert min(each.eigenvalues for each in eliminations(loop, pose)) == 16


def test_the_best_elimination_is_first_and_no_two_hide_the_same_joint():
    found = solution_of("jaco")[1].eliminations
    places = [(each.start, each.hidden) for each in found]
    assert len(set(places)) == len(places) > 1
    assert found[0].eigenvalues == 16
    for each in found:
        kept = [joint for joint in each.unknowns if joint != each.hidden]
        sizes = [(2 if joint in each.straight else 3) + (joint == each.multiplied) for joint in kept]
        assert sum(each.rows) == math.prod(sizes)


def test_an_arm_of_two_joints_has_no_elimination():
    assert find_general(NumericChain.of(arm_of("standard", "R 10 0.1 0.2 30; R 0 0.3 0.4 50"))) == ()


CHOICE = """
from derive.inverse.general.choice import find_general
from derive.inverse.numeric.chain import NumericChain
from tests.inverse.arms import PUBLISHED
print([find_general(NumericChain.of(case.robot())) for case in PUBLISHED if case.name in ("crx-10ia", "jaco")])
"""


@pytest.mark.sweep
def test_no_rounding_of_a_processor_decides_which_elimination_is_taken() -> None:
    """Kernels of OpenBLAS for other processors round otherwise; where the variable means nothing all are the same."""
    found = set()
    for processor in ("Haswell", "Prescott", "SkylakeX"):
        found.add(printed_by(CHOICE, OPENBLAS_CORETYPE=processor, OPENBLAS_NUM_THREADS="1"))
    assert len(found) == 1


@pytest.mark.sweep
def test_joints_that_are_nowhere_near_a_solution_are_tried_in_silence() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert find_general(NumericChain.of(random_arm("6DOF-P-other", 1505).robot()))


COUNTS = [
    ("manseur-doty", 16),
    *swept(("puma560", 8), ("crx-10ia", 16), ("jaco", 16), ("panda", 8)),
    *swept(("5R1P-general 0", 16), ("4R2P-general 1", 8), ("5dof 1", 2)),
]
"""Known from the literature, or by continuation of all solutions over the complex numbers (`tests.inverse.truth`)."""

POSITIONS = {6: 2, 7: 4}
"""Random arms of three joints whose end's position is wanted: P-R-P without squares of lengths, R-R-R."""


def case_of(name):
    """A published arm, or one of a class by ``class number``."""
    return CASES[name] if name in CASES else random_arm(name.split()[0], int(name.split()[1]))


@pytest.mark.parametrize(("name", "count"), COUNTS)
def test_eliminations_that_count_agree_with_the_known_number(name, count):
    case = case_of(name)
    robot = case.robot(choice=False)
    chain = NumericChain.of(robot, case.values)
    q = np.random.default_rng(1).uniform(-1, 1, (1, chain.n))
    loop, _ = free_loop(chain, case.given, q[:, list(case.given)])
    pose = scaled(chain.pose_and_jacobian(q)[0], chain.reach)
    found = sorted(eliminations(loop, pose), key=lambda each: (each.eigenvalues, each.hidden))
    numbers = {count_solutions(robot, each, case.given, seed) for each in found[::5] for seed in (0, 1)}
    assert numbers - {0} == {count}


@pytest.mark.sweep
@pytest.mark.parametrize(("number", "count"), POSITIONS.items())
def test_positions_of_three_joints_have_as_many_solutions_as_continuation_finds(number, count):
    case = random_arm("3dof-spatial-position", number)
    robot = case.robot(choice=False)
    chain = NumericChain.of(robot, case.values)
    found = find_general(chain, (), POSITION)
    assert {count_solutions(robot, each, tip=True) for each in found} == {count}
    general = GeneralSolution((), POSITION, found, count)
    q = np.random.default_rng(2).uniform(-1, 1, (5, 3))
    assert_all(chain, general, q, AllSolutions(Chain(case.arm, POSITION)))
