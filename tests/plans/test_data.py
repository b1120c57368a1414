"""Plans as Python data."""

from __future__ import annotations

import numpy as np
import pytest
import yaml

from derive.errors import RobotFileError
from derive.motion.motion import Motion
from derive.plans.catalogue import plan_text, waypoints
from tests.motion.plans import PICK_AND_PLACE


def test_data_of_a_file_are_the_file_again() -> None:
    keys = yaml.safe_load(PICK_AND_PLACE)
    assert yaml.safe_load(plan_text(keys)) == keys
    assert waypoints([[0], [1]], None)["path"] == ["p0", {"to": "p1", "time": None}]


def test_a_mapping_is_what_its_file_is() -> None:
    keys = yaml.safe_load(PICK_AND_PLACE)
    keys["points"]["D"] = np.array([np.pi / 2, 0, 3, 0])
    keys["path"][-1]["line"] = False
    keys["title"] = None
    motion, read = Motion.from_dict(keys), Motion.from_text(PICK_AND_PLACE)
    t = np.linspace(0, 15, 301)
    assert np.abs(np.array(motion(t)) - np.array(read(t))).max() < 1e-14
    assert motion.trajectory.segments[0] == read.trajectory.segments[0], "texts of cells stay exact"


def test_configurations_in_an_array_are_gone_through() -> None:
    rows = np.array([[0, 0, 1, 0], [0.3, 0.4, 1.2, 0], [0.5, -0.1, 1, 0.2]])
    motion = Motion.through("scara-matlab", rows, [1, 0.5], profile="septic", via="pass")
    assert motion(np.array([0, 1, 1.5]))[0] == pytest.approx(rows, abs=1e-15)
    assert repr(motion) == "Motion of scara-matlab, 1.5 s: p0 -> p1, p1 -> p2"
    assert Motion.through("scara-matlab", rows, 2).duration == 4
    assert Motion.through("scara-matlab", rows[:2], speed=[1] * 4).duration == pytest.approx(0.4 * 15 / 8)


@pytest.mark.parametrize(("rows", "times"), [([0, 1], 1), ([[0, 0, 0, 0]], 1), ([[0] * 4] * 3, [1, 2, 3])])
def test_rows_or_times_that_do_not_belong_together(rows: list[float], times: object) -> None:
    with pytest.raises(ValueError, match=r"points: two rows|times: one, or 2"):
        Motion.through("scara-matlab", rows, times)  # type: ignore[arg-type]


def test_what_is_no_plan_is_refused_at_its_place() -> None:
    with pytest.raises(RobotFileError, match=r"<plan>:\d+:\d+: .*4 joints"):
        Motion.through("scara-matlab", [[0, 0], [1, 1]], 1)
