"""The totals of the corpus: how much is printed right, how much wrong, and that all of it is confirmed."""

from __future__ import annotations

from derive.model.model import Model
from derive.robot.robot import Robot
from tests.lectures.frame_results import FRAMES, frame_results
from tests.lectures.lagrange_formulas import FORMULAS
from tests.lectures.method_results import METHODS, SETS, method_results
from tests.lectures.results import ROBOT_FILES, Result
from tests.lectures.robot_results import robot_results

RIGHT = 1416
WRONG = 35
ERRATA = 26
AGAIN_OR_IMPLIED = 83 + 11


def results() -> list[tuple[str, Result]]:
    found = [(file, result) for file in ROBOT_FILES for result in robot_results(file)]
    found += [("frames.yaml", result) for item in FRAMES for result in frame_results(item["id"])]
    found += [("methods.yaml", result) for name in SETS for result in method_results(name)]
    return found + [("methods.yaml", result) for result in other_methods()]


def other_methods() -> list[Result]:
    """Initial conditions, stop condition and general formulas; `test_methods` tests them one by one."""
    model = Model(Robot.load("planar-2r-perugia"))
    found = [Result(name, name, True, formula(model)) for name, formula in FORMULAS.items()]
    found.append(Result("initial conditions", "initial conditions", True, True))
    stops = [Result(item["id"], item["id"], False, False, corrected=True) for item in METHODS["algorithm"]["errata"]]
    return found + stops


def test_the_totals_of_the_corpus() -> None:
    found = results()
    assert all(result.confirmed for _, result in found)
    counted = [(file, result) for file, result in found if result.counted]
    wrong = [(file, result.item) for file, result in counted if not result.ok]
    assert len(counted) - len(wrong) == RIGHT
    assert len(wrong) == WRONG
    assert len(set(wrong)) == ERRATA
    assert len(found) - len(counted) == AGAIN_OR_IMPLIED
