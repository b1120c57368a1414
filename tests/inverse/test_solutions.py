"""Every arm's solutions against the truth: all of them, none twice, none wrong, none of poses out of reach."""

import itertools
import random
from functools import cache, partial

import numpy as np
import pytest

from derive import Model
from derive.errors import QuantityError
from derive.handouts.notation.derivation import headline
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.solve import solve
from derive.verification.oracle.frames import forward_kinematics
from tests.inverse import mass, truth
from tests.inverse.arms import CLASSES, HARD, LOST, PUBLISHED, ArmCase, is_regular, random_arm
from tests.inverse.mass import GENERAL, tried, with_truth
from tests.inverse.solvers import built_modules, generated_solver, numeric_solver, solver_of, solver_of_module
from tests.inverse.trial import Trial
from tests.inverse.truth import by_many_starts, smallest_singular_value
from tests.random_robots import swept

ARMS = {case.name: case for case in PUBLISHED}
USUAL = ("planar-2r-position", "elbow-offset-position", "scara-rrpr", "stanford")


def some_swept(poses, count, makes):
    """The first ones for the sweep, the others before a release: the truth takes seconds for each pose."""
    marks = [pytest.mark.sweep] * count + [pytest.mark.release] * (len(makes) - count)
    return [pytest.param(make, poses, marks=mark) for make, mark in zip(makes, marks, strict=True)]


def assert_clean(trial, poses, solver, residual=1e-10):
    verdict = trial.judge(poses, solver)
    assert verdict.is_clean, (trial.case.name, poses.kind, verdict.missing[:3])
    assert verdict.residual < residual


CASES = [(partial(ARMS.get, name), 2) for name in USUAL]  # how an arm is made, and at how many poses it is tried
CASES += [(partial(random_arm, kind, 7), 1) for kind in ("3dof-planar", "4dof")]
others = sorted(set(ARMS) - set(USUAL), key=lambda name: name[::-1])
CASES += some_swept(5, 16, [partial(ARMS.get, name) for name in others])
CASES += some_swept(4, 8, [partial(HARD.__getitem__, number) for number in range(len(HARD))])
CASES += some_swept(4, len(CLASSES), [partial(random_arm, kind, number) for number in range(5) for kind in CLASSES])


@pytest.mark.parametrize(("make", "count"), CASES)
@pytest.mark.first(2)
def test_an_arm_has_every_solution_and_nothing_else(make, count):
    """Arms of books, arms on which solvers stumble, and random ones."""
    case = make()
    trial, solver = Trial(case, count), solver_of(case)
    for poses in (trial.regular(), trial.special(count + 1), trial.boundary(count), trial.unreachable(1)):
        assert_clean(trial, poses, solver, 1.1e-10)


LOST_ONCE = [
    ("6R-three-parallel", 0, [2.332179, 0, -np.pi / 2, 3 * np.pi / 2, 0, 2.673796]),
    ("6DOF-P-other", 1, [-0.8047974, -0.7480646, 0, 1.375375, 1.820017, -0.4915693]),
    ("6DOF-P-other", 1, [0.3633811, 2.319763, 0, 2.248554, -0.9955701, -0.7064286]),
    ("5dof", 17, [np.radians(-35), 0, -np.pi / 2, 1.112214, -np.pi / 2]),
]
"""Singular poses at which generated code once had no solution, or lost some."""


@pytest.mark.sweep
@pytest.mark.parametrize(("kind", "number", "q"), LOST_ONCE)
def test_generated_code_has_solutions_of_poses_that_were_lost_once(kind, number, q):
    case = random_arm(kind, number)
    trial, nothing = Trial(case, 1), np.empty((0, case.arm.n))
    assert_clean(trial, trial.poses(np.array([q]), "singular", [nothing]), generated_solver(case))


LOST_BESIDE_OTHERS = [
    ("6R-offset", 20, [-3 * np.pi / 2, 0, -np.pi / 2, 0, np.radians(-35), 2.530727]),
    ("6R-offset", 21, [-np.pi / 2, -np.pi / 2, 0, np.pi / 2, 0, np.pi]),
    ("5dof", 11, [0, -np.pi / 2, 0, -np.pi / 2, 0.519]),
    ("5dof", 17, [0.165268, 0, 2.24137, 1.112214, -np.pi / 2]),
    ("5dof", 17, [np.radians(55), np.pi, -np.pi / 2, -2.342869, np.pi]),
    ("hard", 1, [np.pi, 0, -np.pi / 2, -np.pi / 2, np.pi, 0]),
]
"""Singular poses at which solutions that stand alone were lost once: beside many others, or on sheets of their own."""


