"""Solvers of inverse kinematics are timed for the right solutions alone."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench.inverse import ours, run
from bench.inverse.peers import SOLVERS
from bench.inverse.problem import ARMS, BATCH, CHECKED, ONE, C, Problem, Solver, Solving, one_by_one
from bench.inverse.report import inverse_markdown, times
from bench.results import FOLDER, read_json
from bench.robots import Array, load
from bench.stopwatch import Effort
from bench.tables import figure
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.solve import solve


@pytest.fixture(scope="module")
def problem() -> Problem:
    return Problem(load("stanford-numeric"))


@pytest.fixture(scope="module")
def found(problem: Problem) -> list[Array]:
    solver = InverseSolver.of(problem.case.robot, solve(problem.case.robot))
    return list(solver.solve(problem.poses[:CHECKED]).q)


def test_all_solutions_count_turned_ones_once_and_what_leads_elsewhere_never(
    problem: Problem, found: list[Array]
) -> None:
    assert problem.solutions(found) == 8.0
    turned = [np.vstack([rows, rows + np.array([2 * np.pi, 0, 0, 0, 0, -2 * np.pi])]) for rows in found]
    assert problem.solutions(turned) == 8.0
    wrong = [np.vstack([rows, rows + np.array([0, 0, 0.01, 0, 0, 0]), np.full((1, 6), np.nan)]) for rows in found]
    assert problem.solutions(wrong) == 8.0


def test_a_solver_that_misses_the_configuration_of_a_pose_has_no_time(problem: Problem, found: list[Array]) -> None:
    q = problem.configurations[0]
    rows = found[0][np.abs(np.exp(1j * found[0]) - np.exp(1j * q)).max(axis=1) > 1e-3]
    with pytest.raises(ValueError, match="misses the configuration"):
        problem.solutions([rows])
    with pytest.raises(ValueError, match="misses the configuration"):
        problem.solutions([np.empty((0, 6))])


def test_figures_and_reasons_reach_the_page(monkeypatch: pytest.MonkeyPatch, found: list[Array]) -> None:
    def _right(given: Problem) -> Solving:
        known = dict(zip(map(bytes, given.poses), found, strict=False))
        return one_by_one(lambda pose: known[bytes(pose)], lambda rows: rows, given.poses[:CHECKED])

    def _refused(given: Problem) -> Solving:
        raise ValueError("takes joints that turn alone")

    solvers = (
        Solver("right", ONE, _right),
        Solver("refuses", BATCH, _refused),
        Solver("absent", C, _right, ("nowhere",)),
    )
    monkeypatch.setattr(run, "SOLVERS", solvers)
    monkeypatch.setattr(run, "ARMS", ("stanford-numeric",))
    monkeypatch.setattr(run, "QUICK", Effort(1, 1e-4))
    results: dict[str, Any] = run.run(quick=True)
    page = inverse_markdown(results)
    assert "Not installed: absent (nowhere)." in page
    assert "refuses, Stanford RRPRRR (numeric): ValueError: takes joints that turn alone" in page
    assert "| right | 8.00 |" in page
    spent = results["arms"]["stanford-numeric"]["ways"][ONE]["right"]["processor"]
    assert f"| right | {figure(spent / 1000)} |" in times(results, ONE)


def test_the_committed_page_is_that_of_the_results_and_has_every_solver_and_arm() -> None:
    assert (FOLDER / "inverse.md").read_text(encoding="utf-8") == inverse_markdown(read_json("inverse"))
    assert {solver.way for solver in (*ours.SOLVERS, *SOLVERS)} == {ONE, C, BATCH}
    folder = Path(run.__file__).parents[1] / "robots"
    assert all((folder / f"{name}.yaml").is_file() for name in ARMS)
