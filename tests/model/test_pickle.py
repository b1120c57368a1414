"""Models, motions and what they give out reach another process, and another variable, with all that was computed."""

import copy
import multiprocessing
import pickle
from collections.abc import Callable
from typing import Any

import pytest

import derive
from derive.model.quantities import DESCRIBED, REGISTRY
from tests.rows import robot_of_rows

BODIES = """
links:
  - {mass: m1, com: [0, l1, 0], inertia: {zz: I1}}
  - {mass: m2, com: [l2, 0, 0], motor: {inertia: 1e-4, ratio: 50}}
  - {mass: 2.5, armature: 0.1, friction: {viscous: b, coulomb: f}}
parameters: {a2: 0.5}
"""
ARM = robot_of_rows("R d: d1 | R alpha: pi/2, limits: [-1, 1] | P alpha: -pi/2, a: a2", BODIES, convention="modified")
PLAN = {
    "robot": "scara-matlab",
    "points": {"a": [0, 0, 1, 0], "b": [1, 0.5, 2, 0.3]},
    "path": ["a", {"to": "b", "time": 1}],
}

COPIES: dict[str, Callable[[Any], Any]] = {
    "pickle": lambda value: pickle.loads(pickle.dumps(value)),
    "deepcopy": copy.deepcopy,
    "copy": copy.copy,
}


def computed(model: derive.Model) -> dict[str, Any]:
    rows = (row for row in REGISTRY.values() if row.is_of(model.robot) and row.name not in ("inverse", "singularities"))
    names = {f"{row.name}[{','.join('123'[: row.indices[0]])}]" if row.indices[0] else row.name for row in rows}
    found = {name: model.quantity(name) for name in sorted(names - {"J_rows[1]", "detJ_rows[1]"})}
    return found | {"energy": model.energy, "solutions": model.inverse.solutions, "lines": model.inverse.lines}


@pytest.fixture(scope="module", params=[False, True], ids=["plain", "assumptions"])
def model(request: pytest.FixtureRequest) -> derive.Model:
    made = derive.Model(ARM, "by-geometry", assumptions=request.param)
    computed(made)
    for name in (*DESCRIBED, "singularities"):
        getattr(made, name)
    return made


@pytest.mark.parametrize("copied", COPIES.values(), ids=COPIES.keys())
def test_a_copy_of_a_model_has_equal_quantities(model: derive.Model, copied: Callable[[Any], Any]) -> None:
    other = copied(model)
    assert (type(other), other.robot, other.style) == (type(model), model.robot, model.style)
    names = ("B", "C", "tau", "energy", "base_parameters", "regressor_base", "J_rpy", "q")
    assert [str(getattr(other, name)) for name in names] == [str(getattr(model, name)) for name in names]
    assert other.B == model.B
    assert str(other.inverse.solutions) == str(model.inverse.solutions)


@pytest.mark.parametrize("name", ["B", "inverse", "workspace", "aspects", "singularities", "energy"])
@pytest.mark.parametrize("copied", COPIES.values(), ids=COPIES.keys())
def test_what_a_model_gives_out_can_be_copied(name: str, copied: Callable[[Any], Any], model: derive.Model) -> None:
    value = getattr(model, name)
    assert repr(copied(value)).partition(" object at ")[0] == repr(value).partition(" object at ")[0]


@pytest.mark.parametrize("copied", COPIES.values(), ids=COPIES.keys())
def test_a_copy_of_a_motion_is_the_same_motion(copied: Callable[[Any], Any]) -> None:
    motion = derive.Motion.from_dict(PLAN)
    torques, peaks = motion.torques(motion.times), motion.peaks
    other = copied(motion)
    assert other == motion
    assert (other.torques(other.times) == torques).all()
    assert str(other.peaks) == str(peaks)


def test_a_long_arm_is_copied_without_its_nested_formulas() -> None:
    """SymPy compares them for minutes."""
    rows = "|".join(f"R a: a{i}, d: d{i}, alpha: {'pi/2' if i % 2 else 0.3}" for i in range(10))
    model = derive.Model(robot_of_rows(rows))
    assert model.T.shape == (4, 4)
    for copied in COPIES.values():
        other = copied(model)
        assert "T" not in vars(other)
        assert other.q == model.q


def solutions_and_mass(model: derive.Model) -> tuple[int, str]:
    """In a process that knows nothing of us."""
    return len(model.inverse.solutions), str(model.M[0, 0])


@pytest.mark.parametrize("model", [True], indirect=True, ids=["assumptions"])
def test_a_model_goes_to_a_spawned_process_and_its_results_come_back(model: derive.Model) -> None:
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(solutions_and_mass, (model,)) == solutions_and_mass(model)