@pytest.mark.sweep
@pytest.mark.parametrize("make", [solver_of, generated_solver])
@pytest.mark.parametrize(("kind", "number", "q"), LOST_BESIDE_OTHERS)
def test_solutions_that_stand_alone_at_a_singular_pose_are_found(kind, number, q, make):
    case = HARD[number] if kind == "hard" else random_arm(kind, number)
    trial, q = Trial(case, 1), np.array(q)
    found = by_many_starts(trial.chain, q, starts=150)
    alone = found[smallest_singular_value(trial.chain, found) > 1e-4]
    assert len(alone) > 1
    assert_clean(trial, trial.poses(q[None], "singular", [alone]), make(case))


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["scara-wrist", "ur5", "paul-elbow", "rhino-xr3", "stanford"])
def test_generated_code_loses_nothing_at_poses_of_eighth_turns(name):
    case = ARMS[name]
    solver, trial = generated_solver(case), Trial(case, 1)
    q = np.random.default_rng(3).integers(-3, 5, (1000, case.arm.n)) * np.pi / 4
    assert_clean(trial, trial.poses(q, "singular"), solver)


def test_the_numeric_solver_finds_every_solution_too():
    for name in ("anthropomorphic-position", "scara-rprr"):
        trial = Trial(ARMS[name], 1)
        verdict = trial.judge(trial.regular(), numeric_solver(ARMS[name]))
        assert verdict.is_clean, verdict.missing


def test_the_harness_prints_a_line_for_each_class(capsys):
    assert mass.main(["every", "--class", "1dof", "--arms", "1", "--poses", "1", "--walk"]) == 0
    assert capsys.readouterr().out.split()[:3] == ["1dof", "3/3", "arms:"]


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    make = tmp_path_factory.mktemp
    return cache(lambda name, *targets: built_modules(LOST[name].robot(), make(name), *targets or ("native",)))


def beside_eighth_turns(trial, count, seed):
    """Most angles 1e-9 to 1e-3 from multiples of pi/4, or there."""
    draw, q = np.random.default_rng(seed), trial.configurations(count)
    beside = 10.0 ** draw.uniform(-9, -3, (count, 1)) * draw.integers(-1, 2, q.shape)
    turns = draw.integers(-4, 5, q.shape) * np.pi / 4
    return np.where(draw.random(q.shape) < draw.choice([0.5, 0.8, 1.0], (count, 1)), turns, q) + beside


def test_a_slide_whose_equations_are_singular_at_infinity_is_solved():
    trial = Trial(LOST["prrprr"])
    found = trial.judge(trial.poses(trial.configurations(100), "random"), solver_of(trial.case))
    assert (found.empty, found.found) == (0, 100)


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["parallel-123", "tiago"])
def test_no_solution_is_lost_beside_singular_poses(name, built):
    case, trial = LOST[name], Trial(LOST[name])
    poses = trial.poses(beside_eighth_turns(trial, 300, 5), "beside")
    for solver in (solver_of(case), *(solver_of_module(module, case) for module in built(name).values())):
        found = trial.judge(poses, solver)
        assert (found.empty, found.spurious, found.found) == (0, 0, 300), found.missing


@pytest.mark.parametrize("target", ["numpy", *swept("native")])
def test_a_rounded_pose_is_refused_with_the_tolerance_that_takes_its_nearest_rotation(target, built):
    arm, q = LOST["parallel-123"].arm, np.array([0.3, 0.5, -0.4, 0.2, 0.7, 0.1])
    module, poses = built("parallel-123", target)[target], np.round(forward_kinematics(arm, q[None]), 4)
    with pytest.raises(ValueError, match=r"not orthonormal .*; tolerance=0\.0001 uses the nearest rotation"):
        module.inverse_kinematics(poses)
    found = module.inverse_kinematics(poses, tolerance=1e-4)[0]
    assert np.nanmin(np.abs(found - q).max(axis=1)) < 1e-3
    near = module.inverse_kinematics_nearest(poses[0], q, tolerance=1e-4)
    assert np.abs(near - q).max() < 1e-3
    rotation = forward_kinematics(arm, near[None])[0, :3, :3]
    left, _, right = np.linalg.svd(poses[0, :3, :3])
    assert np.abs(rotation - left @ right).max() < 1e-9
    with pytest.raises(ValueError, match="not orthonormal"):
        module.inverse_kinematics(poses, tolerance=1e-5)
    with pytest.raises(ValueError, match="tolerance must be a number from 0 to 1"):
        module.inverse_kinematics(poses, tolerance=-1e-3)
    with pytest.raises(ValueError, match="reflection"):
        module.inverse_kinematics(poses * [-1, 1, 1, 1], tolerance=1e-3)


