"""Measures every solver on every arm; a time belongs to solutions that were checked."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice
from typing import Any

from bench.environment import environment
from bench.inverse import ours, peers
from bench.inverse.problem import ARMS, CHECKED, POSES, WAYS, Problem, Solver, Solving
from bench.inverse.report import inverse_markdown
from bench.problems import brief
from bench.results import FOLDER, write_json
from bench.robots import load
from bench.stopwatch import FULL, QUICK, Effort, measure
from bench.terminal import say

SOLVERS = (*ours.SOLVERS, *peers.SOLVERS)


def write_inverse(quick: bool) -> str:
    """Measure and write ``results/inverse.json`` and ``results/inverse.md``.

    Args:
        quick: Whether fewer rounds will do.

    Returns:
        The page.
    """
    results = run(quick)
    page = inverse_markdown(results)
    write_json("inverse", results)
    (FOLDER / "inverse.md").write_text(page, encoding="utf-8")
    return page


def run(quick: bool) -> dict[str, Any]:
    """The content of ``inverse.json``."""
    effort = QUICK if quick else FULL
    absent = {solver.label: list(solver.missing) for solver in SOLVERS if solver.missing}
    present = [solver for solver in SOLVERS if not solver.missing]
    arms = {}
    for name in ARMS:
        problem = Problem(load(name))
        arms[name] = {"title": problem.case.robot.title, "ways": _ways(problem, present, effort)}
    return {
        "environment": environment(),
        "not installed": absent,
        "batch": POSES,
        "rounds": effort.rounds,
        "arms": arms,
    }


def _ways(problem: Problem, solvers: Iterable[Solver], effort: Effort) -> dict[str, dict[str, dict[str, Any]]]:
    """Way -> row -> figures."""
    ways: dict[str, dict[str, dict[str, Any]]] = {}
    for way in WAYS:
        ready: dict[str, Solving] = {}
        cells = ways[way] = {}
        for solver in solvers:
            if solver.way == way:
                try:
                    solving = solver.prepare(problem)
                    solving.run()
                    cells[solver.label] = {"solutions": problem.solutions(list(islice(solving.found(), CHECKED)))}
                    ready[solver.label] = solving
                except Exception as error:
                    cells[solver.label] = {"failed": brief(error)}
        for label, times in measure({label: solving.timed for label, solving in ready.items()}, effort).items():
            cells[label] = {**times, **cells[label]}
            say(f"{problem.case.name}: {way}: {label}: {cells[label]}")
    return ways
