"""Paths without a singularity are found where there are some, and none leads through one."""

from __future__ import annotations

import numpy as np
import pytest

from derive.inverse.numeric.chain import NumericChain
from derive.model.singularities.nonsingular_path import CLEAR, Roadmap, ScaledDeterminant, random_configurations
from derive.robot.robot import Robot

PLANAR = "name: planar\nconvention: standard\njoints: [{type: revolute, a: 1}, {type: revolute, a: 0.7}]\n"


@pytest.fixture(scope="module")
def chain() -> NumericChain:
    return NumericChain.of(Robot.from_text(PLANAR))


def test_the_determinant_of_a_planar_arm_is_the_sine_of_its_elbow(chain: NumericChain) -> None:
    q = random_configurations(chain, 50, 1)
    assert np.abs(ScaledDeterminant(chain)(q)) == pytest.approx(np.abs(np.sin(q[:, 1])), abs=1e-5)


def test_a_path_leads_past_singularities_and_none_through_them(chain: NumericChain) -> None:
    determinant = ScaledDeterminant(chain)
    places = random_configurations(chain, 300, 2)
    above = places[determinant(places) > CLEAR]
    sign = float(np.sign(determinant(np.array([0.0, 1.0]))))
    roads = Roadmap(chain, determinant, above if sign > 0 else places[determinant(places) < -CLEAR], (1,))
    start, end = np.array([0.3, 0.2]), np.array([-2.0, 2.9])
    found = roads.path(start, end)
    assert found is not None
    assert found.path[0] == pytest.approx(start)
    assert np.sin(found.path[-1] - end) == pytest.approx(np.zeros(2), abs=1e-12)
    assert CLEAR < found.clearance <= np.sin(0.2) + 1e-5
    assert roads.path(start, np.array([0.3, -0.2])) is None
