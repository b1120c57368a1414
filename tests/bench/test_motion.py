"""Times of motions: what is timed moves as it should, and the page is that of the results."""

import numpy as np
import pytest

from bench import motion
from bench.motion import CORNERS, FALL, FASTEST, LARGEST, ROBOTS, Row, motion_markdown, seconds
from bench.results import FOLDER, read_json
from derive.motion.motion import Motion
from derive.robot.evaluate import evaluate


def test_the_arm_of_the_falls_has_motors_and_friction_at_its_joints() -> None:
    falling = Motion.from_text(FALL.format(ROBOTS / "puma560-friction.yaml", 0.05, "smooth"))
    run = falling.simulate()
    assert run.reached
    assert run.lost[-1] > 0
    assert run.energy_error < 1e-8


def test_the_fastest_motion_goes_through_the_corners_that_the_other_tool_is_given() -> None:
    fast = Motion.from_text(FASTEST)
    corners = [[evaluate(cell, fast.values) for cell in point.q] for point in fast.plan.points.values() if point.q]
    assert np.array_equal(corners, CORNERS)
    assert len(LARGEST) == fast.plan.robot.n


def test_what_is_slow_has_fewer_turns() -> None:
    turns: list[int] = []
    found = seconds(lambda: turns.append(1), 3)
    assert len(turns) == 3
    assert min(found["processor"], found["passed"]) >= 0


def test_rows_reach_the_page_and_the_committed_one_is_that_of_its_results(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    row = Row("falls", "0.05 s", "0.01 s", "160 s", {"processor": 0.01})
    monkeypatch.setattr(motion, "rows", lambda quick, rounds: iter([row]))
    results = motion.run(quick=True)
    assert "| falls | 0.05 s | 0.01 s | 160 s |" in motion_markdown(results)
    assert results["rows"][0]["numbers"] == {"processor": 0.01}
    results = read_json("motion")
    assert (FOLDER / "motion.md").read_text(encoding="utf-8") == motion_markdown(results)
    assert np.isfinite([value for row in results["rows"] for value in row["numbers"].values()]).all()
