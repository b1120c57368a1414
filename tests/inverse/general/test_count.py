"""How many complex solutions an arm has, counted modulo a prime."""

import numpy as np
import pytest

from derive.inverse.general.choice import eliminations, find_general
from derive.inverse.general.count import count_solutions, residue_loop
from derive.inverse.general.search import GeneralSolution, free_loop, scaled
from derive.inverse.numeric.chain import POSITION, NumericChain
from tests.inverse.arms import PUBLISHED, random_arm
from tests.inverse.truth import AllSolutions, Chain

CASES = {case.name: case for case in PUBLISHED}

COUNTS = [
    ("manseur-doty", 16),
    pytest.param("puma560", 8, marks=pytest.mark.sweep),
    pytest.param("crx-10ia", 16, marks=pytest.mark.sweep),
    pytest.param("jaco", 16, marks=pytest.mark.sweep),
    pytest.param("panda", 8, marks=pytest.mark.sweep),
    pytest.param("5R1P-general 0", 16, marks=pytest.mark.sweep),
    pytest.param("4R2P-general 1", 8, marks=pytest.mark.sweep),
    pytest.param("5dof 1", 2, marks=pytest.mark.sweep),
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
    solutions = general.solve(chain, chain.pose_and_jacobian(q)[0])
    for mine, true in zip(solutions, AllSolutions(Chain(case.arm, POSITION)).real(q)[0], strict=True):
        mine = mine[np.isfinite(mine[:, 0])]
        assert len(mine) == len(true)
        assert all(np.abs(np.sin((mine - one) / 2)).max(axis=1).min() < 1e-6 for one in true)


def test_the_loop_modulo_a_prime_has_orthogonal_gaps():
    loop = residue_loop(case_of("crx-10ia").robot(choice=False))
    for gap in loop.gaps:
        square = (gap[:3, :3].T @ gap[:3, :3]) % loop.prime
        assert (square == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]).all()