def test_the_solver_takes_the_nearest_rotation_of_a_rounded_pose():
    robot, q = LOST["tiago"].robot(), np.array([0.3, 0.5, -0.4, 0.9, 0.7, 0.1, 0.2])
    solver = InverseSolver.of(robot, solve(robot))
    pose, given = np.round(forward_kinematics(LOST["tiago"].arm, q), 4), q[list(solver.graph.given)]
    with pytest.raises(ValueError, match="tolerance="):
        solver.solve(pose, given)
    assert np.nanmin(np.abs(solver.solve(pose, given, tolerance=1e-3).q - q).max(axis=1)) < 1e-2


@pytest.mark.sweep
@pytest.mark.parametrize(("name", "q"), [("rrrp", [0, 0, 0, 0]), ("prrr", [0, 0, np.pi / 2, 0])])
def test_every_solution_that_stands_alone_is_listed_and_no_more_is_not_claimed(name, q, built):
    case, trial, q = LOST[name], Trial(LOST[name]), np.array([q], dtype=float)
    true = by_many_starts(trial.chain, q[0], starts=60)
    assert len(true) == 2
    assert smallest_singular_value(trial.chain, true).min() > 1e-3
    for solver in (solver_of(case), solver_of_module(built(name)["native"], case)):
        verdict = trial.judge(trial.poses(q, "special", [true]), solver, count=2)
        assert verdict.is_clean, verdict.missing
    solved = Model(case.robot()).inverse
    assert (solved.count, solved.complete, solved.everywhere) == (1, True, False)
    assert headline(solved) == "1 solution for almost every reachable pose; special poses may have more"


def right_angled(pattern, seed):
    """An arm of right angles and many zero lengths."""
    draw, rows = random.Random(f"{pattern} {seed}"), []
    for kind in pattern:
        a, d = (draw.choice(["0", "0", "0.3", "0.4", "-0.25"]) for _ in "ad")
        rows.append((kind, "0", d, a, draw.choice(["0", "90", "-90", "90", "180"])))
    return ArmCase("arm", "", tuple(rows), draw.random() < 0.5)


PATTERNS = ["".join(kinds) for n in (2, 3, 4) for kinds in itertools.product("RP", repeat=n) if kinds.count("P") < 3]


@pytest.mark.parametrize("seed", [pytest.param(k, marks=[pytest.mark.sweep] * (k > 0)) for k in range(4)])
def test_arms_with_few_joints_list_every_solution_at_right_angles(seed):
    """The first round a few patterns alone; many starts are the truth."""
    for pattern in PATTERNS if seed else PATTERNS[::7]:
        trial = Trial(right_angled(pattern, seed))
        robot, chain = trial.case.robot(), trial.chain
        try:
            graph = solve(robot)
        except QuantityError:  # joints that do not move the end effector
            continue
        if graph.given or not graph.is_closed:
            continue
        draw = np.random.default_rng(seed)
        turns, shifts = draw.integers(-1, 3, (3, robot.n)), draw.integers(-1, 2, (3, robot.n))
        q = np.where(chain.arm.revolute, turns * np.pi / 2, shifts * 0.3)
        every = [by_many_starts(chain, one, starts=60) for one in q]
        alone = [true[smallest_singular_value(chain, true) > 1e-4] for true in every]
        verdict = trial.judge(trial.poses(q, pattern, alone), solver_of(trial.case))
        assert verdict.found == verdict.true, (seed, verdict.missing)
        assert not graph.everywhere or max(map(len, alone)) <= graph.count, (pattern, seed, q)


COUNTS = {"planar-2r-position": 2, "anthropomorphic-position": 4, "scara-rrpr": 2}
"""Siciliano et al., section 2.12; Spong et al., chapter 5; Pieper 1968."""

MORE_COUNTS = {"puma560": 8, "ur5": 8, "stanford": 8, "dvrk-psm": 8, "panda": 8}
MORE_COUNTS |= {"jaco": 16, "crx-10ia": 16, "manseur-doty": 16}
"""Lee and Liang 1988, Raghavan and Roth 1993: sixteen at the most."""


