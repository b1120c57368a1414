"""The search of all solutions of a general arm, the choice of its elimination, and their number."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import warnings
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.closed.solve import solve
from derive.inverse.closed.walk import GraphWalk
from derive.inverse.general.candidates import finished
from derive.inverse.general.choice import eliminations, find_general
from derive.inverse.general.count import count_solutions
from derive.inverse.general.search import GeneralSolution, _distinct, free_loop, scaled
from derive.inverse.numeric.chain import POSE, POSITION, NumericChain
from tests.inverse.arms import PUBLISHED, arm_of, random_arm
from tests.inverse.general.test_closure import pose_of, random_loop
from tests.inverse.truth import AllSolutions, Chain
from tests.places import ROOT
from tests.random_robots import swept

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


ARMS = [
    "jaco",
    *swept("manseur-doty", "crx-10ia", "5R1P-general 0", "4R2P-general 1", "6R-wrist-middle 0", "panda"),
]


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
        kernels = {"OPENBLAS_CORETYPE": processor, "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
        command = [sys.executable, "-c", CHOICE]
        said = {"capture_output": True, "text": True, "check": True}
        found.add(subprocess.run(command, env=os.environ | kernels, cwd=ROOT, **said).stdout)
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
