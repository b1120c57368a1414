"""Maps against damped Newton from many starts, which knows neither formulas nor polynomials."""

from dataclasses import replace

import numpy as np
import pytest

from derive.publish import modules
from derive.sampling.maps import MapGrid, computed
from tests.sampling.numeric_arms import ELBOW, PLANAR, PUMA, SCARA, UR5E, NumericArm

SLOW = [pytest.param(arm, marks=pytest.mark.sweep) for arm in (UR5E, PUMA, PLANAR)]
ARMS = pytest.mark.parametrize("arm", [*SLOW, SCARA, ELBOW], ids=lambda arm: arm.name)


def compare(arm: NumericArm, step: float, turns: tuple[int, int], pairs: int, starts: int = 50) -> tuple[int, int]:
    """Random pairs of cell and orientation of a map against numbers; how many are reached, and not."""
    grid = MapGrid.of(arm.robot, step, *turns, conditioning=pairs < 100)
    rng = np.random.default_rng(5)
    goals, values = [np.zeros((0, 4, 4))], []
    for block in grid.blocks:
        middles, near = grid.cells(block)
        records = computed(block, grid).reshape(*near.shape, -1)
        cells = rng.permutation(np.argwhere(near))[: 1 + pairs // len(grid.blocks)]
        turned = rng.integers(records.shape[-1], size=len(cells))
        goal = np.tile(np.eye(4), (len(cells), 1, 1))
        goal[:, :3, :3] = grid.rotations[turned]
        goal[:, ["xyz".index(name) for name in grid.axes], 3] = middles[tuple(cells.T)]
        goals.append(goal)
        values.append(records[(*cells.T, turned)])
    poses, found = np.concatenate(goals), np.concatenate(values)
    searched = arm.solutions(poses, starts)
    counts = np.array([len(q) for q in searched])
    again = np.flatnonzero(counts < found["postures"])  # a few starts more for what few lead to
    for k, q in zip(again, arm.solutions(poses[again], 8 * starts, seed=1), strict=True):
        searched[k], counts[k] = q, len(q)
    assert np.array_equal(counts, found["postures"])
    assert counts.max() <= arm.postures
    reached = counts > 0
    for name in [*grid.kinds][1:]:
        assert np.array_equal(np.isfinite(found[name]), reached), name
    some = np.flatnonzero(reached)
    worth = {"manipulability": arm.manipulability, "margin": arm.margins}
    if grid.conditioning:
        units = grid.row_units
        worth["conditioning"] = lambda q: 1.0 / np.linalg.cond(arm.jacobian(q) / units)
    for name, function in worth.items():
        assert np.allclose(found[name][some], [max(function(searched[k])) for k in some], atol=1e-5), name
    return len(some), len(counts) - len(some)


@pytest.mark.parametrize(
    ("step", "turns", "pairs"), [(0.11, (5, 2), 60), pytest.param(0.05, (16, 6), 2600, marks=pytest.mark.sweep)]
)
@ARMS
@pytest.mark.first(1)
def test_postures_and_their_worth_are_those_of_numbers(
    arm: NumericArm, step: float, turns: tuple[int, int], pairs: int
) -> None:
    assert min(compare(arm, step, turns, pairs)) > 5


@pytest.mark.sweep
def test_without_a_compiler_it_is_the_same_map(monkeypatch: pytest.MonkeyPatch) -> None:
    grid = MapGrid.of(PUMA.robot, 0.3, 4, 2, conditioning=True)
    compiled = computed(grid.blocks[0], grid)
    monkeypatch.setattr(modules, "find_compiler", lambda: None)
    plain = MapGrid.of(replace(PUMA, name="plain").robot, 0.3, 4, 2, conditioning=True)
    assert plain.solver[0].files[-1][0] == "model_numpy.py"
    other = computed(grid.blocks[0], plain)
    for name in grid.kinds:
        assert np.allclose(compiled[name], other[name], atol=1e-6, equal_nan=True), name