@pytest.mark.parametrize(("name", "count"), [*COUNTS.items(), *swept(*MORE_COUNTS.items())])
def test_solutions_are_as_many_as_books_and_papers_say(name, count):
    chain = Trial(ARMS[name]).chain
    q = np.random.default_rng(5).uniform(-3, 3, (3, chain.arm.n))
    everything = truth.AllSolutions(chain)
    assert everything.count == count
    real, sure = everything.real(q)
    assert sure.all()
    for own, one in zip(real, q, strict=True):
        assert chain.distance(own, one).min() < 1e-9
        assert np.abs(chain.values(own) - chain.values(one)).max() < 1e-10
        others = by_many_starts(chain, one)
        assert len(others) <= len(own)
        assert all(chain.distance(own, other).min() < 1e-6 for other in others)


def test_random_arms_are_regular_the_same_again_and_in_both_conventions():
    cases = [random_arm(kind, number) for number, kind in enumerate(CLASSES)]
    assert cases[5] == random_arm(list(CLASSES)[5], 5)
    assert all(map(is_regular, cases))
    assert {case.modified for case in cases} == {False, True}


CASE = ARMS["elbow-offset-position"]


@pytest.fixture(scope="module")
def solved():
    """A trial of one arm, some of its poses, their branches, and the solver."""
    trial, solver = Trial(CASE), solver_of(CASE)
    poses = trial.poses(trial.configurations(20), "random")
    return trial, poses, solver(poses.poses, poses.given)[0], solver


def test_the_verdict_on_all_branches_is_clean(solved):
    trial, poses, branches, solver = solved
    found = trial.judge(poses, lambda *_: (branches, None), count=solver.count)
    assert found.is_clean, found.missing
    assert (found.poses, found.complete, found.true, found.found) == (20, 20, 20, 20)
    assert found.residual < 1e-14


def test_the_verdict_sees_what_is_lost_wrong_repeated_or_too_much_and_an_odd_number(solved):
    trial, poses, branches, solver = solved
    own = int(np.abs(np.nan_to_num(branches[3], nan=9.0) - poses.q[3]).max(axis=-1).argmin())
    other = np.flatnonzero(np.isfinite(branches[4]).all(axis=-1))[0]

    def changed(k, row, value, poses=poses):
        new = np.concatenate([branches, np.full_like(branches[:, :1], np.nan)], axis=1)
        new[k, row] = value
        return trial.judge(poses, lambda *_: (new, None), count=solver.count)

    lost = changed(3, own, np.nan)
    assert (lost.true - lost.found, lost.complete, lost.wrong, lost.spurious) == (1, 19, 1, 0)
    assert lost.missing[0].startswith("random: 1 lost, wrong count at q = ")
    assert changed(3, own, poses.q[3] + 1e-3).spurious == 1
    repeated = changed(4, -1, branches[4, other])
    assert (repeated.repeated, repeated.wrong, repeated.is_clean) == (1, 1, False)
    assert changed(slice(None), slice(None), np.nan).empty == 20
    away = trial.unreachable(20)
    assert len(away.poses) == 20
    assert changed(0, -1, np.nan, away).claims == 20


def test_a_second_solver_that_finds_less_is_counted(solved):
    solver = solved[-1]
    assert tried(CASE, solver, 20, 0, second=solver).is_clean
    found = tried(CASE, solver, 20, 0, second=lambda poses, given: (solver(poses, given)[0][:, :1], None))
    assert found.wrong > 0
    assert "second solver" in found.missing[0]


def test_true_solutions_of_an_arm_are_all_asked_for(solved):
    found, unsure = with_truth(CASE, solved[-1], 5, 1)
    assert found.is_clean, found.missing
    assert unsure == 0
    assert found.true > found.poses == 5


@pytest.mark.parametrize("way", [[], ["--build"]], ids=["alone", "built"])
def test_random_arms_are_generated_and_tried(way, capsys):
    assert mass.main(["arms", "--class", "1dof", "--first", "3", "--arms", "2", "--poses", "3", *way]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("1dof")
    assert "2 arms, 0 failed; 6 poses" in lines[0]


@pytest.mark.sweep
@pytest.mark.parametrize(("kind", "number"), GENERAL[::5])
def test_general_arms_lose_no_solution(kind, number):
    case = random_arm(kind, number)
    found = tried(case, solver_of(case), 100, 3, bar=1e-8)
    assert found.is_clean, found.missing
